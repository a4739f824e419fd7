//! The link of a scenario.

use runtime::compression::{
    Alphabet, AxisParameters, Encoder, Level, Levels, NumberFormat, Parameters, Scheme,
};
use runtime::error::{Element, Field, ParameterError};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use crate::base::bounded::{BelowOne, NonNegative, Plain, Positive};
use crate::base::ranges::require;
use crate::plants::System;
use crate::sim::link::{LinkData, MAX_LEVELS};
use crate::sim::sampling::Instants;

/// The link between the controller's torque command and the actuators.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinkFile {
    /// What is sent and when.
    pub encoding: EncodingFile,
    /// Largest torque of each axis that a word can say, above 0; commands beyond it are cut off [N m].
    #[serde(with = "Plain::<[Positive; 3]>")]
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
    #[serde(with = "Plain::<[Positive; 3]>")]
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
    #[serde(with = "Plain::<BelowOne>")]
    pub relative: f64,
    /// Threshold of each axis at zero, above 0 and at most twice the limit [N m].
    #[serde(with = "Plain::<[Positive; 3]>")]
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
    #[serde(with = "Plain::<Vec<NonNegative>>")]
    pub from_nm: Vec<f64>,
    /// Step of each interval for each axis, above 0 and at most twice the limit [N m].
    #[serde(with = "Plain::<[Vec<Positive>; 3]>")]
    pub threshold_nm: [Vec<f64>; 3],
}

/// Intervals of equal width up to the limit with steps that grow evenly.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EvenLevelsFile {
    /// Number of intervals, at least 1.
    pub count: u32,
    /// Step of the first interval for each axis, above 0 and at most twice the limit [N m].
    #[serde(with = "Plain::<[Positive; 3]>")]
    pub smallest_threshold_nm: [f64; 3],
    /// Step of the last interval for each axis, above 0 and at most twice the limit [N m].
    #[serde(with = "Plain::<[Positive; 3]>")]
    pub largest_threshold_nm: [f64; 3],
}

/// Checks the link of a file.
pub(crate) fn check_link(
    file: &LinkFile,
    system: &System,
    instants: &Instants,
) -> Result<LinkData<3>, ModelError> {
    if matches!(system, System::TakagiSugeno(_)) {
        return Err(ModelError::WrongShape {
            field: "link".to_string(),
            found: "3 axes".to_string(),
            expected: "none: a link is for a rigid_body only".to_string(),
        });
    }
    if let Instants::Continuous { resolution_s } = *instants {
        let field = "sampling.instants.continuous.resolution_s";
        let allowed = "left out, because a link needs periodic or aperiodic sampling";
        require(false, field, resolution_s, allowed)?;
    }
    let parameters = Parameters {
        axes: axes(file)?,
        resynchronisation_period_s: file.resynchronisation_period_s.map(Positive::get),
    };
    Encoder::new(&parameters).map_err(|error| located(file, &error))?;
    Ok(LinkData {
        parameters,
        bit_error_probability: file.bit_error_probability.get(),
        word_loss_probability: file.word_loss_probability.get(),
    })
}

fn axes(file: &LinkFile) -> Result<[AxisParameters<MAX_LEVELS>; 3], ModelError> {
    let schemes = match &file.encoding {
        EncodingFile::EveryChange(every) => {
            let format = format(every.format);
            [Scheme::EveryChange { format }; 3]
        }
        EncodingFile::FixedThreshold(fixed) => {
            fixed.threshold_nm.map(|threshold| Scheme::FixedThreshold {
                threshold,
                format: format(fixed.format),
            })
        }
        EncodingFile::RelativeThreshold(relative) => {
            let scheme = |absolute| Scheme::RelativeThreshold {
                relative: relative.relative,
                absolute,
                format: format(relative.format),
            };
            relative.absolute_nm.map(scheme)
        }
        EncodingFile::ZAry(compressed) => {
            let alphabet = Alphabet::new(compressed.radix, compressed.digits)
                .map_err(|error| located(file, &error))?;
            levels(compressed)?.map(|levels| Scheme::Compressed { alphabet, levels })
        }
    };
    Ok(std::array::from_fn(|axis| AxisParameters {
        limit: file.torque_limit_nm[axis],
        scheme: schemes[axis],
    }))
}

