//! The unknowns of a problem.

use super::Affine;

/// Hands out matrix unknowns and numbers their scalar entries in the order of creation.
#[derive(Debug, Clone, Default)]
pub struct Unknowns {
    names: Vec<String>,
}

impl Unknowns {
    /// No unknowns yet.
    pub fn new() -> Self {
        Unknowns::default()
    }

    /// Number of scalar unknowns so far.
    pub fn count(&self) -> usize {
        self.names.len()
    }

    /// Names of the scalar unknowns, such as `Uh[0,1]`.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// A symmetric matrix, `side` x `side`: side (side + 1) / 2 scalar unknowns.
    pub fn symmetric(&mut self, name: &str, side: usize) -> Affine {
        self.matrix(name, side, side, true)
    }

    /// A general matrix, `rows` x `columns`.
    pub fn general(&mut self, name: &str, rows: usize, columns: usize) -> Affine {
        self.matrix(name, rows, columns, false)
    }

    /// By columns; of a symmetric matrix only the upper triangle is numbered.
    fn matrix(&mut self, name: &str, rows: usize, columns: usize, symmetric: bool) -> Affine {
        let mut terms = Vec::with_capacity(rows * columns);
        for column in 0..columns {
            let end = if symmetric { column + 1 } else { rows };
            for row in 0..end {
                let unknown = self.next(format!("{name}[{row},{column}]"));
                terms.push((unknown, row, column, 1.0));
                if symmetric && row != column {
                    terms.push((unknown, column, row, 1.0));
                }
            }
        }
        Affine::linear(rows, columns, terms)
    }

    /// A diagonal matrix, `side` x `side`.
    pub fn diagonal(&mut self, name: &str, side: usize) -> Affine {
        let terms = (0..side).map(|k| (self.next(format!("{name}[{k}]")), k, k, 1.0));
        Affine::linear(side, side, terms)
    }

    /// A scalar, as a 1 x 1 matrix.
    pub fn scalar(&mut self, name: &str) -> Affine {
        let unknown = self.next(name.to_string());
        Affine::linear(1, 1, [(unknown, 0, 0, 1.0)])
    }

    fn next(&mut self, name: String) -> usize {
        self.names.push(name);
        self.names.len() - 1
    }
}
