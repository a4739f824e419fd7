//! The composite event trigger: when the actuators are turned off, (6), and on, (8).

use crate::error::{AllowedRange, ParameterError};

/// Share of the longest on-time by which turning off may come early, so that rounding of the sampling
/// instants does not make it late by a whole sample.
const TIME_ROUNDING: f64 = 1e-9;

/// Turn-off (6) and turn-on (8), the latter on V2 against its envelope S2, (70). Times count from the
/// start of the manoeuvre, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompositeTrigger {
    /// s, N^2 m^2, positive: what is allowed at the start, in addition to `held_error_terminal`, of the
    /// squared difference between the torque in force and that of the law.
    pub held_error_initial: f64,
    /// m, N^2 m^2, positive: what is allowed of it in the end.
    pub held_error_terminal: f64,
    /// T_max, s, positive: longest time on.
    pub longest_on_s: f64,
    /// S2(0), J, above `envelope_terminal_j`.
    pub envelope_initial_j: f64,
    /// S2 at infinity, J, positive.
    pub envelope_terminal_j: f64,
    /// beta, 1/s, positive: decay of the envelope and of the allowed difference.
    pub decay_rate_per_s: f64,
    /// delta_m, J, positive: turning on comes as soon as V2 is this close to the envelope. Below
    /// `(1 - relative_buffer) envelope_terminal_j`.
    pub buffer_j: f64,
    /// kappa, dimensionless, in `[0, 1)`: a further buffer in proportion to the envelope. The paper has
    /// none, which suits a trigger that is watched continuously; one evaluated at samples needs it to
    /// stay below the envelope.
    pub relative_buffer: f64,
}

/// When the torque changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TriggerRule {
    /// As published: the actuators are on for short times.
    Composite(CompositeTrigger),
    /// The same law, always on, with a new torque at every sample: what to compare with.
    EverySample,
}

/// What the trigger asks for at an instant. Turning off is decided first: both together replace the
/// torque in force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switching {
    /// The actuators are turned off.
    pub off: bool,
    /// The actuators are turned on.
    pub on: bool,
}

impl CompositeTrigger {
    /// S2 of (70), J.
    pub fn envelope(&self, elapsed_s: f64) -> f64 {
        let difference = self.envelope_initial_j - self.envelope_terminal_j;
        difference * self.decay(elapsed_s) + self.envelope_terminal_j
    }

    /// V2 at which the actuators are turned on, J: S2 less the buffers.
    pub fn turn_on_level(&self, elapsed_s: f64) -> f64 {
        (1.0 - self.relative_buffer) * self.envelope(elapsed_s) - self.buffer_j
    }

    /// Squared norm of the held error e_u at which the actuators are turned off, (6), N^2 m^2.
    pub fn turn_off_level(&self, elapsed_s: f64) -> f64 {
        self.held_error_initial * self.decay(elapsed_s) + self.held_error_terminal
    }

    fn decay(&self, elapsed_s: f64) -> f64 {
        libm::exp(-self.decay_rate_per_s * elapsed_s)
    }

    /// What to switch. `on_since_s` is when the actuators were turned on, if they are;
    /// `held_error_squared` (N^2 m^2) counts only then; `rate_error_energy` is V2 (J).
    pub fn decide(
        &self,
        elapsed_s: f64,
        on_since_s: Option<f64>,
        held_error_squared: f64,
        rate_error_energy: f64,
    ) -> Switching {
        let longest = self.longest_on_s * (1.0 - TIME_ROUNDING);
        let off = on_since_s.is_some_and(|since_s| {
            held_error_squared >= self.turn_off_level(elapsed_s) || elapsed_s - since_s >= longest
        });
        let idle = off || on_since_s.is_none();
        let on = idle && rate_error_energy >= self.turn_on_level(elapsed_s);
        Switching { off, on }
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let positive = |name, value| AllowedRange::POSITIVE.check_scalar(name, value);
        let below = |name, value, upper| AllowedRange::open(0.0, upper).check_scalar(name, value);
        positive("held_error_initial", self.held_error_initial)?;
        positive("held_error_terminal", self.held_error_terminal)?;
        positive("longest_on_s", self.longest_on_s)?;
        positive("envelope_initial_j", self.envelope_initial_j)?;
        let initial = self.envelope_initial_j;
        below("envelope_terminal_j", self.envelope_terminal_j, initial)?;
        positive("decay_rate_per_s", self.decay_rate_per_s)?;
        let fraction = AllowedRange::half_open(0.0, 1.0);
        fraction.check_scalar("relative_buffer", self.relative_buffer)?;
        let room = (1.0 - self.relative_buffer) * self.envelope_terminal_j;
        below("buffer_j", self.buffer_j, room)
    }
}

impl TriggerRule {
    /// The composite trigger, unless the torque changes at every sample.
    pub fn composite(&self) -> Option<&CompositeTrigger> {
        match self {
            TriggerRule::Composite(trigger) => Some(trigger),
            TriggerRule::EverySample => None,
        }
    }
}
