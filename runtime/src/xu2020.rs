//! Event-triggered fuzzy controller of Xu and Huang, "Robust Fuzzy Attitude Stabilization of
//! Networked Spacecraft under Actuator Saturation and Persistent Disturbance" (2020).

use nalgebra::{SMatrix, SVector};

use crate::command::{Command, Departure, HoldReason, SampleClock, Status, BYTES_PER_NUMBER};
use crate::error::{AllowedRange, ParameterError};
use crate::membership::Membership;
use crate::saturation::Saturation;
use crate::trigger::{AperiodicTrigger, ThresholdUpdate};

/// Parameters for `N` states, `M` inputs and `R` fuzzy rules.
///
/// For the rigid spacecraft N = 6 (rate in rad/s, then the vector part of the error quaternion) and
/// M = 3 (torque in N m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters<S, const N: usize, const M: usize, const R: usize> {
    /// Gain F_j (M x N, input unit per state unit) of each rule; a constant gain has one.
    pub gains: [SMatrix<f64, M, N>; R],
    /// Membership functions that schedule the gains.
    pub membership: S,
    /// Trigger weight Upsilon (N x N), symmetric positive definite.
    pub trigger_weight: SMatrix<f64, N, N>,
    /// Evolution of the trigger's threshold.
    pub threshold_update: ThresholdUpdate,
    /// Absolute part eps_a of the trigger, in the unit of e' Upsilon e, not negative; zero for none.
    pub trigger_floor: f64,
    /// Largest torque of each axis, N m (or the input's unit), positive.
    pub torque_limit: SVector<f64, M>,
    /// Longest sampling interval of the design, s, positive (the upper bound in (9)): a longer one
    /// is reported as [`Departure::LateSample`]. `None` switches the report off.
    pub longest_interval_s: Option<f64>,
}

/// The control law (12): a gain scheduled by the memberships at the state sent last, saturated.
///
/// This is the controller module's side of the network: it needs the sent states only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuzzyLaw<S, const N: usize, const M: usize, const R: usize> {
    gains: [SMatrix<f64, M, N>; R],
    membership: S,
    saturation: Saturation<M>,
}

impl<S: Membership<N, R>, const N: usize, const M: usize, const R: usize> FuzzyLaw<S, N, M, R> {
    /// Law with the given gains (M x N each), memberships and limits.
    ///
    /// # Errors
    /// A gain that is not finite, or a limit that is not finite and positive.
    pub fn new(
        gains: [SMatrix<f64, M, N>; R],
        membership: S,
        torque_limit: SVector<f64, M>,
    ) -> Result<Self, ParameterError> {
        const { assert!(R >= 1, "a fuzzy controller has at least one rule") };
        AllowedRange::FINITE.check_rules("gains", &gains)?;
        Ok(Self {
            gains,
            membership,
            saturation: Saturation::new(torque_limit)?,
        })
    }

    /// Membership functions of the law.
    pub fn membership(&self) -> &S {
        &self.membership
    }

    /// Torque asked for at the sent state, before saturation, N m; not finite when it overflows.
    pub fn unsaturated(&self, sent: &SVector<f64, N>) -> SVector<f64, M> {
        let weights = self.membership.weights(sent);
        let mut torque = SVector::zeros();
        for (gain, weight) in self.gains.iter().zip(weights) {
            torque += gain * sent * weight;
        }
        torque
    }

    /// Saturated torque at the sent state, N m; `None` when it overflows.
    pub fn torque(&self, sent: &SVector<f64, N>) -> Option<SVector<f64, M>> {
        let torque = self.unsaturated(sent);
        torque
            .iter()
            .all(|value| value.is_finite())
            .then(|| self.saturation.saturate(&torque))
    }
}

/// The closed controller: trigger (10) at the sensor and law (12) behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller<S, const N: usize, const M: usize, const R: usize> {
    law: FuzzyLaw<S, N, M, R>,
    trigger: AperiodicTrigger<N>,
    longest_interval_s: Option<f64>,
    clock: SampleClock,
    torque: SVector<f64, M>,
}

