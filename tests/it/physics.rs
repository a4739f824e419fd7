//! Inertias that no rigid body has are refused; numbers out of proportion are warned of, with their values.

use std::path::Path;

use crate::support::refusals::assert_says;
use crate::support::*;
use serde_json::{json, Value};

/// No principal moment may be above the sum of the other two.
fn impossible() -> Value {
    json!([[350, 0, 0], [0, 100, 0], [0, 0, 100]])
}

#[test]
fn an_inertia_that_no_rigid_body_has_is_refused_by_every_verb() {
    let folder = folder();
    let out = folder.path().join("out.json");
    let spoiled = |name: &str, pointer: &str| {
        let mut file = json(&shipped(name));
        set(&mut file, pointer, impossible());
        write(folder.path(), name, file.to_string())
    };
    let model = spoiled("xu2020.json", "/plant/exact/inertia_kg_m2");
    let scenario = spoiled("wu2018.json", "/system/rigid_body/inertia_kg_m2");
    let requirements = spoiled("requirements-large.json", "/spacecraft/inertia_kg_m2");
    let gains = shipped("xu2020-appendix-gains.json");
    let path = |path: &Path| word(path).to_string();
    let cases: [(&str, &Path, Vec<String>); 9] = [
        ("check", &model, vec![]),
        ("check", &scenario, vec![]),
        ("check", &requirements, vec![]),
        ("synthesize", &model, vec!["-o".into(), path(&out)]),
        ("feasibility", &model, vec!["-o".into(), path(&out)]),
        ("analyse", &gains, vec!["--model".into(), path(&model)]),
        ("simulate", &scenario, vec!["-o".into(), path(&out)]),
        (
            "campaign",
            &scenario,
            ["--runs", "2", "-o", out.to_str().unwrap()]
                .map(String::from)
                .into(),
        ),
        ("tune", &requirements, vec!["-o".into(), path(&out)]),
    ];
    for (verb, file, more) in cases {
        let mut arguments = vec![verb.to_string(), path(file)];
        arguments.extend(more);
        let message = steadfast(&arguments).refusal();
        let said = [
            "inertia_kg_m2'",
            "is 350 kg m^2",
            "the other two, 200 kg m^2",
            "no rigid body",
        ];
        assert_says(&message, &said);
        assert!(!out.exists(), "{arguments:?}");
    }
}

#[test]
fn a_flat_plate_is_a_rigid_body() {
    let folder = folder();
    let mut scenario = json(&shipped("wu2018.json"));
    let plate = json!([[3, 0, 0], [0, 1, 0], [0, 0, 2]]);
    set(&mut scenario, "/system/rigid_body/inertia_kg_m2", plate);
    let path = write(folder.path(), "plate.json", scenario.to_string());
    steadfast([Path::new("check"), &path]).ends_with(0);
}

#[test]
fn numbers_that_are_hardly_meant_are_warned_of_before_any_work() {
    let folder = folder();
    let mut model = json(&shipped("xu2020.json"));
    set(&mut model, "/plant/exact/disturbance_bound_nm", json!(3));
    set(&mut model, "/plant/exact/rate_rad_s", json!([5, 5, 5]));
    let path = write(folder.path(), "model.json", model.to_string());
    let report = steadfast([Path::new("check"), &path, Path::new("--json")]);
    let warnings = report.ends_with(0).json()["warnings"].clone();
    let warnings: Vec<String> = serde_json::from_value(warnings).expect("a list");
    assert_eq!(warnings.len(), 4, "{warnings:?}");
    let rate = "plant.exact.rate_rad_s[0]: 5 rad/s are 286.48 deg/s";
    assert!(warnings[0].starts_with(rate), "{warnings:?}");
    let disturbance =
        "plant.exact.disturbance_bound_nm is up to 3 N m, above the smallest torque limit, 2 N m";
    assert!(warnings[3].starts_with(disturbance), "{warnings:?}");
    let words = steadfast([Path::new("synthesize"), &path]);
    assert!(
        words.stderr.contains(&format!("warning: {rate}")),
        "{words:#?}"
    );

    let mut scenario = json(&shipped("wu2018.json"));
    set(&mut scenario, "/duration_s", json!(5));
    remove(&mut scenario, "/metrics");
    set(
        &mut scenario,
        "/system/rigid_body/initial_rate_rad_s",
        json!([0, 2, 0]),
    );
    let path = write(folder.path(), "scenario.json", scenario.to_string());
    let run = steadfast([Path::new("simulate"), &path]);
    let said = "warning: system.rigid_body.initial_rate_rad_s[1]: 2 rad/s are 114.59 deg/s";
    assert!(run.stderr.contains(said), "{run:#?}");
}

#[test]
fn every_shipped_file_is_without_a_warning() {
    for path in all_shipped() {
        let run = steadfast([Path::new("check"), &path]).ends_with(0);
        assert_eq!(run.stderr, "", "{}", path.display());
    }
}
