//! Lei et al. 2022 on the harness: the reproduced run, its limits, and what the parameters must satisfy.

use crate::support;
use std::path::Path;

use crate::support::{assert_relative, folder, names_in, set, shipped, steadfast, text, write};
use runtime::attitude::Quaternion;
use runtime::lei2022::{CompositeTrigger, Parameters, TriggerRule};
use runtime::nalgebra::Vector3;
use serde_json::{json, Value};
use steadfast::base::table::Table;
use steadfast::controllers::ControllerChoice;
use steadfast::plants::rigid_body::RigidBodySystem;
use steadfast::plants::System;
use steadfast::run::simulate;
use steadfast::run::summary::{RunVerdict, Summary};
use steadfast::scenario::Scenario;
use steadfast::sim::disturbance::Disturbance;
use steadfast::sim::integrator::Method;
use steadfast::sim::metrics::Metric;
use steadfast::sim::reference::Reference;
use steadfast::sim::sampling::Instants;

fn fast() -> Scenario {
    Scenario::from_json(include_str!("../../models/lei2022.json")).unwrap()
}

fn slow() -> Scenario {
    Scenario::from_json(include_str!("../../models/lei2022-slow.json")).unwrap()
}

fn body(scenario: &mut Scenario) -> &mut RigidBodySystem {
    match &mut scenario.system {
        System::RigidBody(body) => body,
        System::TakagiSugeno(_) => panic!("a rigid body is expected"),
    }
}

fn controller(scenario: &mut Scenario) -> &mut Parameters {
    match &mut scenario.controller {
        ControllerChoice::Lei(parameters) => parameters,
        _ => panic!("Lei's controller is expected"),
    }
}

fn trigger(scenario: &mut Scenario) -> &mut CompositeTrigger {
    match &mut controller(scenario).trigger {
        TriggerRule::Composite(trigger) => trigger,
        TriggerRule::EverySample => panic!("a composite trigger is expected"),
    }
}

fn undisturbed(mut scenario: Scenario) -> Scenario {
    body(&mut scenario).disturbance = Disturbance::none();
    scenario
}

/// The scenario over another time; the tail begins where it began.
fn lasting(mut scenario: Scenario, duration_s: f64) -> Scenario {
    scenario.tail_s += duration_s - scenario.duration_s;
    scenario.duration_s = duration_s;
    scenario
}

fn sampled(mut scenario: Scenario, rate_hz: f64) -> Scenario {
    scenario.instants = Instants::Periodic {
        interval_s: 1.0 / rate_hz,
        jitter_s: 0.0,
    };
    scenario
}

fn run(scenario: &Scenario) -> Summary {
    simulate(scenario, None, false).unwrap().summary
}

fn trajectory(scenario: &Scenario) -> Table {
    simulate(scenario, None, true).unwrap().trajectory.unwrap()
}

fn missed(summary: &Summary) -> Vec<&str> {
    let outcomes = summary.requirements.iter();
    let missed = outcomes.filter(|outcome| !outcome.met);
    missed.map(|outcome| outcome.name.as_str()).collect()
}

fn largest_threshold_ratio(summary: &Summary) -> f64 {
    summary.metric(Metric::ThresholdRatio).unwrap()
}

#[test]
fn the_reproduced_run_has_its_events_its_settling_time_and_its_cost() {
    let summary = run(&fast());
    assert_eq!((summary.turn_ons, summary.turn_offs), (Some(81), Some(81)));
    assert_relative(summary.settle_seconds.unwrap(), 42.95, 0.01);
    assert_relative(summary.final_error_deg.unwrap(), 0.0164, 0.01);
    assert_relative(summary.max_rate.unwrap(), 0.0514, 0.01);
    assert_relative(summary.impulse, 0.511, 0.01);
    assert_relative(summary.on_time_share, 0.313, 0.01);
    assert_relative(summary.tail_error_deg.unwrap(), 0.0300, 0.01);
    let funnel = summary.metric(Metric::FunnelRatio).unwrap();
    assert_relative(funnel, 0.984, 0.01);
    assert_eq!(summary.triggers, 162);
    assert_eq!(summary.bytes, 12 * 162);
    assert_eq!(summary.verdict, RunVerdict::RequirementsMet);
}

/// Sets that look well over 150 s may drift out later, because the trigger watches V2 only.
#[test]
fn both_shipped_scenarios_meet_every_requirement_over_700_s_and_without_disturbance() {
    for scenario in [fast(), slow()] {
        for duration in [100.0, 700.0] {
            let disturbed = lasting(scenario.clone(), duration);
            for scenario in [disturbed.clone(), undisturbed(disturbed)] {
                let summary = run(&scenario);
                let none: [&str; 0] = [];
                assert_eq!(missed(&summary), none, "{} {duration}", scenario.name);
                assert_eq!(summary.violations, 0);
            }
        }
    }
    let long = run(&lasting(fast(), 700.0));
    assert_eq!((long.turn_ons, long.turn_offs), (Some(472), Some(471)));
}

