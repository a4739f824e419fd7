//! The controller of Lei et al. 2022: law, trigger, barrier and a closed loop.

mod trigger;

use crate::common::{Body, Plant};
use approx::assert_relative_eq;
use proptest::prelude::*;
use runtime::attitude::{skew, AttitudeMeasurement, Quaternion};
use runtime::command::{Command, HoldReason, Status};
use runtime::error::ParameterError;
use runtime::lei2022::{
    Barrier, CompositeTrigger, ControlLaw, Controller, DisturbanceCompensation, Parameters,
    PerformanceFunction, SwitchCount, TriggerRule, VirtualLaw, MESSAGE_BYTES,
};
use runtime::nalgebra::{Matrix3, Vector3};

const BARRIER: Barrier = Barrier {
    gain_j: 5e-5,
    width: 1.3,
};
const VIRTUAL: VirtualLaw = VirtualLaw {
    gain: 1.5,
    rate_scale_rad_s: 0.05,
    slope: 13.0,
};

fn performance() -> PerformanceFunction {
    PerformanceFunction {
        initial: Vector3::new(0.6, 0.5, 0.4),
        terminal: Vector3::new(5e-3, 6e-3, 7e-3),
        midpoint_s: 50.0,
        time_scale_s: 6.4,
    }
}

fn trigger() -> CompositeTrigger {
    CompositeTrigger {
        held_error_initial: 1.7e-3,
        held_error_terminal: 1e-5,
        longest_on_s: 1.0,
        envelope_initial_j: 4.2e-3,
        envelope_terminal_j: 2e-7,
        decay_rate_per_s: 0.18,
        buffer_j: 6e-8,
        relative_buffer: 0.0,
    }
}

fn parameters() -> Parameters {
    Parameters {
        law: ControlLaw {
            inertia: Matrix3::new(2.8, 0.1, -0.2, 0.1, 2.5, 0.05, -0.2, 0.05, 1.9),
            performance: performance(),
            barrier: BARRIER,
            virtual_law: VIRTUAL,
            rate_gain: 2.6,
            disturbance: DisturbanceCompensation {
                bound_nm: 1.5e-3,
                smoothing_rad_s: 2.8e-4,
            },
        },
        trigger: TriggerRule::Composite(trigger()),
        torque_limit: Vector3::repeat(0.05),
        sign_hysteresis: 0.0,
    }
}

fn with_trigger(change: impl FnOnce(&mut CompositeTrigger)) -> Parameters {
    let mut rule = trigger();
    change(&mut rule);
    Parameters {
        trigger: TriggerRule::Composite(rule),
        ..parameters()
    }
}

fn measurement(rate: [f64; 3], vector: [f64; 3]) -> AttitudeMeasurement {
    let vector = Vector3::from(vector);
    AttitudeMeasurement {
        error: Quaternion::new((1.0 - vector.norm_squared()).sqrt(), vector),
        rate_rad_s: Vector3::from(rate),
    }
}

/// A unit quaternion with a positive scalar part.
fn unit(parts: [f64; 4]) -> Quaternion {
    let quaternion = Quaternion::from_scalar_first(parts);
    quaternion.normalised().unwrap().shortest()
}

fn any_unit() -> impl Strategy<Value = Quaternion> {
    [0.05..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0_f64].prop_map(unit)
}

fn any_vector(largest: f64) -> impl Strategy<Value = Vector3<f64>> {
    let range = -largest..largest;
    [range.clone(), range.clone(), range].prop_map(Vector3::from)
}

/// The attitude after `time` seconds of turning at a constant body rate.
fn turned(start: &Quaternion, rate: &Vector3<f64>, time: f64) -> Quaternion {
    match Quaternion::from_axis_angle(rate, rate.norm() * time) {
        Ok(turn) => *start * turn,
        Err(_) => *start,
    }
}

