//! Runs with imperfect sensors, networks, actuators and wheels, and what a proof says of them.

mod network;

use crate::common;
use serde_json::{json, Value};
use steadfast::run::design::Design;
use steadfast::run::outcome::RunOutcome;
use steadfast::run::simulate;
use steadfast::run::summary::{CertificateOutcome, Summary};
use steadfast::scenario::Scenario;

const BODY: &str = "/system/rigid_body";

fn spacecraft() -> Value {
    let text = include_str!("../../models/xu2020-closed-loop.json");
    serde_json::from_str(text).expect("a scenario")
}

fn cart() -> Value {
    let text = include_str!("../../models/double-integrator-closed-loop.json");
    serde_json::from_str(text).expect("a scenario")
}

/// The scenario with a value at a place.
fn with(mut scenario: Value, place: &str, value: Value) -> Value {
    let (parent, key) = place.rsplit_once('/').expect("a place");
    scenario.pointer_mut(parent).expect("an object")[key] = value;
    scenario
}

/// The shipped design, whose model allows these imperfections, with numbers in its certificate that stand for those of a
/// proof: they add next to nothing to what feeds the functional.
fn allowing(imperfections: Value) -> Design {
    let mut design: Value = serde_json::from_str(common::spacecraft_design()).expect("a design");
    add_stand_ins(&mut design["certificate"], &imperfections, (6, 3));
    design["model"]["imperfections"] = imperfections;
    common::read(&design.to_string())
}

/// Numbers for n states and m inputs where the imperfections need them.
fn add_stand_ins(certificate: &mut Value, imperfections: &Value, (n, m): (usize, usize)) {
    let zeros = |rows: usize| json!(vec![vec![0.0; n]; rows]);
    if imperfections.get("measurement").is_some() {
        certificate["measurement"] =
            json!({ "error_weight": zeros(n), "sample_weight": vec![1e-9; n] });
    }
    if ["delay_s", "lost_in_a_row"]
        .iter()
        .any(|key| imperfections.get(key).is_some())
    {
        certificate["first_torque"] = json!({
            "growth_per_s": 1e-6, "state": zeros(n), "rate": zeros(n), "disturbance": zeros(m)
        });
    }
    let own = imperfections.get("effectiveness").map_or(0, |_| m);
    let others = imperfections.get("misalignment").map_or(0, |_| m * (m - 1));
    if own + others > 0 {
        certificate["gain_error_weight"] = json!(vec![1.0; own + others]);
    }
}

fn flown(scenario: &Value, design: &Design) -> RunOutcome {
    let scenario = Scenario::from_json(&scenario.to_string()).expect("a scenario");
    simulate(&scenario, Some(design), true).expect("a run")
}

fn run(scenario: &Value, design: &Design) -> Summary {
    flown(scenario, design).summary
}

fn certificate(summary: &Summary) -> &CertificateOutcome {
    summary.certificate.as_ref().expect("a certificate")
}

/// That the outcome has a line that begins so among what is covered, and none among what is not, or the other way round.
#[track_caller]
fn assert_said(outcome: &CertificateOutcome, begins: &str, covered: bool) {
    let has = |lines: &[String]| lines.iter().any(|line| line.starts_with(begins));
    let said = [has(&outcome.covered), has(&outcome.not_covered)];
    assert_eq!(said, [covered, !covered], "{begins}: {outcome:#?}");
}

fn refusal(scenario: &Value) -> String {
    let error = Scenario::from_json(&scenario.to_string()).expect_err("a refusal");
    error.to_string()
}

#[test]
fn a_shipped_run_says_nothing_of_imperfections() {
    let design = common::read(common::spacecraft_design());
    let summary = run(&spacecraft(), &design);
    let outcome = certificate(&summary);
    assert!(outcome.covered.is_empty() && summary.network.is_none());
    let text = serde_json::to_value(&summary).expect("a summary");
    assert!(text.get("network").is_none());
    for key in ["covered", "output_bound"] {
        assert!(text["certificate"].get(key).is_none(), "{key}");
    }
}