fn format(file: FormatFile) -> NumberFormat {
    match file {
        FormatFile::Double => NumberFormat::Double,
        FormatFile::Single => NumberFormat::Single,
        FormatFile::Quantised(quantised) => NumberFormat::Quantised {
            bits: quantised.bits,
        },
    }
}

fn levels(file: &ZAryFile) -> Result<[Levels<MAX_LEVELS>; 3], ModelError> {
    let table = match &file.levels {
        LevelsFile::Even(even) => {
            return Ok(std::array::from_fn(|axis| Levels::Even {
                count: even.count,
                smallest_threshold: even.smallest_threshold_nm[axis],
                largest_threshold: even.largest_threshold_nm[axis],
            }))
        }
        LevelsFile::Table(table) => table,
    };
    let count = table.from_nm.len();
    let place = "link.encoding.z_ary.levels.table";
    if !(1..=MAX_LEVELS).contains(&count) {
        return Err(ModelError::WrongShape {
            field: format!("{place}.from_nm"),
            found: format!("{count} levels"),
            expected: format!("1 to {MAX_LEVELS} levels"),
        });
    }
    let mut out = [Levels::Table {
        levels: [Level::default(); MAX_LEVELS],
        count: 0,
    }; 3];
    for (axis, thresholds) in table.threshold_nm.iter().enumerate() {
        let wrong = || ModelError::WrongShape {
            field: format!("{place}.threshold_nm[{axis}]"),
            found: format!("{} entries", thresholds.len()),
            expected: format!("{count} entries, as in from_nm"),
        };
        if thresholds.len() != count {
            return Err(wrong());
        }
        let pairs = table.from_nm.iter().zip(thresholds);
        let given: Vec<Level> = pairs
            .map(|(&from, &threshold)| Level { from, threshold })
            .collect();
        out[axis] = Levels::table(&given).ok_or_else(wrong)?;
    }
    Ok(out)
}

/// The codec's error with the place in the file.
fn located(file: &LinkFile, error: &ParameterError) -> ModelError {
    match *error {
        ParameterError::OutOfRange {
            field,
            value,
            allowed,
        } => ModelError::OutOfRange {
            field: place(file, field),
            value,
            allowed: format!("in {allowed}"),
        },
        ParameterError::NotEven { field, value } => ModelError::OutOfRange {
            field: place(file, field),
            value: f64::from(value),
            allowed: "even".to_string(),
        },
        _ => ModelError::WrongShape {
            field: "link".to_string(),
            found: error.to_string(),
            expected: "a link that the flight code accepts".to_string(),
        },
    }
}

fn place(file: &LinkFile, field: Field) -> String {
    let encoding = match &file.encoding {
        EncodingFile::EveryChange(_) => "every_change",
        EncodingFile::FixedThreshold(_) => "fixed_threshold",
        EncodingFile::RelativeThreshold(_) => "relative_threshold",
        EncodingFile::ZAry(_) => "z_ary",
    };
    let even =
        matches!(&file.encoding, EncodingFile::ZAry(z) if matches!(z.levels, LevelsFile::Even(_)));
    let levels = if even { "levels.even" } else { "levels.table" };
    let (name, element) = (field.name, field.element);
    let inside = match (name, element) {
        ("bits", _) => "format.quantised.bits".to_string(),
        ("level_count", _) if even => format!("{levels}.count"),
        ("level_count", _) => format!("{levels}.from_nm"),
        ("from", Element::Entry { column, .. }) => format!("{levels}.from_nm[{column}]"),
        ("threshold", Element::Entry { row, column }) => {
            format!("{levels}.threshold_nm[{row}][{column}]")
        }
        ("smallest_threshold" | "largest_threshold", Element::Component(axis)) => {
            format!("{levels}.{name}_nm[{axis}]")
        }
        (_, Element::Component(axis)) => format!("{name}_nm[{axis}]"),
        _ => field.to_string(),
    };
    format!("link.encoding.{encoding}.{inside}")
}
