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
    /// No `=`.
    #[error("'{text}' is not of the form key=lo:hi:n or key=a,b,c")]
    Form {
        /// The text.
        text: String,
    },
    /// A part that is not a finite number.
    #[error("'{name}': '{part}' is not a finite number")]
    Number {
        /// The axis.
        name: String,
        /// The part.
        part: String,
    },
    /// A count that is not allowed.
    #[error(
        "'{name}': '{part}' is not a number of points; it must be a whole number from 2 to {MAX_VALUES}"
    )]
    Count {
        /// The axis.
        name: String,
        /// The part.
        part: String,
    },
    /// A range of no length.
    #[error("'{name}': the range from {from} to {to} is empty; its ends must differ")]
    Empty {
        /// The axis.
        name: String,
        /// Start.
        from: f64,
        /// End.
        to: f64,
    },
    /// A logarithmic range that reaches zero.
    #[error("'{name}': a logarithmic range needs both ends above 0; they are {from} and {to}")]
    Logarithm {
        /// The axis.
        name: String,
        /// Start.
        from: f64,
        /// End.
        to: f64,
    },
    /// The same value twice.
    #[error("'{name}': the value {value} is given twice")]
    Twice {
        /// The axis.
        name: String,
        /// The value.
        value: f64,
    },
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
            [list] => list
                .split(',')
                .map(|part| number(name, part))
                .collect::<Result<_, _>>()?,
            [from, to, count] => range(name, (from, to), count, false)?,
            [from, to, count, "log"] => range(name, (from, to), count, true)?,
            _ => return Err(form()),
        };
        let axis = Axis {
            name: name.to_string(),
            values,
        };
        axis.check_distinct()?;
        Ok(axis)
    }

    fn check_distinct(&self) -> Result<(), AxisError> {
        let mut sorted = self.values.clone();
        sorted.sort_by(f64::total_cmp);
        let twice = sorted.windows(2).find(|pair| pair[0] == pair[1]);
        match twice {
            Some(pair) => Err(AxisError::Twice {
                name: self.name.clone(),
                value: pair[0],
            }),
            None => Ok(()),
        }
    }
}

fn number(name: &str, part: &str) -> Result<f64, AxisError> {
    let value = part.trim().parse::<f64>().ok();
    let finite = value.filter(|value| value.is_finite());
    finite.ok_or_else(|| AxisError::Number {
        name: name.to_string(),
        part: part.trim().to_string(),
    })
}

fn range(
    name: &str,
    (from, to): (&str, &str),
    count: &str,
    logarithmic: bool,
) -> Result<Vec<f64>, AxisError> {
    let (from, to) = (number(name, from)?, number(name, to)?);
    let points = count.parse::<usize>().ok();
    let points = points.filter(|points| (2..=MAX_VALUES).contains(points));
    let points = points.ok_or_else(|| AxisError::Count {
        name: name.to_string(),
        part: count.to_string(),
    })?;
    let name = || name.to_string();
    if from == to {
        return Err(AxisError::Empty {
            name: name(),
            from,
            to,
        });
    }
    if logarithmic && !(from > 0.0 && to > 0.0) {
        return Err(AxisError::Logarithm {
            name: name(),
            from,
            to,
        });
    }
    let last = points - 1;
    let at = |index: usize| {
        let fraction = index as f64 / last as f64;
        match index {
            0 => from,
            index if index == last => to,
            _ if logarithmic => rounded(from * (to / from).powf(fraction)),
            _ => rounded(from * (1.0 - fraction) + to * fraction),
        }
    };
    Ok((0..points).map(at).collect())
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
