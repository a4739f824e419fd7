//! Wu, Shen and Cao 2018 on the harness: what of the paper can be reproduced.

use runtime::attitude::Quaternion;
use runtime::nalgebra::Vector3;
use runtime::wu2018::TriggerRule;
use steadfast::controllers::ControllerChoice;
use steadfast::plants::rigid_body::RigidBodySystem;
use steadfast::plants::System;
use steadfast::run::simulate;
use steadfast::run::summary::Summary;
use steadfast::scenario::Scenario;
use steadfast::sim::integrator::Method;
use steadfast::sim::random::{Purpose, Random};
use steadfast::sim::sampling::Instants;

fn scenario(text: &str) -> Scenario {
    Scenario::from_json(text).unwrap()
}

fn quiet() -> Scenario {
    scenario(include_str!("../../models/wu2018.json"))
}

fn noisy() -> Scenario {
    scenario(include_str!("../../models/wu2018-noise.json"))
}

fn body(scenario: &mut Scenario) -> &mut RigidBodySystem {
    match &mut scenario.system {
        System::RigidBody(body) => body,
        System::TakagiSugeno(_) => panic!("a rigid body is expected"),
    }
}

fn run(scenario: &Scenario) -> Summary {
    simulate(scenario, None, false).unwrap().summary
}

fn every(interval_s: f64) -> Instants {
    Instants::Periodic {
        interval_s,
        jitter_s: 0.0,
    }
}

/// The shorter of the two quaternions of attitudes spread evenly over all rotations.
fn random_attitudes(count: usize) -> Vec<Quaternion> {
    let mut random = Random::new(2018, Purpose::InitialState);
    let attitude = |_| {
        let mut normal = || random.normal();
        let parts = Quaternion::new(normal(), Vector3::new(normal(), normal(), normal()));
        parts.normalised().unwrap().shortest()
    };
    (0..count).map(attitude).collect()
}

/// The paper reports 84 messages without printing its start, so a band over many starts is tested.
#[test]
fn without_noise_the_message_count_lies_about_the_papers_84_from_any_attitude_at_rest() {
    let mut scenario = quiet();
    let mut triggers = Vec::new();
    let mut errors = Vec::new();
    for attitude in random_attitudes(60) {
        body(&mut scenario).attitude = attitude;
        let summary = run(&scenario);
        assert_eq!(summary.bytes, 24 * summary.triggers);
        assert_eq!(summary.bits, 8 * summary.bytes);
        triggers.push(summary.triggers);
        errors.push(summary.rms_error_deg.unwrap());
    }
    let mean = triggers.iter().sum::<u64>() as f64 / triggers.len() as f64;
    let range = (
        triggers.iter().min().unwrap(),
        triggers.iter().max().unwrap(),
    );
    let worst = errors.iter().copied().fold(0.0, f64::max);
    let best = errors.iter().copied().fold(f64::INFINITY, f64::min);
    println!("messages: mean {mean}, range {range:?}; rms {best:.4} to {worst:.4} deg");
    assert!((78.0..92.0).contains(&mean), "{mean}");
    assert!(
        triggers.iter().all(|count| (65..=100).contains(count)),
        "{range:?}"
    );
    assert!(best >= 0.018 && worst <= 0.025, "{best} to {worst}");
}

/// The paper's start being unknown, the shipped scenario has one that gives its count.
#[test]
fn the_shipped_scenario_sends_2016_bytes_as_the_paper() {
    let summary = run(&quiet());
    assert_eq!((summary.triggers, summary.bytes), (84, 2016));
}

/// The paper compares with 1 s; 8 to 10 s is as accurate, which makes the saving much smaller.
#[test]
fn time_triggered_control_every_8_or_10_s_is_as_accurate_as_the_event_trigger() {
    let event_triggered = run(&quiet());
    println!(
        "event-triggered: {} messages, rms {:?} deg",
        event_triggered.triggers, event_triggered.rms_error_deg
    );
    let mut scenario = quiet();
    match &mut scenario.controller {
        ControllerChoice::Wu(parameters) => parameters.trigger = TriggerRule::EverySample,
        _ => panic!("Wu's controller is expected"),
    }
    for (interval, messages) in [(1.0, 1000), (8.0, 125), (10.0, 100)] {
        scenario.instants = every(interval);
        let summary = run(&scenario);
        let rms = summary.rms_error_deg.unwrap();
        println!(
            "every {interval} s: {} messages, rms {rms} deg",
            summary.triggers
        );
        assert_eq!(summary.triggers, messages);
        assert_eq!(summary.bytes, 24 * messages);
        assert!((0.018..0.025).contains(&rms), "{rms}");
    }
    // Settling-time gains hold up to a period of about 2 / (k / J): 11 s is too long.
    scenario.instants = every(11.5);
    let rms = run(&scenario).rms_error_deg.unwrap();
    println!("every 11.5 s: rms {rms} deg");
    assert!(rms > 0.1, "{rms}");
}

