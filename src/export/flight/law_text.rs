//! What the C text of each published law has of its own.

use nalgebra::{SMatrix, Vector3};

use super::source::{Constant, Sending};
use crate::export::quantity::{Numbers, Quantity};

/// What each law's text has of its own.
pub struct LawText {
    /// The fields of the controller's structure.
    pub fields: &'static str,
    /// Further types and functions of the header.
    pub further: [&'static str; 2],
    /// Its numbers.
    pub constants: Vec<Constant>,
    /// Its whole numbers.
    pub counts: Vec<(&'static str, usize)>,
    /// The parts of its text, in order.
    pub parts: Vec<&'static str>,
    /// When its command is sent.
    pub sending: Sending,
    /// Functions of the C library whose last bits are not prescribed.
    pub library: Vec<&'static str>,
    /// Doubles that the controller's structure fits into.
    pub words: usize,
    /// Whether it is given the fault that acts, which it does not estimate.
    pub given_fault: bool,
    /// The same law in the language of MATLAB, to read.
    pub in_matlab: Option<&'static str>,
}

/// A number of the source.
pub(super) fn number(
    variable: &'static str,
    unit: &'static str,
    meaning: &str,
    value: f64,
) -> Constant {
    list(variable, unit, meaning, &value)
}

/// A number for each axis.
pub(super) fn vector(
    variable: &'static str,
    unit: &'static str,
    meaning: &str,
    values: &Vector3<f64>,
) -> Constant {
    list(variable, unit, meaning, values.as_slice())
}

/// Numbers of the source.
pub(super) fn list<T: Numbers + ?Sized>(
    variable: &'static str,
    unit: &'static str,
    meaning: &str,
    values: &T,
) -> Constant {
    Constant {
        variable,
        numbers: Quantity::new(variable, unit, values).means(meaning),
    }
}

/// The rows of a matrix.
pub(super) fn rows<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> Vec<Vec<f64>> {
    let row = |row: usize| (0..C).map(|column| matrix[(row, column)]).collect();
    (0..R).map(row).collect()
}
