//! `steadfast analyse` for gains with a trigger on the command: the file it writes, its claims, what it refuses.

use std::path::Path;

use crate::support::json_schema::first_fault;
use crate::support::*;
use serde_json::{json, Value};

fn analyse(gains: &Path, model: &Path, more: &[&str]) -> Run {
    let paths = [gains.to_str(), Some("--model"), model.to_str()];
    let paths = paths.map(|path| path.expect("a path in UTF-8"));
    steadfast([&["analyse"], &paths[..], more].concat())
}

fn wu(more: &[&str]) -> Run {
    let gains = shipped("wu2018-gains.json");
    analyse(&gains, &shipped("wu2018-plant.json"), more)
}

type Change = fn(&mut Value);

/// The shipped model of Wu's spacecraft with a change.
fn changed(folder: &Path, change: impl FnOnce(&mut Value)) -> std::path::PathBuf {
    let mut model = json(&shipped("wu2018-plant.json"));
    change(&mut model);
    write(folder, "model.json", model.to_string())
}

#[test]
fn the_proof_of_wu_2018_is_written_verified_and_claims_the_same() {
    let folder = folder();
    let output = folder.path().join("proof.json");
    let path = word(&output);
    let report = wu(&["--json", "-o", path]).ends_with(0).json();
    assert_eq!(report["verdict"], "proved");
    assert!(number(&report, "/certified_angle_deg") >= 27.6, "{report}");
    assert!(number(&report, "/pointing_deg") <= 0.11, "{report}");
    let again = steadfast(["verify", path, "--json"]).ends_with(0).json();
    for key in [
        "verdict",
        "certified_angle_deg",
        "pointing_deg",
        "rate_bound_rad_s",
        "within_limit",
        "hand_over_s",
        "conditions",
        "not_covered",
    ] {
        assert_eq!(again[key], report[key], "{key}");
    }
    let schema = steadfast(["schema", "held-command-design"]).ends_with(0);
    let schema: Value = serde_json::from_str(&schema.stdout).expect("a JSON schema");
    assert_eq!(first_fault(&schema, &json(&output)), None);
    let kind = steadfast(["check", path, "--json"]).ends_with(0).json();
    assert_eq!(kind["kind"], "held-command design");
}

#[test]
fn a_single_certificate_bounds_the_pointing_where_the_gain_is_the_objective() {
    let folder = folder();
    let model = changed(folder.path(), |model| {
        let last = model["specs"]["command_trigger"]["final"].clone();
        model["plant"]["exact"]["rate_rad_s"] = last["rate_rad_s"].clone();
        model["plant"]["exact"]["q0_min"] = last["q0_min"].clone();
        model["specs"]["phi_per_s"] = last["phi_per_s"].clone();
        model["specs"]["command_trigger"] =
            json!({ "within_limit": 1, "final_level": last["final_level"] });
    });
    let gains = shipped("wu2018-gains.json");
    let report = analyse(&gains, &model, &["--json"]).ends_with(0).json();
    assert!(number(&report, "/certified_angle_deg") > 7.0, "{report}");
    assert!(number(&report, "/pointing_deg") < 0.11, "{report}");
    assert_eq!(report["hand_over_s"], Value::Null);
}

#[test]
fn a_model_that_the_theorem_does_not_cover_is_refused_and_the_field_named() {
    let folder = folder();
    let gains = shipped("wu2018-gains.json");
    let cases: [(&str, Change); 3] = [
        ("specs.command_trigger", |model| {
            let specs = model["specs"].as_object_mut().expect("specs");
            specs.remove("command_trigger");
        }),
        ("imperfections", |model| {
            model["imperfections"] = json!({ "delay_s": 0.1 });
        }),
        ("plant.exact.inertia_uncertainty", |model| {
            model["plant"]["exact"]["inertia_uncertainty"] = json!({ "diagonal_percent": 1 });
        }),
    ];
    for (field, change) in cases {
        let model = changed(folder.path(), change);
        let message = analyse(&gains, &model, &[]).ends_with(1).stderr;
        assert!(message.contains(field), "{field}: {message}");
    }
}

#[test]
fn a_trigger_goes_with_one_gain() {
    let folder = folder();
    let mut gains = json(&shipped("wu2018-gains.json"));
    let gain = gains["gains"][0].clone();
    gains["gains"] = json!([gain, gain]);
    let gains = write(folder.path(), "gains.json", gains.to_string());
    let message = analyse(&gains, &shipped("wu2018-plant.json"), &[]).refusal();
    assert!(message.contains("1 gain with a trigger"), "{message}");
}

#[test]
fn a_disturbance_three_times_as_large_is_not_proved() {
    let folder = folder();
    let output = folder.path().join("proof.json");
    let path = word(&output);
    wu(&["-o", path]).ends_with(0);
    let mut proof = json(&output);
    proof["model"]["plant"]["exact"]["disturbance_bound_nm"] = json!(2.2e-3);
    let changed = write(folder.path(), "changed.json", proof.to_string());
    let changed = word(&changed);
    let answer = steadfast(["verify", changed]).ends_with(2).stdout;
    assert!(
        answer.contains("not proved: supply below the set")
            || answer.contains("not proved: hand-over"),
        "{answer}"
    );
    assert!(!answer.contains("certified set"), "{answer}");
}