/// The slow scenario's terminal width is 7.8e-3 for this reason: with 5e-3, k_m M rho_infinity =
/// 2.5e-4 rad/s is below sqrt(2 (S2inf - delta_m) / lambda_min) = 3.8e-4 rad/s. Then a body that drifts
/// with V2 just below its envelope is not called back.
#[test]
fn a_terminal_width_below_the_matching_rule_drifts_out_of_accuracy_unseen_by_the_trigger() {
    let mut narrow = slow();
    controller(&mut narrow).law.performance.terminal = Vector3::repeat(5e-3);
    let summary = run(&narrow);
    assert_eq!(summary.turn_ons, Some(72));
    assert_relative(summary.settle_seconds.unwrap(), 57.63, 0.01);
    assert_relative(summary.final_error_deg.unwrap(), 0.0248, 0.01);
    assert_eq!(summary.verdict, RunVerdict::RequirementsMet);

    let summary = run(&undisturbed(lasting(narrow, 700.0)));
    assert_eq!(
        missed(&summary),
        ["settle_seconds at most", "tail_error_deg at most"]
    );
    assert!(largest_threshold_ratio(&summary) < 1.0);
    assert!(summary.tail_error_deg.unwrap() > 0.1);
}

fn event_times(scenario: &Scenario) -> Vec<f64> {
    let table = trajectory(scenario);
    let times = table.column("time_s").unwrap();
    let sent = table.column("sent").unwrap();
    let events = times.into_iter().zip(sent).filter(|(_, sent)| *sent > 0.5);
    events.map(|(time, _)| time).collect()
}

#[test]
fn event_times_are_roots_that_the_step_does_not_move() {
    let events = |step_s: f64| {
        let mut scenario = lasting(fast(), 150.0);
        scenario.method = Method::RungeKutta4 { step_s };
        event_times(&scenario)
    };
    let finest = events(0.0125);
    assert_eq!(finest.len(), 223);
    for step_s in [0.2, 0.1, 0.05, 0.025] {
        let coarser = events(step_s);
        assert_eq!(coarser.len(), finest.len(), "{step_s}");
        let differences = coarser.iter().zip(&finest).map(|(a, b)| (a - b).abs());
        let largest = differences.fold(0.0, f64::max);
        println!("step {step_s} s: event times move by at most {largest:e} s");
        assert!(largest < 1e-6, "{step_s}: {largest:e}");
    }
}

#[test]
fn the_other_quaternion_of_the_start_gives_the_identical_run() {
    let one = fast();
    let mut other = fast();
    let attitude = body(&mut other).attitude;
    body(&mut other).attitude = -attitude;
    let (one, other) = (trajectory(&one), trajectory(&other));
    assert_eq!(one.columns, other.columns);
    assert_eq!(one.rows(), other.rows());
    for name in &one.columns {
        let (a, b) = (one.column(name).unwrap(), other.column(name).unwrap());
        let mirrored = name.starts_with("error_q");
        let same = a
            .iter()
            .zip(&b)
            .all(|(a, b)| if mirrored { *a == -*b } else { a == b });
        assert!(same, "{name}");
    }
}

/// Along the paper's axis; the funnel and the envelope are widened in proportion to hold the start.
fn from_scalar_part(q0: f64) -> Scenario {
    let mut scenario = fast();
    let axis = Vector3::new(-0.4623, 0.3978, -0.3029).normalize();
    let sine = (1.0 - q0 * q0).sqrt();
    let body = body(&mut scenario);
    let desired = body.reference.error(0.0, &at_rest(&Quaternion::identity()));
    body.attitude = desired.error.conjugate() * Quaternion::new(q0, axis * sine);
    controller(&mut scenario).law.performance.initial = axis.abs() * (sine / 0.9836);
    trigger(&mut scenario).envelope_initial_j *= (sine / 0.681).powi(2);
    scenario
}

fn at_rest(attitude: &Quaternion) -> steadfast::sim::rigid_body_state::RigidBodyState {
    steadfast::sim::rigid_body_state::rigid_body_state(attitude, &Vector3::zeros())
}

