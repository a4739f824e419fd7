//! The controller of Xu and Huang 2020: gains, trigger and a closed loop.

use crate::common::{Body, Plant};
use approx::assert_relative_eq;
use proptest::prelude::*;
use runtime::attitude::Quaternion;
use runtime::command::{Command, Departure, HoldReason, Status};
use runtime::error::ParameterError;
use runtime::membership::{ConstantGain, IntervalProduct, Membership, RigidBodyBox};
use runtime::nalgebra::{
    Matrix2, Matrix3, Matrix3x6, Matrix6, RowVector2, SVector, Vector1, Vector2, Vector3, Vector6,
};
use runtime::trigger::{Adaptation, ThresholdUpdate};
use runtime::xu2020::{Controller, Parameters};

/// Two states, one input, one gain.
fn small() -> Parameters<ConstantGain, 2, 1, 1> {
    Parameters {
        gains: [RowVector2::new(-2.0, -1.0)],
        membership: ConstantGain,
        trigger_weight: Matrix2::identity(),
        threshold_update: ThresholdUpdate::Fixed { threshold: 0.25 },
        torque_limit: Vector1::new(1.0),
        trigger_floor: 0.0,
        longest_interval_s: Some(0.1),
    }
}

/// Two rules that blend over the first state, from -1 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Blend(IntervalProduct<1, 2>);

impl Membership<2, 2> for Blend {
    fn weights(&self, state: &Vector2<f64>) -> [f64; 2] {
        self.0.weights(&[state.x])
    }

    fn contains(&self, state: &Vector2<f64>) -> bool {
        self.0.contains(&[state.x])
    }
}

fn scheduled() -> Parameters<Blend, 2, 1, 2> {
    Parameters {
        gains: [RowVector2::new(-4.0, 0.0), RowVector2::new(0.0, -8.0)],
        membership: Blend(IntervalProduct::new([-1.0], [1.0]).unwrap()),
        trigger_weight: Matrix2::identity(),
        threshold_update: ThresholdUpdate::Fixed { threshold: 0.25 },
        torque_limit: Vector1::new(10.0),
        trigger_floor: 0.0,
        longest_interval_s: None,
    }
}

#[test]
fn near_rest_a_floor_keeps_noise_from_being_sent() {
    let sent = |trigger_floor: f64| {
        let parameters = Parameters {
            trigger_floor,
            ..small()
        };
        let mut controller = Controller::new(parameters).unwrap();
        let noise = |index: i32| if index % 2 == 0 { 1e-3 } else { -1e-3 };
        let commands = (0..100).map(|index| {
            let state = Vector2::new(noise(index), noise(index / 2));
            controller.step(0.1 * f64::from(index), &state)
        });
        commands.filter(|command| command.sent).count()
    };
    assert!(sent(0.0) > 90);
    assert_eq!(sent(1e-5), 1);
}

#[test]
fn the_first_sample_is_sent_and_the_torque_is_the_saturated_gain_times_the_state() {
    let mut controller = Controller::new(small()).unwrap();
    let command = controller.step(0.0, &Vector2::new(0.25, 0.125));
    assert_eq!(command.torque, Vector1::new(-0.625));
    assert!(command.sent);
    assert_eq!(command.bytes(), 8);
    assert_eq!(command.status, Status::Nominal);
    let mut controller = Controller::new(small()).unwrap();
    assert_eq!(controller.step(0.0, &Vector2::new(3.0, 0.0)).torque.x, -1.0);
}

#[test]
fn the_torque_is_held_until_the_state_has_moved_enough() {
    let mut controller = Controller::new(small()).unwrap();
    controller.step(0.0, &Vector2::new(0.25, 0.0));
    let kept = controller.step(0.1, &Vector2::new(0.13, 0.0));
    assert_eq!((kept.sent, kept.bytes(), kept.torque.x), (false, 0, -0.5));
    let moved = controller.step(0.2, &Vector2::new(0.125, 0.0));
    assert_eq!(
        (moved.sent, moved.bytes(), moved.torque.x),
        (true, 8, -0.25)
    );
    assert_eq!(controller.trigger().sent(), Some(&Vector2::new(0.125, 0.0)));
}

