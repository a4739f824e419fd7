//! Checks of the numbers of a file.

use synth::model::{finite, ModelError};

/// A value that must satisfy a condition, and be finite and of sensible magnitude.
pub(crate) fn require(ok: bool, field: &str, value: f64, allowed: &str) -> Result<(), ModelError> {
    if !ok {
        return Err(ModelError::OutOfRange {
            field: field.to_string(),
            value,
            allowed: allowed.to_string(),
        });
    }
    finite(field, value)
}

pub(crate) fn each(
    field: &str,
    values: &[f64],
    check: fn(&str, f64) -> Result<(), ModelError>,
) -> Result<(), ModelError> {
    let entries = values.iter().enumerate();
    entries
        .into_iter()
        .try_for_each(|(index, &value)| check(&format!("{field}[{index}]"), value))
}