/// F_s of (1).
fn kinematics(error: &Quaternion) -> Matrix3<f64> {
    (Matrix3::identity() * error.scalar + skew(&error.vector)) * 0.5
}

/// Derivative at zero by central differences with one extrapolation: of order 4.
fn derivative(step: f64, value: impl Fn(f64) -> Vector3<f64>) -> Vector3<f64> {
    let central = |h: f64| (value(h) - value(-h)) / (2.0 * h);
    (central(step / 2.0) * 4.0 - central(step)) / 3.0
}

#[test]
fn the_funnel_falls_from_its_initial_to_its_terminal_width() {
    let funnel = performance();
    for time in [0.0, 20.0, 45.0, 50.0, 51.0, 70.0, 200.0] {
        let t = ((time - 50.0) / 6.4_f64).tanh();
        let printed =
            (funnel.initial + funnel.terminal) / 2.0 - (funnel.initial - funnel.terminal) / 2.0 * t;
        assert_relative_eq!(funnel.value(time), printed, max_relative = 1e-13);
        let rate = derivative(0.02, |h| funnel.value(time + h));
        assert_relative_eq!(
            funnel.rate(time),
            rate,
            max_relative = 1e-8,
            epsilon = 1e-12
        );
    }
    assert_relative_eq!(funnel.value(0.0), funnel.initial, max_relative = 1e-6);
    assert_eq!(funnel.value(1e6), funnel.terminal);
    assert_eq!(funnel.rate(1e6), Vector3::zeros());
}

#[test]
fn occupancy_is_the_largest_component_over_its_width() {
    let vector = Vector3::new(0.3, -0.45, 0.1);
    let share = performance().occupancy(0.0, &vector);
    assert_relative_eq!(share, 0.9, max_relative = 1e-6);
}

/// V2 of the parameters at rest at an error.
fn energy(sample: &AttitudeMeasurement) -> f64 {
    let controller = Controller::new(parameters()).unwrap();
    controller.evaluate(0.0, sample).unwrap().rate_error_energy
}

/// A controller whose envelope is constant but for rounding, at this multiple of V2 of the sample.
fn with_envelope(multiple: f64, sample: &AttitudeMeasurement) -> Controller {
    let level = multiple * energy(sample);
    let parameters = with_trigger(|trigger| {
        trigger.envelope_terminal_j = level;
        trigger.envelope_initial_j = level * (1.0 + 1e-12);
        trigger.buffer_j = 1e-3 * level;
    });
    Controller::new(parameters).unwrap()
}

