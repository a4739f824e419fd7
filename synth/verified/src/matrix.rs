//! Small dense matrices over a [`Scalar`].

use nalgebra::DMatrix;

use crate::interval::Interval;
use crate::rounding::add_up;
use crate::scalar::Scalar;

/// A dense matrix, stored row by row. Operators panic when shapes do not fit, as nalgebra's do.
#[derive(Debug, Clone)]
pub struct Matrix<S> {
    rows: usize,
    columns: usize,
    entries: Vec<S>,
}

impl<S: Scalar> Matrix<S> {
    /// Entry by entry.
    pub fn from_fn(rows: usize, columns: usize, mut entry: impl FnMut(usize, usize) -> S) -> Self {
        let mut entries = Vec::with_capacity(rows * columns);
        for row in 0..rows {
            for column in 0..columns {
                entries.push(entry(row, column));
            }
        }
        Matrix {
            rows,
            columns,
            entries,
        }
    }

    /// The doubles themselves, without rounding.
    pub fn exactly(matrix: &DMatrix<f64>) -> Self {
        Matrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
            S::from_f64(matrix[(r, c)])
        })
    }

    /// Zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Matrix::from_fn(rows, columns, |_, _| S::zero())
    }

    /// A multiple of the identity.
    pub fn identity(side: usize, value: S) -> Self {
        Matrix::from_fn(
            side,
            side,
            |r, c| if r == c { value.clone() } else { S::zero() },
        )
    }

    /// Number of rows.
    pub fn nrows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn ncols(&self) -> usize {
        self.columns
    }

    /// One entry.
    pub fn at(&self, row: usize, column: usize) -> &S {
        &self.entries[row * self.columns + column]
    }

    /// All entries, row by row.
    pub fn entries(&self) -> &[S] {
        &self.entries
    }

    /// Replaces one entry.
    pub fn set(&mut self, row: usize, column: usize, value: S) {
        self.entries[row * self.columns + column] = value;
    }

    /// The transpose.
    pub fn transposed(&self) -> Self {
        Matrix::from_fn(self.columns, self.rows, |r, c| self.at(c, r).clone())
    }

    /// `X + X'`.
    pub fn symmetrised(&self) -> Self {
        self.plus(&self.transposed())
    }

    /// One row, as a 1 x n matrix.
    pub fn row(&self, row: usize) -> Self {
        self.block(row, 0, 1, self.columns)
    }

    /// Rows `row..row + rows` and columns `column..column + columns`.
    pub fn block(&self, row: usize, column: usize, rows: usize, columns: usize) -> Self {
        Matrix::from_fn(rows, columns, |r, c| self.at(row + r, column + c).clone())
    }

    /// Sum of the diagonal.
    pub fn trace(&self) -> S {
        (0..self.rows.min(self.columns)).fold(S::zero(), |sum, k| sum + self.at(k, k).clone())
    }

    /// Sum.
    pub fn plus(&self, other: &Self) -> Self {
        self.with(other, |a, b| a + b)
    }

    /// Difference.
    pub fn minus(&self, other: &Self) -> Self {
        self.with(other, |a, b| a - b)
    }

    /// Negative.
    pub fn negated(&self) -> Self {
        Matrix::from_fn(self.rows, self.columns, |r, c| -self.at(r, c).clone())
    }

    /// Multiple.
    pub fn scaled(&self, factor: &S) -> Self {
        Matrix::from_fn(self.rows, self.columns, |r, c| {
            factor.clone() * self.at(r, c).clone()
        })
    }

    /// Product.
    pub fn times(&self, other: &Self) -> Self {
        assert_eq!(self.columns, other.rows, "inner sizes must agree");
        Matrix::from_fn(self.rows, other.columns, |r, c| {
            (0..self.columns).fold(S::zero(), |sum, k| {
                sum + self.at(r, k).clone() * other.at(k, c).clone()
            })
        })
    }

    /// A symmetric matrix from its blocks on and above the diagonal, one list for each row of blocks, each beginning with
    /// the block on the diagonal. Of that only the part on and above the diagonal is read.
    ///
    /// # Panics
    /// When the shapes do not fit.
    pub fn symmetric(upper: &[&[&Self]]) -> Self {
        let side: usize = upper.iter().map(|blocks| blocks[0].rows).sum();
        let mut out = Matrix::zeros(side, side);
        let mut row = 0;
        for blocks in upper {
            let mut column = row;
            for block in *blocks {
                assert_eq!(block.rows, blocks[0].rows, "a row of blocks has one height");
                for (r, c) in (0..block.rows).flat_map(|r| (0..block.columns).map(move |c| (r, c)))
                {
                    if row + r <= column + c {
                        out.set(row + r, column + c, block.at(r, c).clone());
                        out.set(column + c, row + r, block.at(r, c).clone());
                    }
                }
                column += block.columns;
            }
            assert_eq!(column, side, "a row of blocks reaches the last column");
            row += blocks[0].rows;
        }
        out
    }

    fn with(&self, other: &Self, combine: impl Fn(S, S) -> S) -> Self {
        assert_eq!((self.rows, self.columns), (other.rows, other.columns));
        Matrix::from_fn(self.rows, self.columns, |r, c| {
            combine(self.at(r, c).clone(), other.at(r, c).clone())
        })
    }
}

impl Matrix<Interval> {
    /// Upper bound of the sum of the magnitudes of all entries.
    pub fn magnitude_sum(&self) -> f64 {
        let entries = (0..self.nrows()).flat_map(|r| (0..self.ncols()).map(move |c| (r, c)));
        entries.fold(0.0, |sum, (r, c)| add_up(sum, self.at(r, c).magnitude()))
    }
}
