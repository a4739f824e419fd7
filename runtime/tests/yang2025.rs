//! The controller of Yang et al. 2025 on its own plant.

mod common;

use common::{Body, Plant};
use runtime::attitude::Quaternion;
use runtime::nalgebra::{Matrix3, SMatrix, Vector3};
use runtime::yang2025::envelope::{Adhesion, EnvelopeParameters, Resilience};
use runtime::yang2025::fault::FaultEstimation;
use runtime::yang2025::law::Gains;
use runtime::yang2025::performance::Performance;
use runtime::yang2025::{Controller, Measurement, Parameters};

const APPOINTED_S: [f64; 3] = [40.0, 30.0, 60.0];
const LIMIT: f64 = 0.2;
const SAMPLE_S: f64 = 0.01;

fn nominal_inertia() -> Matrix3<f64> {
    Matrix3::new(89.0, -0.2, 1.5, -0.2, 61.0, -0.7, 1.5, -0.7, 57.0)
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

#[test]
fn explore() {
    for (name, signs) in [("none", [0.0; 5]), ("plus", [1.0; 5]), ("minus", [-1.0; 5])] {
        let plant = Plant::new(nominal_inertia() * 1.01);
        let mut controller = Controller::new(parameters(FaultEstimation::External)).unwrap();
        let start = Quaternion::from_scalar_first([0.9336, 0.1619, -0.0087, 0.3196])
            .normalised()
            .unwrap();
        let mut body = Body::at_rest(start);
        let mut torque = Vector3::zeros();
        let mut peak = Vector3::<f64>::zeros();
        let mut worst = 0.0_f64;
        let mut first_out = None;
        for index in 0..=15000 {
            let time = index as f64 * SAMPLE_S;
            let external = |t: f64| disturbance(t) + table_2(signs, t);
            let acceleration = plant.acceleration(&body.rate, &(torque * 1.001 + external(time)));
            let nominal = nominal_inertia();
            let fault = nominal * acceleration + body.rate.cross(&(nominal * body.rate)) - torque;
            let mut measurement = Measurement::at_rest(body.measured());
            measurement.fault_nm = Some(fault);
            torque = controller.step(time, &measurement).torque;
            let snapshot = controller.snapshot().unwrap();
            let ratio = snapshot.envelope_ratio();
            worst = worst.max(ratio);
            if ratio >= 1.0 && first_out.is_none() {
                first_out = Some((time, snapshot.inside));
            }
            for (axis, &at) in APPOINTED_S.iter().enumerate() {
                if index == (at / SAMPLE_S) as usize {
                    println!(
                        "{name} q{} ({at}) = {:e}",
                        axis + 1,
                        body.attitude.vector[axis]
                    );
                }
            }
            if time > 40.0 {
                peak = peak.zip_map(&body.attitude.vector, |p, q| p.max(q.abs()));
            }
            if index % 1000 == 0 {
                println!(
                    "{time} q {:?} s {:?} u {:?}",
                    body.attitude.vector.as_slice(),
                    snapshot.sliding.as_slice(),
                    torque.as_slice()
                );
            }
            body = plant.advance(&body, time, SAMPLE_S, &(torque * 1.001), external);
        }
        println!(
            "{name} peak {:?} worst {worst} first_out {first_out:?} end angle {}",
            peak.as_slice(),
            body.angle_deg()
        );
    }
}
