//! Estimates of the lumped fault f in (6): the torque that acts beyond what the nominal model explains.
//!
//! `f = J0 omega' + omega x J0 omega - D0 u`, N m about the body axes. It holds actuator faults,
//! disturbances and the errors of the nominal inertia and actuator matrix.

use nalgebra::{Matrix3, Vector3};

use crate::error::{AllowedRange, ParameterError};

/// Where the estimate comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultEstimation {
    /// From the measurement: an external diagnosis, or in a simulation the truth. Samples without a
    /// fault leave the last one in force; before the first it is zero.
    External,
    /// First-order low-pass of the torque that explains the change of the rate.
    LowPass {
        /// Time constant, s, positive.
        time_constant_s: f64,
    },
    /// Extended state observer: estimates the angular momentum and the fault together, with both
    /// poles at the bandwidth.
    ExtendedState {
        /// Bandwidth, rad/s, positive.
        bandwidth_rad_s: f64,
    },
}

/// What the nominal model says about the time since the last sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleInterval {
    /// Length, s.
    pub seconds: f64,
    /// D0 u over the interval, N m.
    pub torque: Vector3<f64>,
}

/// An estimator with its state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultEstimator {
    kind: FaultEstimation,
    inertia: Matrix3<f64>,
    fault: Vector3<f64>,
    /// Rate of the last sample, rad/s.
    rate: Option<Vector3<f64>>,
    /// Estimated angular momentum J0 omega, N m s.
    momentum: Vector3<f64>,
}

impl FaultEstimator {
    /// Estimator for the nominal inertia (kg m^2), before its first sample.
    ///
    /// # Errors
    /// A time constant or bandwidth that is not finite and positive.
    pub fn new(kind: FaultEstimation, inertia: Matrix3<f64>) -> Result<Self, ParameterError> {
        let positive = |name, value| AllowedRange::POSITIVE.check_scalar(name, value);
        match kind {
            FaultEstimation::External => {}
            FaultEstimation::LowPass { time_constant_s } => {
                positive("time_constant_s", time_constant_s)?;
            }
            FaultEstimation::ExtendedState { bandwidth_rad_s } => {
                positive("bandwidth_rad_s", bandwidth_rad_s)?;
            }
        }
        Ok(Self {
            kind,
            inertia,
            fault: Vector3::zeros(),
            rate: None,
            momentum: Vector3::zeros(),
        })
    }

    /// The estimate, N m about the body axes.
    pub fn fault(&self) -> &Vector3<f64> {
        &self.fault
    }

    /// Takes the body rate (rad/s) and, where there is one, the fault (N m) that came with the sample.
    /// `interval` is `None` at the first sample.
    pub fn update(
        &mut self,
        rate: &Vector3<f64>,
        given: Option<&Vector3<f64>>,
        interval: Option<&SampleInterval>,
    ) {
        let momentum = self.inertia * rate;
        match (self.kind, interval, &self.rate) {
            (FaultEstimation::External, ..) => {
                self.fault = given.copied().unwrap_or(self.fault);
            }
            (FaultEstimation::LowPass { time_constant_s }, Some(interval), Some(last)) => {
                // The mean torque over the interval; exact where it is constant.
                let before = self.inertia * last;
                let middle = (rate + last) * 0.5;
                let change = (momentum - before) / interval.seconds;
                let torque = change + middle.cross(&(self.inertia * middle)) - interval.torque;
                let share = -libm::expm1(-interval.seconds / time_constant_s);
                self.fault += (torque - self.fault) * share;
            }
            (FaultEstimation::ExtendedState { bandwidth_rad_s }, Some(interval), Some(last)) => {
                let gyroscopic = last.cross(&(self.inertia * last));
                let acting = interval.torque - gyroscopic + self.fault;
                let predicted = self.momentum + acting * interval.seconds;
                let innovation = momentum - predicted;
                // Both poles of the sampled error at exp(-bandwidth interval): stable for any interval.
                let pole = libm::exp(-bandwidth_rad_s * interval.seconds);
                self.momentum = predicted + innovation * (1.0 - pole * pole);
                let gain = (1.0 - pole) * (1.0 - pole) / interval.seconds;
                self.fault += innovation * gain;
            }
            _ => self.momentum = momentum,
        }
        self.rate = Some(*rate);
    }
}
