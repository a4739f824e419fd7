//! Wrong input to every verb: one line with file, field, value and what is allowed, exit status 1, nothing written and
//! nothing replaced.

use std::path::{Path, PathBuf};

use crate::support::refusals::assert_plain;
use crate::support::*;
use serde_json::{json, Value};

/// A folder with one file of every kind, and what is in it before a command runs.
struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    fn new() -> Self {
        let desk = Desk { folder: folder() };
        let kinds = [
            ("model", "double-integrator.json"),
            ("craft", "xu2020.json"),
            ("scenario", "wu2018.json"),
            ("lei", "lei2022.json"),
            ("yang", "yang2025.json"),
            ("linked", "wu2018-link.json"),
            ("campaign", "wu2018-campaign.json"),
            ("loop", "xu2020-closed-loop.json"),
            ("cart", "double-integrator-closed-loop.json"),
            ("gains", "saturating-gains.json"),
            ("problem", "buffer-network.json"),
            ("region", "saturated-pendulum.json"),
            ("rules", "two-rules.json"),
            ("requirements", "requirements-large.json"),
        ];
        for (name, shipped_name) in kinds {
            desk.put(&format!("{name}.json"), &text(&shipped(shipped_name)));
        }
        desk.put("design.json", &text(xu2020_design()));
        desk.put("cart-design.json", &text(double_integrator_design()));
        desk.put("notes.txt", "mine\n");
        desk.put("broken.json", "{ \"schema_version\": 1,");
        desk.put("empty.json", "");
        desk.put("list.json", "[1, 2]");
        desk.put("run.csv", "time_s,x\n0,1\n1,one\n");
        desk.put("program.dat-s", "1\n1\n2\n1\n1 1 1 1 x\n");
        desk
    }

    fn put(&self, name: &str, contents: &str) -> PathBuf {
        write(self.folder.path(), name, contents)
    }

    /// Every file below the folder with its bytes.
    fn state(&self) -> Vec<(PathBuf, Vec<u8>)> {
        fn below(folder: &Path, out: &mut Vec<(PathBuf, Vec<u8>)>) {
            for name in names_in(folder) {
                let path = folder.join(name);
                match path.is_dir() {
                    true => {
                        out.push((path.clone(), Vec::new()));
                        below(&path, out);
                    }
                    false => out.push((path.clone(), std::fs::read(&path).expect("a file"))),
                }
            }
        }
        let mut out = Vec::new();
        below(self.folder.path(), &mut out);
        out
    }

    /// What is wrong with how a command refuses its arguments; `None` when nothing is.
    fn fault(&self, arguments: &[&str], said: &[&str]) -> Option<String> {
        let before = self.state();
        let output = command()
            .args(arguments)
            .current_dir(self.folder.path())
            .output();
        let run = Run::new(output.expect("the command runs"));
        let unmet = |what: &str| Some(format!("{arguments:?}: {what}: {run:#?}"));
        if run.status != Some(1) {
            return unmet("the exit status is not 1");
        }
        if !run.stdout.is_empty() || run.stderr.lines().count() != 1 {
            return unmet("more or less than one line");
        }
        if !run.stderr.starts_with("error: ") || run.stderr.contains("panicked") {
            return unmet("not an error line");
        }
        if let Some(part) = said.iter().find(|part| !run.stderr.contains(**part)) {
            return unmet(&format!("'{part}' is not said"));
        }
        // The name of a solver is no word of the implementation's language.
        assert_plain(&run.stderr.replace("structured", ""));
        (self.state() != before).then(|| format!("{arguments:?}: something was written"))
    }
}

#[track_caller]
fn assert_none(faults: Vec<String>, cases: usize, least: usize) {
    assert!(
        faults.is_empty(),
        "{} of {cases}:\n{}",
        faults.len(),
        faults.join("\n")
    );
    assert!(cases >= least, "{cases} cases");
}

