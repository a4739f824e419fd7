//! What a campaign draws: from the dispersions of a scenario file to the scenario of each run.

use crate::support::*;
use serde_json::{json, Value};
use steadfast::batch::campaign::plan::{Plan, Resolved};
use steadfast::controllers::ControllerChoice;
use steadfast::plants::rigid_body::{AttitudeFile, RigidBodyFile};
use steadfast::plants::SystemFile;
use steadfast::scenario::ScenarioFile;

const RUNS: u64 = 2000;

fn file(dispersions: Value) -> String {
    let mut file = json(&shipped("wu2018-noise.json"));
    set(&mut file, "/dispersions", dispersions);
    file.to_string()
}

fn runs(dispersions: Value) -> Vec<Resolved> {
    let text = file(dispersions);
    let plan = Plan::new(&text, None, Some(3), RUNS).expect("a plan");
    let runs = (0..RUNS).map(|run| plan.resolve(run).expect("a run"));
    runs.collect()
}

fn body(file: &ScenarioFile) -> &RigidBodyFile {
    match &file.system {
        SystemFile::RigidBody(body) => body,
        SystemFile::TakagiSugeno(_) => panic!("not a spacecraft"),
    }
}

fn quaternion(run: &Resolved) -> [f64; 4] {
    match body(&run.file).initial_attitude {
        AttitudeFile::QuaternionScalarFirst(parts) => parts,
        ref other => panic!("{other:?}"),
    }
}

/// Asserts that the mean is `expected` to five standard errors.
#[track_caller]
fn assert_mean(values: impl Iterator<Item = f64>, expected: f64) {
    let values: Vec<f64> = values.collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let error = (variance / count).sqrt();
    assert!(
        (mean - expected).abs() <= 5.0 * error,
        "{mean} against {expected}, standard error {error}"
    );
}

#[test]
fn any_attitude_means_every_rotation_with_the_same_probability() {
    let runs = runs(json!({ "initial_attitude": { "uniform": {} } }));
    for component in 0..4 {
        assert_mean(runs.iter().map(|run| quaternion(run)[component]), 0.0);
        // Uniform over the sphere of four dimensions: E q^2 = 1/4, E q^4 = 1/8.
        let power = |power: i32| {
            runs.iter()
                .map(move |run| quaternion(run)[component].powi(power))
        };
        assert_mean(power(2), 0.25);
        assert_mean(power(4), 0.125);
    }
    let products = runs
        .iter()
        .map(|run| quaternion(run)[0] * quaternion(run)[3]);
    assert_mean(products, 0.0);
}

#[test]
fn the_columns_of_what_is_drawn_are_named_as_the_conventions_say() {
    let normal = json!({ "normal": { "standard_deviation": 1 } });
    let text = file(json!({
        "initial_attitude": { "uniform": {} },
        "initial_rate_rad_s": normal,
        "inertia": { "products_percent": normal },
        "disturbance": { "factor": normal },
        "faults": [{ "from_s": normal, "effectiveness": { "choice": [0.5] } }],
    }));
    let plan = Plan::new(&text, None, None, 1).expect("a plan");
    let expected = [
        "initial_q0_scalar",
        "initial_q1",
        "initial_q2",
        "initial_q3",
        "initial_rate_1_rad_s",
        "initial_rate_2_rad_s",
        "initial_rate_3_rad_s",
        "inertia_12_kg_m2",
        "inertia_13_kg_m2",
        "inertia_23_kg_m2",
        "disturbance_factor",
        "fault_1_axis",
        "fault_1_from_s",
        "fault_1_until_s",
        "fault_1_effectiveness",
    ];
    assert_eq!(plan.columns.drawn, expected);
}

