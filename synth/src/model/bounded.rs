//! Numbers and matrices of files that carry their range: it is checked when they are read, and stands in the schema.
//!
//! A field may have such a type, or the plain one with the file's form beside it: `#[serde(with = "As::<Positive>")]` on
//! a field of type `f64`.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use nalgebra::DMatrix;
use schemars::{json_schema, JsonSchema, Schema, SchemaGenerator};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

use super::error::{readable, FileError, ModelError};
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

/// Files hold no numbers below this but 0.
const SMALLEST: f64 = 1e-30;

/// What [`finite`] allows, in words.
const MAGNITUDE: &str = "0 or a number of magnitude 1e-30 to 1e30";

/// Whether the square of the number neither overflows nor vanishes.
fn moderate(value: f64) -> bool {
    finite("", value).is_ok()
}

/// Whether it is a number at all.
fn any(value: f64) -> bool {
    value.is_finite()
}

/// Makes types of numbers in a range: the type, the range in words, which sizes are taken, the test, and the keys that
/// the schema has for it.
macro_rules! bounded {
    ($($(#[$doc:meta])+ $name:ident $words:literal $size:ident $ok:expr, $schema:tt;)+) => {$(
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
                match (ok(value), $size(value)) {
                    (false, _) => refuse($words),
                    (true, false) => refuse(MAGNITUDE),
                    (true, true) => Ok(Self(value)),
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

        impl FileForm for $name {
            type Plain = f64;

            fn plain(self) -> f64 {
                self.0
            }

            /// Numbers too small to be allowed in a file are written as 0.
            fn of(plain: &f64) -> Self {
                match plain.abs() < SMALLEST && !$size(*plain) {
                    true => Self(0.0),
                    false => Self(*plain),
                }
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
    Finite "a finite number" moderate |value| !value.is_nan(),
        { "type": "number", "format": "double" };
    /// A number above 0.
    Positive "above 0" moderate |value| value > 0.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0 };
    /// A number that is 0 or above.
    NonNegative "0 or above" moderate |value| value >= 0.0,
        { "type": "number", "format": "double", "minimum": 0 };
    /// Any number of any size.
    AnyFinite "a finite number" any |value| !value.is_nan(),
        { "type": "number", "format": "double" };
    /// A number above 0 of any size: a large one stands for no limit.
    AnyPositive "above 0" any |value| value > 0.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0 };
    /// A number of any size that is 0 or above.
    AnyNonNegative "0 or above" any |value| value >= 0.0,
        { "type": "number", "format": "double", "minimum": 0 };
    /// A number in [0, 1).
    BelowOne "in [0, 1)" any |value| (0.0..1.0).contains(&value),
        { "type": "number", "format": "double", "minimum": 0, "exclusiveMaximum": 1 };
    /// A number in (0, 1).
    InsideUnit "in (0, 1)" any |value| value > 0.0 && value < 1.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0, "exclusiveMaximum": 1 };
    /// A number in (0, 1].
    UpToOne "in (0, 1]" any |value| value > 0.0 && value <= 1.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0, "maximum": 1 };
    /// The size of a part over that of the whole.
    Ratio "above 0 and at most 1" any |value| value > 0.0 && value <= 1.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0, "maximum": 1 };
    /// The shortest sampling interval, for the part of its range that does not depend on the longest one.
    ShortestInterval "above 0 and at most hbar_s" any |value| value > 0.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0 };
    /// The length of the end of a run, for the part of its range that does not depend on the run's.
    Tail "above 0 and at most duration_s" any |value| value > 0.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0 };
    /// A number in [0, 1].
    Unit "in [0, 1]" any |value| (0.0..=1.0).contains(&value),
        { "type": "number", "format": "double", "minimum": 0, "maximum": 1 };
    /// A percentage, in [0, 100].
    Percent "in [0, 100]" any |value| (0.0..=100.0).contains(&value),
        { "type": "number", "format": "double", "minimum": 0, "maximum": 100 };
    /// The margin of strict inequalities, in (0, 0.01].
    Margin "in (0, 0.01]" any |value| value > 0.0 && value <= 0.01,
        { "type": "number", "format": "double", "exclusiveMinimum": 0, "maximum": 0.01 };
    /// A number that is 1 or above.
    AtLeastOne "1 or above" moderate |value| value >= 1.0,
        { "type": "number", "format": "double", "minimum": 1 };
    /// A number in (1, 2).
    OneToTwo "in (1, 2)" any |value| value > 1.0 && value < 2.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 1, "exclusiveMaximum": 2 };
    /// A relative tolerance of an integrator.
    Tolerance "in [1e-14, 0.001]" any |value| (1e-14..=1e-3).contains(&value),
        { "type": "number", "format": "double", "minimum": 1e-14, "maximum": 0.001 };
    /// The resolution of a root in time, s.
    Resolution "at least 1e-9" any |value| value >= 1e-9,
        { "type": "number", "format": "double", "minimum": 1e-9 };
    /// An angle up to half a turn, deg.
    HalfTurn "above 0 and at most 180" any |value| value > 0.0 && value <= 180.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0, "maximum": 180 };
    /// An angle in (0, 180) degrees.
    AngleDeg "in (0, 180)" any |value| value > 0.0 && value < 180.0,
        { "type": "number", "format": "double", "exclusiveMinimum": 0, "exclusiveMaximum": 180 };
}