#[test]
fn errors_of_the_sensors_are_compared_with_the_proved_bounds_with_both_numbers() {
    let design = allowing(json!({ "measurement": { "rate_rad_s": 1e-5, "attitude_deg": 0.003 } }));
    for (kind, factor, covered) in [
        (json!("random"), 1.0, true),
        (json!({ "constant": {} }), 1.0, true),
        (json!("towards_held"), 1.0, true),
        (json!("worst"), 1.0, true),
        (
            json!({ "constant": { "direction": [1, 0, 0, 0, 1, 0] } }),
            1.01,
            false,
        ),
    ] {
        let error =
            json!({ "rate_rad_s": 1e-5 * factor, "attitude_deg": 0.003 * factor, "kind": kind });
        let scenario = with(
            spacecraft(),
            &format!("{BODY}/sensors"),
            json!({ "bounded_error": error }),
        );
        let summary = run(&scenario, &design);
        let outcome = certificate(&summary);
        assert_said(outcome, "error of the measured rate: ", covered);
        assert_said(outcome, "error of the measured attitude: ", covered);
        let lines = [&outcome.covered[..], &outcome.not_covered[..]].concat();
        let proved = "proved for up to 0.00001 rad/s";
        assert!(lines.iter().any(|line| line.ends_with(proved)), "{lines:?}");
    }
    // Without a bound in the model nothing is allowed.
    let ideal = common::read(common::spacecraft_design());
    let noisy = with(
        spacecraft(),
        &format!("{BODY}/sensors"),
        json!({ "rate_noise_deg_s": 1e-6 }),
    );
    let summary = run(&noisy, &ideal);
    assert_said(certificate(&summary), "error of the measured rate: ", false);
}

#[test]
fn gains_of_the_actuators_are_compared_with_the_proved_range() {
    let design = allowing(json!({ "effectiveness": [0.9, 1], "misalignment": 0.02 }));
    let actuators = |value: Value| with(spacecraft(), &format!("{BODY}/actuators"), value);
    for (kind, lowest, covered) in [
        ("constant", 0.9, true),
        ("random", 0.9, true),
        ("worst", 0.89, false),
    ] {
        let gain = json!({ "effectiveness": [lowest, 1], "misalignment": 0.02, "kind": kind });
        let summary = run(&actuators(json!({ "gain_error": gain })), &design);
        assert_said(certificate(&summary), "effectiveness of input 1: ", covered);
        assert_said(
            certificate(&summary),
            "misalignment of the actuators: ",
            true,
        );
    }
    // A known constant gain and a fault count as well.
    let matrix = json!([[0.95, 0.01, 0], [0, 1, 0], [0, 0.03, 0.99]]);
    let mut scenario = actuators(json!({ "matrix": matrix }));
    scenario["system"]["rigid_body"]["faults"] =
        json!([{ "axis": 2, "from_s": 10, "until_s": 20, "effectiveness": 0.5 }]);
    let summary = run(&scenario, &design);
    let outcome = certificate(&summary);
    assert_said(
        outcome,
        "effectiveness of input 1: 0.95 to 0.95; proved for 0.9 to 1",
        true,
    );
    assert_said(
        outcome,
        "effectiveness of input 2: 0.5 to 1; proved for 0.9 to 1",
        false,
    );
    assert_said(
        outcome,
        "misalignment of the actuators: 0.03; proved for up to 0.02",
        false,
    );
}

#[test]
fn the_momentum_of_the_wheels_is_compared_along_the_run_and_their_friction_is_a_disturbance() {
    let wheels = |value: Value| with(spacecraft(), &format!("{BODY}/wheels"), value);
    let momentum = json!({ "initial_momentum_nms": [3, 0, 4] });
    let inside = allowing(json!({ "wheel_momentum_nms": 20 }));
    let outcome = flown(&wheels(momentum.clone()), &inside);
    assert_said(
        certificate(&outcome.summary),
        "momentum of the wheels: ",
        true,
    );
    let trajectory = outcome.trajectory.expect("a trajectory");
    let column = trajectory.column("wheel_momentum_3_nms").expect("a column");
    assert_eq!(column[0], 4.0);
    let per_axis = allowing(json!({ "wheel_momentum_nms": [20, 20, 3.9] }));
    let summary = run(&wheels(momentum.clone()), &per_axis);
    assert_said(
        certificate(&summary),
        "momentum of the wheels about axis 2: ",
        true,
    );
    assert_said(
        certificate(&summary),
        "momentum of the wheels about axis 3: ",
        false,
    );
    let none = common::read(common::spacecraft_design());
    let smooth = run(&wheels(momentum), &none);
    assert_said(certificate(&smooth), "momentum of the wheels: ", false);
    // 5 mN m of friction on each of three wheels, on top of the disturbance of the scenario.
    let rough = json!({ "initial_momentum_nms": [3, 0, 4], "coulomb_nm": 5e-3 });
    let rough = run(&wheels(rough), &inside);
    let [smooth, rough] = [&smooth, &rough].map(|summary| certificate(summary).peak_disturbance);
    assert!(
        smooth < 0.0075 && rough > smooth + 0.003,
        "{smooth} {rough}"
    );
}

