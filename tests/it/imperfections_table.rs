//! The tables of the book on what imperfections cost, made again.

use serde_json::{json, Value};
use steadfast::run::design::Design;
use steadfast::run::simulate;
use steadfast::scenario::Scenario;
use synth::certify::reach::angle_of_vector_part_deg;
use synth::certify::Verdict;
use synth::model::Model;
use synth::synthesis::{synthesize, Outcome, Solvers};

use crate::common;
use crate::falsification::designed;

const PAGE: &str = include_str!("../../docs/src/imperfections.md");

/// Relative difference that the solver's choice of a point makes, beside the last digit of a table.
const SAME: f64 = 1e-2;

/// STEADFAST_TABLES=1 for all rows; without it those that take a second.
fn all_rows() -> bool {
    std::env::var("STEADFAST_TABLES").is_ok()
}

/// An error of a quaternion's vector part as an angle, deg.
fn measurement(rate: f64, vector_part: f64) -> Value {
    json!({ "rate_rad_s": rate, "attitude_deg": (2.0 * vector_part).to_degrees() })
}

/// The rows of the table of costs, and whether each is quick.
fn rows() -> Vec<(&'static str, Value, bool)> {
    let noise = measurement(1e-5, 1e-4);
    let reference = |rate: f64, acceleration: f64| json!({ "reference": { "rate_rad_s": rate, "acceleration_rad_s2": acceleration } });
    let delay = |seconds: f64| json!({ "delay_s": seconds });
    let effective = |least: f64| json!({ "effectiveness": [least, 1] });
    let wheels = |momentum: f64| json!({ "wheel_momentum_nms": momentum });
    vec![
        ("none", json!({}), true),
        (
            "measurement 1e-6 rad/s, 1e-5 in q",
            json!({ "measurement": measurement(1e-6, 1e-5) }),
            false,
        ),
        (
            "measurement 1e-5 rad/s, 1e-4 in q",
            json!({ "measurement": noise }),
            false,
        ),
        (
            "measurement 1e-4 rad/s, 1e-3 in q, no `xi_max`",
            json!({ "measurement": measurement(1e-4, 1e-3) }),
            false,
        ),
        ("delay 5 ms", delay(0.005), false),
        ("delay 20 ms", delay(0.02), true),
        ("delay 50 ms", delay(0.05), false),
        ("delay 100 ms", delay(0.1), false),
        (
            "delay 20 ms, 2 messages lost in a row",
            json!({ "delay_s": 0.02, "lost_in_a_row": 2 }),
            false,
        ),
        ("effectiveness [0.95, 1]", effective(0.95), false),
        ("effectiveness [0.9, 1]", effective(0.9), true),
        ("effectiveness [0.8, 1]", effective(0.8), false),
        ("effectiveness [0.7, 1]", effective(0.7), false),
        ("effectiveness [0.5, 1]", effective(0.5), false),
        (
            "effectiveness [0.95, 1], misalignment 0.02",
            json!({ "effectiveness": [0.95, 1], "misalignment": 0.02 }),
            false,
        ),
        ("wheels 1 N m s", wheels(1.0), false),
        ("wheels 5 N m s", wheels(5.0), false),
        ("wheels 10 N m s", wheels(10.0), false),
        ("wheels 20 N m s", wheels(20.0), false),
        ("wheels 50 N m s", wheels(50.0), false),
        (
            "reference 0.0011 rad/s, 1e-6 rad/s^2",
            reference(0.0011, 1e-6),
            false,
        ),
        (
            "reference 0.005 rad/s, 2e-5 rad/s^2",
            reference(0.005, 2e-5),
            false,
        ),
        (
            "measurement 1e-5 and 1e-4, delay 20 ms, effectiveness [0.9, 1], wheels 5 N m s",
            json!({ "measurement": noise, "delay_s": 0.02, "effectiveness": [0.9, 1], "wheel_momentum_nms": 5 }),
            false,
        ),
    ]
}

/// The numbers of the row with this label, under a heading.
fn printed(heading: &str, label: &str) -> Vec<f64> {
    let (_, section) = PAGE.split_once(heading).expect(heading);
    let row = format!("| {label} |");
    let line = section.lines().find(|line| line.starts_with(&row));
    let cells = line.expect(label)[row.len()..].split('|');
    cells.filter_map(|cell| cell.trim().parse().ok()).collect()
}

