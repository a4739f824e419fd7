//! `steadfast synthesize --objective region`, and `--objective gain` with a search.

use std::path::{Path, PathBuf};

use crate::support::*;
use serde_json::{json, Value};

fn verify(design: &Path) -> Run {
    steadfast(["verify".as_ref(), design.as_os_str(), "--json".as_ref()])
}

/// The cart on a rail, asked to cover a start, with a search of the decay rate.
fn cart(start: [f64; 2]) -> Value {
    let mut model = json(&shipped("double-integrator.json"));
    set(&mut model, "/specs/must_contain", json!([start]));
    set(&mut model, "/specs/objective", json!("region"));
    set(
        &mut model,
        "/specs/search",
        json!({ "phi_per_s": [0.02, 0.5] }),
    );
    model
}

/// A proved design of the cart in a folder.
fn cart_design(folder: &Path) -> PathBuf {
    let model = write(folder, "cart.json", cart([0.3, 0.0]).to_string());
    let design = folder.join("design.json");
    synthesize(&model, &["-o", design.to_str().unwrap()]).ends_with(0);
    design
}

/// The refusal of a shipped model after one change.
fn refusal(name: &str, pointer: &str, value: Value, more: &[&str]) -> String {
    let folder = folder();
    let mut model = json(&shipped(name));
    set(&mut model, pointer, value);
    let path = write(folder.path(), "model.json", model.to_string());
    synthesize(&path, more).refusal()
}

#[test]
fn a_start_is_covered_and_the_design_alone_proves_it() {
    let folder = folder();
    let model = write(folder.path(), "cart.json", cart([0.3, 0.0]).to_string());
    let design = folder.path().join("design.json");
    let run = synthesize(&model, &["--json", "-o", design.to_str().unwrap()]);
    let report = run.ends_with(0).json();
    assert_eq!(report["status"], "solved");
    assert_eq!(report["verdict"], "proved");
    let scale = number(&report, "/must_contain/0/scale");
    assert!(scale > 1.5 && scale * 0.3 < 1.0, "{scale}");
    let checked = verify(&design).ends_with(0).json();
    assert_eq!(number(&checked, "/must_contain/0/scale"), scale);
    // What the search chose stands in the design's own model, with its limits beside it.
    let file = json(&design);
    assert_eq!(file["model"]["specs"]["must_contain"], json!([[0.3, 0.0]]));
    let phi = number(&file, "/model/specs/phi_per_s");
    assert!((0.02..=0.5).contains(&phi));
    let varied = file["provenance"]["search"]["varied"]
        .as_array()
        .expect("a list");
    let decay = varied
        .iter()
        .find(|one| one["field"] == "specs.phi_per_s")
        .expect("phi");
    assert_eq!(number(decay, "/value"), phi);
    // It is printed beside the model's own number.
    let words = synthesize(&model, &[]).ends_with(0).stdout;
    let line = words
        .lines()
        .find(|line| line.starts_with("  specs.phi_per_s = "));
    let line = line.expect("what was found");
    assert!(
        line.ends_with("(from 0.02 to 0.5; the model has 0.1)"),
        "{line}"
    );
    // The scale is that of U: x0'U x0 scale^2 is 1 up to rounding.
    let form = 0.09 * number(&file, "/certificate/lyapunov/0/0");
    assert_relative(form * scale * scale, 1.0, 1e-9);
}

#[test]
fn a_region_is_at_least_as_wide_as_any_fixed_choice_of_the_weight_rho() {
    let folder = folder();
    let mut asked = cart([0.3, 0.0]);
    let model = write(folder.path(), "cart.json", asked.to_string());
    let report = synthesize(&model, &["--json"]).ends_with(0).json();
    let scale = number(&report, "/must_contain/0/scale");
    // The gain objective tries its list of weights with the decay rate as it stands.
    remove(&mut asked, "/specs/search");
    set(&mut asked, "/specs/objective", json!("gain"));
    set(
        &mut asked,
        "/specs/must_contain",
        json!([[0.3 * 1.02 * scale, 0.0]]),
    );
    for phi in [0.02, 0.05, 0.1, 0.2] {
        set(&mut asked, "/specs/phi_per_s", json!(phi));
        let fixed = write(folder.path(), "fixed.json", asked.to_string());
        let run = synthesize(&fixed, &["--json"]);
        assert_ne!(run.status, Some(0), "phi {phi} covers more: {run:?}");
    }
}

#[test]
fn a_tampered_region_design_is_not_proved() {
    let folder = folder();
    let design = cart_design(folder.path());
    let proved = verify(&design).ends_with(0).json();
    let scale = number(&proved, "/must_contain/0/scale");
    let file = json(&design);
    let smaller = |pointer: &str, factor: f64| json!(factor * number(&file, pointer));
    let tampered: [(&str, Value); 6] = [
        (
            "/model/specs/must_contain",
            json!([[0.3 * scale * 1.000001, 0.0]]),
        ),
        (
            "/model/specs/phi_per_s",
            smaller("/model/specs/phi_per_s", 1.5),
        ),
        ("/model/specs/nu", json!(0.3)),
        ("/model/plant/vertices/input_limit", json!([0.5])),
        (
            "/certificate/lyapunov/0/0",
            smaller("/certificate/lyapunov/0/0", 0.8),
        ),
        ("/certificate/gamma", smaller("/certificate/gamma", 0.5)),
    ];
    for (pointer, value) in tampered {
        let mut other = file.clone();
        set(&mut other, pointer, value);
        let path = write(folder.path(), "tampered.json", other.to_string());
        let report = verify(&path).ends_with(2).json();
        assert_eq!(report["verdict"], "not_proved", "{pointer}");
    }
}

