//! Wrong usage of every verb.

/// Arguments in one text, and what the line must say.
pub type Case = (&'static str, &'static [&'static str]);

/// Usage: files that are missing, of another kind or broken, and options that are wrong.
pub const USAGE: [Case; 111] = [
    ("synthesize", &["MODEL"]),
    (
        "synthesize missing.json",
        &["missing.json", "cannot be read"],
    ),
    ("synthesize .", &["cannot be read", "directory"]),
    ("synthesize empty.json", &["empty.json", "not JSON"]),
    (
        "synthesize broken.json",
        &["broken.json", "not JSON", "line 1"],
    ),
    (
        "synthesize list.json",
        &["list.json", "a list", "expected an object"],
    ),
    (
        "synthesize scenario.json",
        &[
            "scenario.json",
            "this is a scenario file",
            "model file is expected",
        ],
    ),
    (
        "synthesize design.json",
        &["design.json", "this is a design file"],
    ),
    (
        "synthesize gains.json",
        &["gains.json", "this is a gains file"],
    ),
    (
        "synthesize requirements.json",
        &["this is a requirements file"],
    ),
    (
        "synthesize model.json --objective speed",
        &["--objective", "speed", "gain"],
    ),
    (
        "synthesize model.json --objective region",
        &["specs.must_contain", "at least one state"],
    ),
    (
        "synthesize model.json --objective both",
        &["specs.outer", "is missing"],
    ),
    (
        "synthesize model.json --form small",
        &["--form", "small", "chordal"],
    ),
    (
        "synthesize model.json --solver mosek",
        &["--solver", "mosek", "clarabel"],
    ),
    (
        "synthesize model.json -o model.json",
        &["model.json", "this is the input"],
    ),
    (
        "synthesize model.json -o .",
        &["this is a folder; a file name is needed"],
    ),
    (
        "synthesize model.json -o no/such/design.json",
        &["its folder does not exist"],
    ),
    (
        "synthesize model.json -o notes.txt",
        &["notes.txt", "holds something else", "--force"],
    ),
    (
        "synthesize model.json -o scenario.json",
        &["scenario.json", "holds a scenario file", "--force"],
    ),
    (
        "synthesize problem.json --form full",
        &["problem.json", "--form"],
    ),
    (
        "synthesize problem.json --objective gain",
        &["problem.json", "--objective"],
    ),
    (
        "synthesize problem.json --cross-check",
        &["problem.json", "--cross-check"],
    ),
    (
        "synthesize problem.json -o design.json",
        &["design.json", "holds a design file"],
    ),
    ("synthesize model.json --unknown", &["--unknown"]),
    ("feasibility", &["MODEL"]),
    (
        "feasibility scenario.json",
        &["scenario.json", "model file is expected"],
    ),
    (
        "feasibility problem.json",
        &["problem.json", "model file is expected"],
    ),
    ("feasibility broken.json", &["broken.json", "not JSON"]),
    (
        "feasibility model.json -o notes.txt",
        &["notes.txt", "--force"],
    ),
    (
        "feasibility model.json -o model.json",
        &["this is the input"],
    ),
    ("analyse gains.json", &["--model"]),
    (
        "analyse model.json --model model.json",
        &["model.json", "gains file is expected"],
    ),
    (
        "analyse gains.json --model gains.json",
        &["gains.json", "model file is expected"],
    ),
    (
        "analyse gains.json --model craft.json",
        &["gains.json", "1 x 2", "3 x 6"],
    ),
    (
        "analyse gains.json --model model.json -o gains.json",
        &["this is the input"],
    ),
    (
        "analyse gains.json --model model.json -o scenario.json",
        &["holds a scenario file"],
    ),
    (
        "analyse missing.json --model model.json",
        &["missing.json", "cannot be read"],
    ),
    ("verify", &["FILE"]),
    (
        "verify model.json",
        &["model.json", "design file is expected"],
    ),
    (
        "verify scenario.json",
        &["scenario.json", "design file is expected"],
    ),
    ("verify broken.json", &["broken.json", "not JSON"]),
    ("verify missing.json", &["missing.json", "cannot be read"]),
    ("check", &["FILE"]),
    ("check notes.txt", &["notes.txt", "not JSON"]),
    ("check list.json", &["list.json", "expected an object"]),
    ("check missing.json", &["missing.json", "cannot be read"]),
    ("simulate", &["SCENARIO"]),
    (
        "simulate model.json",
        &["model.json", "scenario file is expected"],
    ),
    (
        "simulate loop.json",
        &[
            "loop.json",
            "field 'controller.design'",
            "no design file is given",
        ],
    ),
    (
        "simulate loop.json --design model.json",
        &["model.json", "design file is expected"],
    ),
    (
        "simulate loop.json --design missing.json",
        &["missing.json", "cannot be read"],
    ),
    (
        "simulate scenario.json --design design.json",
        &["field 'controller'", "a design is given"],
    ),
    (
        "simulate scenario.json -o notes.txt",
        &["notes.txt", "this is a file; a folder is needed"],
    ),
    (
        "simulate scenario.json -o notes.txt/run",
        &["notes.txt", "is a file"],
    ),
    ("simulate scenario.json --seed 3", &["--run-index"]),
    (
        "simulate campaign.json --run-index 5 --runs 3",
        &["--run-index", "5 is not allowed", "from 0 to 2"],
    ),
    (
        "simulate campaign.json --run-index x",
        &["--run-index", "x"],
    ),
    ("campaign scenario.json -o out", &["--runs"]),
    (
        "campaign scenario.json --runs 0 -o out",
        &["--runs", "'0'", "from 1 to"],
    ),
    ("campaign scenario.json --runs -3 -o out", &["--runs", "-3"]),
    ("campaign scenario.json --runs 3", &["--output"]),
    (
        "campaign scenario.json --runs 3 --shard 4/3 -o out",
        &["--shard", "4/3", "i from 1 to n"],
    ),
    (
        "campaign scenario.json --runs 3 --shard a/b -o out",
        &["--shard", "a/b"],
    ),
    (
        "campaign scenario.json --runs 3 --jobs 0 -o out",
        &["--jobs", "0"],
    ),
    (
        "campaign model.json --runs 3 -o out",
        &["model.json", "scenario file is expected"],
    ),
    (
        "campaign scenario.json --runs 3 -o notes.txt",
        &["notes.txt", "a folder is needed"],
    ),
    (
        "campaign loop.json --runs 3 -o out",
        &["loop.json", "field 'controller.design'"],
    ),
    ("merge missing -o out", &["missing"]),
    ("merge -o out", &["FOLDERS"]),
    ("sweep scenario.json -o out", &["--vary"]),
    (
        "sweep scenario.json --vary duration_s -o out",
        &["--vary", "duration_s"],
    ),
    (
        "sweep scenario.json --vary duration_s=1:2 -o out",
        &["--vary", "duration_s=1:2"],
    ),
    (
        "sweep scenario.json --vary duration_s=1:2:0 -o out",
        &["--vary"],
    ),
    (
        "sweep scenario.json --vary durations=1,2 -o out",
        &["scenario.json", "durations"],
    ),
    (
        "sweep scenario.json --vary duration_s=1,x -o out",
        &["--vary", "x"],
    ),
    (
        "sweep scenario.json --vary duration_s=1,2 --solver clarabel -o out",
        &["--solver", "scenario"],
    ),
    (
        "sweep model.json --vary specs.nu=0.1,0.2 --design design.json -o out",
        &["--design"],
    ),
    (
        "sweep gains.json --vary a=1,2 -o out",
        &["gains.json", "model file is expected"],
    ),
    (
        "sweep scenario.json --vary duration_s=1,2 -o notes.txt",
        &["notes.txt", "a folder is needed"],
    ),
    ("compare scenario.json", &["SCENARIOS"]),
    (
        "compare scenario.json model.json",
        &["model.json", "scenario file is expected"],
    ),
    ("compare scenario.json lei.json", &["lei.json"]),
    (
        "compare scenario.json scenario.json --design design.json",
        &["design.json", "no scenario uses this design"],
    ),
    (
        "compare scenario.json scenario.json -o notes.txt",
        &["notes.txt", "a folder is needed"],
    ),
    ("tune requirements.json", &["--output"]),
    (
        "tune model.json -o out.json",
        &["model.json", "requirements file is expected"],
    ),
    (
        "tune requirements.json -o requirements.json",
        &["this is the input"],
    ),
    (
        "tune requirements.json -o design.json",
        &["holds a design file"],
    ),
    ("report missing", &["missing", "there is no such folder"]),
    ("report notes.txt", &["notes.txt", "this is a file"]),
    (
        "report .",
        &["campaign.json", "not the record of a campaign"],
    ),
    (
        "export design.json --format stl",
        &["--format", "stl", "csv"],
    ),
    (
        "export run.csv --format mat -o out.mat",
        &["run.csv", "line 3", "'one' is not a number"],
    ),
    (
        "export design.json --format c -o scenario.json",
        &["holds a scenario file", "--force"],
    ),
    ("solve program.dat-s", &["program.dat-s"]),
    ("schema planet", &["planet", "model"]),
    ("schema", &["KIND"]),
    ("synthesize model.json -o", &["--output"]),
    (
        "campaign scenario.json --runs 1e3 -o out",
        &["--runs", "1e3", "a whole number"],
    ),
    (
        "campaign scenario.json --runs 2 --keep -1 -o out",
        &["--keep", "-1", "a whole number"],
    ),
    (
        "simulate campaign.json --run-index 0 --seed 1.5",
        &["--seed", "1.5", "a whole number"],
    ),
    (
        "sweep scenario.json --vary duration_s=1,2 --vary duration_s=3,4 -o out",
        &["duration_s", "varied twice"],
    ),
    (
        "sweep scenario.json --vary name=1,2 -o out",
        &["name", "a text, not a number"],
    ),
    (
        "sweep scenario.json --vary duration_s=nan,2 -o out",
        &["nan", "not a finite number"],
    ),
    (
        "simulate loop.json --design cart-design.json",
        &["loop.json", "2 states, 1 inputs", "6 states, 3 inputs"],
    ),
    (
        "simulate cart.json --design design.json -o out",
        &["cart.json", "the design does not fit"],
    ),
    (
        "campaign loop.json --runs 2 --design cart-design.json -o out",
        &["loop.json", "the design does not fit"],
    ),
    (
        "sweep loop.json --vary duration_s=1,2 --design cart-design.json -o out",
        &["loop.json", "does not fit"],
    ),
    (
        "compare loop.json loop.json --design cart-design.json",
        &["loop.json", "the design does not fit"],
    ),
    (
        "compare cart.json cart.json --design cart-design.json",
        &["field 'system'", "only scenarios of a rigid_body"],
    ),
];
