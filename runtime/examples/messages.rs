//! One axis of a spacecraft held by event-triggered feedback: how many samples are sent.
//!
//!     cargo run --release --example messages
//!
//! The plant is a double integrator (angle and rate, moment of inertia 10 kg m^2), stepped exactly between samples.

use std::error::Error;

use runtime::membership::ConstantGain;
use runtime::nalgebra::{Matrix1x2, Matrix2, Vector1, Vector2};
use runtime::trigger::ThresholdUpdate;
use runtime::xu2020::{Controller, Parameters};

const INERTIA_KG_M2: f64 = 10.0;
const STEP_S: f64 = 0.1;
const SAMPLES: u32 = 600;

fn main() -> Result<(), Box<dyn Error>> {
    let mut controller = Controller::new(Parameters {
        gains: [Matrix1x2::new(-10.0, -15.0)],
        membership: ConstantGain,
        trigger_weight: Matrix2::identity(),
        threshold_update: ThresholdUpdate::Fixed { threshold: 0.05 },
        torque_limit: Vector1::new(2.0),
        trigger_floor: 0.0,
        longest_interval_s: Some(STEP_S),
    })?;
    // Angle (rad) and rate (rad/s).
    let mut state = Vector2::new(0.2, 0.0);
    let mut sent = 0;
    for sample in 0..SAMPLES {
        let command = controller.step(f64::from(sample) * STEP_S, &state);
        sent += u32::from(command.sent);
        let acceleration = command.torque[0] / INERTIA_KG_M2;
        state = Vector2::new(
            state.x + state.y * STEP_S + 0.5 * acceleration * STEP_S * STEP_S,
            state.y + acceleration * STEP_S,
        );
    }
    println!(
        "angle after {} s: {:.2e} rad",
        f64::from(SAMPLES) * STEP_S,
        state.x
    );
    println!("samples sent: {sent} of {SAMPLES}");
    match state.norm() < 0.01 && sent < SAMPLES {
        true => Ok(()),
        false => Err("it did not settle, or every sample was sent".into()),
    }
}