proptest! {
    #[test]
    fn the_virtual_law_is_the_printed_one(
        error in any_unit(), width in [0.005..1.0, 0.005..1.0, 0.005..1.0_f64],
    ) {
        let width = Vector3::from(width);
        let bounded = error.vector.zip_map(&width, |q, rho| (VIRTUAL.slope * q / rho).tanh());
        let inverse = kinematics(&error).try_inverse().unwrap();
        let factor = -0.5 * error.scalar * VIRTUAL.gain * VIRTUAL.rate_scale_rad_s;
        let printed = inverse * Matrix3::from_diagonal(&width) * bounded * factor;
        assert_relative_eq!(VIRTUAL.rate(&error, &width), printed, epsilon = 1e-13);
    }

    /// Remark 1: the virtual rate is bounded by k_m M_omega max rho (times the root of 3, which the
    /// remark drops).
    #[test]
    fn the_virtual_rate_is_bounded(
        error in any_unit(), width in [0.005..1.0, 0.005..1.0, 0.005..1.0_f64],
    ) {
        let width = Vector3::from(width);
        let bound = VIRTUAL.strength() * width.norm();
        prop_assert!(VIRTUAL.rate(&error, &width).norm() <= bound * (1.0 + 1e-12));
    }

    #[test]
    fn the_virtual_acceleration_is_the_derivative_of_the_virtual_rate(
        error in any_unit(), rate in any_vector(0.1), time in 0.0..80.0_f64,
    ) {
        let funnel = performance();
        let along = |h: f64| VIRTUAL.rate(&turned(&error, &rate, h), &funnel.value(time + h));
        let found = VIRTUAL.acceleration(&error, &rate, &funnel.value(time), &funnel.rate(time));
        let scale = 1.0 + found.norm();
        assert_relative_eq!(found, derivative(2e-4, along), epsilon = 3e-8 * scale);
    }

    /// What the control law subtracts is what the rate error does to V1, in a funnel that stands still.
    /// As printed (F_s in the place of its transpose) it is not, unless the axes' funnels are equal.
    #[test]
    fn the_compensation_is_the_rate_of_v1_per_body_rate(
        error in any_unit(), rate in any_vector(0.1),
    ) {
        let width = performance().initial;
        let value = |h: f64| {
            let transformed = turned(&error, &rate, h).vector.component_div(&width);
            Vector3::repeat(BARRIER.value(&transformed))
        };
        let found = BARRIER.compensation(&error, &width).dot(&rate);
        prop_assert!((found - derivative(1e-2, value).x).abs() < 1e-11);
    }

    /// (23): with the law's torque in force and no disturbance, J z2' = -K2 z2 - rejection - P_q.
    #[test]
    fn the_law_closes_the_second_layer_as_in_23(
        error in any_unit(), rate in any_vector(0.05), time in 0.0..80.0_f64,
    ) {
        let law = parameters().law;
        let now = law.evaluate(time, &error, &rate);
        let acceleration = Plant::new(law.inertia).acceleration(&rate, &now.torque);
        let along = |h: f64| {
            let error = turned(&error, &rate, h);
            law.evaluate(time + h, &error, &rate).virtual_rate
        };
        let found = law.inertia * (acceleration - derivative(2e-4, along));
        let compensation = law.barrier.compensation(&error, &now.width);
        let rejection = now.rate_error.map(|z2| (z2 / 2.8e-4).tanh()) * 1.5e-3;
        let expected = now.rate_error * -2.6 - rejection - compensation;
        assert_relative_eq!(found, expected, epsilon = 1e-6 * (1.0 + now.torque.norm()));
    }

    #[test]
    fn both_quaternions_of_an_attitude_give_the_same_bits(
        error in any_unit(), rate in any_vector(0.05), time in 0.0..80.0_f64,
    ) {
        let mut one = Controller::new(parameters()).unwrap();
        let mut other = one;
        for time in [0.0, time + 1.0] {
            let positive = AttitudeMeasurement { error, rate_rad_s: rate };
            let negative = AttitudeMeasurement { error: -error, rate_rad_s: rate };
            prop_assert_eq!(one.step(time, &positive), other.step(time, &negative));
        }
    }

    #[test]
    fn every_command_is_finite_and_within_the_limits(
        parts in [-1.0..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0_f64], rate in any_vector(2.0),
    ) {
        let mut controller = Controller::new(parameters()).unwrap();
        let Ok(error) = Quaternion::from_scalar_first(parts).normalised() else {
            return Ok(());
        };
        for step in 0..5 {
            let sample = AttitudeMeasurement { error, rate_rad_s: rate };
            let command = controller.step(f64::from(step) * 0.7, &sample);
            prop_assert_eq!(command.status, Status::Nominal);
            prop_assert!(command.torque.amax() <= 0.05);
        }
    }
}

#[test]
fn the_printed_compensation_is_another_one_where_the_funnels_differ() {
    let error = unit([0.7, 0.4, -0.5, 0.3]);
    let printed = |width: &Vector3<f64>| {
        let transformed = error.vector.component_div(width);
        let pressed = kinematics(&error) * transformed;
        let strength = BARRIER.gain_j * (transformed.norm_squared() / BARRIER.width).tanh();
        pressed.component_div(width) * strength
    };
    let equal = Vector3::repeat(0.5);
    let same = BARRIER.compensation(&error, &equal);
    assert_relative_eq!(printed(&equal), same, max_relative = 1e-13);
    let differing = performance().initial;
    let other = BARRIER.compensation(&error, &differing);
    assert!((printed(&differing) - other).norm() > 0.05 * other.norm());
}

