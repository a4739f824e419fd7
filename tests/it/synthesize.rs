//! `steadfast synthesize`: the verdict, the files it writes and those it must not write.

use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use crate::support::*;
use serde_json::{json, Value};
use sha2::{Digest, Sha256};
use synth::design::DesignFile;

/// Keys of `synthesize --json` that scripts read.
const PROMISED_KEYS: [&str; 10] = [
    "status",
    "gamma",
    "guaranteed_gain",
    "xi",
    "form",
    "vertices",
    "solve_seconds",
    "verdict",
    "conditions",
    "certified_angle_deg",
];

#[track_caller]
fn assert_has_keys(report: &Value, keys: &[&str]) {
    for key in keys {
        assert!(report.get(key).is_some(), "{key} is missing: {report}");
    }
}

/// The spacecraft with a tenth of its torque: Xu & Huang's decay rate cannot be reached.
fn weak_spacecraft(folder: &Path) -> std::path::PathBuf {
    let mut model = json(&shipped("xu2020.json"));
    set(
        &mut model,
        "/plant/exact/torque_limit_nm",
        json!([0.2, 0.2, 0.2]),
    );
    write(folder, "weak.json", model.to_string())
}

#[test]
fn the_spacecraft_of_xu2020_is_proved_with_a_smaller_gain_than_published() {
    let folder = folder();
    let design = folder.path().join("design.json");
    let run = synthesize(
        &shipped("xu2020.json"),
        &["--json", "-o", design.to_str().unwrap()],
    );
    let report = run.ends_with(0).json();
    assert_has_keys(&report, &PROMISED_KEYS);
    assert_eq!(report["status"], "solved");
    assert_eq!(report["verdict"], "proved");
    assert_eq!(report["form"], "reduced");
    assert_eq!(report["vertices"], 16);
    // 0.1616 in the paper. With the form of the gyroscopic torque free no design has less than 0.1246.
    let gamma = number(&report, "/gamma");
    assert!((0.1246..=0.126).contains(&gamma), "{gamma}");
    assert!(number(&report, "/guaranteed_gain") <= gamma);
    let angle = number(&report, "/certified_angle_deg");
    assert!((7.8..=8.2).contains(&angle), "{angle} deg");
    for condition in report["conditions"].as_array().expect("conditions") {
        assert!(condition["name"].is_string());
        assert!(number(condition, "/margin") > 0.0, "{condition}");
    }
    assert_eq!(names_in(folder.path()), ["design.json"]);
    assert_eq!(number(&json(&design), "/certificate/gamma"), gamma);
}

#[test]
fn in_the_papers_form_xu2020_has_the_gains_and_the_gamma_that_an_independent_prototype_found() {
    let design = json(design_in_the_papers_form());
    // 0.15207 is the optimum of the corrected conditions.
    let gamma = number(&design, "/certificate/gamma");
    assert!((0.152..=0.1523).contains(&gamma), "{gamma}");
    let rate = [-141.0, -110.0, -79.0];
    let attitude = [-15.0, -15.8, -19.9];
    for axis in 0..3 {
        let gain = |column: usize| number(&design, &format!("/controller/gains/0/{axis}/{column}"));
        assert_relative(gain(axis), rate[axis], 0.02);
        assert_relative(gain(3 + axis), attitude[axis], 0.02);
    }
}

#[test]
fn the_double_integrator_is_proved_in_words() {
    let run = synthesize(&shipped("double-integrator.json"), &[]).ends_with(0);
    for part in [
        "verdict: PROVED",
        "gamma: 1.99",
        "the proof assumes:",
        "nothing written",
    ] {
        assert!(run.stdout.contains(part), "{part} in {}", run.stdout);
    }
}

