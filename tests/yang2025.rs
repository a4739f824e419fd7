//! Yang et al. 2025 on the harness: what of the paper can be reproduced.

use runtime::attitude::Quaternion;
use runtime::compression::{Alphabet, Levels, Scheme};
use runtime::nalgebra::Vector3;
use runtime::yang2025::fault::FaultEstimation;
use steadfast::harness::random::{Purpose, Random};
use steadfast::harness::recorder::Table;
use steadfast::harness::scenario::{
    ControllerChoice, RigidBodySystem, Scenario, System, YangChoice,
};
use steadfast::harness::simulation::simulate;
use steadfast::harness::summary::{RunVerdict, Summary};

const APPOINTED_S: [f64; 3] = [40.0, 30.0, 60.0];

fn scenario(text: &str) -> Scenario {
    Scenario::from_json(text).unwrap()
}

fn whole() -> Scenario {
    scenario(include_str!("../models/yang2025.json"))
}

fn body(scenario: &mut Scenario) -> &mut RigidBodySystem {
    match &mut scenario.system {
        System::RigidBody(body) => body,
        System::TakagiSugeno(_) => panic!("a rigid body is expected"),
    }
}

fn controller(scenario: &mut Scenario) -> &mut YangChoice {
    match &mut scenario.controller {
        ControllerChoice::Yang(choice) => choice,
        _ => panic!("Yang's controller is expected"),
    }
}

fn run(scenario: &Scenario) -> Summary {
    simulate(scenario, None, false).unwrap().summary
}

fn recorded(scenario: &Scenario) -> Table {
    simulate(scenario, None, true).unwrap().trajectory.unwrap()
}

/// The last value of a column not later than `time_s`.
fn at(table: &Table, column: &str, time_s: f64) -> f64 {
    let times = table.column("time_s").unwrap();
    let row = times.partition_point(|&time| time <= time_s + 1e-9) - 1;
    table.column(column).unwrap()[row]
}

/// Every combination of signs of the five faults of Table 2.
fn with_signs(scenario: &Scenario, pattern: u32) -> Scenario {
    let mut scenario = scenario.clone();
    let pulses = &mut body(&mut scenario).disturbance.pulses;
    assert_eq!(pulses.len(), 5);
    for (index, pulse) in pulses.iter_mut().enumerate() {
        let sign = if pattern >> index & 1 == 1 { -1.0 } else { 1.0 };
        pulse.constant *= sign;
        pulse.wave *= sign;
    }
    scenario
}

/// The start turned by a random angle of 1e-6 rad about each axis.
fn perturbed(scenario: &Scenario, count: usize) -> Vec<Scenario> {
    let mut random = Random::new(2025, Purpose::InitialState);
    let start = |_| {
        let mut scenario = scenario.clone();
        let turn = Vector3::from_fn(|_, _| 0.5e-6 * random.normal());
        let attitude = &mut body(&mut scenario).attitude;
        *attitude = (*attitude * Quaternion::new(1.0, turn))
            .normalised()
            .unwrap();
        scenario
    };
    (0..count).map(start).collect()
}