/// gamma, the certified angle and the pointing error from rest (deg) of a proved design.
fn costs(label: &str, imperfections: &Value) -> [f64; 3] {
    let mut model: Value = serde_json::from_str(common::SPACECRAFT_MODEL).expect("JSON");
    model["plant"]["exact"]["gyroscopic_form_kg_m2"] = json!([[0, 0, 0], [0, 0, 0], [0, 0, 0]]);
    model["imperfections"] = imperfections.clone();
    if label.ends_with("no `xi_max`") {
        let specs = model["specs"].as_object_mut().expect("specs");
        specs.remove("xi_max");
    }
    let text = model.to_string();
    let model = Model::from_json(&text).expect("a valid model");
    let outcome = synthesize(&model, &text, &Solvers::suited_to(&model), None);
    let Ok(Outcome::Solved(design)) = outcome else {
        panic!("{label}: no design");
    };
    assert_eq!(design.report.verdict, Verdict::Proved, "{label}");
    let certificate = &design.file.certificate;
    let own = certificate.certified_vector_part.expect("an angle");
    let bounds = design
        .file
        .certificate(&model)
        .expect("numbers")
        .final_bounds;
    let pointing = bounds.expect("bounds").vector_part;
    [
        certificate.gamma,
        angle_of_vector_part_deg(own),
        angle_of_vector_part_deg(pointing),
    ]
}

#[test]
fn what_each_imperfection_costs_is_what_the_book_says() {
    for (label, imperfections, quick) in rows() {
        let printed = printed("## What each costs", label);
        assert_eq!(printed.len(), 3, "{label}");
        if !quick && !all_rows() {
            continue;
        }
        let found = costs(label, &imperfections);
        println!("{label}: {found:.4?}, printed {printed:?}");
        for (found, printed) in found.iter().zip(&printed) {
            let difference = (found - printed).abs();
            assert!(
                difference <= SAME * printed,
                "{label}: {found} and {printed}"
            );
        }
    }
}

/// The largest error in the last 300 s (deg) and the largest disturbance with the wheels' friction (N m), and whether the
/// proof covers the run.
fn with_friction(design: &Design, coulomb_nm: f64, stiction_nm: f64) -> (f64, f64, bool) {
    let text = include_str!("../../models/xu2020-closed-loop.json");
    let mut scenario: Value = serde_json::from_str(text).expect("a scenario");
    let body = &mut scenario["system"]["rigid_body"];
    body["wheels"] = json!({ "coulomb_nm": coulomb_nm, "stiction_nm": stiction_nm });
    body["initial_attitude"]["axis_angle"]["angle_deg"] = json!(3);
    scenario["duration_s"] = json!(600);
    scenario["metrics"]["tail_s"] = json!(300);
    scenario["integrator"] = json!({ "runge_kutta4": { "step_s": 0.002 } });
    scenario["requirements"] = json!([]);
    let scenario = Scenario::from_json(&scenario.to_string()).expect("a scenario");
    let summary = simulate(&scenario, Some(design), false)
        .expect("a run")
        .summary;
    let tail = summary.tail_error_deg.expect("an error");
    let certificate = summary.certificate.expect("a certificate");
    let covered = certificate.not_covered.is_empty();
    (tail, certificate.peak_disturbance, covered)
}

#[test]
fn friction_of_the_wheels_moves_the_attitude_as_the_book_says() {
    let design = designed(&json!({ "wheel_momentum_nms": 20 }));
    // Coulomb friction and stiction, mN m.
    for (coulomb, stiction, quick) in [
        (0, 0, false),
        (1, 2, false),
        (2, 5, true),
        (5, 10, false),
        (10, 20, true),
        (20, 50, false),
        (50, 100, false),
    ] {
        let label = format!("{coulomb} | {stiction}");
        let printed = printed("## Friction of the wheels", &label);
        assert_eq!(printed.len(), 2, "{label}");
        if !quick && !all_rows() {
            continue;
        }
        let (coulomb, stiction) = (1e-3 * f64::from(coulomb), 1e-3 * f64::from(stiction));
        let (tail, disturbance, covered) = with_friction(&design, coulomb, stiction);
        println!("{label}: {tail:.4} {disturbance:.5} {covered}, printed {printed:?}");
        // A design at another point of the solver turns the wheels a little otherwise.
        assert!(
            (tail - printed[0]).abs() < 0.05 * printed[0],
            "{label}: {tail}"
        );
        let difference = (1e3 * disturbance - printed[1]).abs();
        assert!(difference < 0.05 * printed[1], "{label}: {disturbance}");
        assert_eq!(covered, printed[1] <= 10.0, "{label}");
    }
}