#[test]
fn a_start_that_cannot_be_covered_is_told_how_far_one_gets_and_why() {
    let folder = folder();
    let mut model = cart([0.9, 0.9]);
    set(&mut model, "/plant/vertices/input_limit", json!([0.2]));
    let path = write(folder.path(), "far.json", model.to_string());
    let design = folder.path().join("design.json");
    let run = synthesize(&path, &["--json", "-o", design.to_str().unwrap()]).ends_with(2);
    let report = run.json();
    assert_eq!(report["status"], "undecided");
    assert_eq!(report["verdict"], "not_proved");
    assert!(!design.exists());
    let scale = number(&report, "/shortfall/scale");
    assert!(scale > 0.05 && scale < 1.0, "{scale}");
    let reason = report["shortfall"]["reason"].as_str().expect("a reason");
    let percent = format!("{:.4} %", synth::claim::Claim::AtLeast(100.0 * scale));
    assert!(reason.contains(&percent), "{reason}");
    assert!(!report["shortfall"]["limits"].as_array().unwrap().is_empty());
    assert!(!report["blocking"].as_array().unwrap().is_empty());
    let words = synthesize(&path, &[]).ends_with(2).stdout;
    assert!(words.contains("limiting factors"), "{words}");
    // What it says can be proved: that much of the start, and no more than a little above it.
    set(
        &mut model,
        "/specs/must_contain",
        json!([[0.9 * scale * 0.99, 0.9 * scale * 0.99]]),
    );
    let path = write(folder.path(), "near.json", model.to_string());
    synthesize(&path, &[]).ends_with(0);
}

#[test]
fn a_start_outside_every_box_says_so_at_once() {
    let folder = folder();
    let mut model = json(&shipped("xu2020-region.json"));
    set(&mut model, "/specs/search/q0_min", json!([0.8, 0.95]));
    let path = write(folder.path(), "model.json", model.to_string());
    let report = synthesize(&path, &["--json"]).ends_with(2).json();
    let reason = report["shortfall"]["reason"].as_str().expect("a reason");
    for part in ["outside every box", "0.6641", "83.2 deg", "0.8", "0.6000"] {
        assert!(reason.contains(part), "{part} in {reason}");
    }
    assert!(report["solver_runs"].as_array().unwrap().is_empty());
    set(
        &mut model,
        "/specs/must_contain",
        json!([[0.5, 0, 0, 0, 0, 0]]),
    );
    set(&mut model, "/specs/search/rate_rad_s", json!([0.01, 0.2]));
    let path = write(folder.path(), "model.json", model.to_string());
    let words = synthesize(&path, &[]).ends_with(2).stdout;
    assert!(words.contains("rate about axis 1 is 0.5 rad/s"), "{words}");
}

#[test]
fn a_quaternion_longer_than_one_is_refused() {
    let message = refusal(
        "xu2020-region.json",
        "/specs/must_contain",
        json!([[0, 0, 0, 0.8, 0.8, 0]]),
        &[],
    );
    for part in ["specs.must_contain[0]", "1.13", "at most 1"] {
        assert!(message.contains(part), "{part} in {message}");
    }
}

#[test]
fn a_state_at_the_origin_is_refused() {
    let zero = json!([[0, 0, 0, 0, 0, 0]]);
    let message = refusal("xu2020-region.json", "/specs/must_contain", zero, &[]);
    assert!(message.contains("the state is zero"), "{message}");
}

#[test]
fn a_region_of_a_plant_without_attitudes_needs_a_state() {
    let model = shipped("double-integrator.json");
    let message = synthesize(&model, &["--objective", "region"]).refusal();
    for part in ["specs.must_contain", "empty", "at least one state"] {
        assert!(message.contains(part), "{part} in {message}");
    }
}

#[test]
fn wrong_limits_of_a_search_are_refused_in_one_sentence() {
    let wrong: [(&str, Value, &[&str]); 8] = [
        (
            "phi_per_s",
            json!([0.2, 0.01]),
            &["reversed", "[0.2, 0.01]"],
        ),
        ("phi_per_s", json!([0, 0.01]), &["phi_per_s[0]", "above 0"]),
        ("q0_min", json!([0.5, 1]), &["q0_min[1]", "(0, 1)"]),
        ("nu", json!([0.1, 1.2]), &["nu[1]", "(0, 1)"]),
        ("gamma_max", json!(0), &["gamma_max", "above 0"]),
        ("certified_angle_min_deg", json!(180), &["in (0, 180)"]),
        ("rounds", json!(0), &["rounds", "1 to 1000"]),
        ("phi_per_s", json!([0.1]), &["specs.search.phi_per_s"]),
    ];
    for (key, value, parts) in wrong {
        let pointer = format!("/specs/search/{key}");
        let message = refusal("xu2020-region.json", &pointer, value, &[]);
        for part in parts {
            assert!(message.contains(part), "{key}: {part} in {message}");
        }
    }
}