#[test]
fn a_turn_has_the_angle_that_is_drawn_about_any_axis() {
    let angle = json!({ "uniform": { "from": 10, "to": 30 } });
    let mut scenario: Value = serde_json::from_str(&file(
        json!({ "initial_attitude": { "axis_angle": { "angle_deg": angle } } }),
    ))
    .expect("JSON");
    set(
        &mut scenario,
        "/system/rigid_body/initial_attitude",
        json!({ "quaternion_scalar_first": [0.8, 0.6, 0, 0] }),
    );
    let text = scenario.to_string();
    let plan = Plan::new(&text, None, None, RUNS).expect("a plan");
    let turns: Vec<[f64; 4]> = (0..RUNS)
        .map(|run| {
            let [a, b, c, d] = quaternion(&plan.resolve(run).expect("a run"));
            // The conjugate of the scenario's attitude times the drawn one.
            [
                0.8 * a + 0.6 * b,
                0.8 * b - 0.6 * a,
                0.8 * c + 0.6 * d,
                0.8 * d - 0.6 * c,
            ]
        })
        .collect();
    let angles = turns.iter().map(|turn| 2.0 * turn[0].acos().to_degrees());
    let angles: Vec<f64> = angles.collect();
    assert!(angles.iter().all(|angle| (9.999..30.001).contains(angle)));
    assert_mean(angles.iter().copied(), 20.0);
    for axis in 1..4 {
        let component = |turn: &[f64; 4]| turn[axis] / (1.0 - turn[0] * turn[0]).sqrt();
        assert_mean(turns.iter().map(component), 0.0);
        assert_mean(turns.iter().map(|turn| component(turn).powi(2)), 1.0 / 3.0);
    }
}

#[test]
fn a_changed_inertia_is_not_known_to_the_controller() {
    let normal = json!({ "normal": { "standard_deviation": 5, "at_least": -10, "at_most": 10 } });
    let text = file(json!({ "inertia": { "moments_percent": normal } }));
    let plan = Plan::new(&text, None, None, RUNS).expect("a plan");
    let nominal = [147.0, 158.0, 137.0];
    let mut ratios = Vec::new();
    for run in 0..RUNS {
        let run = plan.resolve(run).expect("a run");
        let inertia = body(&run.file).inertia_kg_m2;
        for axis in 0..3 {
            ratios.push(inertia[axis][axis] / nominal[axis]);
            assert_eq!(run.drawn[axis], Some(inertia[axis][axis]));
        }
        assert_eq!((inertia[0][1], inertia[1][0]), (6.5, 6.5));
        match (&run.scenario.controller, &plan.nominal.controller) {
            (ControllerChoice::Wu(own), ControllerChoice::Wu(known)) => assert_eq!(own, known),
            other => panic!("{other:?}"),
        }
    }
    assert!(ratios.iter().all(|ratio| (0.9..=1.1).contains(ratio)));
    assert_mean(ratios.iter().copied(), 1.0);
    // The standard deviation of a normal distribution cut off at two of it.
    assert_mean(
        ratios.iter().map(|r| (r - 1.0).powi(2)),
        0.05_f64.powi(2) * 0.773_741_2,
    );
}

#[test]
fn a_phase_moves_the_disturbance_in_time_and_a_factor_scales_it() {
    let dispersions = json!({ "disturbance": {
        "factor": { "choice": [0.5] },
        "phase_deg": { "uniform": { "from": 0, "to": 360 } },
    } });
    let runs = runs(dispersions);
    assert_mean(runs.iter().map(|run| run.drawn[1].expect("a phase")), 180.0);
    for run in runs.iter().take(20) {
        let disturbance = &body(&run.file).disturbance;
        assert_eq!(disturbance.bias_nm, [5e-5, -5e-5, 1e-4]);
        let sine = &disturbance.sines[0];
        let phase = run.drawn[1].expect("a phase").to_radians();
        let angle = 0.7_f64;
        let found = sine.sine_nm[0] * angle.sin() + sine.cosine_nm[0] * angle.cos();
        assert!((found - 1e-4 * (angle + phase).sin()).abs() < 1e-18);
        let found = sine.sine_nm[1] * angle.sin() + sine.cosine_nm[1] * angle.cos();
        assert!((found + 2.5e-4 * (angle + phase).cos()).abs() < 1e-18);
    }
}