#[test]
fn nothing_is_written_without_an_output_path() {
    let folder = folder();
    let run = command()
        .current_dir(folder.path())
        .arg("synthesize")
        .arg(shipped("double-integrator.json"))
        .output();
    Run::new(run.expect("the command runs")).ends_with(0);
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn both_forms_reach_the_same_gain() {
    let objective = |form: &str| {
        let run = synthesize(
            &shipped("double-integrator.json"),
            &["--json", "--form", form],
        );
        let report = run.ends_with(0).json();
        assert_eq!(report["form"], form);
        number(&report, "/solver_runs/0/objective")
    };
    assert_relative(objective("reduced"), objective("full"), 1e-5);
}

#[test]
fn an_infeasible_model_names_what_blocks_and_writes_nothing() {
    let folder = folder();
    let model = weak_spacecraft(folder.path());
    let output = write(folder.path(), "design.json", text(xu2020_design()));
    let run = synthesize(&model, &["--json", "-o", output.to_str().unwrap()]).ends_with(2);
    let report = run.json();
    assert_has_keys(&report, &PROMISED_KEYS);
    assert_eq!(report["status"], "infeasible");
    assert_eq!(report["verdict"], "not_proved");
    assert_eq!(report["gamma"], Value::Null);
    assert!(number(&report, "/slack") > 0.0);
    let blocking = report["blocking"].as_array().expect("blocking conditions");
    assert!(!blocking.is_empty());
    for condition in blocking {
        assert!(!condition["name"].as_str().expect("a name").is_empty());
        assert!((0.0..=1.0).contains(&number(condition, "/share")));
    }
    assert_eq!(text(&output), text(xu2020_design()));
    assert_eq!(names_in(folder.path()), ["design.json", "weak.json"]);
}

#[test]
fn an_infeasible_model_is_explained_in_words() {
    let folder = folder();
    let run = synthesize(&weak_spacecraft(folder.path()), &[]).ends_with(2);
    for part in [
        "INFEASIBLE, proved: no design",
        "smallest slack",
        "conditions that block",
        "nothing written",
    ] {
        assert!(run.stdout.contains(part), "{part} in {}", run.stdout);
    }
}

/// A model of one input that acts on the last state, from which the first comes by integrations.
fn chain(states: usize, matrices: Value, bound: f64, sampling_s: f64, nu: f64) -> Value {
    let mut model = json(&shipped("double-integrator.json"));
    let last = |row: usize| json!([f64::from(u8::from(row + 1 == states))]);
    let plant = json!({
        "state_matrices": matrices,
        "input_matrix": (0..states).map(last).collect::<Vec<_>>(),
        "input_limit": [5],
        "disturbance_bound": bound,
    });
    set(&mut model, "/plant/vertices", plant);
    model["specs"] = json!({
        "phi_per_s": 0.05, "hbar_s": sampling_s, "nu": nu, "xi_max": 1000,
    });
    model
}

#[test]
fn where_the_smallest_gain_leaves_no_margin_a_larger_one_is_proved() {
    // A chain of five states, in which the solver's smallest gain bound is smaller than is true.
    let matrices = json!([[
        [0, 1, 0, 0, 0],
        [0, 0, 1, 0, 0],
        [0, 0, 0, 1, 0],
        [0, 0, 0, 0, 1],
        [0.1, -1, -1, -2, -2]
    ]]);
    let folder = folder();
    let model = chain(5, matrices, 0.01, 0.02, 0.02);
    let path = write(folder.path(), "model.json", model.to_string());
    let report = synthesize(&path, &["--json"]).ends_with(0).json();
    assert_eq!(report["verdict"], "proved");
    // Two masses and a spring, the force on one of them and the other the output.
    let mut model = chain(
        4,
        json!([
            [
                [0, 1, 0, 0],
                [-1, -0.1, 1, 0.1],
                [0, 0, 0, 1],
                [1, 0.1, -1, -0.1]
            ],
            [
                [0, 1, 0, 0],
                [-2, -0.1, 2, 0.1],
                [0, 0, 0, 1],
                [2, 0.1, -2, -0.1]
            ]
        ]),
        0.02,
        0.05,
        0.02,
    );
    model["plant"]["vertices"]["input_matrix"] = json!([[0], [1], [0], [0]]);
    model["plant"]["vertices"]["output_matrix"] = json!([[0, 0, 1, 0]]);
    model["specs"]["xi_max"] = json!(200);
    let path = write(folder.path(), "model.json", model.to_string());
    let report = synthesize(&path, &["--json"]).ends_with(0).json();
    assert_eq!(report["verdict"], "proved");
}

#[test]
fn what_is_not_proved_is_not_written() {
    // A stable plant with a tight disturbance weight: hard for the solver. Whatever comes out, only a
    // proved design may reach the disk.
    let folder = folder();
    let mut model = json(&shipped("double-integrator.json"));
    let plant = json!({
        "state_matrices": [[[-0.0962]], [[0]]],
        "input_matrix": [[0.1477, -0.4485]],
        "input_limit": [6.325, 0.8441],
        "disturbance_bound": 1.1447,
        "box": []
    });
    set(&mut model, "/plant/vertices", plant);
    for xi_max in [0.03, 0.04, 0.05, 0.06, 0.07, 0.1, 1.0] {
        set(&mut model, "/specs/xi_max", json!(xi_max));
        let path = write(folder.path(), "model.json", model.to_string());
        let design = folder.path().join("design.json");
        let run = synthesize(&path, &["--json", "-o", design.to_str().unwrap()]);
        assert!(matches!(run.status, Some(0 | 2 | 3)), "{run:?}");
        assert_eq!(
            run.status == Some(0),
            design.exists(),
            "xi_max {xi_max}: {run:?}"
        );
        if design.exists() {
            std::fs::remove_file(&design).unwrap();
        }
    }
}

#[test]
#[cfg(unix)]
fn an_interrupted_run_leaves_nothing_half_written() {
    let folder = folder();
    let output = write(folder.path(), "design.json", text(xu2020_design()));
    let child = command()
        .arg("synthesize")
        .arg(shipped("xu2020.json"))
        .args(["--form", "full", "-o"]) // the slow form: it is still running when it is stopped
        .arg(&output)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    std::thread::sleep(Duration::from_millis(500));
    let kill = format!("kill -INT {}", child.id());
    assert!(std::process::Command::new("sh")
        .args(["-c", &kill])
        .status()
        .unwrap()
        .success());
    let run = Run::new(child.wait_with_output().expect("the command ends"));
    // Without a status it was stopped before it could listen.
    if run.status.is_some() {
        assert_eq!(run.refusal(), "interrupted; nothing was written");
    }
    assert_eq!(text(&output), text(xu2020_design()));
    assert_eq!(names_in(folder.path()), ["design.json"]);
}

#[test]
fn the_numbers_of_a_design_round_trip_exactly() {
    for path in [xu2020_design(), double_integrator_design()] {
        let written = text(path);
        let (design, _) = DesignFile::from_json(&written).expect("a valid design");
        assert_eq!(design.to_json(), written);
    }
}

#[test]
fn a_design_says_what_made_it() {
    let design = json(double_integrator_design());
    let model = std::fs::read(shipped("double-integrator.json")).unwrap();
    let digest: String = Sha256::digest(model)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    let provenance = &design["provenance"];
    assert_eq!(provenance["model_sha256"], digest);
    let generator = concat!("steadfast ", env!("CARGO_PKG_VERSION"));
    assert_eq!(provenance["generator"], generator);
    assert!(provenance["date"].as_str().unwrap().ends_with('Z'));
    assert!(!provenance["solver_runs"].as_array().unwrap().is_empty());
    assert_eq!(design["model"]["name"], "double-integrator");
}

#[test]
#[cfg(unix)]
fn a_linked_output_is_written_where_the_link_leads() {
    let folder = folder();
    let target = write(folder.path(), "target.json", "");
    let link = folder.path().join("link.json");
    std::os::unix::fs::symlink(&target, &link).unwrap();
    let model = shipped("double-integrator.json");
    synthesize(&model, &["-o", link.to_str().unwrap()]).ends_with(0);
    assert!(link.symlink_metadata().unwrap().is_symlink());
    assert_eq!(json(&target)["verdict"]["verdict"], "proved");
}