/// Such a start is beyond the paper's requirements on rate and funnel, but it must come home.
#[test]
fn starts_at_and_near_a_half_turn_settle_and_stay_finite() {
    for q0 in [0.2, 1e-2, 1e-3, 1e-6, 1e-9, 0.0, -1e-9, -1e-6, -1e-3, -0.2] {
        let disturbed = from_scalar_part(q0);
        for scenario in [disturbed.clone(), undisturbed(disturbed)] {
            let outcome = simulate(&scenario, None, true).unwrap();
            let summary = outcome.summary;
            let settled = summary.settle_seconds;
            assert!(settled.is_some_and(|time| time < 72.0), "{q0}: {settled:?}");
            assert!(summary.final_error_deg.unwrap() < 0.05, "{q0}");
            assert!(largest_threshold_ratio(&summary) <= 1.0, "{q0}");
            let table = outcome.trajectory.unwrap();
            assert!(table.values.iter().all(|value| value.is_finite()), "{q0}");
        }
    }
}

/// Without a further buffer a sampled trigger comes too late by up to a sample.
#[test]
fn sampled_without_a_relative_buffer_v2_passes_its_envelope_and_with_one_it_does_not() {
    let ratio = |rate_hz: f64, relative_buffer: f64| {
        let mut scenario = sampled(fast(), rate_hz);
        trigger(&mut scenario).relative_buffer = relative_buffer;
        largest_threshold_ratio(&run(&scenario))
    };
    assert_relative(ratio(100.0, 0.0), 1.067, 0.01);
    assert_relative(ratio(10.0, 0.0), 1.803, 0.01);
    assert_relative(ratio(50.0, 0.2), 0.936, 0.01);
    assert!(ratio(100.0, 0.1) < 1.0 && ratio(20.0, 0.3) < 1.0);
    let notes = run(&sampled(fast(), 10.0)).notes;
    assert!(notes.iter().any(|note| note.contains("relative_buffer")));
}

#[test]
fn what_the_controller_is_not_made_for_is_noted() {
    let mut moving = fast();
    let start = moving.clone();
    body(&mut moving).reference = Reference::Slew {
        start: Quaternion::identity(),
        axis: Vector3::z(),
        rate_rad_s: 1e-3,
        from_s: 0.0,
        until_s: 10.0,
    };
    let notes = run(&moving).notes;
    assert!(notes.iter().any(|note| note.contains("reference moves")));
    let mut low = start.clone();
    trigger(&mut low).envelope_initial_j = 1e-3;
    let notes = run(&low).notes;
    assert!(notes.iter().any(|note| note.contains("above the envelope")));
    let none: [String; 0] = [];
    assert_eq!(run(&start).notes, none);
}

/// What switching off saves is updates and time on, not fuel.
#[test]
fn in_the_steady_state_the_event_trigger_saves_updates_but_no_fuel() {
    let always_on = |rate_hz: f64, duration: f64| {
        let mut scenario = sampled(lasting(fast(), duration), rate_hz);
        controller(&mut scenario).trigger = TriggerRule::EverySample;
        run(&scenario)
    };
    let print = |name: &str, summary: &Summary| {
        println!(
            "{name}: {} updates, settled {:?} s, tail {:?} deg, impulse {}, rate {:?}",
            summary.updates,
            summary.settle_seconds,
            summary.tail_error_deg,
            summary.impulse,
            summary.max_rate
        );
    };
    let event = [150.0, 700.0].map(|duration| run(&lasting(fast(), duration)));
    print("event-triggered, 150 s", &event[0]);
    print("event-triggered, 700 s", &event[1]);
    for rate_hz in [10.0, 2.0, 1.0] {
        for duration in [150.0, 700.0] {
            let summary = always_on(rate_hz, duration);
            print(&format!("{rate_hz} Hz, {duration} s"), &summary);
            assert_eq!(summary.triggers, (rate_hz * duration) as u64);
            // While saturated the torque stays as it is.
            assert!(summary.updates + 10 > summary.triggers);
        }
    }
    let fine = [150.0, 700.0].map(|duration| always_on(10.0, duration));
    assert_relative(fine[0].impulse, 0.603, 0.01);
    assert_relative(event[0].impulse, 0.562, 0.01);
    let steady = |pair: &[Summary; 2]| pair[1].impulse - pair[0].impulse;
    assert!(steady(&event) > 1.05 * steady(&fine), "no fuel is saved");
    assert!(10 * event[1].updates < 2 * fine[1].updates);
    // At 2 Hz the same law is accurate but pays in fuel; at 1 Hz it no longer settles in time.
    assert!(always_on(2.0, 100.0).settle_seconds.unwrap() < 60.0);
    assert!(always_on(1.0, 100.0)
        .settle_seconds
        .is_none_or(|time| time > 60.0));
}