/// Counts with the paper's noise: 5641 to 5872 at 32 Hz, 318 to 352 at 1 Hz; with a tenth of it 92.
#[test]
fn with_the_papers_noise_the_count_is_far_from_84() {
    let fast = run(&noisy());
    println!(
        "noise, 32 Hz: {} messages, rms {:?}",
        fast.triggers, fast.rms_error_deg
    );
    assert!((5077..=6459).contains(&fast.triggers), "{}", fast.triggers);
    let mut slow = noisy();
    slow.instants = every(1.0);
    let slow = run(&slow);
    println!("noise, 1 Hz: {} messages", slow.triggers);
    assert!((286..=387).contains(&slow.triggers), "{}", slow.triggers);
    let mut tenth = noisy();
    body(&mut tenth).sensors.attitude_noise_rad *= 0.1;
    body(&mut tenth).sensors.rate_noise_rad_s *= 0.1;
    let tenth = run(&tenth);
    println!("a tenth of the noise, 32 Hz: {} messages", tenth.triggers);
    assert!((75..=110).contains(&tenth.triggers), "{}", tenth.triggers);
}

/// It costs accuracy: about 0.035 deg instead of 0.023.
#[test]
fn a_threshold_above_the_noise_brings_the_count_down_again() {
    let mut scenario = noisy();
    match &mut scenario.controller {
        ControllerChoice::Wu(parameters) => {
            // 2.5 times the rms of the trigger error's noise, 9.2e-6 rad/s.
            parameters.trigger = TriggerRule::Relative {
                relative: 0.5,
                absolute_rad_s: 2.3e-5,
            };
        }
        _ => panic!("Wu's controller is expected"),
    }
    let summary = run(&scenario);
    println!(
        "{} messages, rms {:?}",
        summary.triggers, summary.rms_error_deg
    );
    assert!(
        (80..=200).contains(&summary.triggers),
        "{}",
        summary.triggers
    );
    assert!((0.02..0.05).contains(&summary.rms_error_deg.unwrap()));
}

#[test]
fn a_trigger_watched_continuously_fires_at_roots_that_the_step_does_not_move() {
    let events = |step_s: f64| {
        let mut scenario = quiet();
        scenario.duration_s = 200.0;
        scenario.tail_s = 40.0;
        scenario.instants = Instants::Continuous { resolution_s: 1e-9 };
        scenario.method = Method::RungeKutta4 { step_s };
        let table = simulate(&scenario, None, true).unwrap().trajectory.unwrap();
        let (times, sent) = (
            table.column("time_s").unwrap(),
            table.column("sent").unwrap(),
        );
        let events = times.into_iter().zip(sent).filter(|(_, sent)| *sent > 0.5);
        events.map(|(time, _)| time).collect::<Vec<_>>()
    };
    let (coarse, fine) = (events(0.125), events(0.03125));
    println!("{} events in 200 s", coarse.len());
    assert_eq!(coarse.len(), fine.len());
    assert!(coarse.len() > 20);
    for (a, b) in coarse.iter().zip(&fine) {
        assert!((a - b).abs() < 1e-5, "{a} and {b}");
    }
}

#[test]
fn the_fixed_step_agrees_with_the_reference_integrator_over_1000_s() {
    let fixed = quiet();
    assert_eq!(fixed.method, Method::RungeKutta4 { step_s: 0.03125 });
    let mut adaptive = quiet();
    adaptive.method = Method::DormandPrince853 { tolerance: 1e-13 };
    assert!(largest_attitude_difference_rad(&fixed, &adaptive) < 1e-8);
}

/// Largest angle between the attitudes of two runs at the times of their messages and at the end.
fn largest_attitude_difference_rad(a: &Scenario, b: &Scenario) -> f64 {
    let path = |scenario: &Scenario| {
        let mut scenario = scenario.clone();
        scenario.output_interval_s = 1.0;
        simulate(&scenario, None, true).unwrap().trajectory.unwrap()
    };
    let (a, b) = (path(a), path(b));
    assert_eq!(a.rows(), b.rows());
    let quaternion = |table: &steadfast::base::table::Table, row: usize| {
        let width = table.columns.len();
        let values = &table.values[row * width..];
        Quaternion::from_scalar_first([values[1], values[2], values[3], values[4]])
    };
    let times = a.column("time_s").unwrap();
    assert_eq!(Some(&times), b.column("time_s").as_ref());
    assert_eq!(times.last(), Some(&1000.0));
    let differences = (0..a.rows()).map(|row| {
        quaternion(&a, row)
            .error_from(&quaternion(&b, row))
            .rotation_angle_rad()
    });
    let largest = differences.fold(0.0, f64::max);
    println!("largest difference {largest:e} rad over {} rows", a.rows());
    largest
}
