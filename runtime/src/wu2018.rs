//! Event-triggered attitude controller of Wu, Shen and Cao, "Event-triggered attitude control of
//! spacecraft", Advances in Space Research 61 (2018) 927-934.

use nalgebra::Vector3;

use crate::attitude::{AttitudeMeasurement, SignHysteresis};
use crate::command::{Command, HoldReason, SampleClock, Status, BYTES_PER_NUMBER};
use crate::error::{AllowedRange, ParameterError};
use crate::saturation::Saturation;

/// Bytes of one message: the filtered error and the torque, three numbers each (the paper's section
/// 5).
pub const MESSAGE_BYTES: usize = 6 * BYTES_PER_NUMBER;

/// Gains of the law (6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Gain k on the filtered error, N m s/rad, positive.
    pub error_gain: f64,
    /// Weight beta of the attitude in the filtered error, rad/s, positive.
    pub attitude_weight: f64,
}

impl Gains {
    /// Gains (39) for a settling time: with the natural frequency omega_n = 8 / settling time,
    /// k = 2 damping omega_n |J| and beta = omega_n / damping.
    ///
    /// `largest_inertia_kg_m2` is the largest principal moment of inertia |J|, kg m^2;
    /// `settling_time_s` is in s; the damping ratio xi has no unit.
    ///
    /// # Errors
    /// An argument that is not finite and positive.
    pub fn from_settling_time(
        largest_inertia_kg_m2: f64,
        damping_ratio: f64,
        settling_time_s: f64,
    ) -> Result<Self, ParameterError> {
        let positive = |name, value| AllowedRange::POSITIVE.check_scalar(name, value);
        positive("largest_inertia_kg_m2", largest_inertia_kg_m2)?;
        positive("damping_ratio", damping_ratio)?;
        positive("settling_time_s", settling_time_s)?;
        let natural_frequency = 8.0 / settling_time_s;
        Ok(Self {
            error_gain: 2.0 * damping_ratio * natural_frequency * largest_inertia_kg_m2,
            attitude_weight: natural_frequency / damping_ratio,
        })
    }
}

/// When the filtered error is sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TriggerRule {
    /// The paper's (8): send when the filtered error s has moved by at least `relative |s| +
    /// absolute_rad_s` from the one sent last.
    Relative {
        /// alpha, dimensionless, in (0, 1).
        relative: f64,
        /// gamma, rad/s, positive.
        absolute_rad_s: f64,
    },
    /// Send at every sample: the time-triggered loop the paper compares with.
    EverySample,
}

/// Which of the two quaternions of an attitude the law drives to the identity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Unwinding {
    /// As published: always to scalar part +1, so that a start with a negative scalar part turns the
    /// long way round.
    #[default]
    AsPublished,
    /// The shorter way: the vector part enters with the sign of the scalar part. The sign changes
    /// only when the scalar part has passed zero by more than `hysteresis` (in `[0, 1)`).
    ShortestRotation {
        /// Half width of the hysteresis, dimensionless.
        hysteresis: f64,
    },
}

/// Parameters of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Gains of the law.
    pub gains: Gains,
    /// Event trigger.
    pub trigger: TriggerRule,
    /// Largest torque of each axis, N m, positive.
    pub torque_limit: Vector3<f64>,
    /// Treatment of the quaternion's sign.
    pub unwinding: Unwinding,
}

/// Law (6) with trigger (8): u = sat(-k s), s = omega + beta q held between triggers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    gains: Gains,
    rule: TriggerRule,
    saturation: Saturation<3>,
    sign: Option<SignHysteresis>,
    clock: SampleClock,
    sent: Option<Vector3<f64>>,
    torque: Vector3<f64>,
}

impl Controller {
    /// Controller at rest, before its first sample.
    ///
    /// # Errors
    /// The first parameter that is not finite or out of its range.
    pub fn new(parameters: Parameters) -> Result<Self, ParameterError> {
        let positive = |name, value| AllowedRange::POSITIVE.check_scalar(name, value);
        positive("error_gain", parameters.gains.error_gain)?;
        positive("attitude_weight", parameters.gains.attitude_weight)?;
        if let TriggerRule::Relative {
            relative,
            absolute_rad_s,
        } = parameters.trigger
        {
            AllowedRange::open(0.0, 1.0).check_scalar("relative", relative)?;
            positive("absolute_rad_s", absolute_rad_s)?;
        }
        let sign = match parameters.unwinding {
            Unwinding::AsPublished => None,
            Unwinding::ShortestRotation { hysteresis } => Some(SignHysteresis::new(hysteresis)?),
        };
        Ok(Self {
            gains: parameters.gains,
            rule: parameters.trigger,
            saturation: Saturation::new(parameters.torque_limit)?,
            sign,
            clock: SampleClock::default(),
            sent: None,
            torque: Vector3::zeros(),
        })
    }

    /// Takes the measurement at `time_s` seconds. The first usable one is always sent; later ones
    /// when the trigger fires. In between the torque is constant.
    pub fn step(&mut self, time_s: f64, measurement: &AttitudeMeasurement) -> Command<3> {
        let outcome = self.advance(time_s, measurement);
        Command::of_step(self.torque, 8 * MESSAGE_BYTES, outcome)
    }

    fn advance(
        &mut self,
        time_s: f64,
        measurement: &AttitudeMeasurement,
    ) -> Result<(bool, Status), HoldReason> {
        self.clock.interval(time_s)?;
        measurement.check()?;
        let mut sign = self.sign;
        let error = self.filtered_error(measurement, &mut sign);
        if !error.iter().all(|value| value.is_finite()) {
            return Err(HoldReason::Overflow);
        }
        self.sign = sign;
        self.clock.accept(time_s);
        let sent = self.fires(&error);
        if sent {
            self.torque = self.saturation.saturate(&(error * -self.gains.error_gain));
            self.sent = Some(error);
        }
        Ok((sent, Status::Nominal))
    }

    /// The filtered error s of (5), rad/s.
    fn filtered_error(
        &self,
        measurement: &AttitudeMeasurement,
        sign: &mut Option<SignHysteresis>,
    ) -> Vector3<f64> {
        let side = sign
            .as_mut()
            .map_or(1.0, |sign| sign.update(measurement.error.scalar));
        measurement.rate_rad_s + measurement.error.vector * (side * self.gains.attitude_weight)
    }

    fn fires(&self, error: &Vector3<f64>) -> bool {
        let Some(sent) = &self.sent else {
            return true;
        };
        match self.rule {
            TriggerRule::EverySample => true,
            TriggerRule::Relative {
                relative,
                absolute_rad_s,
            } => length(&(sent - error)) >= relative * length(error) + absolute_rad_s,
        }
    }

    /// The filtered error sent last, rad/s; `None` before the first.
    pub fn sent(&self) -> Option<&Vector3<f64>> {
        self.sent.as_ref()
    }

    /// The torque in force, N m.
    pub fn torque(&self) -> &Vector3<f64> {
        &self.torque
    }

    /// Back to the state before the first sample, with zero torque. The way on after a time stamp
    /// that was finite but wrong and far in the future.
    pub fn reset(&mut self) {
        if let Some(sign) = &mut self.sign {
            sign.reset();
        }
        self.clock = SampleClock::default();
        self.sent = None;
        self.torque = Vector3::zeros();
    }
}

fn length(vector: &Vector3<f64>) -> f64 {
    libm::sqrt(vector.dot(vector))
}