#[test]
fn gains_are_scheduled_at_the_state_sent_last() {
    let mut controller = Controller::new(scheduled()).unwrap();
    // Weights at 0.5 are 1/4 and 3/4: u = 1/4 (-4 * 0.5) + 3/4 (-8 * 0.25) = -2.
    assert_eq!(
        controller.step(0.0, &Vector2::new(0.5, 0.25)).torque.x,
        -2.0
    );
    let kept = controller.step(1.0, &Vector2::new(0.375, 0.25));
    assert!(!kept.sent);
    assert_eq!(kept.torque.x, -2.0);
}

#[test]
fn a_state_outside_of_the_box_is_used_with_clamped_weights_and_reported() {
    let mut controller = Controller::new(scheduled()).unwrap();
    let command = controller.step(0.0, &Vector2::new(1.5, 0.25));
    assert_eq!(command.torque.x, -2.0);
    assert!(command.sent);
    assert_eq!(command.status, Status::Uncertified(Departure::OutsideBox));
    let back = controller.step(1.0, &Vector2::new(1.0, 0.25));
    assert_eq!(back.status, Status::Nominal);
}

#[test]
fn a_sample_later_than_the_design_allows_is_used_and_reported() {
    let mut controller = Controller::new(small()).unwrap();
    let state = Vector2::new(0.25, 0.0);
    assert_eq!(controller.step(0.0, &state).status, Status::Nominal);
    assert_eq!(controller.step(0.0625, &state).status, Status::Nominal);
    let late = Departure::LateSample {
        interval_s: 0.25,
        longest_s: 0.1,
    };
    assert_eq!(
        controller.step(0.3125, &state).status,
        Status::Uncertified(late)
    );
}

#[test]
fn samples_exactly_at_the_longest_interval_are_not_late_by_rounding() {
    let mut controller = Controller::new(small()).unwrap();
    for index in 0..1_000_000 {
        let time = 0.1 * f64::from(index);
        let command = controller.step(time, &Vector2::new(0.25, 0.0));
        assert_eq!(command.status, Status::Nominal, "at {time} s");
    }
}

fn held<const M: usize>(command: Command<M>, torque: SVector<f64, M>, reason: HoldReason) {
    assert_eq!(command.status, Status::Held(reason));
    assert_eq!(command.torque, torque);
    assert!(!command.sent);
    assert_eq!(command.bytes(), 0);
}

#[test]
fn unusable_samples_hold_the_last_command_and_say_why() {
    let mut controller = Controller::new(small()).unwrap();
    let good = Vector2::new(0.25, 0.0);
    let torque = controller.step(5.0, &good).torque;
    let before = controller;
    for time in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        held(
            controller.step(time, &good),
            torque,
            HoldReason::NonFiniteTime,
        );
    }
    for time in [5.0, -1.0] {
        let reason = HoldReason::TimeNotIncreasing {
            last_s: 5.0,
            time_s: time,
        };
        held(controller.step(time, &good), torque, reason);
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let reason = HoldReason::NonFiniteMeasurement { component: 1 };
        held(
            controller.step(5.05, &Vector2::new(0.0, bad)),
            torque,
            reason,
        );
    }
    let huge = Vector2::new(1e200, 0.0);
    held(controller.step(5.05, &huge), torque, HoldReason::Overflow);
    assert_eq!(controller, before);
    let command = controller.step(5.05, &(good * 2.0));
    assert_eq!((command.status, command.torque.x), (Status::Nominal, -1.0));
}

#[test]
fn a_torque_that_is_not_a_number_is_not_commanded() {
    let mut parameters = small();
    parameters.gains = [RowVector2::new(f64::MAX, -f64::MAX)];
    let mut controller = Controller::new(parameters).unwrap();
    let command = controller.step(0.0, &Vector2::new(4.0, 4.0));
    held(command, Vector1::zeros(), HoldReason::Overflow);
    assert!(controller.trigger().sent().is_none());
}

