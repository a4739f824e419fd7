//! The controller: law, trigger and what is remembered between samples.

use nalgebra::Vector3;

use super::{ControlLaw, Evaluation, Switching, TriggerRule};
use crate::attitude::{AttitudeMeasurement, SignHysteresis};
use crate::command::{Command, HoldReason, SampleClock, Status, BYTES_PER_NUMBER};
use crate::error::ParameterError;
use crate::saturation::Saturation;

/// Bytes of one message to the actuators: the torque from now on, three numbers, zero to turn off.
pub const MESSAGE_BYTES: usize = 3 * BYTES_PER_NUMBER;

/// Parameters of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Law (12).
    pub law: ControlLaw,
    /// Event trigger.
    pub trigger: TriggerRule,
    /// Largest torque of each axis, N m, positive.
    pub torque_limit: Vector3<f64>,
    /// Half width of the hysteresis of the sign of the error's scalar part, dimensionless, in `[0, 1)`.
    /// Zero as published.
    pub sign_hysteresis: f64,
}

/// How often the actuators were switched since the start of the manoeuvre. Counts stop at the largest
/// number that fits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SwitchCount {
    /// Times turned on.
    pub on: u32,
    /// Times turned off.
    pub off: u32,
}

/// Law (12) with triggers (6) and (8). The manoeuvre starts at the first usable sample, with the
/// actuators off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    law: ControlLaw,
    rule: TriggerRule,
    saturation: Saturation<3>,
    sign: SignHysteresis,
    clock: SampleClock,
    start_s: Option<f64>,
    on_since_s: Option<f64>,
    torque: Vector3<f64>,
    count: SwitchCount,
}

impl Controller {
    /// Controller at rest, before its first sample.
    ///
    /// # Errors
    /// The first parameter that is not finite or out of its range.
    pub fn new(parameters: Parameters) -> Result<Self, ParameterError> {
        parameters.law.check()?;
        if let TriggerRule::Composite(trigger) = &parameters.trigger {
            trigger.check()?;
        }
        Ok(Self {
            law: parameters.law,
            rule: parameters.trigger,
            saturation: Saturation::new(parameters.torque_limit)?,
            sign: SignHysteresis::new(parameters.sign_hysteresis)?,
            clock: SampleClock::default(),
            start_s: None,
            on_since_s: None,
            torque: Vector3::zeros(),
            count: SwitchCount::default(),
        })
    }

    /// Takes the measurement at `time_s` seconds. [`Command::sent`] says whether the actuators are
    /// switched at this sample; in between the torque is constant.
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
        let mut sign = self.sign;
        let now = self.evaluate_with(&mut sign, time_s, measurement)?;
        let elapsed_s = self.elapsed_s(time_s);
        self.sign = sign;
        self.clock.accept(time_s);
        self.start_s.get_or_insert(time_s);
        let wanted = self.saturation.saturate(&now.torque);
        let switching = self.switching(elapsed_s, &wanted, &now);
        if switching.off {
            self.torque = Vector3::zeros();
            self.on_since_s = None;
            self.count.off = self.count.off.saturating_add(1);
        }
        if switching.on {
            self.torque = wanted;
            self.on_since_s = Some(elapsed_s);
            self.count.on = self.count.on.saturating_add(1);
        }
        Ok((switching.off || switching.on, Status::Nominal))
    }

    fn switching(&self, elapsed_s: f64, wanted: &Vector3<f64>, now: &Evaluation) -> Switching {
        match &self.rule {
            TriggerRule::EverySample => Switching {
                off: false,
                on: true,
            },
            TriggerRule::Composite(trigger) => {
                let held_error = wanted - self.torque;
                trigger.decide(
                    elapsed_s,
                    self.on_since_s,
                    held_error.dot(&held_error),
                    now.rate_error_energy,
                )
            }
        }
    }

    /// What the law computes from a measurement at `time_s`; the controller stays as it is.
    ///
    /// # Errors
    /// The reason why the measurement cannot be used.
    pub fn evaluate(
        &self,
        time_s: f64,
        measurement: &AttitudeMeasurement,
    ) -> Result<Evaluation, HoldReason> {
        if !time_s.is_finite() {
            return Err(HoldReason::NonFiniteTime);
        }
        let mut sign = self.sign;
        self.evaluate_with(&mut sign, time_s, measurement)
    }

    fn evaluate_with(
        &self,
        sign: &mut SignHysteresis,
        time_s: f64,
        measurement: &AttitudeMeasurement,
    ) -> Result<Evaluation, HoldReason> {
        measurement.check()?;
        let unit = measurement.error.normalised();
        let mut error = unit.map_err(|error| HoldReason::NotUnitQuaternion { norm: error.norm })?;
        if sign.update(error.scalar) < 0.0 {
            error = -error;
        }
        let elapsed_s = self.elapsed_s(time_s);
        let now = self
            .law
            .evaluate(elapsed_s, &error, &measurement.rate_rad_s);
        if now.is_finite() {
            Ok(now)
        } else {
            Err(HoldReason::Overflow)
        }
    }

    /// Time since the start of the manoeuvre at a time, s; zero before the first sample.
    pub fn elapsed_s(&self, time_s: f64) -> f64 {
        self.start_s.map_or(0.0, |start_s| time_s - start_s)
    }

    /// The law.
    pub fn law(&self) -> &ControlLaw {
        &self.law
    }

    /// The trigger.
    pub fn rule(&self) -> &TriggerRule {
        &self.rule
    }

    /// Whether the actuators are on.
    pub fn is_on(&self) -> bool {
        self.on_since_s.is_some()
    }

    /// How often the actuators were switched.
    pub fn switch_count(&self) -> SwitchCount {
        self.count
    }

    /// The torque in force, N m.
    pub fn torque(&self) -> &Vector3<f64> {
        &self.torque
    }

    /// Back to the state before the first sample, with the actuators off: a new manoeuvre, or the way
    /// on after a time stamp that was finite but wrong and far in the future.
    pub fn reset(&mut self) {
        self.sign.reset();
        self.clock = SampleClock::default();
        self.start_s = None;
        self.on_since_s = None;
        self.torque = Vector3::zeros();
        self.count = SwitchCount::default();
    }
}
