//! The link of a scenario.

use runtime::compression::{
    Alphabet, AxisParameters, Encoder, Level, Levels, NumberFormat, Parameters, Scheme,
};
use runtime::error::{Element, Field, ParameterError};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use crate::base::bounded::{AnyNonNegative, AnyPositive, BelowOne};
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
    pub torque_limit_nm: [AnyPositive; 3],
    /// Probability that a bit of a word arrives inverted, in [0, 1).
    #[serde(default)]
    pub bit_error_probability: BelowOne,
    /// Probability that a word does not arrive, in [0, 1).
    #[serde(default)]
    pub word_loss_probability: BelowOne,
    /// Time between two samples at which every axis is resynchronised, above 0; never when left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resynchronisation_period_s: Option<AnyPositive>,
}

/// The encodings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum EncodingFile {
    /// Every command that differs from the one before is sent.
    EveryChange {
        /// How a torque is written; `double` when left out.
        #[serde(default)]
        format: FormatFile,
    },
    /// A command is sent when it differs from the torque held by the threshold or more.
    FixedThreshold {
        /// Threshold of each axis, above 0 and at most twice the limit [N m].
        threshold_nm: [AnyPositive; 3],
        /// How a torque is written; `double` when left out.
        #[serde(default)]
        format: FormatFile,
    },
    /// As `fixed_threshold`, with the threshold `relative |u| + absolute_nm` of a command u.
    RelativeThreshold {
        /// Fraction of the command's magnitude, in [0, 1).
        relative: BelowOne,
        /// Threshold of each axis at zero, above 0 and at most twice the limit [N m].
        absolute_nm: [AnyPositive; 3],
        /// How a torque is written; `double` when left out.
        #[serde(default)]
        format: FormatFile,
    },
    /// Steps up and down, named by a few base-z digits: Yang et al. 2025, (21)-(23).
    ZAry(Box<ZAryFile>),
}

/// How a torque is written into a word.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FormatFile {
    /// IEEE 754 double precision: 64 bits.
    #[default]
    Double,
    /// IEEE 754 single precision: 32 bits.
    Single,
    /// Evenly spaced torques between the limits.
    Quantised {
        /// Bits of a word, 2 to 32.
        bits: u32,
    },
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
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LevelsFile {
    /// Given one by one, at most 64.
    Table {
        /// Lower ends of the intervals of the command's magnitude, from 0 upwards, below the limit [N m].
        from_nm: Vec<AnyNonNegative>,
        /// Step of each interval for each axis, above 0 and at most twice the limit [N m].
        threshold_nm: [Vec<AnyPositive>; 3],
    },
    /// Intervals of equal width up to the limit with steps that grow evenly.
    Even {
        /// Number of intervals, at least 1.
        count: u32,
        /// Step of the first interval for each axis, above 0 and at most twice the limit [N m].
        smallest_threshold_nm: [AnyPositive; 3],
        /// Step of the last interval for each axis, above 0 and at most twice the limit [N m].
        largest_threshold_nm: [AnyPositive; 3],
    },
}

/// Checks the link of a file.
pub(crate) fn check_link(
    file: &LinkFile,
    system: &System,
    instants: &Instants,
) -> Result<LinkData<3>, ModelError> {
    if matches!(system, System::TakagiSugeno(_)) {
        return Err(ModelError::shape(
            "link",
            "3 axes",
            "none: a link is for a rigid_body only",
        ));
    }
    if let Instants::Continuous { resolution_s } = *instants {
        let field = "sampling.instants.continuous.resolution_s";
        let allowed = "left out, because a link needs periodic or aperiodic sampling";
        require(false, field, resolution_s, allowed)?;
    }
    let parameters = Parameters {
        axes: axes(file)?,
        resynchronisation_period_s: file.resynchronisation_period_s.map(AnyPositive::get),
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
        EncodingFile::EveryChange { format } => {
            [Scheme::EveryChange {
                format: format.number(),
            }; 3]
        }
        EncodingFile::FixedThreshold {
            threshold_nm,
            format,
        } => threshold_nm.map(|threshold| Scheme::FixedThreshold {
            threshold: threshold.get(),
            format: format.number(),
        }),
        EncodingFile::RelativeThreshold {
            relative,
            absolute_nm,
            format,
        } => absolute_nm.map(|absolute| Scheme::RelativeThreshold {
            relative: relative.get(),
            absolute: absolute.get(),
            format: format.number(),
        }),
        EncodingFile::ZAry(compressed) => {
            let alphabet = Alphabet::new(compressed.radix, compressed.digits)
                .map_err(|error| located(file, &error))?;
            let levels = compressed.levels.of_axes()?;
            levels.map(|levels| Scheme::Compressed { alphabet, levels })
        }
    };
    Ok(std::array::from_fn(|axis| AxisParameters {
        limit: file.torque_limit_nm[axis].get(),
        scheme: schemes[axis],
    }))
}

impl FormatFile {
    fn number(self) -> NumberFormat {
        match self {
            FormatFile::Double => NumberFormat::Double,
            FormatFile::Single => NumberFormat::Single,
            FormatFile::Quantised { bits } => NumberFormat::Quantised { bits },
        }
    }
}

impl LevelsFile {
    fn of_axes(&self) -> Result<[Levels<MAX_LEVELS>; 3], ModelError> {
        let (from_nm, threshold_nm) = match self {
            LevelsFile::Even {
                count,
                smallest_threshold_nm,
                largest_threshold_nm,
            } => {
                return Ok(std::array::from_fn(|axis| Levels::Even {
                    count: *count,
                    smallest_threshold: smallest_threshold_nm[axis].get(),
                    largest_threshold: largest_threshold_nm[axis].get(),
                }))
            }
            LevelsFile::Table {
                from_nm,
                threshold_nm,
            } => (from_nm, threshold_nm),
        };
        let wrong = |field: &str, found: String, expected: String| {
            let table = "link.encoding.z_ary.levels.table";
            ModelError::shape(format!("{table}.{field}"), found, expected)
        };
        let count = from_nm.len();
        if !(1..=MAX_LEVELS).contains(&count) {
            let expected = format!("1 to {MAX_LEVELS} levels");
            return Err(wrong("from_nm", format!("{count} levels"), expected));
        }
        let mut out = [Levels::Table {
            levels: [Level::default(); MAX_LEVELS],
            count: 0,
        }; 3];
        for (axis, thresholds) in threshold_nm.iter().enumerate() {
            let pairs = from_nm.iter().zip(thresholds);
            let given: Vec<Level> = pairs
                .map(|(from, threshold)| Level {
                    from: from.get(),
                    threshold: threshold.get(),
                })
                .collect();
            let levels = Levels::table(&given).filter(|_| thresholds.len() == count);
            out[axis] = levels.ok_or_else(|| {
                let found = format!("{} entries", thresholds.len());
                let expected = format!("{count} entries, as in from_nm");
                wrong(&format!("threshold_nm[{axis}]"), found, expected)
            })?;
        }
        Ok(out)
    }
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
        _ => {
            let expected = "a link that the flight code accepts";
            ModelError::shape("link", error.to_string(), expected)
        }
    }
}

fn place(file: &LinkFile, field: Field) -> String {
    let encoding = match &file.encoding {
        EncodingFile::EveryChange { .. } => "every_change",
        EncodingFile::FixedThreshold { .. } => "fixed_threshold",
        EncodingFile::RelativeThreshold { .. } => "relative_threshold",
        EncodingFile::ZAry(_) => "z_ary",
    };
    let even = matches!(&file.encoding, EncodingFile::ZAry(z) if matches!(z.levels, LevelsFile::Even { .. }));
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
