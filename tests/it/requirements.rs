//! From what an engineer knows and requires to a proved design, in one command.

use std::path::{Path, PathBuf};

use serde_json::{json, Value};

use crate::support::*;

/// A shipped file with one value changed.
fn changed(folder: &Path, pointer: &str, value: Value) -> PathBuf {
    let mut file = json(&shipped("facts-cubesat.json"));
    set(&mut file, pointer, value);
    write(folder, "facts.json", file.to_string())
}

#[test]
fn from_facts_alone_a_design_is_proved_that_meets_every_requirement() {
    for name in [
        "facts-cubesat.json",
        "facts-xu2020.json",
        "facts-small-satellite.json",
    ] {
        let folder = folder();
        let path = folder.path().join("design.json");
        let run = synthesize(&shipped(name), &["--json", "-o", word(&path)]);
        let report = run.ends_with(0).json();
        assert_eq!(report["verdict"], "proved", "{name}");
        // Whatever the start in the large set, the bound in the end is that of the small one.
        let handed_over = &report["outer"]["hand_over_s"];
        assert!(
            handed_over.as_f64().is_some_and(|time| time > 0.0),
            "{name}"
        );
        let requirements = report["requirements"].as_array().expect("requirements");
        assert_eq!(requirements.len(), 2, "{name}");
        // In SI units, by the file alone.
        let verified = steadfast([Path::new("verify"), &path, Path::new("--json")]);
        let verified = verified.ends_with(0).json();
        let required = &json(&shipped(name))["requirements"];
        let pointing = number(&verified, "/pointing_deg");
        assert!(
            pointing <= number(required, "/pointing_deg"),
            "{name}: {pointing}"
        );
        let angle = match verified["outer"].is_null() {
            true => number(&verified, "/certified_angle_deg"),
            false => number(&verified, "/outer/certified_angle_deg"),
        };
        assert!(
            angle >= number(required, "/certified_angle_deg"),
            "{name}: {angle}"
        );
        let design = json(&path);
        for key in ["inertia_kg_m2", "torque_limit_nm", "disturbance_bound_nm"] {
            let pointer = format!("/plant/exact/{key}");
            let (found, given) = (&design["model"], &json(&shipped(name)));
            assert_eq!(
                numbers(found.pointer(&pointer)),
                numbers(given.pointer(&pointer)),
                "{name}: {key}"
            );
        }
    }
}

/// All numbers of a value.
fn numbers(value: Option<&Value>) -> Vec<f64> {
    match value.expect("a value") {
        Value::Array(entries) => entries.iter().flat_map(|one| numbers(Some(one))).collect(),
        one => vec![one.as_f64().expect("a number")],
    }
}

#[test]
fn what_is_beyond_reach_is_answered_with_a_change_that_is_proved_when_it_is_made() {
    let folder = folder();
    let facts = changed(folder.path(), "/requirements/pointing_deg", json!(0.012));
    let output = folder.path().join("design.json");
    let arguments = ["--json", "-o", word(&output)];
    let report = synthesize(&facts, &arguments).ends_with(2).json();
    assert_eq!(report["verdict"], "not_proved");
    assert!(!output.exists());
    let fraction = number(&report, "/fraction");
    assert!(fraction > 0.2 && fraction < 1.0, "{fraction}");
    let file = with_first_change(&json(&facts), &report).expect("a change");
    let better = write(folder.path(), "better.json", file.to_string());
    synthesize(&better, &arguments).ends_with(0);
    assert!(output.exists());
}

#[test]
fn a_time_to_settle_is_proved_with_the_pointing_error_that_it_is_about() {
    let folder = folder();
    let mut file = json(&shipped("facts-cubesat.json"));
    set(&mut file, "/requirements/settle_s", json!(120));
    let facts = write(folder.path(), "facts.json", file.to_string());
    let report = synthesize(&facts, &["--json"]).ends_with(0).json();
    let requirements = report["requirements"].as_array().expect("requirements");
    let settle = requirements
        .iter()
        .find(|one| one["requirement"] == "settle_s");
    let proved = number(settle.expect("the time"), "/proved");
    assert!(
        proved > number(&report, "/outer/hand_over_s") && proved <= 120.0,
        "{proved}"
    );

    set(
        &mut file,
        "/requirements",
        json!({ "certified_angle_deg": 30, "settle_s": 120 }),
    );
    let alone = write(folder.path(), "alone.json", file.to_string());
    let message = synthesize(&alone, &[]).refusal();
    assert!(
        message.contains("requirements.settle_s") && message.contains("pointing_deg"),
        "{message}"
    );
}

#[test]
fn a_given_box_and_decay_rate_are_kept() {
    let folder = folder();
    let mut file = json(&shipped("facts-cubesat.json"));
    set(&mut file, "/specs/nu", json!(0.1));
    set(&mut file, "/plant/exact/rate_rad_s", json!([0.2, 0.2, 0.2]));
    let facts = write(folder.path(), "facts.json", file.to_string());
    let output = folder.path().join("design.json");
    synthesize(&facts, &["-o", word(&output)]).ends_with(0);
    let design = json(&output);
    assert_eq!(number(&design, "/model/specs/nu"), 0.1);
    assert_eq!(
        numbers(design.pointer("/model/plant/exact/rate_rad_s")),
        [0.2; 3]
    );
}

#[test]
fn wrong_facts_are_refused_in_one_line_with_the_field() {
    let folder = folder();
    let cases = [
        ("/specs/hbar_s", json!(0.25), "specs.sample_hz"),
        ("/requirements", json!({}), "requirements"),
        (
            "/requirements/pointing_deg",
            json!(-1),
            "requirements.pointing_deg",
        ),
        (
            "/plant/exact/inertia_kg_m2",
            json!([[1, 0, 0], [0, 1, 0], [0, 0, 3]]),
            "plant.exact.inertia_kg_m2",
        ),
        (
            "/plant/exact/disturbance_bound_nm",
            json!(0),
            "plant.exact.disturbance_bound_nm",
        ),
        ("/requirements/pointing", json!(1), "pointing"),
        ("/specs/hmin_s", json!(3), "specs.hmin_s"),
        (
            "/imperfections",
            json!({ "measurement": { "state": [1, 1, 1, 1, 1, 1] } }),
            "imperfections.measurement",
        ),
    ];
    for (pointer, value, field) in cases {
        let facts = changed(folder.path(), pointer, value);
        for verb in ["synthesize", "check"] {
            let run = steadfast([Path::new(verb), &facts]).ends_with(1);
            assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
            assert!(run.stderr.contains(field), "{field}: {}", run.stderr);
        }
    }
    let facts = shipped("facts-cubesat.json");
    let run = synthesize(&facts, &["--objective", "gain"]).ends_with(1);
    assert!(run.stderr.contains("--objective"), "{}", run.stderr);
}
