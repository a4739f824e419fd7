//! The controller of Yang et al. 2025 on its own plant.

use crate::common::{Body, Plant};
use proptest::prelude::*;
use runtime::attitude::{AttitudeMeasurement, Quaternion};
use runtime::command::{HoldReason, Status};
use runtime::error::{Field, ParameterError};
use runtime::nalgebra::{Matrix3, Matrix3x4, SMatrix, Vector3, Vector4};
use runtime::yang2025::envelope::{Adhesion, EnvelopeParameters, Resilience};
use runtime::yang2025::fault::FaultEstimation;
use runtime::yang2025::law::Gains;
use runtime::yang2025::performance::Performance;
use runtime::yang2025::{Controller, Measurement, Parameters};

const APPOINTED_S: [f64; 3] = [40.0, 30.0, 60.0];
const LIMIT: f64 = 0.2;
const SAMPLE_S: f64 = 0.01;

fn nominal_inertia() -> Matrix3<f64> {
    Matrix3::new(89.0, 0.2, 1.5, 0.2, 61.0, 0.7, 1.5, 0.7, 57.0)
}

fn envelope(appointed_time_s: f64) -> EnvelopeParameters {
    EnvelopeParameters {
        performance: Performance::AppointedTime {
            initial_level: 0.1,
            final_level: 1e-4,
            appointed_time_s,
            rate_per_s: 0.1,
            offset: 0.9,
        },
        shape: 1.0,
        one_sided: true,
        adhesion: Some(Adhesion {
            width: 3.0,
            exponent: 0.4,
            span_s: appointed_time_s,
        }),
        resilience: Some(Resilience {
            fault_gain: 1.0,
            rate_gain: 0.5,
            decay_per_s: 0.17,
            decay_size: 4.0,
            away_width: 0.1,
            toward_width: 1.0,
        }),
    }
}

fn parameters(fault_estimation: FaultEstimation) -> Parameters<3> {
    Parameters {
        inertia: nominal_inertia(),
        actuator_matrix: SMatrix::identity(),
        torque_limit: Vector3::repeat(LIMIT),
        envelopes: APPOINTED_S.map(envelope),
        gains: Gains {
            surface_gain: 0.02,
            surface_exponent: 5.0 / 3.0,
            linear_gain: 0.3,
            power_gain: 0.18,
            power_exponent: 0.6,
            dead_zone_rad_s: Vector3::repeat(1e-3),
        },
        fault_estimation,
    }
}

/// Section 4, N m.
fn disturbance(time: f64) -> Vector3<f64> {
    let sine = (0.33 * time).sin();
    Vector3::new(
        3.0 * sine * (0.67 * time).cos(),
        sine * (0.98 * time).cos(),
        2.0 * sine * (0.75 * time).cos(),
    ) * 1e-3
}

/// Table 2 with a sign for each of its five faults.
fn table_2(signs: [f64; 5], time: f64) -> Vector3<f64> {
    let within = |from: f64, until: f64| (from..until).contains(&time);
    let mut fault = Vector3::zeros();
    if within(52.0, 62.0) {
        fault.x = 0.4 * signs[0];
    }
    if within(40.0, 43.0) {
        fault.y = 0.3 * signs[1];
    }
    if within(75.0, 100.0) {
        fault.y = 0.3 * (0.35 * time).sin() * (-0.03 * time).exp() * signs[2];
    }
    if within(100.0, 104.0) {
        fault.y = 0.5 * (0.36 * time).cos() * (-0.02 * time).exp() * signs[3];
    }
    if within(66.0, 86.0) {
        fault.z = 0.4 * (0.03 * time).sin() * signs[4];
    }
    fault
}

fn paper_start() -> Body {
    let start = Quaternion::from_scalar_first([0.9336, 0.1619, -0.0087, 0.3196]);
    Body::at_rest(start.normalised().unwrap())
}

/// What is watched along a run.
struct Run {
    /// Vector part of the error at each component's appointed time.
    at_appointed_time: [f64; 3],
    /// Largest share of the envelope used.
    envelope_ratio: f64,
    largest_command: f64,
    last: Body,
}

