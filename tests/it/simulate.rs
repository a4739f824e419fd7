//! `steadfast simulate` and `steadfast report` from outside.

use crate::common;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn steadfast(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_steadfast"))
        .args(arguments)
        .output()
        .unwrap()
}

fn model(name: &str) -> String {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    models.join(name).to_str().unwrap().to_string()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A scenario with one piece of its text replaced, and the error it gives.
fn error_of(name: &str, from: &str, to: &str) -> String {
    let original = std::fs::read_to_string(model(name)).unwrap();
    assert!(original.contains(from), "{from}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scenario.json");
    std::fs::write(&path, original.replacen(from, to, 1)).unwrap();
    let output = steadfast(&["simulate", path.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stdout));
    assert!(output.stdout.is_empty());
    let message = text(&output.stderr);
    let place = format!("error: {}: ", path.display());
    let sentence = message
        .strip_prefix(&place)
        .unwrap_or_else(|| panic!("{message}"));
    assert_eq!(sentence.trim_end().lines().count(), 1, "{message}");
    sentence.trim_end().to_string()
}

fn design_file(folder: &Path) -> PathBuf {
    let path = folder.join("design.json");
    std::fs::write(&path, common::spacecraft_design()).unwrap();
    path
}

#[test]
fn json_is_one_object_with_the_promised_keys() {
    let output = steadfast(&["simulate", &model("wu2018.json"), "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let keys = [
        "triggers",
        "updates",
        "bits",
        "bytes",
        "settle_seconds",
        "final_error_deg",
        "rms_error_deg",
        "max_rate",
        "max_torque",
        "impulse",
        "violations",
        "requirements",
    ];
    for key in keys {
        assert!(!summary[key].is_null(), "{key}");
    }
    for key in ["name", "value", "limit", "met"] {
        assert!(!summary["requirements"][0][key].is_null(), "{key}");
    }
    assert_eq!(summary["bytes"], 2016);
}

#[test]
fn a_missed_requirement_gives_status_2() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scenario.json");
    let original = std::fs::read_to_string(model("wu2018.json")).unwrap();
    let strict = original.replace(
        r#"{ "metric": "triggers", "at_most": 100 }"#,
        r#"{ "metric": "triggers", "at_most": 83 }"#,
    );
    std::fs::write(&path, strict).unwrap();
    let output = steadfast(&["simulate", path.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["verdict"], "requirements_missed");
    let missed: Vec<_> = summary["requirements"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|requirement| requirement["met"] == false)
        .map(|requirement| requirement["name"].as_str().unwrap().to_string())
        .collect();
    assert_eq!(missed, ["triggers at most"]);
}

#[test]
fn a_design_is_verified_before_it_is_used() {
    let folder = tempfile::tempdir().unwrap();
    let design = design_file(folder.path());
    let scenario = model("xu2020-closed-loop.json");
    let output = steadfast(&["simulate", &scenario, "--design", design.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("design 'xu2020': PROVED"));
    assert!(text(&output.stdout).contains("the proof covers this run"));
    // A disturbance weight far below what the conditions need.
    let mut tampered: Value = serde_json::from_str(common::spacecraft_design()).unwrap();
    tampered["certificate"]["xi"] = Value::from(1e-9);
    let path = folder.path().join("tampered.json");
    std::fs::write(&path, tampered.to_string()).unwrap();
    let output = steadfast(&["simulate", &scenario, "--design", path.to_str().unwrap()]);
    assert!(text(&output.stderr).contains("NOT PROVED"));
    assert!(text(&output.stdout).contains("- the design is not proved"));
}

#[test]
fn the_files_of_a_run_are_complete_and_the_report_can_be_rebuilt() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let run_path = run.to_str().unwrap();
    let output = steadfast(&["simulate", &model("xu2020-published.json"), "-o", run_path]);
    assert_eq!(output.status.code(), Some(0));
    let mut names: Vec<_> = std::fs::read_dir(&run)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["report.html", "summary.json", "trajectory.csv"]);
    let page = std::fs::read_to_string(run.join("report.html")).unwrap();
    let again = folder.path().join("again.html");
    let output = steadfast(&["report", run_path, "-o", again.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(std::fs::read_to_string(&again).unwrap(), page);
    // The same scenario and seed: the same bytes.
    let second = folder.path().join("second");
    steadfast(&[
        "simulate",
        &model("xu2020-published.json"),
        "-o",
        second.to_str().unwrap(),
    ]);
    for name in names {
        let read = |folder: &Path| std::fs::read(folder.join(&name)).unwrap();
        assert!(read(&run) == read(&second), "{name}");
    }
}

#[test]
fn a_folder_without_a_run_gives_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let output = steadfast(&["report", folder.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("summary.json: cannot be read"));
    std::fs::write(folder.path().join("summary.json"), "{}").unwrap();
    let output = steadfast(&["report", folder.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("not a summary: field"));
}

#[test]
fn a_value_out_of_range_is_named_with_its_value_and_the_allowed_range() {
    let cases = [
        (
            r#""duration_s": 1000"#,
            r#""duration_s": -1"#,
            "field 'duration_s': the value -1 is not allowed; it must be above 0",
        ),
        (
            "[147, 6.5, 6]",
            "[147, 6.5, 7]",
            "field 'system.rigid_body.inertia_kg_m2': entry (1, 3) is 7 but entry (3, 1) is 6; the \
             matrix must be symmetric",
        ),
        (
            r#""relative": 0.5"#,
            r#""relative": 1"#,
            "field 'controller.wu2018.trigger.relative.relative': the value 1 is not allowed; it must \
             be in (0, 1)",
        ),
        (
            r#""euler_321_deg": [5, 5, 5]"#,
            r#""quaternion_scalar_last": [0, 0, 0, 0.9]"#,
            "field 'system.rigid_body.initial_attitude.quaternion_scalar_last': the norm of the quaternion \
             is 0.9; it must be 1 (within 0.01)",
        ),
        (
            r#"{ "metric": "triggers", "at_most": 100 }"#,
            r#"{ "metric": "triggers" }"#,
            "field 'requirements[1]': found 0 limits, expected 1 limit: at_most or at_least",
        ),
        (
            r#""interval_s": 0.03125"#,
            r#""interval_s": 1e-9"#,
            "field 'sampling.instants.periodic.interval_s': 1e-9 s is too short for duration_s, 1000 s: a run \
             has at most 1e9 steps; shorten the run or lengthen the step",
        ),
    ];
    for (from, to, expected) in cases {
        assert_eq!(error_of("wu2018.json", from, to), expected);
    }
}

#[test]
fn a_key_that_is_unknown_missing_or_of_the_wrong_type_is_named() {
    let unknown = error_of("wu2018.json", r#""seed": 1"#, r#""seed": 1, "sed": 2"#);
    assert!(
        unknown.starts_with("field 'random.sed': unknown field `sed`"),
        "{unknown}"
    );
    let missing = error_of("wu2018.json", r#""duration_s": 1000,"#, "");
    assert!(missing.contains("missing field `duration_s`"), "{missing}");
    let wrong = error_of(
        "wu2018.json",
        r#""duration_s": 1000"#,
        r#""duration_s": "long""#,
    );
    assert!(
        wrong.starts_with("field 'duration_s': ") && wrong.contains("\"long\""),
        "{wrong}"
    );
    let metric = error_of("wu2018.json", r#""triggers""#, r#""trigers""#);
    assert!(
        metric.contains("requirements[1].metric") && metric.contains("`triggers`"),
        "{metric}"
    );
    let broken = error_of(
        "wu2018.json",
        r#""schema_version": 1,"#,
        r#""schema_version": 1"#,
    );
    assert!(broken.starts_with("not JSON: "), "{broken}");
}

#[test]
fn a_file_of_another_kind_is_recognised() {
    let output = steadfast(&["simulate", &model("xu2020.json")]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("this is a model file; a scenario file is expected here"));
}

#[test]
fn a_design_that_is_missing_or_not_wanted_is_said() {
    let output = steadfast(&["simulate", &model("xu2020-closed-loop.json")]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("no design file is given; name one with --design"));
    let folder = tempfile::tempdir().unwrap();
    let design = design_file(folder.path());
    let arguments = [
        "simulate",
        &model("wu2018.json"),
        "--design",
        design.to_str().unwrap(),
    ];
    let output = steadfast(&arguments);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("a design is given, but the controller is not 'design'"));
}
