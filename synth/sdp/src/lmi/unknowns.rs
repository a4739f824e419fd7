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
        let mut terms = Vec::with_capacity(side * side);
        for column in 0..side {
            for row in 0..=column {
                let unknown = self.next(format!("{name}[{row},{column}]"));
                terms.push((unknown, row, column, 1.0));
                if row != column {
                    terms.push((unknown, column, row, 1.0));
                }
            }
        }
        Affine::linear(side, side, terms)
    }

    /// A general matrix, `rows` x `columns`.
    pub fn general(&mut self, name: &str, rows: usize, columns: usize) -> Affine {
        let mut terms = Vec::with_capacity(rows * columns);
        for column in 0..columns {
            for row in 0..rows {
                let unknown = self.next(format!("{name}[{row},{column}]"));
                terms.push((unknown, row, column, 1.0));
            }
        }
        Affine::linear(rows, columns, terms)
    }

    /// A diagonal matrix, `side` x `side`.
    pub fn diagonal(&mut self, name: &str, side: usize) -> Affine {
        let mut terms = Vec::with_capacity(side);
        for index in 0..side {
            let unknown = self.next(format!("{name}[{index}]"));
            terms.push((unknown, index, index, 1.0));
        }
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
