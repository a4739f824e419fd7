//! `steadfast feasibility`: a proved yes, a proved no, files that prove it again, and what to relax.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::support::*;
use serde_json::{json, Value};

fn feasibility(model: &Path, more: &[&str]) -> Run {
    let output = command().arg("feasibility").arg(model).args(more).output();
    Run::new(output.expect("the command runs"))
}

fn verify(file: &Path, more: &[&str]) -> Run {
    let output = command().arg("verify").arg(file).args(more).output();
    Run::new(output.expect("the command runs"))
}

fn edited(folder: &Path, model: &str, pointer: &str, value: Value) -> PathBuf {
    let mut model = json(&shipped(model));
    set(&mut model, pointer, value);
    write(folder, "model.json", model.to_string())
}

/// The cart with a hundredth of its force.
fn weak_cart(folder: &Path) -> PathBuf {
    let pointer = "/plant/vertices/input_limit";
    edited(folder, "double-integrator.json", pointer, json!([0.01]))
}

/// An infeasibility certificate of the weak cart, made once.
fn certificate() -> &'static Value {
    static CERTIFICATE: OnceLock<Value> = OnceLock::new();
    CERTIFICATE.get_or_init(|| {
        let folder = folder();
        let path = folder.path().join("certificate.json");
        let arguments = ["--no-relaxations", "-o", path.to_str().unwrap()];
        feasibility(&weak_cart(folder.path()), &arguments).ends_with(2);
        json(&path)
    })
}

#[test]
fn the_thresholds_of_xu2020_in_the_papers_form_are_proved_on_both_sides() {
    // Bisection finds ubar = 0.777 N m, nu = 0.896, hbar = 1.159 s; 3 % on either side.
    thresholds(
        Some(json!(vec![[0.0; 3]; 3])),
        [[0.801, 0.754], [0.869, 0.923], [1.124, 1.194]],
    );
}

#[test]
fn the_thresholds_of_xu2020_are_proved_on_both_sides_for_every_form() {
    // In between nothing is proved: what covers every form is weaker than what is known of one.
    thresholds(None, [[0.62, 0.4], [0.93, 0.97], [1.3, 1.5]]);
}

/// Torque limit, threshold and sampling interval: feasible at the first, infeasible at the second of two values.
fn thresholds(form: Option<Value>, values: [[f64; 2]; 3]) {
    let pointers = ["/plant/exact/torque_limit_nm", "/specs/nu", "/specs/hbar_s"];
    let folder = folder();
    for (pointer, values) in pointers.into_iter().zip(values) {
        for (value, (verdict, status)) in
            values.into_iter().zip([("feasible", 0), ("infeasible", 2)])
        {
            let value = match pointer.contains("torque") {
                true => json!([value, value, value]),
                false => json!(value),
            };
            let mut model = json(&shipped("xu2020.json"));
            set(&mut model, pointer, value.clone());
            if let Some(form) = &form {
                set(
                    &mut model,
                    "/plant/exact/gyroscopic_form_kg_m2",
                    form.clone(),
                );
            }
            let model = write(folder.path(), "model.json", model.to_string());
            let run = feasibility(&model, &["--json", "--no-relaxations"]).ends_with(status);
            let report = run.json();
            assert_eq!(report["verdict"], verdict, "{pointer} = {value}");
            let slack = number(&report, "/slack");
            assert_eq!(slack > 0.0, verdict == "infeasible", "{pointer} = {value}");
        }
    }
}

#[test]
fn a_feasible_model_gives_a_design_that_verify_proves() {
    let folder = folder();
    let design = folder.path().join("design.json");
    let model = shipped("double-integrator.json");
    let run = feasibility(&model, &["--json", "-o", design.to_str().unwrap()]);
    let report = run.ends_with(0).json();
    assert_eq!(report["verdict"], "feasible");
    assert_eq!(report["bound"], Value::Null);
    assert_eq!(report["blocking"], json!([]));
    assert!(number(&report, "/slack") < 0.0);
    let report = verify(&design, &["--json"]).ends_with(0).json();
    assert_eq!(report["verdict"], "proved");
}

