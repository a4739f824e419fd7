//! `steadfast analyse`: what can be proved for given gains.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::support::*;
use nalgebra::{DMatrix, DVector};
use serde_json::{json, Value};

fn analyse(gains: &Path, model: &Path, output: Option<&Path>) -> Run {
    let mut arguments: Vec<OsString> = vec![
        "analyse".into(),
        gains.into(),
        "--model".into(),
        model.into(),
        "--json".into(),
    ];
    if let Some(output) = output {
        arguments.extend(["-o".into(), output.into()]);
    }
    steadfast(arguments)
}

fn gains_file(folder: &Path, gains: Value) -> PathBuf {
    let file = json!({ "schema_version": 1, "name": "given", "gains": gains });
    write(folder, "gains.json", file.to_string())
}

fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = serde_json::from_value(value.clone()).expect("a matrix");
    DMatrix::from_fn(rows.len(), rows[0].len(), |r, c| rows[r][c])
}

/// Largest |F_s x| / ubar_s over x'Ux <= 1, for the first gain.
fn saturation_ratio(design: &Value) -> f64 {
    let lyapunov = matrix(&design["certificate"]["lyapunov"]);
    let gain = matrix(&design["controller"]["gains"][0]);
    let spread = &gain * lyapunov.try_inverse().expect("positive definite") * gain.transpose();
    let limits = &design["model"]["plant"]["vertices"]["input_limit"];
    let limits: Vec<f64> = serde_json::from_value(limits.clone()).expect("limits");
    let ratios = limits
        .iter()
        .enumerate()
        .map(|(s, limit)| spread[(s, s)].sqrt() / limit);
    ratios.fold(0.0, f64::max)
}

#[test]
fn gains_that_saturate_in_the_certified_set_are_proved_and_keep_their_promise() {
    let folder = folder();
    let output = folder.path().join("design.json");
    let gains = shipped("saturating-gains.json");
    let run = analyse(&gains, &shipped("saturating-cart.json"), Some(&output)).ends_with(0);
    assert_eq!(run.json()["verdict"], "proved");
    let design = json(&output);
    let ratio = saturation_ratio(&design);
    assert!((2.5..5.0).contains(&ratio), "{ratio}");

    // A start on the edge of the certified set, in the direction of the largest command.
    let lyapunov = matrix(&design["certificate"]["lyapunov"]);
    let gain = matrix(&design["controller"]["gains"][0]);
    let direction: DVector<f64> = lyapunov.clone().try_inverse().unwrap() * gain.row(0).transpose();
    let level = (direction.transpose() * &lyapunov * &direction)[(0, 0)];
    let start = direction * (0.999 / level.sqrt());
    let mut scenario = json(&shipped("double-integrator-closed-loop.json"));
    let path = "/system/takagi_sugeno/initial_state";
    for sign in [1.0, -1.0] {
        set(
            &mut scenario,
            path,
            json!([sign * start[0], sign * start[1]]),
        );
        let scenario = write(folder.path(), "scenario.json", scenario.to_string());
        let run = steadfast([
            "simulate".as_ref(),
            scenario.as_os_str(),
            "--design".as_ref(),
            output.as_ref(),
            "--json".as_ref(),
        ]);
        let summary: Value = serde_json::from_str(&run.ends_with(0).stdout).expect("a summary");
        assert_eq!(summary["violations"], 0);
        assert_eq!(summary["certificate"]["covers_run"], true);
        assert_eq!(number(&summary, "/max_torque"), 1.0, "it saturates");
    }
}

#[test]
fn the_gain_of_a_design_is_proved_again_with_the_same_bound() {
    let folder = folder();
    let design = json(double_integrator_design());
    let gains = gains_file(folder.path(), design["controller"]["gains"].clone());
    let report = analyse(&gains, &shipped("double-integrator.json"), None);
    let found = number(&report.ends_with(0).json(), "/gamma");
    let designed = number(&design, "/certificate/gamma");
    // The analysis may not be worse than the synthesis by more than its room of 0.1 %, nor better than
    // the best gain by more than what the synthesis left.
    assert_relative(found, designed, 5e-3);
}

