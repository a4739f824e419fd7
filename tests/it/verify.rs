//! `steadfast verify`: a proof from the file's numbers alone, and refusals that name the condition.

use std::path::Path;

use crate::support::*;
use serde_json::{json, Value};

fn verify(design: &Path) -> Run {
    steadfast([Path::new("verify"), design, Path::new("--json")])
}

/// Verifies the design of xu2020 after an edit.
fn verify_edited(edit: impl FnOnce(&mut Value)) -> Run {
    let folder = folder();
    let mut design = json(xu2020_design());
    edit(&mut design);
    verify(&write(folder.path(), "design.json", design.to_string()))
}

fn scale(design: &mut Value, pointer: &str, factor: f64) {
    let value = number(design, pointer) * factor;
    set(design, pointer, json!(value));
}

#[test]
fn what_synthesize_wrote_is_proved() {
    let before = text(xu2020_design());
    let report = verify(xu2020_design()).ends_with(0).json();
    assert_eq!(report["verdict"], "proved");
    assert!(report["worst"]["name"].is_string());
    assert!(number(&report, "/worst/margin") > 0.0);
    let design = json(xu2020_design());
    assert_eq!(report["gamma"], design["certificate"]["gamma"]);
    assert_eq!(report["conditions"], design["verdict"]["conditions"]);
    assert_eq!(text(xu2020_design()), before);
}

#[test]
fn the_proof_is_reported_in_words_with_what_it_assumes() {
    let run = steadfast([Path::new("verify"), double_integrator_design()]).ends_with(0);
    for part in [
        "verdict: PROVED",
        "worst condition:",
        "the proof assumes:",
        "gamma: 1.99",
    ] {
        assert!(run.stdout.contains(part), "{part} in {}", run.stdout);
    }
}

#[test]
fn a_tampered_number_is_refused_and_the_condition_named() {
    let cases: [(&str, f64, &str); 9] = [
        ("/controller/gains/0/0/0", 0.5, "decrease"),
        ("/controller/trigger_weight/0/0", 1e3, "decrease"),
        (
            "/certificate/integral_weight/0/0",
            -1.0,
            "integral weight positive",
        ),
        (
            "/certificate/sector_weight/0",
            -1.0,
            "sector weight input 1",
        ),
        ("/certificate/gamma", 0.5, "peak gain"),
        (
            "/certificate/gamma",
            0.5,
            "gain bound above disturbance weight",
        ),
        ("/certificate/guaranteed_gain", 0.5, "guaranteed gain"),
        (
            "/certificate/certified_vector_part",
            1.5,
            "certified attitudes",
        ),
        (
            "/model/plant/exact/torque_limit_nm/0",
            0.5,
            "anti-windup input 1",
        ),
    ];
    for (pointer, factor, condition) in cases {
        let run = verify_edited(|design| scale(design, pointer, factor));
        let report = run.ends_with(2).json();
        assert_eq!(report["verdict"], "not_proved", "{pointer}");
        assert!(number(&report, "/worst/margin") <= 0.0, "{pointer}");
        let failed = report["conditions"].as_array().unwrap().iter();
        let failed = failed.filter(|found| number(found, "/margin") <= 0.0);
        let names: Vec<&str> = failed
            .map(|found| found["name"].as_str().unwrap())
            .collect();
        let named = names.iter().any(|name| name.starts_with(condition));
        assert!(named, "{pointer} times {factor}: {names:?}");
    }
}

#[test]
fn a_refusal_in_words_names_the_condition() {
    let folder = folder();
    let mut design = json(xu2020_design());
    scale(&mut design, "/certificate/certified_vector_part", 1.5);
    let path = write(folder.path(), "design.json", design.to_string());
    let run = steadfast([Path::new("verify"), &path]).ends_with(2);
    assert!(run.stdout.contains("verdict: NOT PROVED"), "{}", run.stdout);
    assert!(
        run.stdout.contains("not proved: certified attitudes"),
        "{}",
        run.stdout
    );
}

#[test]
fn the_verdict_in_the_file_is_not_trusted() {
    let denied = verify_edited(|design| {
        set(design, "/verdict/verdict", json!("not_proved"));
        set(design, "/verdict/conditions", json!([]));
    });
    assert_eq!(denied.ends_with(0).json()["verdict"], "proved");
    let claimed = verify_edited(|design| scale(design, "/controller/gains/0/1/1", 0.5));
    assert_eq!(claimed.ends_with(2).json()["verdict"], "not_proved");
}

#[test]
fn a_larger_plant_disturbance_than_designed_for_is_refused() {
    let run = verify_edited(|design| {
        set(
            design,
            "/model/plant/exact/disturbance_bound_nm",
            json!(10.0),
        );
    });
    assert_eq!(run.ends_with(2).json()["verdict"], "not_proved");
}

#[test]
fn a_matrix_that_is_not_symmetric_is_an_invalid_file() {
    let folder = folder();
    let mut design = json(xu2020_design());
    scale(&mut design, "/certificate/lyapunov/0/1", 1.001);
    let path = write(folder.path(), "design.json", design.to_string());
    let message = verify(&path).refusal();
    assert!(message.contains("certificate.lyapunov"), "{message}");
    assert!(message.contains("symmetric"), "{message}");
}
