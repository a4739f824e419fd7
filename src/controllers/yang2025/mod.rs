//! The controller of Yang et al. 2025.

pub mod file;

use nalgebra::{Matrix3, Vector3};
use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;
use runtime::error::ParameterError;
use runtime::yang2025::{self, Measurement};

use super::law::{AttitudeLaw, Surroundings};
use crate::plants::RigidBody;
use crate::sim::controller::{Controller, Truth, Use};
use crate::sim::plant::Plant;
use crate::sim::reference::Reference;
use crate::sim::rigid_body_state::{body_rate, RigidBodyState};

pub use file::*;

/// What the controller shows of itself.
const SIGNALS: [&str; 18] = [
    "envelope_lower_1",
    "envelope_lower_2",
    "envelope_lower_3",
    "envelope_upper_1",
    "envelope_upper_2",
    "envelope_upper_3",
    "envelope_error_1",
    "envelope_error_2",
    "envelope_error_3",
    "fault_estimate_1_nm",
    "fault_estimate_2_nm",
    "fault_estimate_3_nm",
    "sliding_1_rad_s",
    "sliding_2_rad_s",
    "sliding_3_rad_s",
    "correction_1",
    "correction_2",
    "correction_3",
];

/// The flight code with what it needs besides attitude measurements.
#[derive(Clone, Copy, Debug)]
pub struct YangAttitude {
    controller: yang2025::Controller<3>,
    /// Nominal inertia, kg m^2.
    inertia: Matrix3<f64>,
    reference: Reference,
    /// Whether an encoder sits behind the controller, so that the command itself is not a message.
    linked: bool,
    /// The true body, when the controller is given its fault.
    oracle: Option<RigidBody>,
    fault: Option<Vector3<f64>>,
    held: Option<Vector3<f64>>,
}

impl YangAttitude {
    /// The controller before its first sample. With the true body as `oracle` it is given the lumped
    /// fault; otherwise it has to estimate it. `linked`: whether an encoder sends its commands on.
    ///
    /// # Errors
    /// A parameter that the flight code refuses.
    pub fn new(
        parameters: yang2025::Parameters<3>,
        reference: Reference,
        oracle: Option<RigidBody>,
        linked: bool,
    ) -> Result<Self, ParameterError> {
        Ok(Self {
            controller: yang2025::Controller::new(parameters)?,
            inertia: parameters.inertia,
            reference,
            linked,
            oracle,
            fault: None,
            held: None,
        })
    }

    /// (6): the torque that the nominal model does not explain.
    fn lumped_fault(&self, body: &RigidBody, truth: &Truth<3>) -> Vector3<f64> {
        let state = RigidBodyState::from_column_slice(truth.state);
        let disturbance = Vector3::from_column_slice(truth.disturbance);
        let slope = body.derivative(truth.time_s, &state, &truth.acting, &disturbance);
        let (rate, acceleration) = (body_rate(&state), body_rate(&slope));
        let nominal = self.controller.allocation().torque(&truth.held);
        self.inertia * acceleration + rate.cross(&(self.inertia * rate)) - nominal
    }
}

impl AttitudeLaw for YangChoice {
    fn name(&self) -> String {
        "Yang, Yang, Ji, Wang and Ma 2025, law (20)".to_string()
    }

    fn torque_limit(&self) -> Vector3<f64> {
        self.parameters.torque_limit
    }

    fn build<U: Use<AttitudeMeasurement, 3>>(
        &self,
        around: &Surroundings,
        then: U,
    ) -> Result<U::Output, ParameterError> {
        let oracle = self.told_fault.then_some(around.system.body);
        let reference = around.system.reference;
        let controller = YangAttitude::new(self.parameters, reference, oracle, around.linked)?;
        Ok(then.with(controller))
    }

    fn sends_every_sample(&self) -> bool {
        true
    }

    fn sends_by_link(&self) -> bool {
        true
    }
}

impl Controller<AttitudeMeasurement, 3> for YangAttitude {
    fn step(&mut self, time_s: f64, measurement: &AttitudeMeasurement) -> Command<3> {
        let (_, desired_rate_rad_s) = self.reference.at(time_s);
        let measurement = Measurement {
            attitude: *measurement,
            desired_rate_rad_s,
            desired_acceleration_rad_s2: self.reference.acceleration(time_s),
            fault_nm: self.fault,
            held_nm: self.held,
        };
        let mut command = self.controller.step(time_s, &measurement);
        if self.linked {
            (command.sent, command.bits) = (false, 0);
        }
        command
    }

    fn observe_truth(&mut self, truth: &Truth<3>) {
        self.held = Some(truth.held);
        self.fault = self.oracle.map(|body| self.lumped_fault(&body, truth));
    }

    fn would_send(&self, time_s: f64, measurement: &AttitudeMeasurement) -> bool {
        let mut trial = *self;
        trial.step(time_s, measurement).sent
    }

    fn signal_names(&self) -> &'static [&'static str] {
        &SIGNALS
    }

    fn signals(&self, time_s: f64, truth: &AttitudeMeasurement, values: &mut [f64]) {
        let (error, bounds) = self.controller.envelope_at(time_s, &truth.error);
        let snapshot = self.controller.snapshot().copied().unwrap_or_default();
        let lower = bounds.map(|bound| bound.lower.value);
        let upper = bounds.map(|bound| bound.upper.value);
        let groups = [
            lower.into(),
            upper.into(),
            error,
            snapshot.fault,
            snapshot.sliding,
            snapshot.correction,
        ];
        let numbers = groups.iter().flat_map(|group: &Vector3<f64>| group.iter());
        for (value, number) in values.iter_mut().zip(numbers) {
            *value = *number;
        }
    }

    fn funnel_ratio(&self, time_s: f64, truth: &AttitudeMeasurement) -> Option<f64> {
        let (error, bounds) = self.controller.envelope_at(time_s, &truth.error);
        let positions = bounds.iter().zip(error.iter());
        Some(positions.fold(0.0, |largest, (bound, &error)| {
            f64::max(largest, bound.position(error).abs())
        }))
    }
}
