//! Time of one controller step: `cargo bench -p steadfast-runtime`.

use std::hint::black_box;
use std::time::Instant;

use runtime::attitude::{AttitudeMeasurement, Quaternion};
use runtime::membership::{ConstantGain, Membership, RigidBodyBox};
use runtime::nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3, Vector6};
use runtime::trigger::{Adaptation, ThresholdUpdate};
use runtime::{lei2022, wu2018, xu2020};

const STEPS: usize = 2_000_000;
const REPEATS: usize = 5;

fn main() {
    for (name, threshold) in [("every sample sent", 0.0), ("rarely sent", 0.9)] {
        let plane = RigidBodyBox::new([0.1; 3], 0.75).expect("a box");
        report(
            &format!("xu2020, 16 gains, {name}"),
            fuzzy(plane, [gain(); 16], threshold),
        );
        report(
            &format!("xu2020, 1 gain, {name}"),
            fuzzy(ConstantGain, [gain()], threshold),
        );
    }
    report(
        "wu2018, every sample sent",
        wu(wu2018::TriggerRule::EverySample),
    );
    report(
        "wu2018, relative trigger",
        wu(wu2018::TriggerRule::Relative {
            relative: 0.5,
            absolute_rad_s: 1e-6,
        }),
    );
    report("lei2022, every sample sent", lei());
}

fn report(name: &str, mut step: impl FnMut(usize)) {
    let best = (0..REPEATS)
        .map(|repeat| {
            let start = Instant::now();
            for index in 1..=STEPS {
                step(repeat * STEPS + index);
            }
            start.elapsed().as_secs_f64() / STEPS as f64
        })
        .fold(f64::INFINITY, f64::min);
    println!("{name:<40} {:>8.1} ns per step", 1e9 * best);
}

fn gain() -> Matrix3x6<f64> {
    Matrix3x6::from_fn(|row, column| if column % 3 == row { -100.0 } else { 1.0 })
}

fn phase(index: usize) -> f64 {
    (index % 1024) as f64 / 1024.0
}

fn fuzzy<S: Membership<6, R>, const R: usize>(
    membership: S,
    gains: [Matrix3x6<f64>; R],
    threshold: f64,
) -> impl FnMut(usize) {
    let adaptation = Adaptation {
        amplitude: 10.0,
        slope: 1.0,
        dead_band: 0.02,
    };
    let mut controller = xu2020::Controller::new(xu2020::Parameters {
        gains,
        membership,
        trigger_weight: Matrix6::identity(),
        threshold_update: ThresholdUpdate::Clamped {
            adaptation,
            minimum: threshold,
            maximum: threshold,
        },
        torque_limit: Vector3::repeat(2.0),
        trigger_floor: 0.0,
        longest_interval_s: Some(0.1),
    })
    .expect("valid parameters");
    move |index| {
        let state = Vector6::repeat(0.03 + 0.01 * phase(index));
        black_box(controller.step(0.01 * index as f64, black_box(&state)));
    }
}

fn wu(trigger: wu2018::TriggerRule) -> impl FnMut(usize) {
    let mut controller = wu2018::Controller::new(wu2018::Parameters {
        gains: wu2018::Gains {
            error_gain: 26.0,
            attitude_weight: 0.08,
        },
        trigger,
        torque_limit: Vector3::repeat(0.2),
        unwinding: wu2018::Unwinding::AsPublished,
    })
    .expect("valid parameters");
    move |index| {
        let measurement = AttitudeMeasurement {
            error: Quaternion::new(0.999, Vector3::new(0.04 * phase(index), 0.01, -0.02)),
            rate_rad_s: Vector3::new(1e-3, -1e-3, 2e-3),
        };
        black_box(controller.step(0.01 * index as f64, black_box(&measurement)));
    }
}

fn lei() -> impl FnMut(usize) {
    let mut controller = lei2022::Controller::new(lei2022::Parameters {
        law: lei2022::ControlLaw {
            inertia: Matrix3::from_diagonal(&Vector3::new(2.8, 2.5, 1.9)),
            performance: lei2022::PerformanceFunction {
                initial: Vector3::repeat(0.5),
                terminal: Vector3::repeat(5e-3),
                midpoint_s: 50.0,
                time_scale_s: 6.4,
            },
            barrier: lei2022::Barrier {
                gain_j: 5e-5,
                width: 1.0,
            },
            virtual_law: lei2022::VirtualLaw {
                gain: 1.5,
                rate_scale_rad_s: 0.0524,
                slope: 13.0,
            },
            rate_gain: 2.6,
            disturbance: lei2022::DisturbanceCompensation {
                bound_nm: 1.5e-3,
                smoothing_rad_s: 2.8e-4,
            },
        },
        trigger: lei2022::TriggerRule::EverySample,
        torque_limit: Vector3::repeat(0.05),
        sign_hysteresis: 0.0,
    })
    .expect("valid parameters");
    move |index| {
        let measurement = AttitudeMeasurement {
            error: Quaternion::new(0.999, Vector3::new(0.04 * phase(index), 0.01, -0.02)),
            rate_rad_s: Vector3::new(1e-3, -1e-3, 2e-3),
        };
        black_box(controller.step(0.01 * index as f64, black_box(&measurement)));
    }
}
