//! The controller of Yang et al. 2025, with three and with four actuators.

use core::hint::black_box;

use runtime::attitude::AttitudeMeasurement;
use runtime::error::ParameterError;
use runtime::nalgebra::{Matrix3, Matrix3x4, SMatrix, SVector, Vector3};
use runtime::yang2025::envelope::{Adhesion, EnvelopeParameters, Resilience};
use runtime::yang2025::fault::FaultEstimation;
use runtime::yang2025::law::Gains;
use runtime::yang2025::performance::Performance;
use runtime::yang2025::{Controller, Measurement, Parameters};

/// Largest torque, N m, over a few samples.
pub fn largest_torque() -> Result<f64, ParameterError> {
    let four = Matrix3x4::new(
        1.0, 1.0, -1.0, -1.0, //
        1.0, -1.0, 1.0, -1.0, //
        1.0, -1.0, -1.0, 1.0,
    );
    let estimations = [
        FaultEstimation::External,
        FaultEstimation::LowPass {
            time_constant_s: 0.2,
        },
        FaultEstimation::ExtendedState {
            bandwidth_rad_s: 10.0,
        },
    ];
    let mut largest = 0.0_f64;
    for estimation in estimations {
        largest = largest.max(with_actuators(Matrix3::identity(), estimation)?);
        largest = largest.max(with_actuators(four, estimation)?);
    }
    Ok(largest)
}

fn with_actuators<const M: usize>(
    matrix: SMatrix<f64, 3, M>,
    estimation: FaultEstimation,
) -> Result<f64, ParameterError> {
    let appointed = Performance::AppointedTime {
        initial_level: 0.1,
        final_level: 1e-4,
        appointed_time_s: 40.0,
        rate_per_s: 0.1,
        offset: 0.9,
    };
    let exponential = Performance::Exponential {
        initial_level: 0.1,
        final_level: 1e-4,
        rate_per_s: 0.1,
    };
    let adhesion = Adhesion {
        width: 3.0,
        exponent: 0.4,
        span_s: 40.0,
    };
    let resilience = Resilience {
        fault_gain: 1.0,
        rate_gain: 0.5,
        decay_per_s: 0.17,
        decay_size: 4.0,
        away_width: 0.1,
        toward_width: 1.0,
    };
    let envelope = |performance| EnvelopeParameters {
        performance: black_box(performance),
        shape: 1.0,
        one_sided: black_box(true),
        adhesion: black_box(Some(adhesion)),
        resilience: black_box(Some(resilience)),
    };
    let mut controller = Controller::new(Parameters {
        inertia: black_box(Matrix3::from_diagonal(&Vector3::new(89.0, 61.0, 57.0))),
        actuator_matrix: black_box(matrix),
        torque_limit: black_box(SVector::repeat(0.2)),
        envelopes: [appointed, exponential, appointed].map(envelope),
        gains: black_box(Gains {
            surface_gain: 0.02,
            surface_exponent: 5.0 / 3.0,
            linear_gain: 0.3,
            power_gain: 0.18,
            power_exponent: 0.6,
            dead_zone_rad_s: Vector3::repeat(1e-3),
        }),
        fault_estimation: black_box(estimation),
    })?;
    Ok(super::largest_torque(|time_s, attitude| {
        step(&mut controller, time_s, attitude)
    }))
}

fn step<const M: usize>(
    controller: &mut Controller<M>,
    time_s: f64,
    attitude: &AttitudeMeasurement,
) -> runtime::command::Command<3> {
    let measurement = Measurement {
        fault_nm: black_box(Some(Vector3::new(0.3, 0.0, -0.1))),
        held_nm: black_box(None),
        ..Measurement::at_rest(*attitude)
    };
    let command = controller.step(time_s, &measurement);
    let (_, bounds) = controller.envelope_at(time_s + 0.1, &attitude.error);
    let used = controller.snapshot().map_or(0.0, |at| at.envelope_ratio());
    if command.torque.norm() > 1e3 || bounds[0].position(used) > 1e9 {
        controller.reset();
    }
    runtime::command::Command {
        torque: controller.allocation().torque(&command.torque),
        sent: command.sent,
        bits: command.bits,
        status: command.status,
    }
}