#[test]
fn the_barrier_is_the_printed_logarithm_at_small_and_large_errors() {
    for size in [1e-4, 0.05, 0.099, 0.101, 0.3, 1.0, 3.0] {
        let transformed = Vector3::new(size, -0.5 * size, 0.3 * size);
        let x: f64 = transformed.norm_squared() / BARRIER.width;
        let printed = 0.5 * BARRIER.gain_j * BARRIER.width * x.cosh().ln();
        // The printed form itself loses its digits where cosh is near 1.
        let lost = 1e-16 * BARRIER.gain_j;
        assert_relative_eq!(
            BARRIER.value(&transformed),
            printed,
            max_relative = 1e-12,
            epsilon = lost
        );
    }
    let far = BARRIER.value(&Vector3::repeat(1e5));
    assert!(far.is_finite() && far > 0.0);
}

/// (10) as printed has no value at a half turn; the limit from the positive side does.
#[test]
fn at_a_half_turn_the_law_is_finite_and_turns_back_along_the_axis() {
    let error = Quaternion::new(0.0, Vector3::new(0.6, 0.0, 0.8));
    let rate = VIRTUAL.rate(&error, &Vector3::repeat(1.0));
    assert!(rate.cross(&error.vector).norm() < 1e-15);
    assert!(rate.dot(&error.vector) < -0.05);
    let mut controller = Controller::new(parameters()).unwrap();
    let sample = AttitudeMeasurement {
        error,
        rate_rad_s: Vector3::zeros(),
    };
    let torque = controller.evaluate(0.0, &sample).unwrap().torque;
    assert!(torque.dot(&error.vector) < -0.05);
    assert_eq!(controller.step(0.0, &sample).status, Status::Nominal);
}

#[test]
fn with_hysteresis_the_sign_changes_late() {
    let side = |hysteresis: f64| {
        let mut controller = Controller::new(Parameters {
            sign_hysteresis: hysteresis,
            ..parameters()
        })
        .unwrap();
        let at = |scalar: f64| AttitudeMeasurement {
            error: Quaternion::new(
                scalar,
                Vector3::new((1.0 - scalar * scalar).sqrt(), 0.0, 0.0),
            ),
            rate_rad_s: Vector3::zeros(),
        };
        controller.step(0.0, &at(0.05));
        let now = controller.evaluate(0.1, &at(-0.05)).unwrap();
        now.virtual_rate.x
    };
    assert!(side(0.0) > 0.0, "as published the sign has changed");
    assert!(side(0.1) < 0.0, "with hysteresis it has not");
}

#[test]
fn an_unusable_sample_holds_the_torque_and_leaves_the_controller_as_it_was() {
    let sample = measurement([0.0; 3], [0.3, -0.2, 0.1]);
    let mut controller = with_envelope(0.9, &sample);
    let torque = controller.step(1.0, &sample).torque;
    let before = controller;
    let held = |reason| Command {
        torque,
        sent: false,
        bits: 0,
        status: Status::Held(reason),
    };
    let early = HoldReason::TimeNotIncreasing {
        last_s: 1.0,
        time_s: 1.0,
    };
    assert_eq!(controller.step(1.0, &sample), held(early));
    let command = controller.step(f64::NAN, &sample);
    assert_eq!(command, held(HoldReason::NonFiniteTime));
    let mut broken = sample;
    broken.rate_rad_s.y = f64::INFINITY;
    let reason = HoldReason::NonFiniteMeasurement { component: 5 };
    assert_eq!(controller.step(2.0, &broken), held(reason));
    broken.rate_rad_s.y = 1e200;
    assert_eq!(controller.step(2.0, &broken), held(HoldReason::Overflow));
    broken = sample;
    broken.error.scalar = 0.0;
    let norm = broken.error.norm();
    let reason = HoldReason::NotUnitQuaternion { norm };
    assert_eq!(controller.step(2.0, &broken), held(reason));
    assert_eq!(controller, before);
}

