//! The product of axes.

use serde_json::Value;

use super::axis::Axis;
use super::parameter::{ParameterError, VariedNumber};

/// Most points of a grid.
pub const MAX_POINTS: usize = 1_000_000;

/// A grid over numbers of a file. The last axis changes fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Its axes.
    pub axes: Vec<GridAxis>,
    points: usize,
}

/// A number of the file with its values.
#[derive(Debug, Clone, PartialEq)]
pub struct GridAxis {
    /// The number.
    pub parameter: VariedNumber,
    /// Its values.
    pub values: Vec<f64>,
}

/// Why axes make no grid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GridError {
    /// An axis is no number of the file, or takes a value that the number cannot have.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Two axes are the same number.
    #[error("'{name}' is varied twice")]
    Twice {
        /// The number.
        name: String,
    },
    /// More points than anyone waits for.
    #[error("the grid has {points} points; at most {MAX_POINTS} are allowed")]
    TooLarge {
        /// Their number.
        points: String,
    },
    /// No axis.
    #[error("nothing is varied; give --vary key=lo:hi:n or --vary key=a,b,c")]
    NoAxis,
}

impl Grid {
    /// The grid of some axes over a file.
    ///
    /// # Errors
    /// A name that is no number of the file, an axis given twice, too many points.
    pub fn new(file: &Value, axes: &[Axis]) -> Result<Self, GridError> {
        let mut known: Vec<GridAxis> = Vec::new();
        for axis in axes {
            let parameter = VariedNumber::find(file, &axis.name)?;
            if known
                .iter()
                .any(|other| other.parameter.overlaps(&parameter))
            {
                return Err(GridError::Twice {
                    name: parameter.name,
                });
            }
            let mut trial = file.clone();
            for &value in &axis.values {
                parameter.set(&mut trial, value)?;
            }
            let values = axis.values.clone();
            known.push(GridAxis { parameter, values });
        }
        if known.is_empty() {
            return Err(GridError::NoAxis);
        }
        let sizes = known.iter().map(|axis| axis.values.len());
        let points = sizes.clone().try_fold(1usize, usize::checked_mul);
        match points.filter(|&points| points <= MAX_POINTS) {
            Some(points) => Ok(Grid {
                axes: known,
                points,
            }),
            None => Err(GridError::TooLarge {
                points: sizes.map(|n| n.to_string()).collect::<Vec<_>>().join(" x "),
            }),
        }
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.points
    }

    /// Full names of the numbers that are varied.
    pub fn names(&self) -> Vec<String> {
        let names = self.axes().map(|(name, _)| name.to_string());
        names.collect()
    }

    /// The axes: name and values.
    pub fn axes(&self) -> impl DoubleEndedIterator<Item = (&str, &[f64])> {
        let axes = self.axes.iter();
        axes.map(|axis| (axis.parameter.name.as_str(), axis.values.as_slice()))
    }

    /// Values of a point, in the order of the axes; `index` counts from 0.
    pub fn point(&self, index: usize) -> Vec<f64> {
        let mut rest = index;
        let mut values: Vec<f64> = Vec::with_capacity(self.axes.len());
        for (_, axis) in self.axes().rev() {
            values.push(axis[rest % axis.len()]);
            rest /= axis.len();
        }
        values.reverse();
        values
    }

    /// The file with a point's values.
    ///
    /// # Errors
    /// A value that is not whole where the file needs a whole number.
    pub fn apply(&self, file: &Value, values: &[f64]) -> Result<Value, ParameterError> {
        let mut variant = file.clone();
        for (axis, &value) in self.axes.iter().zip(values) {
            axis.parameter.set(&mut variant, value)?;
        }
        Ok(variant)
    }
}
