//! What can be wrong with a file.

use std::fmt;

/// The kinds of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A model file.
    Model,
    /// A design file.
    Design,
    /// A scenario file.
    Scenario,
    /// An infeasibility certificate.
    Infeasibility,
    /// A problem file: a model file with a `problem` in place of `specs`.
    Problem,
    /// The design file of a problem.
    ProblemDesign,
    /// A gains file.
    Gains,
    /// A requirements file of the parameter search.
    Requirements,
    /// The summary of a run.
    Summary,
}

impl Kind {
    /// Its name with the article, such as `an infeasibility`.
    pub fn with_article(self) -> String {
        let article = match self {
            Kind::Infeasibility => "an",
            _ => "a",
        };
        format!("{article} {self}")
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Kind::Model => "model",
            Kind::Design => "design",
            Kind::Scenario => "scenario",
            Kind::Infeasibility => "infeasibility",
            Kind::Problem => "problem",
            Kind::ProblemDesign => "problem design",
            Kind::Gains => "gains",
            Kind::Requirements => "requirements",
            Kind::Summary => "summary",
        })
    }
}

/// Why a file could not be used. The file's name is added by whoever reports it.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file could not be read or written.
    #[error("{action}: {source}")]
    Io {
        /// What was tried.
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file is larger than any sensible input.
    #[error("the file has {bytes} bytes or more; at most {limit} bytes are read")]
    TooLarge {
        /// Size of the file, as far as it is known.
        bytes: u64,
        /// Largest size.
        limit: u64,
    },
    /// The file is not text.
    #[error("the file is not UTF-8 text (byte {position})")]
    NotText {
        /// Where it stops being text.
        position: usize,
    },
    /// The file starts with a byte order mark.
    #[error("the file starts with a byte order mark; it must be UTF-8 text without one")]
    ByteOrderMark,
    /// The file is not JSON.
    #[error("not JSON: {reason}")]
    NotJson {
        /// The parser's words, with line and column.
        reason: String,
    },
    /// The file is JSON, but a field is missing, unknown or of the wrong type.
    #[error("field '{field}': {reason}")]
    Field {
        /// Path of the field.
        field: String,
        /// What is wrong, with the allowed names or types.
        reason: String,
    },
    /// The file is of another kind.
    #[error("this is {} file; {} file is expected here", found.with_article(), expected.with_article())]
    WrongKind {
        /// What it is.
        found: Kind,
        /// What is needed.
        expected: Kind,
    },
    /// A value is not allowed.
    #[error(transparent)]
    Value(#[from] ModelError),
}

/// A value that is not allowed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// A number is outside its range.
    #[error("field '{field}': the value {} is not allowed; it must be {allowed}", readable(*value))]
    OutOfRange {
        /// Path of the field.
        field: String,
        /// The number.
        value: f64,
        /// The allowed range in words.
        allowed: String,
    },
    /// A list or matrix has the wrong size, or something else stands where it should.
    #[error("field '{field}': found {found}, expected {expected}")]
    WrongShape {
        /// Path of the field.
        field: String,
        /// The size found.
        found: String,
        /// The size needed.
        expected: String,
    },
    /// A matrix is not symmetric.
    #[error(
        "field '{field}': entry ({row}, {column}) is {value} but entry ({column}, {row}) is \
         {mirrored}; the matrix must be symmetric"
    )]
    NotSymmetric {
        /// Path of the field.
        field: String,
        /// Row, from 1.
        row: usize,
        /// Column, from 1.
        column: usize,
        /// Entry at (row, column).
        value: f64,
        /// Entry at (column, row).
        mirrored: f64,
    },
    /// A matrix is not positive definite.
    #[error(
        "field '{field}': the smallest eigenvalue is {smallest}; the matrix must be positive \
         definite (every eigenvalue above 0)"
    )]
    NotPositiveDefinite {
        /// Path of the field.
        field: String,
        /// Its smallest eigenvalue.
        smallest: f64,
    },
    /// A text holds a character that it must not.
    #[error(
        "field '{field}': character {position} is the control character {character:?}; the text \
         must be on one line and hold none"
    )]
    ControlCharacter {
        /// Path of the field.
        field: String,
        /// Its position, from 1.
        position: usize,
        /// The character.
        character: char,
    },
    /// A point of the box at which every rule has weight 0.
    #[error(
        "field '{field}': at the state {point:?}, which is in the box, every rule has weight 0; the \
         memberships must leave no point of the box without a rule"
    )]
    Uncovered {
        /// Path of the field.
        field: String,
        /// The point.
        point: Vec<f64>,
    },
    /// A choice that does not go with another one.
    #[error("field '{field}': {reason}")]
    Choice {
        /// Path of the field.
        field: String,
        /// Why, and what is possible.
        reason: String,
    },
    /// The format version is unknown.
    #[error("field 'schema_version': the value {found} is not allowed; it must be {expected}")]
    SchemaVersion {
        /// Version in the file.
        found: u32,
        /// Version this program reads.
        expected: u32,
    },
}