/// The paper's 150 s: a plant 1 % heavier and actuators 0.1 % stronger than nominal, one command every
/// 0.01 s.
fn fly(parameters: Parameters<3>, signs: [f64; 5]) -> Run {
    let nominal = parameters.inertia;
    let plant = Plant::new(nominal * 1.01);
    let mut controller = Controller::new(parameters).unwrap();
    let mut body = paper_start();
    let mut torque = Vector3::zeros();
    let mut run = Run {
        at_appointed_time: [f64::NAN; 3],
        envelope_ratio: 0.0,
        largest_command: 0.0,
        last: body,
    };
    for index in 0..15_000 {
        let time = f64::from(index) * SAMPLE_S;
        let external = |time: f64| disturbance(time) + table_2(signs, time);
        let acceleration = plant.acceleration(&body.rate, &(torque * 1.001 + external(time)));
        let gyroscopic = body.rate.cross(&(nominal * body.rate));
        let measurement = Measurement {
            fault_nm: Some(nominal * acceleration + gyroscopic - torque),
            ..Measurement::at_rest(body.measured())
        };
        let command = controller.step(time, &measurement);
        assert_eq!(command.status, Status::Nominal);
        torque = command.torque;
        let snapshot = controller.snapshot().unwrap();
        run.envelope_ratio = run.envelope_ratio.max(snapshot.envelope_ratio());
        run.largest_command = run.largest_command.max(torque.amax());
        for (axis, appointed) in APPOINTED_S.iter().enumerate() {
            if (time - appointed).abs() < 1e-9 {
                run.at_appointed_time[axis] = body.attitude.vector[axis];
            }
        }
        body = plant.advance(&body, time, SAMPLE_S, &(torque * 1.001), external);
    }
    run.last = body;
    run
}

#[test]
fn without_faults_each_axis_arrives_in_time_and_rests_where_the_dead_zone_says() {
    let parameters = parameters(FaultEstimation::External);
    let run = fly(parameters, [0.0; 5]);
    println!("q at the appointed times: {:?}", run.at_appointed_time);
    assert!(run.at_appointed_time.iter().all(|q| q.abs() < 3e-5));
    assert!(run.envelope_ratio < 1.0);
    // Axis 2 comes to rest inside of its dead zone, short of the edge.
    for axis in [0, 2] {
        let expected = parameters.gains.steady_error(axis, 1e-4).unwrap();
        let found = run.last.attitude.vector[axis].abs();
        let degrees = 2.0 * found.to_degrees();
        println!(
            "axis {}: {found:e}, {degrees:e} deg; dead zone: {expected:e}",
            axis + 1
        );
        assert!((found / expected - 1.0).abs() < 0.01);
        assert!((degrees / 9.474e-4 - 1.0).abs() < 0.01);
    }
    assert!(run.last.attitude.vector.y.abs() < parameters.gains.steady_error(1, 1e-4).unwrap());
}

#[test]
fn the_faults_of_table_2_in_all_sign_patterns_leave_the_error_inside_of_its_envelope() {
    let mut worst = 0.0_f64;
    for pattern in 0..32_u32 {
        let signs = std::array::from_fn(|index| f64::from(pattern >> index & 1) * 2.0 - 1.0);
        let run = fly(parameters(FaultEstimation::External), signs);
        assert!(
            run.envelope_ratio < 1.0,
            "pattern {pattern}: {}",
            run.envelope_ratio
        );
        assert!(run.largest_command <= LIMIT);
        worst = worst.max(run.envelope_ratio);
        // The paper's return to the target by 150 s is not reproduced.
        assert!(run.last.attitude.vector.z.abs() > 0.05);
    }
    println!("largest share of the envelope: {worst}");
}

#[test]
fn the_estimators_keep_the_envelope_when_fast_enough() {
    let kinds = [
        (
            FaultEstimation::LowPass {
                time_constant_s: 0.2,
            },
            true,
        ),
        (
            FaultEstimation::LowPass {
                time_constant_s: 0.5,
            },
            false,
        ),
        (
            FaultEstimation::ExtendedState {
                bandwidth_rad_s: 10.0,
            },
            true,
        ),
        (
            FaultEstimation::ExtendedState {
                bandwidth_rad_s: 2.0,
            },
            false,
        ),
    ];
    for (kind, kept) in kinds {
        let run = fly(parameters(kind), [1.0; 5]);
        println!("{kind:?}: {}", run.envelope_ratio);
        assert_eq!(run.envelope_ratio < 1.0, kept, "{kind:?}");
    }
}