#[test]
fn explore() {
    for (name, text) in [
        ("ces", include_str!("../models/yang2025.json")),
        (
            "fixed",
            include_str!("../models/yang2025-fixed-threshold.json"),
        ),
        (
            "relative",
            include_str!("../models/yang2025-relative-threshold.json"),
        ),
    ] {
        let words: Vec<_> = perturbed(&scenario(text), 10)
            .iter()
            .map(|s| {
                let s = run(s);
                let l = s.link.unwrap();
                (l.words, l.bits, s.violations)
            })
            .collect();
        println!("{name} {words:?}");
    }
    for pattern in 0..32 {
        let ces = run(&with_signs(&whole(), pattern));
        let mut continuous = with_signs(&whole(), pattern);
        continuous.link = None;
        let continuous = run(&continuous);
        println!(
            "{pattern} ces {} {:?} cont {} {:?} {} {}",
            ces.violations,
            ces.funnel.unwrap().largest_ratio,
            continuous.violations,
            continuous.funnel.unwrap().largest_ratio,
            continuous.max_torque,
            ces.link.unwrap().words
        );
    }
    for linked in [true, false] {
        let mut quiet = whole();
        body(&mut quiet).disturbance.pulses.clear();
        if !linked {
            quiet.link = None;
        }
        let outcome = simulate(&quiet, None, true).unwrap();
        let table = outcome.trajectory.unwrap();
        println!(
            "linked {linked} violations {} {:?} words {:?}",
            outcome.summary.violations,
            outcome.summary.funnel,
            outcome.summary.link.map(|l| l.words)
        );
        for (axis, &time) in APPOINTED_S.iter().enumerate() {
            let c = format!("error_q{}", axis + 1);
            println!(
                "{c} {time} {:e} end {:e}",
                at(&table, &c, time),
                at(&table, &c, 150.0)
            );
        }
        println!("final deg {:?}", outcome.summary.final_error_deg);
    }
    for k in [0.04, 0.042, 0.044, 0.045, 0.046, 0.048] {
        for level in [0.35, 0.4, 0.45, 0.5] {
            let text = include_str!("../models/yang2025-static-envelope.json")
                .replace("\"rate_per_s\": 0.05", &format!("\"rate_per_s\": {k}"))
                .replace(
                    "\"initial_level\": 0.4",
                    &format!("\"initial_level\": {level}"),
                );
            let s = run(&scenario(&text));
            println!(
                "static {k} {level}: {:?}",
                s.funnel.unwrap().first_outside_s
            );
        }
    }
    for kind in [
        FaultEstimation::LowPass {
            time_constant_s: 0.05,
        },
        FaultEstimation::LowPass {
            time_constant_s: 0.2,
        },
        FaultEstimation::LowPass {
            time_constant_s: 0.5,
        },
        FaultEstimation::ExtendedState {
            bandwidth_rad_s: 20.0,
        },
        FaultEstimation::ExtendedState {
            bandwidth_rad_s: 10.0,
        },
        FaultEstimation::ExtendedState {
            bandwidth_rad_s: 5.0,
        },
        FaultEstimation::ExtendedState {
            bandwidth_rad_s: 2.0,
        },
    ] {
        for linked in [true, false] {
            let mut bad = 0;
            let mut ratio = 0.0_f64;
            for pattern in [0, 31, 10, 21] {
                let mut s = with_signs(&whole(), pattern);
                if !linked {
                    s.link = None;
                }
                let choice = controller(&mut s);
                choice.told_fault = false;
                choice.parameters.fault_estimation = kind;
                let s = run(&s);
                bad += u32::from(s.violations > 0);
                ratio = ratio.max(s.funnel.unwrap().largest_ratio);
            }
            println!("{kind:?} linked {linked} bad {bad}/4 ratio {ratio}");
        }
    }
    for factor in [1.2, 1.4, 1.6, 2.0] {
        let mut s = whole();
        let a = [18.0, 5.0, 37.0].map(|x: f64| (x * factor).to_radians());
        let about =
            |angle: f64, axis: Vector3<f64>| Quaternion::from_axis_angle(&axis, angle).unwrap();
        body(&mut s).attitude =
            about(a[0], Vector3::x()) * about(a[1], Vector3::y()) * about(a[2], Vector3::z());
        let plain = run(&s);
        s.link = None;
        body(&mut s).disturbance.pulses.clear();
        let c = run(&s);
        println!(
            "x{factor} ces+faults {} {:?} cont nofault {} {:?}",
            plain.violations,
            plain.funnel.unwrap(),
            c.violations,
            c.funnel.unwrap()
        );
    }
    let start = Quaternion::from_scalar_first([0.9336, 0.1619, -0.0087, 0.3196]);
    println!("{start:?}");
    // z = 6, m = 4
    let mut s = whole();
    let link = s.link.as_mut().unwrap();
    for axis in &mut link.parameters.axes {
        let Scheme::Compressed { levels, .. } = axis.scheme else {
            panic!()
        };
        let (lo, hi) = (levels.threshold(0).unwrap(), levels.threshold(3).unwrap());
        axis.scheme = Scheme::Compressed {
            alphabet: Alphabet::new(6, 4).unwrap(),
            levels: Levels::Even {
                count: 648,
                smallest_threshold: lo,
                largest_threshold: hi,
            },
        };
    }
    let s = run(&s);
    println!("6,4: {:?} {}", s.link, s.violations);
}