impl<S: Membership<N, R>, const N: usize, const M: usize, const R: usize> Controller<S, N, M, R> {
    /// Bytes of one message: the state, [`BYTES_PER_NUMBER`] each (24 for the spacecraft).
    pub const MESSAGE_BYTES: usize = BYTES_PER_NUMBER * N;

    /// Controller at rest, before its first sample.
    ///
    /// # Errors
    /// The first parameter that is not finite or out of its range.
    pub fn new(parameters: Parameters<S, N, M, R>) -> Result<Self, ParameterError> {
        if let Some(interval) = parameters.longest_interval_s {
            AllowedRange::POSITIVE.check_scalar("longest_interval_s", interval)?;
        }
        Ok(Self {
            law: FuzzyLaw::new(
                parameters.gains,
                parameters.membership,
                parameters.torque_limit,
            )?,
            trigger: AperiodicTrigger::new(parameters.trigger_weight, parameters.threshold_update)?
                .with_floor(parameters.trigger_floor)?,
            longest_interval_s: parameters.longest_interval_s,
            clock: SampleClock::default(),
            torque: SVector::zeros(),
        })
    }

    /// Takes the sample of the state (N components) at `time_s` seconds. The first usable sample is
    /// always sent; later ones when the trigger fires. In between the torque is constant.
    pub fn step(&mut self, time_s: f64, state: &SVector<f64, N>) -> Command<M> {
        self.step_measured(time_s, Ok(*state))
    }

    /// As [`Self::step`], with the state of a measurement, or why the measurement has none: it is then not used, as
    /// [`AttitudeMeasurement::checked_state`](crate::attitude::AttitudeMeasurement::checked_state) says of an attitude.
    pub fn step_measured(
        &mut self,
        time_s: f64,
        state: Result<SVector<f64, N>, HoldReason>,
    ) -> Command<M> {
        let outcome = self.advance(time_s, state);
        Command::of_step(self.torque, 8 * Self::MESSAGE_BYTES, outcome)
    }

    fn advance(
        &mut self,
        time_s: f64,
        state: Result<SVector<f64, N>, HoldReason>,
    ) -> Result<(bool, Status), HoldReason> {
        let interval_s = self.clock.interval(time_s)?;
        let state = &state?;
        HoldReason::check_finite(0, state.iter())?;
        let sent = self.trigger.fires(state).ok_or(HoldReason::Overflow)?;
        if sent {
            self.torque = self.law.torque(state).ok_or(HoldReason::Overflow)?;
            self.trigger.record_sent(state);
        }
        self.clock.accept(time_s);
        Ok((sent, self.status(time_s, interval_s, state)))
    }

    fn status(&self, time_s: f64, interval_s: Option<f64>, state: &SVector<f64, N>) -> Status {
        if !self.law.membership.contains(state) {
            return Status::Uncertified(Departure::OutsideBox);
        }
        match (interval_s, self.longest_interval_s) {
            (Some(interval_s), Some(longest_s))
                if interval_s - longest_s > time_rounding(time_s) =>
            {
                Status::Uncertified(Departure::LateSample {
                    interval_s,
                    longest_s,
                })
            }
            _ => Status::Nominal,
        }
    }

    /// The control law.
    pub fn law(&self) -> &FuzzyLaw<S, N, M, R> {
        &self.law
    }

    /// The trigger, with the state sent last and the threshold in force.
    pub fn trigger(&self) -> &AperiodicTrigger<N> {
        &self.trigger
    }

    /// The torque in force, N m.
    pub fn torque(&self) -> &SVector<f64, M> {
        &self.torque
    }

    /// Back to the state before the first sample, with zero torque. The way on after a time stamp
    /// that was finite but wrong and far in the future.
    pub fn reset(&mut self) {
        self.trigger.reset();
        self.clock = SampleClock::default();
        self.torque = SVector::zeros();
    }
}

/// Largest error of an interval, s, when both of its ends are times up to `time_s` that carry two
/// roundings each.
fn time_rounding(time_s: f64) -> f64 {
    4.0 * f64::EPSILON * time_s.abs()
}
