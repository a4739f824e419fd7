//! Whether what a folder holds is what is asked for.

use serde::Serialize;
use serde_json::Value;

/// What determines every number of some work: it goes on only where all of it is the same.
pub trait Identity: Serialize {
    /// Keys and what they are called, those that explain a difference best first.
    const FIELDS: &'static [(&'static str, &'static str)];
}

/// A field in which two pieces of work differ.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldDifference {
    /// What it is called.
    pub name: &'static str,
    /// Its value in the work that is there.
    pub known: Value,
    /// Its value in the work that is asked for.
    pub requested: Value,
}

/// The first field in which two pieces of work differ.
pub fn first_difference<I: Identity>(known: &I, requested: &I) -> Option<FieldDifference> {
    // Identities hold numbers and texts only, so they can always be written.
    let value = |identity: &I| serde_json::to_value(identity).unwrap_or_default();
    let (known, requested) = (value(known), value(requested));
    let mut fields = I::FIELDS.iter();
    fields.find_map(|(key, name)| {
        let (known, requested) = (&known[*key], &requested[*key]);
        (known != requested).then(|| FieldDifference {
            name,
            known: known.clone(),
            requested: requested.clone(),
        })
    })
}
