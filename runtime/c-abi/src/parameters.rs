//! What C hands over, field by field as in the header, and what it gets back.

use runtime::attitude::{AttitudeMeasurement, Quaternion};
use runtime::command::Command;
use runtime::error::ParameterError;
use runtime::membership::RigidBodyBox;
use runtime::nalgebra::{Matrix3x6, Matrix6, Vector3};
use runtime::trigger::{Adaptation, ThresholdUpdate};
use runtime::{wu2018, xu2020};

/// A controller of a design with one gain, for a spacecraft.
pub type Xu2020Controller = xu2020::Controller<RigidBodyBox, 6, 3, 1>;

/// `steadfast_command`.
#[repr(C)]
pub struct CommandOfC {
    torque_nm: [f64; 3],
    sent: u8,
    status: i32,
}

/// `steadfast_xu2020_parameters`.
#[repr(C)]
pub struct Xu2020Parameters {
    gain: [[f64; 6]; 3],
    trigger_weight: [[f64; 6]; 6],
    trigger_floor: f64,
    threshold: f64,
    least_threshold: f64,
    mu: [f64; 3],
    torque_limit_nm: [f64; 3],
    rate_bound_rad_s: [f64; 3],
    least_scalar_part: f64,
    longest_interval_s: f64,
}

/// `steadfast_wu2018_parameters`.
#[repr(C)]
pub struct Wu2018Parameters {
    error_gain_nm_s_rad: f64,
    attitude_weight_rad_s: f64,
    relative: f64,
    absolute_rad_s: f64,
    torque_limit_nm: [f64; 3],
    hysteresis: f64,
}

impl Xu2020Parameters {
    /// The controller before its first sample.
    pub fn controller(&self) -> Result<Xu2020Controller, ParameterError> {
        let [amplitude, slope, dead_band] = self.mu;
        let update = match self.mu == [0.0; 3] {
            true => ThresholdUpdate::Fixed {
                threshold: self.threshold,
            },
            false => ThresholdUpdate::Clamped {
                adaptation: Adaptation {
                    amplitude,
                    slope,
                    dead_band,
                },
                minimum: self.least_threshold,
                maximum: self.threshold,
            },
        };
        // Rows in C, columns there.
        let gain = Matrix3x6::from_row_iterator(self.gain.iter().flatten().copied());
        let weight = Matrix6::from_row_iterator(self.trigger_weight.iter().flatten().copied());
        xu2020::Controller::new(xu2020::Parameters {
            gains: [gain],
            membership: RigidBodyBox::new(self.rate_bound_rad_s, self.least_scalar_part)?,
            trigger_weight: weight,
            threshold_update: update,
            trigger_floor: self.trigger_floor,
            torque_limit: self.torque_limit_nm.into(),
            longest_interval_s: Some(self.longest_interval_s),
        })
    }
}

impl Wu2018Parameters {
    /// The controller before its first sample.
    pub fn controller(&self) -> Result<wu2018::Controller, ParameterError> {
        wu2018::Controller::new(wu2018::Parameters {
            gains: wu2018::Gains {
                error_gain: self.error_gain_nm_s_rad,
                attitude_weight: self.attitude_weight_rad_s,
            },
            trigger: wu2018::TriggerRule::Relative {
                relative: self.relative,
                absolute_rad_s: self.absolute_rad_s,
            },
            torque_limit: self.torque_limit_nm.into(),
            unwinding: match self.hysteresis < 0.0 {
                true => wu2018::Unwinding::AsPublished,
                false => wu2018::Unwinding::ShortestRotation {
                    hysteresis: self.hysteresis,
                },
            },
        })
    }
}

/// A measurement, the quaternion with its scalar part first.
pub fn measurement(error: &[f64; 4], rate_rad_s: &[f64; 3]) -> AttitudeMeasurement {
    AttitudeMeasurement {
        error: Quaternion::from_scalar_first(*error),
        rate_rad_s: Vector3::from(*rate_rad_s),
    }
}

impl CommandOfC {
    /// A command as C reads it.
    pub fn of(command: &Command<3>) -> Self {
        CommandOfC {
            torque_nm: command.torque.into(),
            sent: u8::from(command.sent),
            status: i32::from(command.status.number()),
        }
    }

    /// Its status.
    pub fn status(&self) -> i32 {
        self.status
    }
}

/// `STEADFAST_NULL_POINTER`.
pub const NULL_POINTER: i32 = 8;
/// `STEADFAST_BAD_PARAMETERS`.
pub const BAD_PARAMETERS: i32 = 9;
