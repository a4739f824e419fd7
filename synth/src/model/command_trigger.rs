//! Laws that send their command by a trigger on the command, and what a proof of such a law is to be.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bounded::{As, BelowOne, NonNegative, Positive, Ratio, UpToOne};

/// The trigger of given gains.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum GivenTrigger {
    /// On the command.
    Command(CommandTrigger),
}

/// A sample is sent when |u - F x| >= relative |F x| + absolute, with u the command in force and x the sampled state
/// (Euclidean norms); the first sample is sent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CommandTrigger {
    /// al, in [0, 1).
    #[serde(with = "As::<BelowOne>")]
    pub relative: f64,
    /// ga, not negative [N m].
    #[serde(with = "As::<NonNegative>")]
    pub absolute_nm: f64,
}

/// The proof of given gains with a trigger on the command, on the box and with the decay rate of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CommandTriggerSpecs {
    /// Share theta of the command that stays within the torque limit on the certified set, in (0, 1]; 1: the torque never
    /// saturates there. Searched when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Ratio>>")]
    pub within_limit: Option<f64>,
    /// Largest level r / phi that the functional settles at, in (0, 1], where the certified set is x'Ux <= 1.
    #[serde(with = "As::<Ratio>")]
    pub final_level: f64,
    /// A second certificate, on a smaller set that the state reaches, for the pointing in the end. Without it the one
    /// certificate is for the angle, or, with the objective gain, for the pointing.
    #[serde(default, rename = "final", skip_serializing_if = "Option::is_none")]
    pub last: Option<FinalSetSpecs>,
}

/// The certificate of the smaller set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FinalSetSpecs {
    /// Decay rate phi of its functional, above 0 [1/s].
    #[serde(with = "As::<Positive>")]
    pub phi_per_s: f64,
    /// Its box: bound on the magnitude of each rate, above 0 [rad/s].
    #[serde(with = "As::<[Positive; 3]>")]
    pub rate_rad_s: [f64; 3],
    /// Its box: smallest scalar part q0 of the error quaternion, in (0, 1].
    #[serde(with = "As::<UpToOne>")]
    pub q0_min: f64,
    /// As above; the torque does not saturate in this set when left out.
    #[serde(default = "whole", with = "As::<Ratio>")]
    pub within_limit: f64,
    /// As above.
    #[serde(with = "As::<Ratio>")]
    pub final_level: f64,
}

fn whole() -> f64 {
    1.0
}
