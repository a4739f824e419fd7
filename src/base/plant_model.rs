//! Checks of a model file's plant in another file.

use synth::model::ModelError;

/// The same error at another place.
pub(crate) fn relocated(mut error: ModelError, from: &str, to: &str) -> ModelError {
    if let ModelError::OutOfRange { field, .. }
    | ModelError::WrongShape { field, .. }
    | ModelError::NotSymmetric { field, .. }
    | ModelError::NotPositiveDefinite { field, .. }
    | ModelError::Choice { field, .. } = &mut error
    {
        if let Some(rest) = field.strip_prefix(from) {
            *field = format!("{to}{rest}");
        }
    }
    error
}
