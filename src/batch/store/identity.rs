//! Whether what a folder holds is what is asked for.

use serde::Serialize;
use serde_json::Value;

/// A field in which two pieces of work differ.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldDifference {
    /// Its key.
    pub key: &'static str,
    /// Its value in the work that is there.
    pub known: Value,
    /// Its value in the work that is asked for.
    pub requested: Value,
}

/// The first field in which two pieces of work differ. `keys` are all fields that determine the work's
/// numbers, those that explain a difference best first: it goes on only where all of them are the same.
pub fn first_difference<I: Serialize>(
    known: &I,
    requested: &I,
    keys: &[&'static str],
) -> Option<FieldDifference> {
    // Identities hold numbers and texts only, so they can always be written.
    let value = |identity: &I| serde_json::to_value(identity).unwrap_or_default();
    let (mut known, mut requested) = (value(known), value(requested));
    let key = keys.iter().find(|key| known[**key] != requested[**key])?;
    Some(FieldDifference {
        key,
        known: known[key].take(),
        requested: requested[key].take(),
    })
}