#[test]
fn four_actuators_move_the_body_as_three_do() {
    let matrix = Matrix3x4::new(
        1.0, 1.0, -1.0, -1.0, //
        1.0, -1.0, 1.0, -1.0, //
        1.0, -1.0, -1.0, 1.0,
    ) / 3f64.sqrt();
    let three = parameters(FaultEstimation::External);
    let mut of_three = Controller::new(three).unwrap();
    let mut of_four = Controller::new(Parameters {
        inertia: three.inertia,
        actuator_matrix: matrix,
        torque_limit: Vector4::repeat(LIMIT),
        envelopes: three.envelopes,
        gains: three.gains,
        fault_estimation: three.fault_estimation,
    })
    .unwrap();
    let plant = Plant::new(nominal_inertia());
    let mut body = paper_start();
    let mut compared = 0;
    for index in 0..2000 {
        let time = f64::from(index) * SAMPLE_S;
        let torque = of_three
            .step(time, &Measurement::at_rest(body.measured()))
            .torque;
        let command = of_four
            .step(time, &Measurement::at_rest(body.measured()))
            .torque;
        if torque.amax() < LIMIT && command.amax() < LIMIT {
            assert!((matrix * command - torque).amax() < 1e-12);
            compared += 1;
        }
        body = plant.advance(&body, time, SAMPLE_S, &torque, |_| Vector3::zeros());
    }
    assert!(compared > 1000, "{compared}");
}

#[test]
fn a_moving_reference_is_followed_within_the_final_envelope() {
    let plant = Plant::new(nominal_inertia());
    let mut controller = Controller::new(parameters(FaultEstimation::External)).unwrap();
    let mut body = paper_start();
    let axis = Vector3::new(0.6, 0.0, 0.8);
    let (amplitude, frequency) = (0.05_f64, 0.1_f64);
    for index in 0..10_000 {
        let time = f64::from(index) * SAMPLE_S;
        let (sine, cosine) = (frequency * time).sin_cos();
        let desired = Quaternion::from_axis_angle(&axis, amplitude * sine).unwrap();
        let desired_rate = axis * (amplitude * frequency * cosine);
        let error = body.attitude.error_from(&desired);
        let attitude = AttitudeMeasurement {
            error,
            rate_rad_s: error.rate_error(&body.rate, &desired_rate),
        };
        let measurement = Measurement {
            desired_rate_rad_s: desired_rate,
            desired_acceleration_rad_s2: axis * (-amplitude * frequency * frequency * sine),
            ..Measurement::at_rest(attitude)
        };
        let torque = controller.step(time, &measurement).torque;
        let snapshot = controller.snapshot().unwrap();
        assert!(snapshot.envelope_ratio() < 1.0, "at {time} s");
        if time > 61.0 {
            assert!(
                snapshot.error.amax() < 1e-4,
                "{:?} at {time} s",
                snapshot.error
            );
        }
        body = plant.advance(&body, time, SAMPLE_S, &torque, |_| Vector3::zeros());
    }
}

proptest! {
    #[test]
    fn any_usable_sequence_of_samples_gives_finite_commands_within_the_limits(
        samples in prop::collection::vec(
            (prop::array::uniform4(-1.0..1.0_f64), prop::array::uniform3(-1e3..1e3_f64),
             prop::array::uniform3(-1e6..1e6_f64), 1e-6..1e3_f64),
            1..20),
    ) {
        let mut controller = Controller::new(parameters(FaultEstimation::ExtendedState {
            bandwidth_rad_s: 10.0,
        })).unwrap();
        let mut external = Controller::new(parameters(FaultEstimation::External)).unwrap();
        let mut time = 0.0;
        for (parts, rate, fault, interval) in samples {
            time += interval;
            let Ok(error) = Quaternion::from_scalar_first(parts).normalised() else { continue };
            let mut measurement = Measurement::at_rest(AttitudeMeasurement {
                error,
                rate_rad_s: rate.into(),
            });
            measurement.fault_nm = Some(fault.into());
            for controller in [&mut controller, &mut external] {
                let command = controller.step(time, &measurement);
                prop_assert!(command.torque.iter().all(|torque| torque.abs() <= LIMIT));
            }
        }
    }
}