#[test]
fn any_mixture_of_gains_is_no_better_than_each_of_them() {
    let folder = folder();
    let model = shipped("double-integrator.json");
    let both = [json!([[-1.5, -2.0]]), json!([[-1.0, -2.0]])];
    let gamma = |gains: Value| {
        let file = gains_file(folder.path(), gains);
        let output = folder.path().join("design.json");
        let report = analyse(&file, &model, Some(&output)).ends_with(0).json();
        let again = steadfast([Path::new("verify"), &output]).ends_with(0);
        assert!(again.stdout.contains("PROVED"));
        number(&report, "/gamma")
    };
    let single = both.clone().map(|gain| gamma(json!([gain])));
    let mixed = gamma(json!(both));
    assert!(
        mixed > 0.998 * single[0].max(single[1]),
        "{mixed} {single:?}"
    );
}

#[test]
fn gains_of_a_mixture_can_be_proved_but_not_run() {
    let folder = folder();
    let gains = gains_file(folder.path(), json!([[[-1.5, -2.0]], [[-1.0, -2.0]]]));
    let output = folder.path().join("design.json");
    analyse(&gains, &shipped("double-integrator.json"), Some(&output)).ends_with(0);
    let run = steadfast([
        "simulate".as_ref(),
        shipped("double-integrator-closed-loop.json").as_os_str(),
        "--design".as_ref(),
        output.as_ref(),
    ]);
    let message = run.ends_with(1).stderr;
    assert!(message.contains("the design has 2 gains"), "{message}");
}

/// Proves from a written certificate that the conditions cannot hold.
fn refuted_again(certificate: &Path) -> String {
    let run = steadfast([Path::new("verify"), certificate]).ends_with(0);
    assert!(run.stdout.contains("verdict: PROVED"), "{}", run.stdout);
    run.stdout
}

#[test]
fn that_a_gain_which_does_not_stabilise_has_no_proof_is_proved() {
    let folder = folder();
    let gains = gains_file(folder.path(), json!([[[1.0, 1.0]]]));
    let output = folder.path().join("none.json");
    let run = analyse(&gains, &shipped("double-integrator.json"), Some(&output));
    let report = run.ends_with(2).json();
    assert_eq!(report["status"], "infeasible");
    assert_eq!(report["verdict"], "not_proved");
    assert_eq!(report["feasibility"], "infeasible");
    assert_eq!(report["gamma"], Value::Null);
    assert_eq!(number(&report, "/bound"), f64::MAX);
    let words = refuted_again(&output);
    assert!(
        words.contains("for these gains the conditions cannot hold"),
        "{words}"
    );

    // The same numbers say nothing about a gain that has a proof.
    let mut changed = json(&output);
    set(&mut changed, "/gains", json!([[[-1.0, -2.0]]]));
    let changed = write(folder.path(), "changed.json", changed.to_string());
    let run = steadfast([Path::new("verify"), &changed]).ends_with(2);
    assert!(run.stdout.contains("verdict: NOT PROVED"), "{}", run.stdout);
    // Nor without the gains: that no gain has a proof would be another statement.
    let mut changed = json(&output);
    changed.as_object_mut().expect("an object").remove("gains");
    let changed = write(folder.path(), "changed.json", changed.to_string());
    steadfast([Path::new("verify"), &changed]).refusal();
}

#[test]
fn all_gains_of_the_papers_appendix_have_no_proof_on_either_model_because_of_one() {
    let folder = folder();
    let gains = shipped("xu2020-appendix-gains.json");
    for (model, blocking) in [("xu2020-rules.json", 1), ("xu2020.json", 6)] {
        let output = folder.path().join("none.json");
        let run = analyse(&gains, &shipped(model), Some(&output));
        let report = run.ends_with(2).json();
        assert_eq!(report["feasibility"], "infeasible", "{model}");
        assert_eq!(report["blocking_gains"], json!([blocking]), "{model}");
        assert_eq!(number(&report, "/bound"), f64::MAX, "{model}");
        let words = refuted_again(&output);
        let because = format!("gain {blocking} alone excludes them");
        assert!(words.contains(&because), "{words}");
    }
}