#[test]
fn faults_happen_as_often_as_they_should_on_any_axis_in_their_window() {
    let fault = json!({
        "probability": 0.3,
        "from_s": { "uniform": { "from": 100, "to": 200 } },
        "duration_s": { "choice": [50] },
        "effectiveness": { "uniform": { "from": 0, "to": 0.5 } },
    });
    let always =
        json!({ "axis": 2, "from_s": { "choice": [900] }, "effectiveness": { "choice": [0] } });
    let runs = runs(json!({ "faults": [fault, always] }));
    let faults = |run: &Resolved| body(&run.file).faults.clone();
    assert_mean(runs.iter().map(|run| faults(run).len() as f64), 1.3);
    let mut axes = [0.0; 3];
    for run in &runs {
        let faults = faults(run);
        let last = faults.last().expect("a fault");
        assert_eq!((last.axis, last.from_s, last.until_s), (2, 900.0, 1000.0));
        assert_eq!(run.drawn[4..], [2.0, 900.0, 1000.0, 0.0].map(Some));
        if faults.len() == 1 {
            assert_eq!(run.drawn[..4], [None; 4]);
            continue;
        }
        let first = &faults[0];
        axes[first.axis as usize - 1] += 1.0;
        assert!((100.0..=200.0).contains(&first.from_s) && first.effectiveness <= 0.5);
        assert_eq!(first.until_s, first.from_s + 50.0);
    }
    let third = axes.iter().sum::<f64>() / 3.0;
    let chi: f64 = axes
        .iter()
        .map(|count| (count - third).powi(2) / third)
        .sum();
    assert!(chi < 20.0, "{axes:?}");
}

#[test]
fn numbers_are_replaced_added_or_multiplied_by_their_name() {
    let choice = |value: f64| json!({ "choice": [value] });
    let dispersions = json!({
        "initial_rate_rad_s": { "uniform": { "from": -1e-3, "to": 1e-3 } },
        "values": [
            { "name": "attitude_noise_deg", "distribution": choice(2.0), "change": "multiply" },
            { "name": "sampling.dropout_probability", "distribution": choice(0.25) },
            { "name": "interval_s", "distribution": choice(0.5), "change": "add" },
        ],
    });
    let run = &runs(dispersions)[7];
    assert_eq!(body(&run.file).sensors.attitude_noise_deg, 0.004);
    assert_eq!(run.scenario.dropout_probability, 0.25);
    assert_eq!(run.drawn[..3], [0.004, 0.25, 0.53125].map(Some));
    let rates = body(&run.file).initial_rate_rad_s;
    assert_eq!(run.drawn[3..], rates.map(Some));
}

#[test]
fn a_run_depends_on_its_index_and_the_seed_and_not_on_their_number() {
    for sampling in ["independent", "sobol"] {
        let text = file(json!({ "sampling": sampling, "initial_attitude": { "uniform": {} } }));
        let plan = |seed: u64, runs: u64| Plan::new(&text, None, Some(seed), runs).expect("a plan");
        let one = |plan: &Plan| plan.resolve(5).expect("a run");
        let (few, many, other) = (one(&plan(1, 6)), one(&plan(1, 1_000_000)), one(&plan(2, 6)));
        assert_eq!((&few.file, &few.drawn), (&many.file, &many.drawn));
        assert_ne!(few.drawn, other.drawn);
        assert_ne!(few.scenario.seed, other.scenario.seed);
    }
}

#[test]
fn a_spread_plan_has_a_mean_far_closer_than_independent_numbers() {
    let error = |sampling: &str| {
        let rate = json!({ "normal": { "standard_deviation": 1e-3 } });
        let runs = runs(json!({ "sampling": sampling, "initial_rate_rad_s": rate }));
        let sums = runs.iter().map(|run| run.drawn[0].expect("a rate"));
        (sums.sum::<f64>() / RUNS as f64).abs()
    };
    let standard_error = 1e-3 / (RUNS as f64).sqrt();
    assert!(error("latin_hypercube") < 0.05 * standard_error);
    assert!(error("sobol") < 0.2 * standard_error);
}