#[test]
fn reset_goes_back_to_the_first_sample() {
    let mut controller = Controller::new(small()).unwrap();
    let fresh = controller;
    controller.step(1e12, &Vector2::new(0.25, 0.0));
    controller.reset();
    assert_eq!(controller, fresh);
    assert!(controller.step(0.0, &Vector2::new(0.25, 0.0)).sent);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_comes_in_the_torque_is_finite_and_within_its_limit(
        samples in prop::collection::vec(
            (prop::num::f64::ANY, prop::array::uniform2(prop::num::f64::ANY)),
            1..40,
        ),
    ) {
        let mut controller = Controller::new(scheduled()).unwrap();
        for (time, state) in samples {
            let command = controller.step(time, &Vector2::from(state));
            prop_assert!(command.torque.x.abs() <= 10.0);
            prop_assert!(!command.sent || !matches!(command.status, Status::Held(_)));
        }
    }

    #[test]
    fn between_messages_the_state_stays_within_the_threshold_of_the_one_sent(
        samples in prop::collection::vec(prop::array::uniform2(-1.0..1.0f64), 1..60),
    ) {
        let mut controller = Controller::new(small()).unwrap();
        for (index, state) in samples.into_iter().enumerate() {
            let state = Vector2::from(state);
            controller.step(0.1 * index as f64, &state);
            let sent = controller.trigger().sent().unwrap();
            prop_assert!((state - sent).norm_squared() <= 0.25 * sent.norm_squared());
        }
    }
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    type Change = fn(&mut Parameters<ConstantGain, 2, 1, 1>);
    let cases: [(&str, Change); 6] = [
        ("gains[0][0][1] is NaN, not a finite number", |p| {
            p.gains[0][(0, 1)] = f64::NAN
        }),
        ("trigger_weight[0][0] is inf, not a finite number", |p| {
            p.trigger_weight[(0, 0)] = f64::INFINITY;
        }),
        ("threshold is 1, allowed is [0, 1)", |p| {
            p.threshold_update = ThresholdUpdate::Fixed { threshold: 1.0 };
        }),
        ("torque_limit[0] is -1, allowed is (0, inf)", |p| {
            p.torque_limit.x = -1.0
        }),
        ("longest_interval_s is 0, allowed is (0, inf)", |p| {
            p.longest_interval_s = Some(0.0)
        }),
        (
            "trigger_weight[1][1]: the matrix is not positive definite, pivot 0",
            |p| {
                p.trigger_weight = Matrix2::repeat(1.0);
            },
        ),
    ];
    for (message, change) in cases {
        let mut parameters = small();
        change(&mut parameters);
        let error: ParameterError = Controller::new(parameters).unwrap_err();
        assert_eq!(error.to_string(), message);
    }
}

#[test]
fn sixteen_equal_gains_command_the_same_torque_as_one() {
    let rules = RigidBodyBox::new([0.1; 3], 0.7).unwrap();
    let mut scheduled = Controller::new(spacecraft(rules, [published_gain(); 16])).unwrap();
    let mut constant = Controller::new(spacecraft(rules, [published_gain()])).unwrap();
    for index in 0..100 {
        let (sine, cosine) = (0.3 * f64::from(index)).sin_cos();
        let state = Vector6::new(
            0.1 * sine,
            0.0,
            0.08 * cosine,
            0.3 * cosine,
            0.1,
            -0.2 * sine,
        );
        let time = 0.05 * f64::from(index);
        let (left, right) = (scheduled.step(time, &state), constant.step(time, &state));
        assert_relative_eq!(left.torque, right.torque, epsilon = 1e-13);
        assert_eq!((left.sent, left.bytes()), (right.sent, right.bytes()));
        assert_eq!(left.status, right.status);
    }
}

/// Gain F_1 of Appendix A; printed rows 1 to 3 are its rate block, rows 4 to 6 its attitude block.
fn published_gain() -> Matrix3x6<f64> {
    Matrix3x6::from_row_slice(&[
        -157.7479, 12.8948, 6.9567, -35.0656, 0.0821, -2.6976, //
        11.6462, -117.2082, 4.5123, -0.5367, -37.3799, -3.5277, //
        2.7898, 0.1396, -85.1616, 2.4968, 4.1414, -40.3453,
    ])
}

/// Trigger weight of Appendix A.
fn published_weight() -> Matrix6<f64> {
    Matrix6::from_row_slice(&[
        2.8914, -0.3518, -0.1452, 0.3317, -0.0362, 0.0542, //
        -0.3518, 1.6962, -0.0533, 0.0037, 0.2039, 0.0777, //
        -0.1452, -0.0533, 0.9666, -0.0210, -0.0422, 0.1158, //
        0.3317, 0.0037, -0.0210, 0.4205, -0.0388, -0.0319, //
        -0.0362, 0.2039, -0.0422, -0.0388, 0.4071, -0.0351, //
        0.0542, 0.0777, 0.1158, -0.0319, -0.0351, 0.4022,
    ])
}