#[track_caller]
fn assert_refused(change: impl FnOnce(&mut Parameters), message: &str) {
    let mut bad = parameters();
    change(&mut bad);
    let error: ParameterError = Controller::new(bad).unwrap_err();
    assert_eq!(error.to_string(), message);
}

fn composite(parameters: &mut Parameters) -> &mut CompositeTrigger {
    match &mut parameters.trigger {
        TriggerRule::Composite(trigger) => trigger,
        TriggerRule::EverySample => panic!("a composite trigger is expected"),
    }
}

#[test]
fn parameters_out_of_their_range_are_refused_with_the_numbers() {
    assert_refused(
        |p| p.law.performance.terminal.y = 0.5,
        "terminal[1] is 0.5, allowed is (0, 0.5)",
    );
    assert_refused(
        |p| p.law.performance.time_scale_s = 0.0,
        "time_scale_s is 0, allowed is (0, inf)",
    );
    assert_refused(
        |p| composite(p).envelope_terminal_j = 4.2e-3,
        "envelope_terminal_j is 0.0042, allowed is (0, 0.0042)",
    );
    assert_refused(
        |p| composite(p).buffer_j = 2e-7,
        "buffer_j is 0.0000002, allowed is (0, 0.0000002)",
    );
    assert_refused(
        |p| composite(p).longest_on_s = 0.0,
        "longest_on_s is 0, allowed is (0, inf)",
    );
    assert_refused(
        |p| composite(p).relative_buffer = 1.0,
        "relative_buffer is 1, allowed is [0, 1)",
    );
    assert_refused(
        |p| p.law.barrier.gain_j = f64::NAN,
        "barrier_gain_j is NaN, not a finite number",
    );
    assert_refused(
        |p| p.law.virtual_law.slope = -1.0,
        "slope is -1, allowed is (0, inf)",
    );
    assert_refused(
        |p| p.law.inertia[(0, 1)] = 0.3,
        "inertia[0][1] is 0.3 and its mirror image 0.1: the matrix is not symmetric",
    );
    assert_refused(
        |p| p.torque_limit.z = 0.0,
        "torque_limit[2] is 0, allowed is (0, inf)",
    );
    assert_refused(
        |p| p.sign_hysteresis = 1.0,
        "hysteresis is 1, allowed is [0, 1)",
    );
}

/// A small version of the harness's runs: sampled at 50 Hz with a relative buffer, from a start away from
/// the paper's, with a full inertia matrix.
#[test]
fn sampled_at_50_hz_the_body_settles_in_its_funnel_below_its_envelope() {
    let mut envelope = trigger();
    envelope.relative_buffer = 0.2;
    envelope.envelope_initial_j = 5.5e-3;
    let parameters = with_trigger(|trigger| *trigger = envelope);
    let funnel = parameters.law.performance;
    let plant = Plant::new(parameters.law.inertia);
    let mut controller = Controller::new(parameters).unwrap();
    let mut body = Body::at_rest(unit([0.8, 0.4, -0.3, 0.25]));
    let step = 0.02;
    let mut largest = 0.0_f64;
    for index in 0..5000 {
        let time = f64::from(index) * step;
        let sample = body.measured();
        let command = controller.step(time, &sample);
        let energy = controller
            .evaluate(time, &sample)
            .unwrap()
            .rate_error_energy;
        largest = largest.max(energy / envelope.envelope(time));
        assert!(funnel.occupancy(time, &body.attitude.vector) < 1.0);
        body = plant.advance(&body, time, step, &command.torque, |_| Vector3::zeros());
    }
    assert!(largest < 1.0, "{largest}");
    assert!(body.attitude.vector.amax() < 1e-3);
}
