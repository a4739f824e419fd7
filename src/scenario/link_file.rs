//! The link part of the scenario file, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::base::bounded::{BelowOne, Positive};

/// The link between the controller's torque command and the actuators.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinkFile {
    /// What is sent and when.
    pub encoding: EncodingFile,
    /// Largest torque of each axis that a word can say, above 0; commands beyond it are cut off [N m].
    pub torque_limit_nm: [f64; 3],
    /// Probability that a bit of a word arrives inverted, in [0, 1).
    #[serde(default)]
    pub bit_error_probability: BelowOne,
    /// Probability that a word does not arrive, in [0, 1).
    #[serde(default)]
    pub word_loss_probability: BelowOne,
    /// Time between two samples at which every axis is resynchronised, above 0; never when left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resynchronisation_period_s: Option<Positive>,
}

/// The encodings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EncodingFile {
    /// Every command that differs from the one before is sent.
    EveryChange(EveryChangeFile),
    /// A command is sent when it differs from the torque held by the threshold or more.
    FixedThreshold(CommandThresholdFile),
    /// As `fixed_threshold`, with a threshold that grows with the command.
    RelativeThreshold(RelativeCommandThresholdFile),
    /// Steps up and down, named by a few base-z digits: Yang et al. 2025, (21)-(23).
    ZAry(Box<ZAryFile>),
}

/// How a torque is written into a word.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FormatFile {
    /// IEEE 754 double precision: 64 bits.
    #[default]
    Double,
    /// IEEE 754 single precision: 32 bits.
    Single,
    /// Evenly spaced torques between the limits.
    Quantised(QuantisedFile),
}

/// Evenly spaced torques.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QuantisedFile {
    /// Bits of a word, 2 to 32.
    pub bits: u32,
}

/// Every change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EveryChangeFile {
    /// How a torque is written; `double` when left out.
    #[serde(default)]
    pub format: FormatFile,
}

/// A fixed threshold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CommandThresholdFile {
    /// Threshold of each axis, above 0 and at most twice the limit [N m].
    pub threshold_nm: [f64; 3],
    /// How a torque is written; `double` when left out.
    #[serde(default)]
    pub format: FormatFile,
}

/// The threshold `relative |u| + absolute_nm` of a command u.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelativeCommandThresholdFile {
    /// Share of the command's magnitude, in [0, 1).
    pub relative: f64,
    /// Threshold of each axis at zero, above 0 and at most twice the limit [N m].
    pub absolute_nm: [f64; 3],
    /// How a torque is written; `double` when left out.
    #[serde(default)]
    pub format: FormatFile,
}

/// z-ary compression.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ZAryFile {
    /// z: the base of the digits, even, at least 2.
    pub radix: u32,
    /// m: digits of a word, at least 1; z^m is at most 2^24.
    pub digits: u32,
    /// Which step belongs to which magnitude of the command.
    pub levels: LevelsFile,
}

/// Levels of the command's magnitude, at most z^m / 2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LevelsFile {
    /// Given one by one.
    Table(LevelTableFile),
    /// Evenly spaced.
    Even(EvenLevelsFile),
}

/// Levels one by one, at most 64.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LevelTableFile {
    /// Lower ends of the intervals of the command's magnitude, from 0 upwards, below the limit [N m].
    pub from_nm: Vec<f64>,
    /// Step of each interval for each axis, above 0 and at most twice the limit [N m].
    pub threshold_nm: [Vec<f64>; 3],
}

/// Intervals of equal width up to the limit with steps that grow evenly.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EvenLevelsFile {
    /// Number of intervals, at least 1.
    pub count: u32,
    /// Step of the first interval for each axis, above 0 and at most twice the limit [N m].
    pub smallest_threshold_nm: [f64; 3],
    /// Step of the last interval for each axis, above 0 and at most twice the limit [N m].
    pub largest_threshold_nm: [f64; 3],
}