#[test]
fn two_gains_that_are_proved_alone_are_refuted_together() {
    let folder = folder();
    // A spring with stiffness between 1 and 9 has one quadratic Lyapunov function only where the damping
    // exceeds sqrt(9) - sqrt(1).
    let both = [json!([[-1.0, -1.5]]), json!([[-9.0, -1.5]])];
    let mut model = json(&shipped("double-integrator.json"));
    set(&mut model, "/plant/vertices/input_limit", json!([20.0]));
    let model = write(folder.path(), "model.json", model.to_string());
    let output = folder.path().join("out.json");
    for gain in &both {
        let file = gains_file(folder.path(), json!([gain]));
        let report = analyse(&file, &model, None).ends_with(0).json();
        assert_eq!(report["verdict"], "proved");
    }
    let file = gains_file(folder.path(), json!(both));
    let report = analyse(&file, &model, Some(&output)).ends_with(2).json();
    assert_eq!(report["feasibility"], "infeasible");
    assert_eq!(report["blocking_gains"], json!([1, 2]));
    let words = refuted_again(&output);
    assert!(
        words.contains("gains 1, 2 together exclude them"),
        "{words}"
    );
}

#[test]
fn the_first_gain_of_the_papers_appendix_is_proved_on_the_exact_model() {
    let folder = folder();
    let appendix = json(&shipped("xu2020-appendix-gains.json"));
    let gains = gains_file(folder.path(), json!([appendix["gains"][0]]));
    let report = analyse(&gains, &shipped("xu2020.json"), None)
        .ends_with(0)
        .json();
    assert_eq!(report["verdict"], "proved");
    let gamma = number(&report, "/gamma");
    // Above the best of any gain on this model, and above the paper's claim.
    assert!((0.1616..0.25).contains(&gamma), "{gamma}");
}

#[test]
fn bad_gains_are_refused_in_one_sentence() {
    let folder = folder();
    let cases: [(&str, &[&str]); 7] = [
        (
            r#"{"schema_version":1,"name":"g","gains":[]}"#,
            &["gains", "at least 1"],
        ),
        (
            r#"{"schema_version":1,"name":"g","gains":[[[1,2,3]]]}"#,
            &["gains[0]", "1 x 3", "1 x 2"],
        ),
        (
            r#"{"schema_version":1,"name":"g","gains":[[[1,2]],[[1]]]}"#,
            &["gains[1]", "1 x 2"],
        ),
        (
            r#"{"schema_version":2,"name":"g","gains":[[[1,2]]]}"#,
            &["schema_version", "2", "1"],
        ),
        (
            r#"{"schema_version":1,"name":"g","gains":[[[1,2]]],"kappa":1}"#,
            &["kappa", "unknown"],
        ),
        (
            r#"{"schema_version":1,"name":"g","gains":[[[1,"a"]]]}"#,
            &["gains[0][0][1]"],
        ),
        (
            r#"{"schema_version":1,"specs":{}}"#,
            &["this is a model file", "gains file"],
        ),
    ];
    for (text, parts) in cases {
        let gains = write(folder.path(), "gains.json", text);
        let message = analyse(&gains, &shipped("double-integrator.json"), None).refusal();
        for part in parts {
            assert!(message.contains(part), "'{part}' is not in: {message}");
        }
    }
    let output = folder.path().join("gains.json");
    write(
        folder.path(),
        "gains.json",
        r#"{"schema_version":1,"name":"g","gains":[[[-1,-2]]]}"#,
    );
    let run = analyse(&output, &shipped("double-integrator.json"), Some(&output));
    assert!(run.refusal().contains("this is the input"));
}
