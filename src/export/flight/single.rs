//! A controller in single precision, but for the time: what is said of it, and which there are none of.

use synth::certify::controller_rounding::controller_rounding;
use synth::certify::interval::Interval;

use super::error::NoSource;
use super::source::{Precision, Source};
use crate::run::design::Design;

/// Half the distance of 1 from the next number of single precision, and a quarter more. The numbers of the file and the
/// measurement are rounded too, so that n + 2 roundings are behind a term of a command of n states: as many as the bound counts.
const UNIT: f64 = 1.25 / 16_777_216.0;

/// A controller in the precision that is asked for, of a design where it is one's.
///
/// # Errors
/// In single precision, those of it.
pub fn in_precision(
    precision: Precision,
    source: Source,
    design: Option<&Design>,
) -> Result<Source, NoSource> {
    match precision {
        Precision::Double => Ok(source),
        Precision::Single => in_single(source, design),
    }
}

/// A controller in single precision.
///
/// # Errors
/// A law in which time takes part, or whose threshold moves; numbers beyond the range.
fn in_single(mut source: Source, design: Option<&Design>) -> Result<Source, NoSource> {
    let has = |variable: &str| source.constants.iter().any(|one| one.variable == variable);
    if source.library.iter().any(|name| *name != "exp") || has("AMPLITUDE") {
        return Err(NoSource::SinglePrecision);
    }
    let numbers = source.constants.iter().flat_map(|one| &one.numbers.values);
    if let Some(&value) = numbers
        .into_iter()
        .find(|value| value.abs() > f64::from(f32::MAX) * UNIT)
    {
        return Err(NoSource::BeyondSingle { value });
    }
    for constant in &mut source.constants {
        let toward_zero = constant.variable == "LIMITS";
        for value in &mut constant.numbers.values {
            *value = representable(*value, toward_zero);
        }
    }
    let bound = design.and_then(|design| {
        let certificate = design.file.certificate(&design.model).ok()?;
        let bound = controller_rounding::<Interval>(&design.model, &certificate, UNIT)?;
        Some(bound.torque.hi())
    });
    let bound = bound.map_or(String::new(), |bound| {
        format!(" A command is off by at most {bound:.1e} in norm for states that the proof is about, where both decide alike.")
    });
    source.proved = false;
    source.precision = Precision::Single;
    source.library.clear();
    source.about.insert(
        1,
        format!(
            "SINGLE PRECISION: NOT PROVED. What is said to be proved below is of the controller in doubles, and this code computes in float, \
             but for the time.{bound} The test measures how far it is off, and how often the trigger decides otherwise."
        ),
    );
    Ok(source)
}

/// A number that float holds about as it is: zero for what is below its range, and a limit is never exceeded.
fn representable(value: f64, toward_zero: bool) -> f64 {
    if value.abs() < f64::from(f32::MIN_POSITIVE) {
        return 0.0;
    }
    let nearest = value as f32;
    let beyond = f64::from(nearest).abs() > value.abs();
    let kept = match toward_zero && beyond {
        true => f32::from_bits(nearest.to_bits() - 1),
        false => nearest,
    };
    f64::from(kept)
}