impl ModelError {
    /// The path of the field, where the error has one that can move.
    pub fn field_mut(&mut self) -> Option<&mut String> {
        match self {
            ModelError::OutOfRange { field, .. }
            | ModelError::WrongShape { field, .. }
            | ModelError::NotSymmetric { field, .. }
            | ModelError::NotPositiveDefinite { field, .. }
            | ModelError::ControlCharacter { field, .. }
            | ModelError::Uncovered { field, .. }
            | ModelError::Choice { field, .. } => Some(field),
            ModelError::SchemaVersion { .. } => None,
        }
    }

    /// The same error with the field's path inside a larger file.
    pub fn within(mut self, parent: &str) -> Self {
        if let Some(field) = self.field_mut() {
            *field = format!("{parent}.{field}");
        }
        self
    }

    /// A number outside its range.
    pub fn range(field: impl Into<String>, value: f64, allowed: impl Into<String>) -> Self {
        let (field, allowed) = (field.into(), allowed.into());
        ModelError::OutOfRange {
            field,
            value,
            allowed,
        }
    }

    /// A choice that does not go with another one.
    pub fn choice(field: impl Into<String>, reason: impl Into<String>) -> Self {
        let (field, reason) = (field.into(), reason.into());
        ModelError::Choice { field, reason }
    }

    /// A list or matrix of the wrong size.
    pub fn shape(
        field: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        let (field, found, expected) = (field.into(), found.into(), expected.into());
        ModelError::WrongShape {
            field,
            found,
            expected,
        }
    }
}

/// A number in few characters that reads back as the same number.
pub fn readable(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (1e-4..1e9).contains(&magnitude) || !value.is_finite() {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// The kind that a file claims to be, from keys that only this kind has; `None` when it is none of them. Whether
/// it is a valid file of this kind, only its reader says.
pub fn kind_of(text: &str) -> Option<Kind> {
    let value: serde_json::Value = serde_json::from_str(text).ok()?;
    let keys = value.as_object()?;
    let asks = |value: &serde_json::Value| value.get("problem").is_some();
    let is_empty = |value: &serde_json::Value| value.as_object().is_none_or(|own| own.is_empty());
    if ["scenario", "verdict", "scales"]
        .iter()
        .all(|key| keys.contains_key(*key))
    {
        // A summary has a certificate, too.
        Some(Kind::Summary)
    } else if keys.contains_key("infeasibility") {
        Some(Kind::Infeasibility)
    } else if keys.contains_key("certificate") {
        match keys.get("model").is_some_and(asks) {
            true => Some(Kind::ProblemDesign),
            false => Some(Kind::Design),
        }
    } else if keys.contains_key("duration_s") {
        Some(Kind::Scenario)
    } else if asks(&value) && !(keys.contains_key("specs") && is_empty(&value["problem"])) {
        Some(Kind::Problem)
    } else if keys.contains_key("manoeuvre") {
        Some(Kind::Requirements)
    } else if keys.contains_key("specs") {
        Some(Kind::Model)
    } else if keys.get("gains").is_some_and(serde_json::Value::is_array) {
        Some(Kind::Gains)
    } else {
        None
    }
}
