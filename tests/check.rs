//! `steadfast check`: what a file is, or what is wrong with it.

mod support;

use std::path::Path;

use support::*;

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
        let expected = kind_by_keys(&json(&file));
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