const PUBLISHED: Adaptation = Adaptation {
    amplitude: 10.0,
    slope: 1.0,
    dead_band: 0.02,
};

fn spacecraft<S: Membership<6, R>, const R: usize>(
    membership: S,
    gains: [Matrix3x6<f64>; R],
) -> Parameters<S, 6, 3, R> {
    Parameters {
        gains,
        membership,
        trigger_weight: published_weight(),
        threshold_update: ThresholdUpdate::Clamped {
            adaptation: PUBLISHED,
            minimum: 0.2,
            maximum: 0.2,
        },
        torque_limit: Vector3::repeat(2.0),
        trigger_floor: 0.0,
        longest_interval_s: Some(0.1),
    }
}

fn paper_plant() -> Plant {
    Plant::new(Matrix3::new(
        350.0, 3.0, 4.0, 3.0, 270.0, 10.0, 4.0, 10.0, 190.0,
    ))
}

/// Disturbance of section 4, N m.
fn paper_disturbance(time: f64) -> Vector3<f64> {
    let (slow, fast) = (0.06 * time, 0.2 * time);
    Vector3::new(
        -1.5 + 2.0 * slow.cos() - 0.5 * fast.cos(),
        2.0 + 1.5 * slow.sin() - fast.cos(),
        -1.5 + 2.0 * slow.sin() - 1.5 * fast.sin(),
    ) * 1e-3
}

/// Uniform numbers in [0, 1) from a multiplicative generator, the same in every run.
struct Uniform(u64);

impl Uniform {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

struct Run {
    samples: usize,
    triggers: usize,
    error_deg: f64,
    threshold: f64,
}

/// The paper's loop over 200 s with F_1 alone: sampling intervals uniform in [0.001, 0.1] s, and the
/// largest error over the last 50 s.
fn closed_loop(threshold_update: ThresholdUpdate, seed: u64) -> Run {
    let parameters = Parameters {
        threshold_update,
        ..spacecraft(ConstantGain, [published_gain()])
    };
    let mut controller = Controller::new(parameters).unwrap();
    let plant = paper_plant();
    let start = Quaternion::from_scalar_first([0.7477, -0.3802, 0.2124, 0.5013]);
    let mut body = Body::at_rest(start.normalised().unwrap());
    let mut uniform = Uniform(seed);
    let mut run = Run {
        samples: 0,
        triggers: 0,
        error_deg: 0.0,
        threshold: 0.0,
    };
    let mut time = 0.0;
    while time < 200.0 {
        let command = controller.step(time, &body.measured().rigid_body_state());
        assert_eq!(command.status, Status::Nominal);
        assert!(command.torque.amax() <= 2.0);
        assert_eq!(command.bytes(), if command.sent { 24 } else { 0 });
        run.samples += 1;
        run.triggers += usize::from(command.sent);
        if time > 150.0 {
            run.error_deg = run.error_deg.max(body.angle_deg());
        }
        let interval = 0.001 + 0.099 * uniform.next();
        body = plant.advance(&body, time, interval, &command.torque, paper_disturbance);
        time += interval;
    }
    run.threshold = controller.trigger().threshold();
    run
}

/// With the threshold clamped the error ends at the disturbance's offset, below a twentieth of a
/// degree; as printed the threshold grows past 1 and the trigger goes blind.
#[test]
fn clamping_the_published_threshold_keeps_the_pointing_that_the_printed_update_loses() {
    for seed in 1..=3 {
        let clamped = closed_loop(
            ThresholdUpdate::Clamped {
                adaptation: PUBLISHED,
                minimum: 0.2,
                maximum: 0.2,
            },
            seed,
        );
        let printed = closed_loop(
            ThresholdUpdate::UnclampedAsPublished {
                adaptation: PUBLISHED,
                minimum: 0.2,
            },
            seed,
        );
        for run in [&clamped, &printed] {
            println!(
                "{} triggers in {} samples, {} deg, threshold {}",
                run.triggers, run.samples, run.error_deg, run.threshold
            );
        }
        assert!(clamped.triggers * 20 < clamped.samples);
        assert!(clamped.error_deg < 0.05, "{} deg", clamped.error_deg);
        assert_eq!(clamped.threshold, 0.2);
        assert!(printed.threshold > 1.0, "{}", printed.threshold);
        assert!(printed.error_deg > 10.0 * clamped.error_deg);
    }
}
