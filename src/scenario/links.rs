//! The checked link of a scenario.

use runtime::compression::{
    Alphabet, AxisParameters, Encoder, Level, Levels, NumberFormat, Parameters, Scheme,
};
use runtime::error::{Element, Field, ParameterError};
use synth::model::ModelError;

use super::link_file::{EncodingFile, FormatFile, LevelsFile, LinkFile, ZAryFile};
use crate::base::bounded::Positive;
use crate::base::ranges::require;
use crate::plants::System;
use crate::sim::link::{LinkData, MAX_LEVELS};
use crate::sim::sampling::Instants;

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
        ParameterError::NotFinite { field, value } => ModelError::OutOfRange {
            field: place(file, field),
            value,
            allowed: "a finite number".to_string(),
        },
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
        ("limit", Element::Component(axis)) => return format!("link.torque_limit_nm[{axis}]"),
        ("bits", _) => "format.quantised.bits".to_string(),
        ("relative", _) => name.to_string(),
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
