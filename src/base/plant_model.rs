//! Errors of a plant that is checked with the model's checks, at their place in another file.

use synth::model::ModelError;

/// The same error at another place.
pub(crate) fn relocated(mut error: ModelError, from: &str, to: &str) -> ModelError {
    if let Some(field) = error.field_mut() {
        if let Some(rest) = field.strip_prefix(from) {
            *field = format!("{to}{rest}");
        }
    }
    error
}