#[test]
fn an_infeasible_model_gives_a_certificate_that_verify_proves() {
    let folder = folder();
    let path = folder.path().join("certificate.json");
    let model = weak_cart(folder.path());
    let arguments = ["--json", "--no-relaxations", "-o", path.to_str().unwrap()];
    let report = feasibility(&model, &arguments).ends_with(2).json();
    assert_eq!(report["verdict"], "infeasible");
    assert!(number(&report, "/slack") > 0.0);
    assert!(number(&report, "/bound") >= 1e6);
    let blocking = report["blocking"].as_array().expect("conditions");
    assert!(!blocking.is_empty());
    for condition in blocking {
        assert!(condition["name"].is_string(), "{condition}");
        let share = number(condition, "/share");
        assert!(share > 0.0 && share <= 1.0, "{condition}");
    }

    let again = verify(&path, &["--json"]).ends_with(0).json();
    assert_eq!(again["verdict"], "proved");
    assert_eq!(again["statement"], "infeasible");
    assert_eq!(again["bound"], report["bound"]);
    let words = verify(&path, &[]).ends_with(0).stdout;
    assert!(
        words.contains("verdict: PROVED, no design satisfies the conditions"),
        "{words}"
    );
    let check = steadfast([Path::new("check"), &path, Path::new("--json")]);
    assert_eq!(check.ends_with(0).json()["kind"], "infeasibility");
}

#[test]
fn a_certificate_of_another_model_is_not_accepted() {
    let folder = folder();
    let mut file = certificate().clone();
    // With its whole force the cart has a design.
    set(&mut file, "/model/plant/vertices/input_limit", json!([1.0]));
    let path = write(folder.path(), "certificate.json", file.to_string());
    let report = verify(&path, &["--json"]).ends_with(2).json();
    assert_eq!(report["verdict"], "not_proved");
    assert_eq!(report["bound"], Value::Null);
}

#[test]
fn without_a_sample_weight_the_proof_names_its_bound() {
    // eps3 = 0: the multiplier's equation holds to rounding only.
    let folder = folder();
    let mut model = json(&shipped("double-integrator.json"));
    set(&mut model, "/plant/vertices/input_limit", json!([0.01]));
    set(&mut model, "/specs/eps", json!([1, 1, 0]));
    let model = write(folder.path(), "model.json", model.to_string());
    let path = folder.path().join("certificate.json");
    let arguments = ["--json", "--no-relaxations", "-o", path.to_str().unwrap()];
    let report = feasibility(&model, &arguments).ends_with(2).json();
    assert_eq!(report["verdict"], "infeasible");
    let bound = number(&report, "/bound");
    assert!((1e6..f64::MAX).contains(&bound), "{bound:e}");
    let words = verify(&path, &[]).ends_with(0).stdout;
    assert!(words.contains("entries up to R ="), "{words}");
}

#[test]
fn relaxing_the_force_alone_is_found_to_help_and_at_a_proved_value() {
    let folder = folder();
    let model = edited(
        folder.path(),
        "double-integrator.json",
        "/plant/vertices/input_limit",
        json!([0.02]),
    );
    let report = feasibility(&model, &["--json"]).ends_with(2).json();
    let relaxations = report["relaxations"].as_array().expect("relaxations");
    let symbols: Vec<&str> = relaxations
        .iter()
        .map(|relaxation| relaxation["requirement"].as_str().expect("a symbol"))
        .collect();
    for symbol in ["ubar", "hbar", "nu", "phi", "box", "xi_max"] {
        assert!(symbols.contains(&symbol), "{symbol} in {symbols:?}");
    }
    let force = relaxations.iter().find(|one| one["requirement"] == "ubar");
    let force = force.expect("the force");
    let (value, factor) = (number(force, "/value"), number(force, "/factor"));
    let not_at = number(force, "/not_at_factor");
    assert!(
        1.0 <= not_at && not_at < factor && factor < 1.02 * not_at,
        "{force}"
    );
    for (limit, status) in [(value, 0), (0.02 * not_at, 2)] {
        let pointer = "/plant/vertices/input_limit";
        let model = edited(
            folder.path(),
            "double-integrator.json",
            pointer,
            json!([limit]),
        );
        feasibility(&model, &["--no-relaxations"]).ends_with(status);
    }
}

#[test]
fn a_model_with_states_to_contain_is_refuted_for_every_weight_that_is_tried() {
    let folder = folder();
    let mut model = json(&shipped("double-integrator.json"));
    // Outside the box |x| <= 1.
    set(&mut model, "/specs/must_contain", json!([[2.0, 0.0]]));
    let model = write(folder.path(), "model.json", model.to_string());
    let path = folder.path().join("certificate.json");
    let arguments = ["--json", "--no-relaxations", "-o", path.to_str().unwrap()];
    let report = feasibility(&model, &arguments).ends_with(2).json();
    // No other weight is covered.
    assert_eq!(report["verdict"], "undecided");
    let sets = json(&path)["infeasibility"]
        .as_array()
        .expect("sets")
        .clone();
    let weights = sets.iter().map(|set| number(set, "/containment_weight"));
    assert_eq!(weights.collect::<Vec<_>>(), [0.5, 1.0, 0.25, 2.0]);
    verify(&path, &[]).ends_with(2);
}

