//! Two checks without rounding, `verify --exact` and the stand-alone Python program, against the check in intervals.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{json, Value};

use crate::support::*;

const DESIGNS: [&str; 2] = ["double-integrator-design.json", "xu2020-design.json"];

/// Edits that break a design, and the condition that then fails.
const BREAKS: [(&str, f64, &str); 6] = [
    ("/controller/gains/0/0/0", 0.5, "decrease r=1 vertex 1"),
    (
        "/controller/trigger_weight/0/0",
        1e3,
        "decrease r=1 vertex 1",
    ),
    (
        "/certificate/integral_weight/0/0",
        -1.0,
        "integral weight positive",
    ),
    ("/certificate/gamma", 0.5, "peak gain"),
    ("/certificate/guaranteed_gain", 0.99, "guaranteed gain"),
    (
        "/certificate/xi",
        2.0,
        "gain bound above disturbance weight",
    ),
];

fn exactly(design: &Path) -> Run {
    let verb = Path::new("verify");
    steadfast([verb, design, Path::new("--exact"), Path::new("--json")])
}

/// The double integrator's design with one number changed.
fn broken(folder: &Path, pointer: &str, factor: f64) -> PathBuf {
    let mut design = json(&fixture(DESIGNS[0]));
    let value = number(&design, pointer) * factor;
    set(&mut design, pointer, json!(value));
    write(folder, "broken.json", design.to_string())
}

fn names(failed: &Value) -> Vec<&str> {
    let failed = failed.as_array().expect("a list of names");
    failed
        .iter()
        .map(|name| name.as_str().expect("a name"))
        .collect()
}

#[test]
fn every_shared_design_is_proved_in_exact_arithmetic() {
    for name in DESIGNS {
        let report = exactly(&fixture(name)).ends_with(0).json();
        assert_eq!(report["exact"]["verdict"], "proved", "{name}");
        let decided = report["exact"]["conditions"].as_u64().expect("a count");
        let conditions = report["conditions"].as_array().expect("conditions");
        assert_eq!(decided, conditions.len() as u64, "{name}");
        assert_eq!(names(&report["exact"]["failed"]), [""; 0], "{name}");
    }
}

#[test]
fn without_the_option_nothing_is_decided_exactly() {
    let design = fixture(DESIGNS[0]);
    let run = steadfast([Path::new("verify"), &design, Path::new("--json")]);
    assert_eq!(run.ends_with(0).json()["exact"], Value::Null);
}

#[test]
fn what_intervals_do_not_prove_of_a_broken_design_does_not_hold_exactly() {
    let folder = folder();
    for (pointer, factor, condition) in BREAKS {
        let report = exactly(&broken(folder.path(), pointer, factor))
            .ends_with(2)
            .json();
        let conditions = report["conditions"].as_array().expect("conditions").iter();
        let not_proved = conditions.filter(|one| number(one, "/margin") < 0.0);
        let not_proved: Vec<&str> = not_proved.filter_map(|one| one["name"].as_str()).collect();
        let failed = names(&report["exact"]["failed"]);
        assert_eq!(failed, not_proved, "{pointer}");
        assert!(failed.contains(&condition), "{pointer}: {failed:?}");
    }
}

#[test]
fn the_exact_check_is_reported_in_words_before_the_verdict() {
    let folder = folder();
    let words = |path: &Path, status| {
        let run = steadfast([Path::new("verify"), path, Path::new("--exact")]);
        run.ends_with(status).stdout
    };
    let proved = words(&fixture(DESIGNS[0]), 0);
    assert!(
        proved.contains("exact arithmetic: all 14 conditions hold\n"),
        "{proved}"
    );
    let not = words(&broken(folder.path(), "/certificate/gamma", 0.5), 2);
    assert!(
        not.contains("exact arithmetic: 2 of 14 conditions do not hold\n"),
        "{not}"
    );
    assert!(not.contains("  does not hold: peak gain\n"), "{not}");
    assert!(not.trim_end().ends_with("verdict: NOT PROVED"), "{not}");
}

#[test]
fn a_proved_infeasibility_is_confirmed_exactly_and_a_weakened_one_denied() {
    let folder = folder();
    let model = folder.path().join("model.json");
    let mut weak = json(&shipped("double-integrator.json"));
    set(&mut weak, "/plant/vertices/input_limit/0", json!(0.01));
    std::fs::write(&model, weak.to_string()).expect("a file");
    let path = folder.path().join("certificate.json");
    let quick = Path::new("--no-relaxations");
    let arguments = [
        Path::new("feasibility"),
        &model,
        quick,
        Path::new("-o"),
        &path,
    ];
    steadfast(arguments).ends_with(2);
    let report = exactly(&path).ends_with(0).json();
    assert_eq!(report["exact"]["verdict"], "proved");
    // The larger multiplier of the torque limit makes the sum of the conditions positive.
    let mut file = json(&path);
    let pointer = "/infeasibility/0/anti_windup/0/unit";
    let value = number(&file, pointer) * 1e3;
    set(&mut file, pointer, json!(value));
    let report = exactly(&write(folder.path(), "weak.json", file.to_string()))
        .ends_with(2)
        .json();
    assert_eq!(report["exact"]["verdict"], "not_proved");
    assert!(
        names(&report["exact"]["failed"]).contains(&"sum of the conditions"),
        "{report}"
    );
}

/// The stand-alone checker on a file: exit status and what it prints; `None` without Python.
fn python_checker(design: &Path) -> Option<(Option<i32>, String)> {
    let script = repository().join("docs/tools/check_design.py");
    let run = Command::new("python3").arg(script).arg(design).output();
    let Ok(run) = run else {
        eprintln!("SKIPPED: python3 is not installed; nothing was compared");
        return None;
    };
    let printed = String::from_utf8_lossy(&run.stdout).into_owned();
    Some((run.status.code(), printed))
}

#[test]
fn a_checker_written_from_the_book_alone_agrees_on_every_shared_design() {
    for name in DESIGNS {
        let Some((status, printed)) = python_checker(&fixture(name)) else {
            return;
        };
        assert_eq!(status, Some(0), "{printed}");
        assert!(
            printed.trim_end().ends_with("conditions, PROVED"),
            "{printed}"
        );
    }
}

#[test]
fn a_checker_written_from_the_book_alone_names_what_does_not_hold_in_a_broken_design() {
    let folder = folder();
    for (pointer, factor, condition) in BREAKS {
        let Some((status, printed)) = python_checker(&broken(folder.path(), pointer, factor))
        else {
            return;
        };
        assert_eq!(status, Some(2), "{pointer}: {printed}");
        assert!(printed.contains(condition), "{pointer}: {printed}");
    }
}