#[test]
fn limits_that_only_a_spacecraft_has_are_refused_for_other_plants() {
    let search = json!({ "rate_rad_s": [0.1, 0.2] });
    let message = refusal("double-integrator.json", "/specs/search", search, &[]);
    assert!(message.contains("specs.search.rate_rad_s"), "{message}");
    assert!(message.contains("only an 'exact' plant"), "{message}");
}

#[test]
fn a_bound_on_gamma_that_nothing_meets_is_told_with_the_smallest_gain() {
    let folder = folder();
    let mut model = cart([0.3, 0.0]);
    set(&mut model, "/specs/search/gamma_max", json!(1e-4));
    let path = write(folder.path(), "model.json", model.to_string());
    let report = synthesize(&path, &["--json"]).ends_with(2).json();
    let reason = report["shortfall"]["reason"].as_str().expect("a reason");
    assert!(reason.contains("0.0001"), "{reason}");
    assert!(reason.contains("smallest guaranteed gain"), "{reason}");
}

#[test]
fn a_search_for_a_small_gain_beats_the_numbers_it_starts_from() {
    let folder = folder();
    let mut model = json(&shipped("double-integrator.json"));
    let plain = synthesize(&shipped("double-integrator.json"), &["--json"])
        .ends_with(0)
        .json();
    assert!(plain["search"].is_null());
    set(
        &mut model,
        "/specs/search",
        json!({ "phi_per_s": [0.05, 0.5] }),
    );
    let path = write(folder.path(), "model.json", model.to_string());
    let design = folder.path().join("design.json");
    let run = synthesize(&path, &["--json", "-o", design.to_str().unwrap()]);
    let found = run.ends_with(0).json();
    assert_eq!(found["search"]["objective"], "gain");
    let gain = |report: &Value| number(report, "/guaranteed_gain");
    assert!(
        gain(&found) < 0.9 * gain(&plain),
        "{} {}",
        gain(&found),
        gain(&plain)
    );
    verify(&design).ends_with(0);
}

#[test]
fn a_search_keeps_within_its_bounds_on_the_gain() {
    let folder = folder();
    let mut model = cart([0.3, 0.0]);
    let wide = write(folder.path(), "wide.json", model.to_string());
    let wide = synthesize(&wide, &["--json"]).ends_with(0).json();
    set(&mut model, "/specs/search/gamma_max", json!(4.0));
    let bounded = write(folder.path(), "bounded.json", model.to_string());
    let bounded = synthesize(&bounded, &["--json"]).ends_with(0).json();
    assert!(number(&bounded, "/gamma") <= 4.0);
    let scale = |report: &Value| number(report, "/must_contain/0/scale");
    assert!(scale(&bounded) <= scale(&wide) * 1.001);
}

/// Takes about a minute of two processors.
#[test]
#[ignore = "a search over wide regions: minutes"]
fn the_start_of_xu2020_is_proved_without_a_weight_chosen_by_hand() {
    let folder = folder();
    let design = folder.path().join("design.json");
    let run = synthesize(
        &shipped("xu2020-region.json"),
        &[
            "--objective",
            "region",
            "--json",
            "-o",
            design.to_str().unwrap(),
        ],
    );
    let report = run.ends_with(0).json();
    assert!(number(&report, "/must_contain/0/scale") > 1.0);
    assert!(number(&report, "/certified_angle_along_deg") >= 115.0);
    verify(&design).ends_with(0);
    let simulated = steadfast([
        "simulate".as_ref(),
        shipped("xu2020-region-closed-loop.json").as_os_str(),
        "--design".as_ref(),
        design.as_os_str(),
        "--json".as_ref(),
    ]);
    let simulated = simulated.ends_with(0).json();
    assert!(number(&simulated, "/max_torque") < 2.0);
    assert_eq!(number(&simulated, "/violations"), 0.0);
}

#[test]
#[ignore = "a search over wide regions: minutes"]
fn every_attitude_up_to_sixty_degrees_is_covered() {
    let report = synthesize(&shipped("xu2020-attitudes.json"), &["--json"])
        .ends_with(0)
        .json();
    assert!(number(&report, "/certified_angle_any_axis_deg") >= 60.0);
}

#[test]
#[ignore = "a search over wide regions: minutes"]
fn the_guaranteed_gain_of_xu2020_falls_below_0_135_with_the_decay_rate_free() {
    let report = synthesize(&shipped("xu2020-gain.json"), &["--json"])
        .ends_with(0)
        .json();
    assert!(number(&report, "/guaranteed_gain") < 0.135);
    assert!(number(&report, "/certified_angle_any_axis_deg") >= 8.0);
}
