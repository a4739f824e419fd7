//! Checks of controller parameters and their errors: which field, which value, which range is allowed.

use core::fmt;

use nalgebra::{SMatrix, SVector};
use thiserror::Error;

/// Where in a parameter the offending number is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// The parameter is a single number.
    Scalar,
    /// Component of a vector, counted from zero.
    Component(usize),
    /// Entry of a matrix, counted from zero.
    Entry {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
    },
    /// Entry of one matrix or vector of a list with one item per fuzzy rule, counted from zero.
    RuleEntry {
        /// Fuzzy rule.
        rule: usize,
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
    },
}

/// A parameter's name and the element of it that is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name of the parameter, as in the parameter structure.
    pub name: &'static str,
    /// Element of that parameter.
    pub element: Element,
}

impl Field {
    /// A parameter that is a single number.
    pub const fn scalar(name: &'static str) -> Self {
        Self::at(name, Element::Scalar)
    }

    /// A component of a vector parameter.
    pub const fn component(name: &'static str, index: usize) -> Self {
        Self::at(name, Element::Component(index))
    }

    /// An entry of a matrix parameter.
    pub const fn entry(name: &'static str, row: usize, column: usize) -> Self {
        Self::at(name, Element::Entry { row, column })
    }

    /// An element of a parameter.
    pub const fn at(name: &'static str, element: Element) -> Self {
        Self { name, element }
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.element {
            Element::Scalar => write!(f, "{}", self.name),
            Element::Component(index) => write!(f, "{}[{index}]", self.name),
            Element::Entry { row, column } => write!(f, "{}[{row}][{column}]", self.name),
            Element::RuleEntry { rule, row, column } => {
                write!(f, "{}[{rule}][{row}][{column}]", self.name)
            }
        }
    }
}

/// An interval of allowed values, each end open or closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AllowedRange {
    /// Lower end.
    pub lower: f64,
    /// True when the lower end itself is not allowed.
    pub lower_open: bool,
    /// Upper end; infinite when there is none.
    pub upper: f64,
    /// True when the upper end itself is not allowed.
    pub upper_open: bool,
}

impl AllowedRange {
    /// Strictly positive finite numbers.
    pub const POSITIVE: Self = Self::open(0.0, f64::INFINITY);
    /// Zero and the positive finite numbers.
    pub const NON_NEGATIVE: Self = Self::half_open(0.0, f64::INFINITY);

    /// Every finite number.
    pub(crate) const FINITE: Self = Self::open(f64::NEG_INFINITY, f64::INFINITY);

    /// The open interval `(lower, upper)`.
    pub const fn open(lower: f64, upper: f64) -> Self {
        Self::new(lower, true, upper, true)
    }

    /// The closed interval `[lower, upper]`.
    pub const fn closed(lower: f64, upper: f64) -> Self {
        Self::new(lower, false, upper, false)
    }

    /// The half-open interval `(lower, upper]`.
    pub const fn left_open(lower: f64, upper: f64) -> Self {
        Self::new(lower, true, upper, false)
    }

    /// The half-open interval `[lower, upper)`.
    pub const fn half_open(lower: f64, upper: f64) -> Self {
        Self::new(lower, false, upper, true)
    }

    const fn new(lower: f64, lower_open: bool, upper: f64, upper_open: bool) -> Self {
        Self {
            lower,
            lower_open,
            upper,
            upper_open,
        }
    }

    /// True when `value` lies in the range; false for a value that is not a number.
    pub fn contains(&self, value: f64) -> bool {
        let above = value > self.lower || (!self.lower_open && value == self.lower);
        let below = value < self.upper || (!self.upper_open && value == self.upper);
        above && below
    }

    /// Checks that the value of an element is finite and in the range.
    pub(crate) fn check(self, field: Field, value: f64) -> Result<(), ParameterError> {
        if !value.is_finite() {
            Err(ParameterError::NotFinite { field, value })
        } else if self.contains(value) {
            Ok(())
        } else {
            Err(ParameterError::OutOfRange {
                field,
                value,
                allowed: self,
            })
        }
    }

    /// Checks a parameter that is a single number.
    pub(crate) fn check_scalar(self, name: &'static str, value: f64) -> Result<(), ParameterError> {
        self.check(Field::scalar(name), value)
    }

    /// Checks every component of a vector.
    pub(crate) fn check_vector<const N: usize>(
        self,
        name: &'static str,
        vector: &SVector<f64, N>,
    ) -> Result<(), ParameterError> {
        self.check_entries(vector, |row, _| Field::component(name, row))
    }

    /// Checks every entry of a matrix, column by column; `field` names the one at (row, column).
    pub(crate) fn check_entries<const R: usize, const C: usize>(
        self,
        matrix: &SMatrix<f64, R, C>,
        field: impl Fn(usize, usize) -> Field,
    ) -> Result<(), ParameterError> {
        for (column, values) in matrix.data.0.iter().enumerate() {
            for (row, value) in values.iter().enumerate() {
                self.check(field(row, column), *value)?;
            }
        }
        Ok(())
    }