/// Zero, for those ranges that hold it.
macro_rules! zero_by_default {
    ($($name:ident)+) => {$(
        impl Default for $name {
            fn default() -> Self {
                Self(0.0)
            }
        }
    )+};
}

zero_by_default! { Finite NonNegative BelowOne }

/// What a file holds in the place of a plain value.
pub trait FileForm: Sized {
    /// What the program computes with.
    type Plain;

    /// The value of a form that was read.
    fn plain(self) -> Self::Plain;

    /// The form of a value, to be written.
    fn of(plain: &Self::Plain) -> Self;
}

impl<F: FileForm> FileForm for Option<F> {
    type Plain = Option<F::Plain>;

    fn plain(self) -> Self::Plain {
        self.map(F::plain)
    }

    fn of(plain: &Self::Plain) -> Self {
        plain.as_ref().map(F::of)
    }
}

impl<F: FileForm> FileForm for Vec<F> {
    type Plain = Vec<F::Plain>;

    fn plain(self) -> Self::Plain {
        self.into_iter().map(F::plain).collect()
    }

    fn of(plain: &Self::Plain) -> Self {
        plain.iter().map(F::of).collect()
    }
}

impl<F: FileForm, const N: usize> FileForm for [F; N] {
    type Plain = [F::Plain; N];

    fn plain(self) -> Self::Plain {
        self.map(F::plain)
    }

    fn of(plain: &Self::Plain) -> Self {
        plain.each_ref().map(F::of)
    }
}

/// A matrix as a list of rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Vec<Finite>>", into = "Vec<Vec<Finite>>")]
pub struct Rows(DMatrix<f64>);

/// A row of a matrix that is not as long as the first one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("row 1 has {expected} entries and row {row} has {found}; all rows of a matrix must have the same length")]
pub struct Ragged {
    /// Number of the row, from 1.
    pub row: usize,
    /// Its length.
    pub found: usize,
    /// That of the first row.
    pub expected: usize,
}

impl TryFrom<Vec<Vec<Finite>>> for Rows {
    type Error = Ragged;

    fn try_from(rows: Vec<Vec<Finite>>) -> Result<Self, Ragged> {
        let expected = rows.first().map_or(0, Vec::len);
        let ragged = rows.iter().position(|row| row.len() != expected);
        if let Some(index) = ragged {
            return Err(Ragged {
                row: index + 1,
                found: rows[index].len(),
                expected,
            });
        }
        let matrix = DMatrix::from_fn(rows.len(), expected, |r, c| rows[r][c].get());
        Ok(Rows(matrix))
    }
}

impl From<Rows> for Vec<Vec<Finite>> {
    fn from(Rows(matrix): Rows) -> Self {
        let rows = matrix.row_iter();
        rows.map(|row| row.iter().map(Finite::of).collect())
            .collect()
    }
}

impl FileForm for Rows {
    type Plain = DMatrix<f64>;

    fn plain(self) -> Self::Plain {
        self.0
    }

    fn of(plain: &Self::Plain) -> Self {
        Rows(plain.clone())
    }
}

impl JsonSchema for Rows {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Rows".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Vec::<Vec<Finite>>::json_schema(generator)
    }
}

/// Reads and writes a field of a plain type in its form `F`: `#[serde(with = "As::<F>")]`. It takes part in the
/// schema, too.
pub struct As<F>(PhantomData<F>);

impl<F: FileForm> As<F> {
    /// Writes the value in its form.
    ///
    /// # Errors
    /// Those of the serializer.
    pub fn serialize<S: Serializer>(plain: &F::Plain, serializer: S) -> Result<S::Ok, S::Error>
    where
        F: Serialize,
    {
        F::of(plain).serialize(serializer)
    }

    /// Reads the form and checks its range.
    ///
    /// # Errors
    /// A value of another type or out of its range.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<F::Plain, D::Error>
    where
        F: Deserialize<'de>,
    {
        F::deserialize(deserializer).map(F::plain)
    }
}

impl<F: JsonSchema> JsonSchema for As<F> {
    fn inline_schema() -> bool {
        F::inline_schema()
    }

    fn schema_name() -> Cow<'static, str> {
        F::schema_name()
    }

    fn schema_id() -> Cow<'static, str> {
        F::schema_id()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        F::json_schema(generator)
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

/// A document that was put together by the program, with every number checked as if it was read.
///
/// # Errors
/// The first number that is out of its range.
pub fn within_ranges<T: DeserializeOwned + Serialize>(document: &T) -> Result<T, ModelError> {
    let checked = serde_json::to_value(document).map(serde_path_to_error::deserialize::<_, T>);
    match checked {
        Ok(Ok(document)) => Ok(document),
        Ok(Err(error)) => Err(ModelError::choice(
            error.path().to_string(),
            error.inner().to_string(),
        )),
        Err(error) => Err(ModelError::choice("(top level)", error.to_string())),
    }
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