#[test]
fn either_quaternion_of_an_attitude_gives_the_same_command() {
    let mut one = Controller::new(parameters(FaultEstimation::External)).unwrap();
    let mut other = one;
    let plant = Plant::new(nominal_inertia());
    let mut body = paper_start();
    for index in 0..500 {
        let time = f64::from(index) * SAMPLE_S;
        let mut measured = body.measured();
        let torque = one.step(time, &Measurement::at_rest(measured)).torque;
        if index % 3 == 1 {
            measured.error = -measured.error;
        }
        assert_eq!(
            other.step(time, &Measurement::at_rest(measured)).torque,
            torque
        );
        body = plant.advance(&body, time, SAMPLE_S, &torque, |_| Vector3::zeros());
    }
}

#[test]
fn an_unusable_sample_changes_nothing() {
    let mut controller = Controller::new(parameters(FaultEstimation::LowPass {
        time_constant_s: 0.2,
    }))
    .unwrap();
    let mut usable = Measurement::at_rest(paper_start().measured());
    controller.step(0.0, &usable);
    usable.attitude.rate_rad_s = Vector3::new(0.01, -0.02, 0.03);
    let command = controller.step(0.01, &usable);
    let before = controller;
    let mut cases: Vec<(f64, Measurement<3>, HoldReason)> = Vec::new();
    cases.push((f64::NAN, usable, HoldReason::NonFiniteTime));
    let not_increasing = HoldReason::TimeNotIncreasing {
        last_s: 0.01,
        time_s: 0.01,
    };
    cases.push((0.01, usable, not_increasing));
    for component in [1, 6, 8, 12, 14, 17] {
        let mut broken = usable;
        match component {
            1 => broken.attitude.error.vector.x = f64::INFINITY,
            6 => broken.attitude.rate_rad_s.z = f64::NAN,
            8 => broken.desired_rate_rad_s.y = f64::NAN,
            12 => broken.desired_acceleration_rad_s2.z = f64::NAN,
            14 => broken.fault_nm = Some(Vector3::new(0.0, f64::NAN, 0.0)),
            _ => broken.held_nm = Some(Vector3::new(0.0, f64::NAN, 0.0)),
        }
        cases.push((0.02, broken, HoldReason::NonFiniteMeasurement { component }));
    }
    let mut long = usable;
    long.attitude.error = Quaternion::new(2.0, Vector3::zeros());
    cases.push((0.02, long, HoldReason::NotUnitQuaternion { norm: 2.0 }));
    let mut fast = usable;
    fast.attitude.rate_rad_s = Vector3::repeat(1e200);
    cases.push((0.02, fast, HoldReason::Overflow));
    for (time, measurement, reason) in cases {
        let held = controller.step(time, &measurement);
        assert_eq!(held.status, Status::Held(reason));
        assert_eq!(held.torque, command.torque);
        assert!(!held.sent);
        assert_eq!(controller, before);
    }
    controller.reset();
    assert_eq!(controller.torque(), Vector3::zeros());
    assert_eq!(controller.snapshot(), None);
}

#[test]
fn the_printed_exponent_is_refused() {
    let mut printed = parameters(FaultEstimation::External);
    printed.gains.surface_exponent = 3.0 / 5.0;
    let refused = Controller::new(printed).unwrap_err();
    let field = Field::scalar("surface_exponent");
    assert!(matches!(refused, ParameterError::OutOfRange { field: found, .. } if found == field));
    let mut crooked = parameters(FaultEstimation::External);
    crooked.inertia[(0, 1)] = 5.0;
    let refused = Controller::new(crooked).unwrap_err();
    assert!(matches!(refused, ParameterError::NotSymmetric { .. }));
}