    /// Checks every entry of a list of matrices, one for each rule.
    pub(crate) fn check_rules<const R: usize, const C: usize>(
        self,
        name: &'static str,
        rules: &[SMatrix<f64, R, C>],
    ) -> Result<(), ParameterError> {
        rules.iter().enumerate().try_for_each(|(rule, matrix)| {
            self.check_entries(matrix, |row, column| {
                Field::at(name, Element::RuleEntry { rule, row, column })
            })
        })
    }
}

impl fmt::Display for AllowedRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let left = if self.lower_open { '(' } else { '[' };
        let right = if self.upper_open { ')' } else { ']' };
        write!(f, "{left}{}, {}{right}", self.lower, self.upper)
    }
}

/// Why a controller refused its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ParameterError {
    /// The value is infinite or not a number.
    #[error("{field} is {value}, not a finite number")]
    NotFinite {
        /// Offending parameter.
        field: Field,
        /// Its value.
        value: f64,
    },
    /// The value is outside of the range the control law allows.
    #[error("{field} is {value}, allowed is {allowed}")]
    OutOfRange {
        /// Offending parameter.
        field: Field,
        /// Its value.
        value: f64,
        /// Values that are allowed.
        allowed: AllowedRange,
    },
    /// A number that must be even is odd.
    #[error("{field} is {value}, not an even number")]
    NotEven {
        /// Offending parameter.
        field: Field,
        /// Its value.
        value: u32,
    },
    /// A lower bound is not below its upper bound (or, where equality is allowed, is above it).
    #[error("{field}: the interval from {lower} to {upper} contains nothing")]
    EmptyInterval {
        /// Offending parameter: the one that holds the lower bound.
        field: Field,
        /// The lower bound.
        lower: f64,
        /// The upper bound.
        upper: f64,
    },
    /// A matrix that must be symmetric is not.
    #[error("{field} is {value} and its mirror image {mirrored}: the matrix is not symmetric")]
    NotSymmetric {
        /// Offending entry (above the diagonal).
        field: Field,
        /// Its value.
        value: f64,
        /// The value of the mirrored entry.
        mirrored: f64,
    },
    /// A matrix that must be positive definite is not: elimination met a pivot that is not positive.
    #[error("{field}: the matrix is not positive definite, pivot {pivot}")]
    NotPositiveDefinite {
        /// The diagonal entry at which elimination stopped.
        field: Field,
        /// The pivot found there.
        pivot: f64,
    },
    /// A matrix that must have full row rank does not: some direction is out of its reach.
    #[error(
        "{field}: the matrix does not reach every direction, relative determinant {determinant}"
    )]
    RankDeficient {
        /// The matrix's first entry.
        field: Field,
        /// Determinant of the matrix times its transpose, relative to the cube of its mean diagonal.
        determinant: f64,
    },
}

/// Largest difference between mirrored entries of a symmetric matrix, relative to its largest entry.
pub const SYMMETRY_TOLERANCE: f64 = 1e-9;

/// Checks that a matrix is finite, symmetric up to [`SYMMETRY_TOLERANCE`] and positive definite.
pub(crate) fn require_positive_definite<const N: usize>(
    name: &'static str,
    matrix: &SMatrix<f64, N, N>,
) -> Result<(), ParameterError> {
    AllowedRange::FINITE.check_entries(matrix, |row, column| Field::entry(name, row, column))?;
    let columns = matrix.data.0;
    let rows = matrix.transpose().data.0;
    let entries = columns.iter().flatten();
    let largest = entries.fold(0.0_f64, |largest, value| largest.max(value.abs()));
    for (row, (above, below)) in rows.iter().zip(&columns).enumerate() {
        let pairs = above.iter().zip(below).enumerate().skip(row + 1);
        for (column, (&value, &mirrored)) in pairs {
            if (value - mirrored).abs() > SYMMETRY_TOLERANCE * largest {
                return Err(ParameterError::NotSymmetric {
                    field: Field::entry(name, row, column),
                    value,
                    mirrored,
                });
            }
        }
    }
    check_pivots(name, columns)
}

/// Gaussian elimination of a symmetric matrix; every pivot must be positive.
fn check_pivots<const N: usize>(
    name: &'static str,
    mut columns: [[f64; N]; N],
) -> Result<(), ParameterError> {
    for k in 0..N {
        let eliminated = columns[k];
        let pivot = eliminated[k];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return Err(ParameterError::NotPositiveDefinite {
                field: Field::entry(name, k, k),
                pivot,
            });
        }
        for column in columns.iter_mut().skip(k + 1) {
            let ratio = column[k] / pivot;
            for (value, entry) in column.iter_mut().zip(&eliminated).skip(k + 1) {
                *value -= ratio * entry;
            }
        }
    }
    Ok(())
}