#[test]
fn synthesize_proves_that_no_design_exists() {
    let folder = folder();
    let model = weak_cart(folder.path());
    let run = steadfast([Path::new("synthesize"), &model, Path::new("--json")]);
    let report = run.ends_with(2).json();
    assert_eq!(report["status"], "infeasible");
    assert_eq!(report["feasibility"], "infeasible");
    assert!(number(&report, "/bound") >= 1e6);
    let words = steadfast([Path::new("synthesize"), &model])
        .ends_with(2)
        .stdout;
    assert!(words.contains("INFEASIBLE, proved"), "{words}");
}

#[test]
fn bad_models_and_certificates_are_refused_with_the_field() {
    let folder = folder();
    let refusal = |path: &Path| steadfast([Path::new("verify"), path]).refusal();
    let mut cases: Vec<(&str, Value, &[&str])> = vec![
        ("/schema_version", json!(2), &["schema_version", "2"]),
        (
            "/infeasibility",
            json!([]),
            &["infeasibility", "at least 1"],
        ),
        ("/infeasibility/0/unheard_of", json!(1), &["unheard_of"]),
        (
            "/infeasibility/0/containment_weight",
            json!(1.0),
            &["infeasibility[0].containment_weight", "left out"],
        ),
        (
            "/infeasibility/0/decrease_end/vertices/0/vertex",
            json!(3),
            &["infeasibility[0].decrease_end.vertices[0].vertex", "1 to 2"],
        ),
        (
            "/infeasibility/0/integral",
            json!([[1.0, 2.0], [3.0, 4.0]]),
            &["infeasibility[0].integral", "symmetric"],
        ),
        (
            "/infeasibility/0/integral",
            json!([[1.0]]),
            &["infeasibility[0].integral", "2 x 2"],
        ),
        (
            "/infeasibility/0/anti_windup",
            json!([]),
            &["infeasibility[0].anti_windup", "1 entries"],
        ),
        (
            "/infeasibility/0/anti_windup/0/unit",
            json!(1e40),
            &["infeasibility[0].anti_windup[0].unit", "1e30"],
        ),
    ];
    let nothing: &[&str] = &["infeasibility[0].decrease_start.multiplied_sample"];
    cases.push((
        "/infeasibility/0/decrease_start/multiplied_sample",
        Value::Null,
        nothing,
    ));
    for (pointer, value, parts) in cases {
        let mut file = certificate().clone();
        set(&mut file, pointer, value);
        let path = write(folder.path(), "certificate.json", file.to_string());
        let message = refusal(&path);
        for part in parts {
            assert!(message.contains(part), "'{part}' is not in: {message}");
        }
    }
    let path = write(folder.path(), "certificate.json", certificate().to_string());
    let message = feasibility(&path, &[]).refusal();
    let expected = "this is an infeasibility file; a model file is expected here";
    assert!(message.contains(expected), "{message}");
    let model = edited(folder.path(), "xu2020.json", "/specs/nu", json!(1.5));
    let message = feasibility(&model, &[]).refusal();
    assert!(
        message.contains("specs.nu") && message.contains("[0, 1)"),
        "{message}"
    );
}

#[test]
fn the_design_of_a_model_for_two_certificates_is_one_for_the_gain() {
    let folder = folder();
    let output = folder.path().join("design.json");
    let model = shipped("xu2020-both.json");
    let path = word(&output);
    feasibility(&model, &["--no-relaxations", "-o", path]).ends_with(0);
    assert_eq!(json(&output)["model"]["specs"]["objective"], "gamma");
    verify(&output, &[]).ends_with(0);
}

#[test]
fn a_limit_on_xi_that_is_far_too_small_is_found_to_block() {
    let folder = folder();
    let mut model = json(&shipped("double-integrator.json"));
    // About 1e8 times below where it would no longer matter.
    set(&mut model, "/specs/xi_max", json!(2e-6));
    let path = write(folder.path(), "model.json", model.to_string());
    let report = feasibility(&path, &["--json"]).ends_with(2).json();
    let relaxations = report["relaxations"].as_array().expect("relaxations");
    let named = |name: &str| {
        let found = relaxations.iter().find(|one| one["requirement"] == name);
        found.expect("the requirement").clone()
    };
    let factor = named("xi_max")["factor"]
        .as_f64()
        .expect("a factor that helps");
    assert!(factor > 1e3, "{factor}");
    // What was tried is said of those that do not help.
    let tried = named("hbar")["tried"]
        .as_array()
        .expect("the factors")
        .clone();
    assert!(tried[1].as_f64() < Some(0.01), "{tried:?}");
}