#[test]
fn without_friction_and_momentum_wheels_that_turn_slowly_change_little() {
    let design = common::read(common::spacecraft_design());
    let plain = run(&spacecraft(), &design);
    let wheeled = run(
        &with(spacecraft(), &format!("{BODY}/wheels"), json!({})),
        &design,
    );
    let [plain, wheeled] =
        [plain, wheeled].map(|summary| certificate(&summary).largest_lyapunov_ratio);
    assert!((plain - wheeled).abs() < 1e-3, "{plain} {wheeled}");
}

#[test]
fn a_run_that_begins_with_the_motion_of_its_reference_begins_in_the_origin_of_the_error() {
    let design =
        allowing(json!({ "reference": { "rate_rad_s": 0.0011, "acceleration_rad_s2": 1e-6 } }));
    let slew = json!({ "slew": {
        "start": { "axis_angle": { "axis": [1, 2, 3], "angle_deg": 70 } },
        "axis": [0, 0, 1], "rate_rad_s": 0.001, "from_s": 0, "until_s": 1e4
    } });
    let mut scenario = with(spacecraft(), &format!("{BODY}/reference"), slew);
    scenario["system"]["rigid_body"]["initial_attitude"] =
        json!({ "axis_angle": { "axis": [1, 2, 3], "angle_deg": 70 } });
    scenario["system"]["rigid_body"]["initial_rate_rad_s"] = json!([0, 0, 0.001]);
    let summary = run(&scenario, &design);
    let outcome = certificate(&summary);
    assert_said(
        outcome,
        "rate of the reference: 0.001 rad/s; proved for up to 0.0011 rad/s",
        true,
    );
    assert!(outcome.start_level < 1e-20, "{}", outcome.start_level);
    // The error stays where the disturbance keeps it, although the body turns by 11 degrees.
    assert!(summary.tail_error_deg.expect("an error") < 0.1);
    assert_eq!(outcome.bound_broken_steps, 0);
    // The error's rate, not the body's, is bounded by the box and enters x'Ux.
    let faster = json!({ "sine": {
        "centre": { "axis_angle": { "axis": [1, 2, 3], "angle_deg": 70 } },
        "axis": [0, 1, 0], "amplitude_deg": 2, "frequency_rad_s": 0.05
    } });
    let scenario = with(scenario, &format!("{BODY}/reference"), faster);
    let summary = run(&scenario, &design);
    assert_said(certificate(&summary), "rate of the reference: ", false);
    assert_said(
        certificate(&summary),
        "acceleration of the reference: ",
        false,
    );
}

#[test]
fn a_rounded_torque_is_compared_and_the_bound_has_its_share() {
    let rounded = allowing(json!({ "torque_quantum_nm": 0.001 }));
    let scenario = with(
        spacecraft(),
        &format!("{BODY}/actuators"),
        json!({ "torque_quantum_nm": 0.001 }),
    );
    let summary = run(&scenario, &rounded);
    assert_said(
        certificate(&summary),
        "rounding of the torque to steps of: 0.001 N m",
        true,
    );
    let plain = common::read(common::spacecraft_design());
    let plain = run(&spacecraft(), &plain);
    let [wider, plain] = [&summary, &plain].map(|summary| certificate(summary).ultimate_level);
    let larger = 0.01 + 0.75_f64.sqrt() * 0.001;
    assert!(
        (wider / plain / (larger / 0.01).powi(2) - 1.0).abs() < 1e-6,
        "{wider} {plain}"
    );
}

#[test]
fn the_floor_of_the_trigger_is_flown_and_widens_the_bound() {
    let mut text: Value = serde_json::from_str(common::spacecraft_design()).expect("a design");
    let plain = common::read(&text.to_string());
    let xi = plain.certificate.disturbance_weight;
    text["controller"]["trigger_floor"] = json!(xi * 1e-4);
    let floored = common::read(&text.to_string());
    let noise = json!({ "bounded_error": { "rate_rad_s": 1e-5, "attitude_deg": 0.0028, "kind": "random" } });
    let scenario = with(spacecraft(), &format!("{BODY}/sensors"), noise);
    let [plain, floored] = [plain, floored].map(|design| run(&scenario, &design));
    assert!(
        floored.triggers * 5 < plain.triggers,
        "{} {}",
        floored.triggers,
        plain.triggers
    );
    let [narrow, wide] = [&plain, &floored].map(|summary| certificate(summary).ultimate_level);
    assert!((wide / narrow - 2.0).abs() < 1e-12);
}

#[test]
fn the_worst_disturbance_has_its_norm_and_comes_closer_to_the_bound_than_the_scenarios() {
    let design = common::read(common::spacecraft_design());
    let mild = run(&spacecraft(), &design);
    let hard = run(
        &with(
            spacecraft(),
            &format!("{BODY}/disturbance"),
            json!({ "worst_nm": 0.01 }),
        ),
        &design,
    );
    let [mild, hard] = [&mild, &hard].map(certificate);
    assert!(hard.covers_run, "{:?}", hard.not_covered);
    assert!((hard.peak_disturbance / 0.01 - 1.0).abs() < 1e-12);
    assert!(hard.largest_lyapunov_ratio > mild.largest_lyapunov_ratio);
    assert!(hard.largest_lyapunov_ratio <= 1.0);
}

