//! One axis of a grid: `key=lo:hi:n`, `key=lo:hi:n:log` or `key=a,b,c`.

use serde::{Deserialize, Serialize};

/// Most values of an axis.
pub const MAX_VALUES: usize = 100_000;

/// One number of the file with the values it takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// The number's name: as the user gave it, or the full one.
    pub name: String,
    /// Its values, in the order in which they were given.
    pub values: Vec<f64>,
}

/// Why a text is no axis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AxisError {
    /// No `=`, or no values.
    #[error("'{text}' is not of the form key=lo:hi:n or key=a,b,c")]
    Form {
        /// The text.
        text: String,
    },
    /// Values that an axis cannot have.
    #[error("'{name}': {problem}")]
    Values {
        /// The axis.
        name: String,
        /// What is wrong with them.
        problem: ValuesError,
    },
}

/// Why an axis cannot have some values.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ValuesError {
    /// A part that is not a finite number.
    #[error("'{0}' is not a finite number")]
    Number(String),
    /// A count that is not allowed.
    #[error("'{0}' is not a number of points; it must be a whole number from 2 to {MAX_VALUES}")]
    Count(String),
    /// A range of no length: its ends.
    #[error("the range from {0} to {1} is empty; its ends must differ")]
    Empty(f64, f64),
    /// A logarithmic range that reaches zero: its ends.
    #[error("a logarithmic range needs both ends above 0; they are {0} and {1}")]
    Logarithm(f64, f64),
    /// The same value twice.
    #[error("the value {0} is given twice")]
    Twice(f64),
}

impl Axis {
    /// The axis that a text describes. Ranges include both ends.
    ///
    /// # Errors
    /// A text of another form, numbers that are not finite, an empty range, a value given twice.
    pub fn parse(text: &str) -> Result<Self, AxisError> {
        let form = || AxisError::Form {
            text: text.to_string(),
        };
        let (name, rest) = text.split_once('=').ok_or_else(form)?;
        let name = name.trim();
        if name.is_empty() || rest.trim().is_empty() {
            return Err(form());
        }
        let parts: Vec<&str> = rest.split(':').map(str::trim).collect();
        let values = match parts.as_slice() {
            [list] => list.split(',').map(number).collect(),
            [from, to, count] => range(from, to, count, false),
            [from, to, count, "log"] => range(from, to, count, true),
            _ => return Err(form()),
        };
        let name = name.to_string();
        match values.and_then(distinct) {
            Ok(values) => Ok(Axis { name, values }),
            Err(problem) => Err(AxisError::Values { name, problem }),
        }
    }
}

fn distinct(values: Vec<f64>) -> Result<Vec<f64>, ValuesError> {
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(ValuesError::Twice(pair[0])),
        None => Ok(values),
    }
}

fn number(part: &str) -> Result<f64, ValuesError> {
    let value = part
        .trim()
        .parse()
        .ok()
        .filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| ValuesError::Number(part.trim().to_string()))
}

fn range(from: &str, to: &str, count: &str, logarithmic: bool) -> Result<Vec<f64>, ValuesError> {
    let (from, to) = (number(from)?, number(to)?);
    let points = count.parse().ok();
    let points = points.filter(|points| (2..=MAX_VALUES).contains(points));
    let last = points.ok_or_else(|| ValuesError::Count(count.to_string()))? - 1;
    if from == to {
        return Err(ValuesError::Empty(from, to));
    }
    if logarithmic && !(from > 0.0 && to > 0.0) {
        return Err(ValuesError::Logarithm(from, to));
    }
    let at = |index: usize| {
        let fraction = index as f64 / last as f64;
        match index {
            0 => from,
            index if index == last => to,
            _ if logarithmic => rounded(from * (to / from).powf(fraction)),
            _ => rounded(from * (1.0 - fraction) + to * fraction),
        }
    };
    Ok((0..=last).map(at).collect())
}

/// Fifteen significant digits: 0.07 and not 0.06999999999999999.
fn rounded(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_a_range_are_those_that_one_would_write() {
        let values = |text: &str| Axis::parse(text).unwrap().values;
        assert_eq!(values("a=0.01:0.09:5"), [0.01, 0.03, 0.05, 0.07, 0.09]);
        assert_eq!(values("a=1e-6:1e-4:3:log"), [1e-6, 1e-5, 1e-4]);
        assert_eq!(values("a=-1:1:3"), [-1.0, 0.0, 1.0]);
    }
}
