//! `steadfast check`: what a file is, or what is wrong with it.

use std::path::Path;

use crate::support::*;

fn check(file: &Path) -> Run {
    steadfast([Path::new("check"), file, Path::new("--json")])
}

#[test]
fn every_shipped_file_is_valid() {
    let files = all_shipped();
    assert!(files.contains(&shipped("xu2020.json")));
    for file in files {
        let report = check(&file).ends_with(0).json();
        assert_eq!(report["valid"], true, "{}", file.display());
        let expected = shipped_kind(&json(&file));
        assert_eq!(report["kind"], expected, "{}", file.display());
    }
}

#[test]
fn a_design_is_recognised() {
    let report = check(double_integrator_design()).ends_with(0).json();
    assert_eq!(report["kind"], "design");
}

#[test]
fn a_valid_file_is_described_in_words() {
    let run = steadfast([Path::new("check"), &shipped("xu2020.json")]).ends_with(0);
    assert!(
        run.stdout
            .contains("valid model file: xu2020, 16 vertices, 6 states"),
        "{run:?}"
    );
}

#[test]
fn a_design_with_a_damaged_model_names_the_field_in_the_model() {
    let folder = folder();
    let mut design = json(double_integrator_design());
    set(&mut design, "/model/specs/nu", 1.5.into());
    let path = write(folder.path(), "design.json", design.to_string());
    let message = check(&path).refusal();
    assert!(
        message.contains("'model.specs.nu': the value 1.5 is not allowed"),
        "{message}"
    );
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    use std::process::Stdio;
    let mut child = command()
        .arg("check")
        .arg(shipped("xu2020.json"))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    drop(child.stdout.take());
    let run = Run::new(child.wait_with_output().expect("the command ends"));
    assert_eq!(run.ends_with(0).stderr, "");
}

#[test]
fn the_conditions_of_an_intermittent_controller_are_shown_and_change_no_status() {
    let path = shipped("lei2022.json");
    let words = steadfast([Path::new("check"), &path]).ends_with(0).stdout;
    assert!(
        words
            .contains("  FAILS  first layer decays: |q_e0| M_omega > 4 max |rho_i'| / rho_i; 3.83"),
        "{words}"
    );
    assert!(words.contains("  holds  envelope starts above: S2(0) >= V2(0); 4.2000e-3 >= 3.7"));
    let report = check(&path).ends_with(0).json();
    let conditions = report["design_check"]["conditions"].as_array().unwrap();
    assert_eq!(conditions.len(), 14);
    for condition in conditions {
        let sides = condition["left"].as_f64().zip(condition["right"].as_f64());
        let holds = match condition["relation"].as_str() {
            Some(">") => sides.is_some_and(|(left, right)| left > right),
            Some(">=") => sides.is_some_and(|(left, right)| left >= right),
            other => panic!("{other:?}"),
        };
        assert_eq!(condition["holds"], holds, "{condition}");
    }
    let failed = |one: &&serde_json::Value| one["holds"] == false;
    assert_eq!(conditions.iter().filter(failed).count(), 7);
    assert!(check(&shipped("wu2018.json")).json()["design_check"].is_null());
}

#[test]
fn a_controller_without_the_trigger_has_no_conditions_on_it() {
    let folder = folder();
    let mut file = json(&shipped("lei2022.json"));
    let trigger = serde_json::json!({ "every_sample": {} });
    set(&mut file, "/controller/lei2022/trigger", trigger);
    let periodic = serde_json::json!({ "periodic": { "interval_s": 0.1 } });
    set(&mut file, "/sampling/instants", periodic);
    let requirements = file["requirements"].as_array_mut().unwrap();
    requirements.retain(|one| one["metric"] != "threshold_ratio");
    let path = write(folder.path(), "scenario.json", file.to_string());
    let report = check(&path).ends_with(0).json();
    assert!(report["design_check"].is_null(), "{report}");
}