#[test]
fn a_takagi_sugeno_plant_has_the_same_imperfections() {
    let mut design: Value = serde_json::from_str(common::cart_design()).expect("a design");
    let imperfections = json!({
        "measurement": { "state": [1e-4, 1e-4] }, "delay_s": 0.01, "lost_in_a_row": 1, "effectiveness": [0.9, 1]
    });
    add_stand_ins(&mut design["certificate"], &imperfections, (2, 1));
    design["model"]["imperfections"] = imperfections;
    let design = common::read(&design.to_string());
    let mut scenario = with(
        cart(),
        "/network",
        json!({ "delay_s": 0.01, "delay": "worst", "lost_in_a_row": 1 }),
    );
    let system = &mut scenario["system"]["takagi_sugeno"];
    system["measurement_error"] = json!({ "state": [1e-4, 2e-4], "kind": "worst" });
    system["gain_error"] = json!({ "effectiveness": [0.9, 1], "kind": "worst" });
    let summary = run(&scenario, &design);
    let outcome = certificate(&summary);
    assert_said(outcome, "error of the measured state 1: ", true);
    assert_said(outcome, "error of the measured state 2: ", false);
    assert_said(outcome, "delay from sample to torque: ", true);
    assert_said(outcome, "messages lost in a row: 1; ", true);
    assert_said(outcome, "effectiveness of input 1: ", true);
}

#[test]
fn a_file_with_imperfections_that_contradict_each_other_is_refused() {
    let body = |key: &str, value: Value| with(spacecraft(), &format!("{BODY}/{key}"), value);
    let linked = json!({ "encoding": { "every_change": {} }, "torque_limit_nm": [2, 2, 2] });
    let wu: Value =
        serde_json::from_str(include_str!("../../models/wu2018.json")).expect("a scenario");
    let cases = [
        (
            with(with(spacecraft(), "/link", linked), "/network", json!({})),
            "field 'network'",
        ),
        (
            with(spacecraft(), "/network", json!({ "lost_in_a_row": 101 })),
            "field 'network.lost_in_a_row'",
        ),
        (
            with(
                wu.clone(),
                "/network",
                json!({ "delay_s": 0.1, "delay": "worst" }),
            ),
            "field 'network'",
        ),
        (
            with(
                wu,
                &format!("{BODY}/disturbance"),
                json!({ "worst_nm": 0.1 }),
            ),
            "field 'system.rigid_body.disturbance.worst_nm'",
        ),
        (
            body(
                "actuators",
                json!({ "matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "gain_error": {} }),
            ),
            "field 'system.rigid_body.actuators'",
        ),
        (
            body(
                "actuators",
                json!({ "gain_error": { "effectiveness": [0.9, 0.8] } }),
            ),
            "field 'system.rigid_body.actuators.gain_error.effectiveness'",
        ),
        (
            body(
                "wheels",
                json!({ "stiction_nm": 0.02, "standstill_nms": 1e-6 }),
            ),
            "field 'system.rigid_body.wheels.standstill_nms'",
        ),
        (
            body(
                "wheels",
                json!({ "axes": [[1, 0, 0], [0, 1, 0], [1, 1, 0]] }),
            ),
            "field 'system.rigid_body.wheels.axes'",
        ),
        (
            body(
                "sensors",
                json!({ "bounded_error": { "kind": { "constant": { "direction": [1] } } } }),
            ),
            "field 'system.rigid_body.sensors.bounded_error.kind.constant.direction'",
        ),
    ];
    for (scenario, field) in cases {
        let said = refusal(&scenario);
        assert!(said.starts_with(field), "{field}: {said}");
    }
}

#[test]
fn the_same_seed_gives_the_same_run_and_errors_do_not_move_the_samples() {
    let design = common::read(common::spacecraft_design());
    let noise =
        json!({ "bounded_error": { "rate_rad_s": 1e-5, "attitude_deg": 0.003, "kind": "random" } });
    let scenario = with(spacecraft(), &format!("{BODY}/sensors"), noise);
    let scenario = with(
        scenario,
        "/network",
        json!({ "delay_s": 0.05, "delay": "random" }),
    );
    let [first, second] = [run(&scenario, &design), run(&scenario, &design)];
    assert_eq!(first, second);
    assert_eq!(first.samples, run(&spacecraft(), &design).samples);
}