/// The refusal of a shipped scenario in which one value is changed.
#[track_caller]
fn refusal(pointer: &str, value: Value) -> String {
    let folder = folder();
    let mut scenario = support::json(&shipped("lei2022.json"));
    set(&mut scenario, pointer, value);
    let path = write(folder.path(), "scenario.json", scenario.to_string());
    let message = steadfast([Path::new("simulate"), &path]).refusal();
    assert_eq!(names_in(folder.path()), ["scenario.json"]);
    let start = format!("{}: ", path.display());
    message.strip_prefix(&start).unwrap_or(&message).to_string()
}

#[test]
fn parameters_that_cannot_work_are_refused_with_one_sentence() {
    let field = |name: &str| format!("/controller/lei2022/{name}");
    let of = |name: &str| field(&format!("trigger/composite/{name}"));
    let cases = [
        (
            field("performance/terminal/0"),
            json!(0.5),
            "field 'controller.lei2022.performance.terminal[0]': the value 0.5 is not allowed; it must \
             be above 0 and below initial[0] = 0.47",
        ),
        (
            of("envelope_terminal_j"),
            json!(4.2e-3),
            "field 'controller.lei2022.trigger.composite.envelope_terminal_j': the value 0.0042 is not \
             allowed; it must be above 0 and below envelope_initial_j = 0.0042",
        ),
        (
            of("buffer_j"),
            json!(2e-7),
            "field 'controller.lei2022.trigger.composite.buffer_j': the value 2e-7 is not allowed; it \
             must be above 0 and below envelope_terminal_j = 0.0000002",
        ),
        (
            of("longest_on_s"),
            json!(0),
            "field 'controller.lei2022.trigger.composite.longest_on_s': the value 0 is not allowed; it \
             must be above 0",
        ),
        (
            field("performance/initial/0"),
            json!(0.4),
            "field 'controller.lei2022.performance.initial[0]': the value 0.4 is not allowed; it must \
             be large enough to hold the start: rho is 0.400000 at 0 s, and component 1 of the error \
             quaternion's vector part is 0.462",
        ),
        (
            field("sign_hysteresis"),
            json!(1),
            "field 'controller.lei2022.sign_hysteresis': the value 1 is not allowed; it must be in [0, 1)",
        ),
        (
            field("inertia_kg_m2"),
            json!([[1, 0, 0], [0, -1, 0], [0, 0, 1]]),
            "field 'controller.lei2022.inertia_kg_m2'",
        ),
        (
            field("trigger"),
            json!({ "every_sample": {} }),
            "field 'sampling.instants.continuous.resolution_s'",
        ),
        (
            field("gamma"),
            json!(13),
            "field 'controller.lei2022.gamma': unknown field",
        ),
        (
            "/metrics/settle_tolerance_deg".to_string(),
            json!(0.1),
            "field 'metrics.settle_tolerance_component'",
        ),
    ];
    for (pointer, value, expected) in cases {
        let message = refusal(&pointer, value);
        assert!(message.starts_with(expected), "{message}\n{expected}");
    }
}

#[test]
fn the_report_shows_the_papers_figures() {
    let folder = folder();
    let scenario = shipped("lei2022.json");
    let arguments = [
        Path::new("simulate"),
        &scenario,
        Path::new("-o"),
        folder.path(),
    ];
    let output = steadfast(arguments).ends_with(0).stdout;
    assert!(
        output.contains("turned on 81 and off 81 times, 31.3 % of the time with a torque"),
        "{output}"
    );
    let page = text(&folder.path().join("report.html"));
    let figures = [
        "Component 1 of the error in its funnel",
        "Components of the error and settling tolerance",
        "Body rate",
        "Norm of the body rate",
        "Torque about axis 3",
        "Actuators on (1) and off (0)",
        "V2 and its envelope S2",
    ];
    for title in figures {
        let heading = format!("<h2>{title}</h2>");
        let (_, after) = page.split_once(&heading).expect(title);
        assert!(after.contains("<polyline"), "{title}");
    }
    let table = Table::from_csv(&text(&folder.path().join("trajectory.csv"))).unwrap();
    let column = |name: &str| table.column(name).unwrap();
    let (energy, envelope) = (column("rate_error_v2_j"), column("envelope_s2_j"));
    assert!(energy.iter().zip(&envelope).all(|(v2, s2)| v2 < s2));
    let (on, torque) = (column("on"), column("torque_1_nm"));
    let agree = on
        .iter()
        .zip(&torque)
        .all(|(&on, &torque)| (on > 0.5) == (torque != 0.0));
    assert!(agree, "a torque acts exactly where the actuators are on");
}
