//! Numbers of files that carry their range: it is checked when they are read, and stands in the schema.

use std::borrow::Cow;
use std::fmt;

use schemars::{json_schema, JsonSchema, Schema, SchemaGenerator};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::error::{readable, FileError};
use super::ranges::finite;

/// A number out of its range, without its place in the file, which the reader knows.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the value {} is not allowed; it must be {allowed}", readable(*value))]
pub struct OutOfRange {
    /// The number.
    pub value: f64,
    /// The allowed range in words.
    pub allowed: &'static str,
}

/// What [`finite`] allows, in words.
const MAGNITUDE: &str = "0 or a number of magnitude 1e-30 to 1e30";

/// Makes types of numbers in a range: the type, the range in words, the test, and the keys that the
/// schema has for it. All refuse what `synth::model::finite` refuses.
macro_rules! bounded {
    ($($(#[$doc:meta])+ $name:ident $words:literal $ok:expr, $schema:tt;)+) => {$(
        $(#[$doc])+
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(try_from = "f64", into = "f64")]
        pub struct $name(f64);

        impl $name {
            /// The number.
            pub const fn get(self) -> f64 {
                self.0
            }
        }

        impl TryFrom<f64> for $name {
            type Error = OutOfRange;

            fn try_from(value: f64) -> Result<Self, OutOfRange> {
                let ok: fn(f64) -> bool = $ok;
                let refuse = |allowed| Err(OutOfRange { value, allowed });
                match (ok(value), finite("", value)) {
                    (false, _) => refuse($words),
                    (true, Err(_)) => refuse(MAGNITUDE),
                    (true, Ok(())) => Ok(Self(value)),
                }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                self.0.fmt(formatter)
            }
        }

        impl From<$name> for f64 {
            fn from(number: $name) -> f64 {
                number.0
            }
        }

        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }
    )+};
}

bounded! {
    /// Any number.
    Finite "a finite number" |value| !value.is_nan(),
        { "type": "number", "format": "double" };
    /// A number above 0.
    Positive "above 0" |value| value > 0.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0 };
    /// A number that is 0 or above.
    NonNegative "0 or above" |value| value >= 0.0,
        { "type": "number", "format": "double", "minimum": 0 };
    /// A number in [0, 1).
    BelowOne "in [0, 1)" |value| (0.0..1.0).contains(&value),
        { "type": "number", "format": "double", "minimum": 0, "exclusiveMaximum": 1 };
    /// A number in (0, 1).
    InsideUnit "in (0, 1)" |value| value > 0.0 && value < 1.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0, "exclusiveMaximum": 1 };
}

impl Default for BelowOne {
    fn default() -> Self {
        Self(0.0)
    }
}

/// The plain numbers of a list.
pub fn plain<T: Copy + Into<f64>, const N: usize>(numbers: &[T; N]) -> [f64; N] {
    numbers.map(Into::into)
}

/// A document from its JSON value.
///
/// # Errors
/// The first field that is missing, unknown, of the wrong type or out of its range.
pub fn from_value<T: DeserializeOwned>(value: Value) -> Result<T, FileError> {
    serde_path_to_error::deserialize(value).map_err(|error| FileError::Field {
        field: error.path().to_string(),
        reason: error.inner().to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_out_of_its_range_is_refused_in_words() {
        let refused = Positive::try_from(-1.0).unwrap_err().to_string();
        assert_eq!(refused, "the value -1 is not allowed; it must be above 0");
        assert!(BelowOne::try_from(1.0).is_err() && BelowOne::try_from(0.0).is_ok());
        assert!(InsideUnit::try_from(0.0).is_err() && NonNegative::try_from(0.0).is_ok());
        assert!(Finite::try_from(1e300).is_err());
        assert!(Positive::try_from(f64::NAN).is_err());
    }

    #[test]
    fn a_value_is_refused_with_its_place() {
        let read: Result<Vec<[Positive; 2]>, _> = from_value(serde_json::json!([[1, 2], [3, 0]]));
        let refused = read.unwrap_err().to_string();
        assert_eq!(
            refused,
            "field '[1][1]': the value 0 is not allowed; it must be above 0"
        );
    }
}
