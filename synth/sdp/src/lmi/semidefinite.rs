//! The lowered form that backends and file writers read.

use nalgebra::DMatrix;

use super::affine::{Affine, Entries};
use super::LmiProblem;

/// One entry of a symmetric matrix: row <= column, counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Row, from 0.
    pub row: usize,
    /// Column, not less than the row.
    pub column: usize,
    /// Value of the entry itself (no factor sqrt(2)).
    pub value: f64,
}

impl Entry {
    /// The entry at (row, column), or at (column, row) where that is above the diagonal.
    pub fn new(row: usize, column: usize, value: f64) -> Self {
        Entry {
            row: row.min(column),
            column: row.max(column),
            value,
        }
    }

    /// How often it stands in the full matrix.
    pub fn count(&self) -> f64 {
        if self.row == self.column {
            1.0
        } else {
            2.0
        }
    }
}

/// `<F, Z>` for the upper triangle of F and a symmetric Z, given by its entry at (row, column).
pub fn inner(entries: &[Entry], z: impl Fn(usize, usize) -> f64) -> f64 {
    let terms = entries
        .iter()
        .map(|e| e.count() * e.value * z(e.row, e.column));
    terms.sum()
}

/// `constant + sum_i y_i coefficient_i >= 0`, symmetric of the given side.
#[derive(Debug, Clone)]
pub struct Cone {
    /// Name of the condition.
    pub name: String,
    /// Side of the matrix.
    pub side: usize,
    /// Upper triangle of the constant matrix.
    pub constant: Vec<Entry>,
    /// (unknown, upper triangle of its coefficient), unknowns ascending, none empty.
    pub coefficients: Vec<(usize, Vec<Entry>)>,
}

impl Cone {
    /// Entries of its stacked upper triangle, in the order of [`svec_index`].
    pub fn height(&self) -> usize {
        self.side.saturating_mul(self.side + 1) / 2
    }
}

/// `minimise cost' y + offset` subject to every cone's matrix being positive semidefinite.
#[derive(Debug, Clone)]
pub struct Semidefinite {
    /// Cost of each scalar unknown; its length is the number of unknowns.
    pub cost: Vec<f64>,
    /// Constant part of the objective.
    pub offset: f64,
    /// The cones, in the order of the problem's conditions.
    pub cones: Vec<Cone>,
}

impl Semidefinite {
    /// Side of the widest cone; 0 without cones.
    pub fn widest(&self) -> usize {
        self.cones.iter().map(|cone| cone.side).max().unwrap_or(0)
    }
}

/// Place of entry (row, column), or of its mirror image, in the stacked upper triangle read by columns
/// (`svec`): column (column + 1) / 2 + row where row <= column. Off-diagonal entries are stored times
/// sqrt(2) there.
pub fn svec_index(row: usize, column: usize) -> usize {
    let (row, column) = (row.min(column), row.max(column));
    column * (column + 1) / 2 + row
}

/// `<F, Z>` of a symmetric matrix F, given by its upper entries, and a dual matrix Z.
pub fn inner_product(entries: &[Entry], dual: &[f64]) -> f64 {
    inner(entries, |row, column| dual[svec_index(row, column)])
}

/// The trace of a dual matrix.
pub fn dual_trace(side: usize, dual: &[f64]) -> f64 {
    (0..side).map(|k| dual[svec_index(k, k)]).sum()
}

/// A dual matrix in full.
pub fn dual_matrix(side: usize, dual: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(side, side, |r, c| dual[svec_index(r.min(c), r.max(c))])
}

impl LmiProblem {
    /// Lowers the problem to lists of entries.
    pub fn lower(&self) -> Semidefinite {
        let mut cost = vec![0.0; self.unknowns.count()];
        for (&unknown, entries) in &self.objective.coefficients {
            cost[unknown] = entries.values().sum();
        }
        let offset = self.objective.constant.values().sum();
        let cones = self.conditions.iter().map(|condition| {
            let expression = condition.expression();
            Cone {
                name: condition.name().to_string(),
                side: condition.side(),
                constant: upper(&expression.constant),
                coefficients: coefficients(expression),
            }
        });
        Semidefinite {
            cost,
            offset,
            cones: cones.collect(),
        }
    }
}

fn coefficients(expression: &Affine) -> Vec<(usize, Vec<Entry>)> {
    let lowered = expression.coefficients.iter();
    lowered
        .map(|(&unknown, entries)| (unknown, upper(entries)))
        .filter(|(_, entries)| !entries.is_empty())
        .collect()
}

fn upper(entries: &Entries) -> Vec<Entry> {
    entries
        .iter()
        .filter(|((row, column), _)| row <= column)
        .map(|(&(row, column), &value)| Entry { row, column, value })
        .collect()
}
