//! Bad files, outputs and usage: one clear sentence, exit status 1, nothing written, never a panic.

use std::path::{Path, PathBuf};

use crate::support::random::Random;
use crate::support::refusals::*;
use crate::support::*;
use serde_json::json;

#[test]
fn a_file_of_300_megabytes_is_refused_unread() {
    let folder = folder();
    let path = folder.path().join("large.json");
    std::fs::File::create(&path)
        .unwrap()
        .set_len(300_000_000)
        .unwrap();
    for verb in ["synthesize", "check", "verify"] {
        let message = steadfast([Path::new(verb), &path]).refusal();
        assert_says(&message, &["large.json", "300000000 bytes", "at most"]);
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_device_without_end_is_refused() {
    let message = steadfast(["check", "/dev/zero"]).refusal();
    assert_says(&message, &["/dev/zero", "bytes or more; at most"]);
}

#[test]
fn a_file_of_another_kind_is_refused() {
    let folder = folder();
    let scenario = json!({ "schema_version": 1, "duration_s": 10.0 }).to_string();
    let scenario = write(folder.path(), "scenario.json", scenario);
    let model = shipped("double-integrator.json");
    let design = double_integrator_design();
    let cases: [(&str, &Path, &str); 4] = [
        (
            "synthesize",
            design,
            "this is a design file; a model file is expected here",
        ),
        (
            "synthesize",
            &scenario,
            "this is a scenario file; a model file is expected here",
        ),
        (
            "verify",
            &model,
            "this is a model file; a design file is expected here",
        ),
        (
            "verify",
            &scenario,
            "this is a scenario file; a design file is expected here",
        ),
    ];
    for (verb, file, sentence) in cases {
        let message = steadfast([Path::new(verb), file]).refusal();
        assert_eq!(message, format!("{}: {sentence}", file.display()));
    }
}

#[test]
fn a_missing_file_and_a_folder_are_refused() {
    let folder = folder();
    let missing = folder.path().join("missing.json");
    for verb in ["synthesize", "verify", "check"] {
        let message = steadfast([Path::new(verb), &missing]).refusal();
        assert_says(&message, &["missing.json", "cannot be read"]);
        let message = steadfast([Path::new(verb), folder.path()]).refusal();
        assert_says(&message, &["cannot be read", "directory"]);
    }
    let arguments = [
        Path::new("export"),
        &missing,
        "--format".as_ref(),
        "sdpa".as_ref(),
    ];
    assert_says(
        &steadfast(arguments).refusal(),
        &["missing.json", "cannot be read"],
    );
}

/// A refusal to write the design of a good model.
#[track_caller]
fn output_refusal(model: &Path, output: &Path) -> String {
    let run = steadfast([Path::new("synthesize"), model, Path::new("-o"), output]);
    run.refusal()
}

#[test]
fn an_output_that_cannot_be_written_is_refused() {
    let folder = folder();
    let model = write(folder.path(), "model.json", cart().to_string());
    let before = text(&model);
    let nowhere = folder.path().join("nowhere/design.json");
    assert_says(
        &output_refusal(&model, &nowhere),
        &["design.json", "folder does not exist"],
    );
    assert_says(
        &output_refusal(&model, folder.path()),
        &["this is a folder"],
    );
    assert_says(
        &output_refusal(&model, &model),
        &["it would be overwritten"],
    );
    assert_eq!(text(&model), before);
    assert_eq!(names_in(folder.path()), ["model.json"]);
}

#[test]
#[cfg(unix)]
fn an_output_that_is_no_ordinary_file_is_not_replaced() {
    use std::os::unix::fs::FileTypeExt;
    let folder = folder();
    let socket: PathBuf = folder.path().join("socket");
    let _listener = std::os::unix::net::UnixListener::bind(&socket).expect("a socket");
    let message = output_refusal(&shipped("double-integrator.json"), &socket);
    assert_says(&message, &["not an ordinary file"]);
    assert!(std::fs::metadata(&socket).unwrap().file_type().is_socket());
}

#[test]
fn bad_usage_ends_with_1_and_says_why() {
    let model = shipped("xu2020.json");
    let model = model.to_str().unwrap();
    let cases: [(&[&str], &str); 8] = [
        (&[], "Usage"),
        (&["dance"], "unrecognized subcommand 'dance'"),
        (&["synthesize"], "<MODEL>"),
        (
            &["synthesize", model, "--fast"],
            "unexpected argument '--fast'",
        ),
        (
            &["synthesize", model, "--objective", "area"],
            "invalid value 'area'",
        ),
        (
            &["synthesize", model, "--form", "short"],
            "[possible values: chordal, vertex-relaxed, full]",
        ),
        (&["export", model, "--format", "pdf"], "invalid value 'pdf'"),
        (&["schema", "everything"], "invalid value 'everything'"),
    ];
    for (arguments, sentence) in cases {
        let run = steadfast(arguments).ends_with(1);
        assert_eq!(run.stdout, "");
        assert_says(&run.stderr, &[sentence]);
    }
}

#[test]
fn help_and_version_are_no_errors() {
    for arguments in [&["--help"][..], &["--version"], &["synthesize", "--help"]] {
        let run = steadfast(arguments).ends_with(0);
        assert_eq!(run.stderr, "");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_not_called_a_success() {
    let full = std::fs::File::options()
        .write(true)
        .open("/dev/full")
        .expect("/dev/full");
    let run = command().args(["schema", "model"]).stdout(full).output();
    let message = Run::new(run.expect("the command runs")).refusal();
    assert_says(&message, &["standard output cannot be written"]);
}

/// A damaged copy of a file: cut short, bits flipped, or digits exchanged.
fn damage(good: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = good.to_vec();
    match random.below(4) {
        0 => bytes.truncate(random.below(good.len())),
        1 => {
            for _ in 0..=random.below(4) {
                let at = random.below(bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
        }
        2 => {
            let at = random.below(bytes.len());
            bytes.remove(at);
        }
        _ => {
            let digits: Vec<usize> = (0..bytes.len())
                .filter(|&at| bytes[at].is_ascii_digit())
                .collect();
            let at = digits[random.below(digits.len())];
            bytes[at] = b"0123456789-e."[random.below(13)];
        }
    }
    bytes
}

/// Runs a verb on damaged copies of a file. It may answer, but it must not fall over.
fn assert_survives(good: &Path, arguments: &[&str], seed: u64, allowed: &[i32]) {
    let good = std::fs::read(good).unwrap();
    let mut random = Random(seed);
    let folder = folder();
    let mut refused = 0;
    for round in 0..250 {
        let path = write(folder.path(), "damaged.json", damage(&good, &mut random));
        let run = command().args(arguments).arg(&path).output();
        let run = Run::new(run.expect("the command runs"));
        let status = run.status.filter(|status| allowed.contains(status));
        assert!(status.is_some(), "seed {seed}, round {round}: {run:#?}");
        assert!(
            !run.stderr.contains("panicked"),
            "seed {seed}, round {round}: {run:#?}"
        );
        if status == Some(1) {
            run.refusal();
            refused += 1;
        }
        assert_eq!(names_in(folder.path()), ["damaged.json"]);
    }
    assert!(refused > 100, "most damage must be seen: {refused} of 250");
}

#[test]
fn a_damaged_model_never_makes_the_check_fall_over() {
    assert_survives(&shipped("xu2020.json"), &["check"], 2020, &[0, 1]);
    assert_survives(
        &shipped("double-integrator.json"),
        &["check"],
        2021,
        &[0, 1],
    );
}

#[test]
fn a_damaged_design_never_makes_the_proof_fall_over() {
    assert_survives(xu2020_design(), &["verify"], 18, &[0, 1, 2]);
    assert_survives(double_integrator_design(), &["verify"], 19, &[0, 1, 2]);
    assert_survives(double_integrator_design(), &["check"], 20, &[0, 1]);
}

#[test]
fn a_damaged_model_never_makes_synthesis_fall_over() {
    let model = shipped("double-integrator.json");
    assert_survives(&model, &["synthesize", "--json"], 7, &[0, 1, 2, 3]);
}

#[test]
fn a_damaged_problem_or_its_design_never_makes_anything_fall_over() {
    let problem = shipped("saturated-pendulum.json");
    assert_survives(&problem, &["check"], 31, &[0, 1]);
    assert_survives(&problem, &["synthesize", "--json"], 32, &[0, 1, 2, 3]);
    let folder = folder();
    let design = folder.path().join("design.json");
    let run = command()
        .arg("synthesize")
        .arg(&problem)
        .arg("-o")
        .arg(&design)
        .output();
    Run::new(run.expect("the command runs")).ends_with(0);
    assert_survives(&design, &["verify"], 33, &[0, 1, 2]);
}

#[test]
fn a_file_that_was_cut_off_is_said_to_end_too_early() {
    let folder = folder();
    // Within a name, within a number and between two keys: of no kind that could be told.
    for contents in [
        r#"{"schema_version": 1, "model": {"name": "x"#,
        r#"{"schema_version": 1, "certificate": {"xi": 714.8"#,
        r#"{"schema_version": 1, "duration_s": 5,"#,
    ] {
        let file = write(folder.path(), "cut.json", contents);
        for verb in ["check", "verify", "synthesize", "simulate"] {
            let message = steadfast([Path::new(verb), &file]).refusal();
            assert_says(&message, &["cut.json: not JSON: the file ends too early"]);
        }
    }
}

#[test]
fn a_bad_use_of_the_arguments_is_one_line() {
    let folder = folder();
    let out = folder.path().join("out");
    let scenario = shipped("wu2018-campaign.json");
    let scenario = word(&scenario);
    let out = word(&out);
    let cases: [(&[&str], &str); 5] = [
        (&["synthesize"], "were not provided: <MODEL>; Usage:"),
        (&["simulate", scenario, "--seed", "3"], "--run-index <K>"),
        (
            &["campaign", scenario, "--runs", "-3", "-o", out],
            "invalid value '-3' for '--runs <N>'",
        ),
        (
            &[
                "campaign", scenario, "--runs", "3", "--jobs", "0", "-o", out,
            ],
            "0 is not in 1..=1024",
        ),
        (
            &[
                "sweep",
                scenario,
                "--vary",
                "seed=1,2",
                "--solver",
                "structured",
                "-o",
                out,
            ],
            "argument --solver: a solver goes with a model",
        ),
    ];
    for (arguments, part) in cases {
        assert_says(&steadfast(arguments).refusal(), &[part]);
    }
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn a_file_in_the_place_of_a_folder_is_refused_before_any_run() {
    let folder = folder();
    let file = write(folder.path(), "taken", "mine");
    let scenario = shipped("wu2018-campaign.json");
    let verbs: [&[&str]; 3] = [
        &["simulate"],
        &["campaign", "--runs", "2"],
        &["sweep", "--vary", "seed=1,2"],
    ];
    for verb in verbs {
        let mut command = command();
        command.args(verb).arg(&scenario).arg("-o").arg(&file);
        let run = Run::new(command.output().expect("the command runs"));
        let expected = format!("{}: this is a file; a folder is needed", file.display());
        assert_eq!(run.refusal(), expected);
    }
    assert_eq!(text(&file), "mine");
}

#[test]
fn a_design_that_the_scenario_has_no_use_for_is_refused_unread() {
    let arguments = [
        Path::new("simulate"),
        &shipped("wu2018.json"),
        "--design".as_ref(),
        "nowhere.json".as_ref(),
    ];
    let message = steadfast(arguments).refusal();
    assert_says(&message, &["wu2018.json", "a design is given"]);
}

#[test]
fn a_name_of_several_lines_is_refused_in_a_scenario_too() {
    let folder = folder();
    let mut scenario = json(&shipped("wu2018.json"));
    scenario["name"] = json!("two\nlines");
    let file = write(folder.path(), "scenario.json", scenario.to_string());
    let message = steadfast([Path::new("simulate"), &file]).refusal();
    assert_says(&message, &["field 'name'", "must be on one line"]);
}