/// Arguments in one text, and what the line must say.
type Case = (&'static str, &'static [&'static str]);

/// Usage: files that are missing, of another kind or broken, and options that are wrong.
const USAGE: [Case; 111] = [
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
        &["--runs", "0 is not allowed", "from 1 to"],
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

#[test]
fn wrong_usage_of_every_verb_is_refused_in_one_line() {
    let desk = Desk::new();
    let faults = USAGE.iter().filter_map(|(arguments, said)| {
        let words: Vec<&str> = arguments.split_whitespace().collect();
        desk.fault(&words, said)
    });
    assert_none(faults.collect(), USAGE.len(), 90);
}

/// A file of the desk, the place of a value, a value that is not allowed, and what the line must say of what is.
type Wrong = (&'static str, &'static str, Value, &'static str);

fn wrong_values() -> Vec<Wrong> {
    vec![
        ("model", "/schema_version", json!(7), "1"),
        ("model", "/name", json!("two\nlines"), "line"),
        ("model", "/specs/phi_per_s", json!(0), "above 0"),
        ("model", "/specs/phi_per_s", json!(-0.1), "above 0"),
        ("model", "/specs/hbar_s", json!("0.1"), "expected a number"),
        (
            "model",
            "/specs/hbar_s",
            json!(1e9),
            "at most 100 / phi_per_s",
        ),
        ("model", "/specs/nu", json!(1), "[0, 1)"),
        ("model", "/specs/nu", json!(-0.1), "[0, 1)"),
        ("model", "/specs/xi_max", json!(0), "above 0"),
        ("model", "/specs/hmin_s", json!(0), "above 0"),
        ("model", "/specs/hmin_s", json!(1), "at most hbar_s"),
        ("model", "/specs/eps", json!([1, 1]), "3 entries"),
        ("model", "/specs/margin", json!(1), "(0, 0.01]"),
        ("model", "/specs/objective", json!("fast"), "gain"),
        ("model", "/specs/must_contain", json!([[0.1]]), "2"),
        ("model", "/specs/speed", json!(1), "unknown field"),
        (
            "model",
            "/plant/vertices/input_limit",
            json!([0]),
            "above 0",
        ),
        ("model", "/plant/vertices/input_limit", json!([1, 1]), "1"),
        (
            "model",
            "/plant/vertices/disturbance_bound",
            json!(-1),
            "0 or above",
        ),
        (
            "model",
            "/plant/vertices/state_matrices",
            json!([]),
            "1 to 4096 matrices",
        ),
        (
            "model",
            "/plant/vertices/state_matrices/1",
            json!([[0, 1]]),
            "2",
        ),
        ("model", "/plant/vertices/input_matrix", json!([[0]]), "2"),
        ("model", "/plant/vertices/box/0/bound", json!(0), "above 0"),
        ("model", "/gains", json!("scheduled"), "mismatch"),
        ("craft", "/plant/exact/q0_min", json!(1.2), "1"),
        (
            "craft",
            "/plant/exact/rate_rad_s",
            json!([0.1, 0.1, 0]),
            "above 0",
        ),
        (
            "craft",
            "/plant/exact/torque_limit_nm",
            json!([2, -2, 2]),
            "above 0",
        ),
        (
            "craft",
            "/plant/exact/inertia_kg_m2/0/1",
            json!(5),
            "symmetric",
        ),
        (
            "craft",
            "/plant/exact/inertia_kg_m2/0/0",
            json!(-350),
            "positive",
        ),
        (
            "craft",
            "/plant/exact/inertia_kg_m2/0/0",
            json!(900),
            "at most the sum of the other two",
        ),
        ("craft", "/specs/must_contain", json!([[0, 0, 0, 1]]), "6"),
        ("craft", "/mismatch", json!({ "kappa": 2 }), "1"),
        ("rules", "/plant/rules/state_bounds", json!([1]), "2"),
        ("rules", "/plant/rules/rules/0/if/0/state", json!(9), "2"),
        ("scenario", "/duration_s", json!(0), "above 0"),
        ("scenario", "/duration_s", json!(1e300), "1e-30 to 1e30"),
        (
            "scenario",
            "/random/generator",
            json!("mersenne"),
            "chacha8",
        ),
        ("scenario", "/random/seed", json!(-1), "whole number"),
        (
            "scenario",
            "/system/rigid_body/initial_rate_rad_s",
            json!([0, 0]),
            "3 entries",
        ),
        (
            "scenario",
            "/system/rigid_body/initial_attitude",
            json!({ "quaternion_scalar_first": [1, 1, 0, 0] }),
            "norm 1",
        ),
        (
            "scenario",
            "/system/rigid_body/initial_attitude",
            json!({ "quaternion": [1, 0, 0, 0] }),
            "quaternion_scalar_first",
        ),
        (
            "scenario",
            "/system/rigid_body/initial_attitude",
            json!({ "axis_angle": { "axis": [0, 0, 0], "angle_deg": 5 } }),
            "length above 0",
        ),
        (
            "scenario",
            "/system/rigid_body/inertia_kg_m2/0/0",
            json!(1e3),
            "at most the sum of the other two",
        ),
        (
            "scenario",
            "/system/rigid_body/actuators",
            json!({ "delay_s": -1 }),
            "0 or above",
        ),
        (
            "scenario",
            "/system/rigid_body/actuators",
            json!({ "torque_limit_nm": [0, 1, 1] }),
            "above 0",
        ),
        (
            "scenario",
            "/system/rigid_body/sensors",
            json!({ "attitude_noise_deg": -1 }),
            "0 or above",
        ),
        (
            "scenario",
            "/system/rigid_body/faults",
            json!([{ "axis": 4, "from_s": 1, "until_s": 2, "effectiveness": 0 }]),
            "1, 2 or 3",
        ),
        (
            "scenario",
            "/system/rigid_body/faults",
            json!([{ "axis": 1, "from_s": 2, "until_s": 1, "effectiveness": 0 }]),
            "above from_s",
        ),
        (
            "scenario",
            "/sampling/instants",
            json!({ "periodic": { "interval_s": 0 } }),
            "above 0",
        ),
        (
            "scenario",
            "/sampling/instants",
            json!({ "aperiodic": { "shortest_s": 0.2, "longest_s": 0.1 } }),
            "shortest_s or above",
        ),
        (
            "scenario",
            "/sampling/dropout_probability",
            json!(1),
            "[0, 1)",
        ),
        (
            "scenario",
            "/integrator",
            json!({ "runge_kutta4": { "step_s": 0 } }),
            "above 0",
        ),
        (
            "scenario",
            "/integrator",
            json!({ "dormand_prince853": { "tolerance": 1 } }),
            "0.001",
        ),
        (
            "scenario",
            "/integrator",
            json!({ "euler": {} }),
            "runge_kutta4",
        ),
        ("scenario", "/controller", json!({ "pid": {} }), "wu2018"),
        (
            "scenario",
            "/controller/wu2018/torque_limit_nm",
            json!([0.2, 0.2]),
            "3 entries",
        ),
        ("scenario", "/metrics/tail_s", json!(1e6), "duration_s"),
        (
            "scenario",
            "/requirements",
            json!([{ "metric": "speed", "at_most": 1 }]),
            "settle_seconds",
        ),
        (
            "scenario",
            "/requirements",
            json!([{ "metric": "triggers" }]),
            "at_most",
        ),
        ("scenario", "/output", json!({ "interval_s": 0 }), "above 0"),
        (
            "lei",
            "/controller/lei2022/performance/time_scale_s",
            json!(0),
            "above 0",
        ),
        (
            "lei",
            "/controller/lei2022/performance/initial",
            json!([0.1, 0.1, 0.1]),
            "hold the start",
        ),
        (
            "lei",
            "/controller/lei2022/trigger/composite/decay_rate_per_s",
            json!(-1),
            "above 0",
        ),
        (
            "yang",
            "/controller/yang2025/gains/power_exponent",
            json!(2),
            "1",
        ),
        (
            "yang",
            "/link/torque_limit_nm",
            json!([0, 0.2, 0.2]),
            "above 0",
        ),
        (
            "cart",
            "/system/takagi_sugeno/initial_state",
            json!([0.2]),
            "2",
        ),
        (
            "cart",
            "/system/takagi_sugeno/mixing",
            json!({ "cycle": { "dwell_s": 0 } }),
            "above 0",
        ),
        ("design", "/schema_version", json!(9), "1"),
        ("design", "/controller/gains", json!([]), "1 to 64 matrices"),
        ("design", "/controller/gains", json!([[[1, 2]]]), "3 x 6"),
        (
            "design",
            "/controller/gains/0/0/0",
            json!("x"),
            "expected a number",
        ),
        (
            "design",
            "/controller/trigger_weight",
            json!([[1]]),
            "6 x 6",
        ),
        ("design", "/certificate/gamma", json!(-1), "above 0"),
        (
            "design",
            "/certificate/gamma",
            json!(null),
            "expected a number",
        ),
        ("design", "/certificate/xi", json!(0), "above 0"),
        ("design", "/certificate/lyapunov/0/1", json!(5), "symmetric"),
        (
            "design",
            "/certificate/certified_vector_part",
            json!(2),
            "[0, 1]",
        ),
        (
            "design",
            "/certificate/sector_weight",
            json!([1, 2]),
            "1 x 3",
        ),
        ("design", "/model/specs/nu", json!(2), "[0, 1)"),
        ("design", "/verdict", json!("proved"), "expected an object"),
        ("campaign", "/dispersions/sampling", json!("grid"), "sobol"),
        (
            "campaign",
            "/dispersions",
            json!({ "speed": 1 }),
            "unknown field",
        ),
        ("gains", "/gains", json!([]), "1"),
        ("gains", "/gains/0", json!([[1, 2], [3]]), "2"),
        (
            "problem",
            "/problem/h_infinity/output_matrix",
            json!([[1, 0]]),
            "3",
        ),
        ("problem", "/problem", json!({ "lqr": {} }), "h_infinity"),
        ("requirements", "/manoeuvre/angle_deg", json!(175), "170"),
        ("requirements", "/limits/accuracy_deg", json!(0), "0.0001"),
        (
            "requirements",
            "/limits/settle_s",
            json!(1),
            "no controller turns this body",
        ),
        ("requirements", "/disturbance/bound_nm", json!(9), "below 5"),
        (
            "requirements",
            "/spacecraft/inertia_kg_m2/0/0",
            json!(2000),
            "at most the sum of the other two",
        ),
        (
            "requirements",
            "/spacecraft/torque_limit_nm",
            json!([5, 5]),
            "3 entries",
        ),
    ]
}

/// The verbs that read a file, and what else they need.
fn readers(name: &str) -> Vec<Vec<&'static str>> {
    match name {
        "model" | "craft" | "rules" => vec![
            vec!["check"],
            vec!["synthesize", "-o", "out.json"],
            vec!["feasibility", "-o", "out.json"],
            vec!["sweep", "--vary", "specs.nu=0.1,0.2", "-o", "out"],
            vec!["export", "--format", "sdpa", "-o", "out.dat-s"],
        ],
        "design" => vec![
            vec!["check"],
            vec!["verify"],
            vec!["export", "--format", "c", "-o", "out.h"],
            vec!["export", "--format", "sdpa", "-o", "out.dat-s"],
        ],
        "gains" => vec![
            vec!["check"],
            vec!["analyse", "--model", "model.json", "-o", "out.json"],
        ],
        "problem" => vec![
            vec!["check"],
            vec!["synthesize", "-o", "out.json"],
            vec!["export", "--format", "sdpa", "-o", "out.dat-s"],
        ],
        "requirements" => vec![vec!["tune", "-o", "out.json"]],
        "cart" => vec![
            vec!["check"],
            vec!["simulate", "--design", "cart-design.json", "-o", "out"],
        ],
        _ => vec![
            vec!["check"],
            vec!["simulate", "-o", "out"],
            vec!["campaign", "--runs", "2", "-o", "out"],
            vec!["sweep", "--vary", "random.seed=1,2", "-o", "out"],
            vec!["compare", "scenario.json", "-o", "out"],
        ],
    }
}

#[test]
fn a_wrong_value_is_refused_by_every_verb_with_file_field_value_and_range() {
    let desk = Desk::new();
    let mut faults = Vec::new();
    let mut cases = 0;
    for (name, pointer, value, allowed) in wrong_values() {
        let mut file = json(&desk.folder.path().join(format!("{name}.json")));
        set(&mut file, pointer, value);
        let path = desk.put("wrong.json", &file.to_string());
        // The key that the line must name: the last of the place that is none of a list's numbers.
        let keys = pointer.rsplit('/');
        let key = keys.clone().find(|key| key.parse::<usize>().is_err());
        for reader in readers(name) {
            let (verb, more) = reader.split_first().expect("a verb");
            let arguments = [&[*verb, "wrong.json"][..], more].concat();
            let fault = desk.fault(&arguments, &["wrong.json", allowed]);
            let named = |fault: &String| format!("{pointer} ({key:?}): {fault}");
            faults.extend(fault.as_ref().map(named));
            cases += 1;
        }
        std::fs::remove_file(path).expect("it is there");
    }
    assert_none(faults, cases, 250);
}
