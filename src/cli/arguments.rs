//! Values of options, read with what is allowed in the refusal.

/// A whole number, 0 or above, of an option.
pub(crate) fn whole(text: &str) -> Result<u64, String> {
    let number = text.parse();
    number.map_err(|_| "it must be a whole number, 0 or above".to_string())
}
