//! Matrix expressions that are affine in the unknowns, and symmetric ones made of blocks.

use std::collections::BTreeMap;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use nalgebra::DMatrix;

/// Nonzero entries of one unknown's coefficient matrix: (row, column) to value.
pub(crate) type Entries = BTreeMap<(usize, usize), f64>;

/// A matrix `C + sum_i y_i C_i` with constant matrices `C`, `C_i` and scalar unknowns `y_i`.
///
/// Matrix unknowns come from [`Unknowns`](crate::lmi::Unknowns). Operators panic when shapes do not
/// fit, as those of nalgebra do: a wrong shape is a mistake in the program, never in its input.
#[derive(Debug, Clone, PartialEq)]
pub struct Affine {
    rows: usize,
    columns: usize,
    pub(super) constant: Entries,
    pub(super) coefficients: BTreeMap<usize, Entries>,
}

impl Affine {
    /// The zero matrix, `rows` x `columns`.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Affine {
            rows,
            columns,
            constant: Entries::new(),
            coefficients: BTreeMap::new(),
        }
    }

    /// A constant matrix.
    pub fn constant(matrix: &DMatrix<f64>) -> Self {
        let mut out = Affine::zeros(matrix.nrows(), matrix.ncols());
        for column in 0..matrix.ncols() {
            for row in 0..matrix.nrows() {
                accumulate(&mut out.constant, (row, column), matrix[(row, column)]);
            }
        }
        out
    }

    /// A constant multiple of the identity, `side` x `side`.
    pub fn identity(side: usize, value: f64) -> Self {
        Affine::constant(&(DMatrix::identity(side, side) * value))
    }

    /// `sum_i y_i C_i` from (unknown, row, column, value).
    pub(crate) fn linear(
        rows: usize,
        columns: usize,
        terms: impl IntoIterator<Item = (usize, usize, usize, f64)>,
    ) -> Self {
        let mut out = Affine::zeros(rows, columns);
        for (unknown, row, column, value) in terms {
            let entries = out.coefficients.entry(unknown).or_default();
            accumulate(entries, (row, column), value);
        }
        out
    }

    /// Number of rows.
    pub fn nrows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn ncols(&self) -> usize {
        self.columns
    }

    /// The transpose.
    pub fn transposed(&self) -> Self {
        self.map_entries(self.columns, self.rows, |entries| {
            entries.iter().map(|(&(r, c), &v)| ((c, r), v)).collect()
        })
    }

    /// `X + X'`, the bracket `[X]_s` of the papers.
    pub fn symmetrised(&self) -> Self {
        self + &self.transposed()
    }

    /// `T' X T` for a symmetric X and a constant T: the congruence that keeps definiteness when T
    /// is invertible. Rounding cannot make the result unsymmetric.
    pub fn congruence(&self, transform: &DMatrix<f64>) -> Self {
        let product = &(&transform.transpose() * self) * transform;
        0.5 * product.symmetrised()
    }

    /// The scalar expression (1 x 1) times a constant matrix.
    pub fn times_matrix(&self, matrix: &DMatrix<f64>) -> Self {
        assert_eq!((self.rows, self.columns), (1, 1), "only a scalar scales");
        let pattern = Affine::constant(matrix).constant;
        self.map_entries(matrix.nrows(), matrix.ncols(), |entries| {
            let factor = entries.get(&(0, 0)).copied().unwrap_or(0.0);
            pattern.iter().map(|(&at, &v)| (at, v * factor)).collect()
        })
    }

    /// Rows `row..row + rows` and columns `column..column + columns`.
    pub fn view(&self, row: usize, column: usize, rows: usize, columns: usize) -> Self {
        assert!(row + rows <= self.rows && column + columns <= self.columns);
        self.map_entries(rows, columns, |entries| {
            entries
                .range((row, 0)..(row + rows, 0))
                .filter(|((_, c), _)| (column..column + columns).contains(c))
                .map(|(&(r, c), &v)| ((r - row, c - column), v))
                .collect()
        })
    }

    /// One row, 1 x n.
    pub fn row(&self, row: usize) -> Self {
        self.view(row, 0, 1, self.columns)
    }

    /// Adds `block` at (row, column) of this matrix.
    pub fn add_block(&mut self, row: usize, column: usize, block: &Affine) {
        assert!(row + block.rows <= self.rows && column + block.columns <= self.columns);
        let shift = |target: &mut Entries, source: &Entries| {
            for (&(r, c), &v) in source {
                accumulate(target, (row + r, column + c), v);
            }
        };
        shift(&mut self.constant, &block.constant);
        for (unknown, entries) in &block.coefficients {
            shift(self.coefficients.entry(*unknown).or_default(), entries);
        }
    }

    /// The value at a point: `values[i]` is the scalar unknown of index i.
    pub fn value(&self, values: &[f64]) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.rows, self.columns);
        for (&at, &v) in &self.constant {
            out[at] += v;
        }
        for (&unknown, entries) in &self.coefficients {
            for (&at, &v) in entries {
                out[at] += v * values[unknown];
            }
        }
        out
    }

    /// The sum of the magnitudes of the terms of each entry at a point: what rounding is relative to.
    pub fn magnitudes(&self, values: &[f64]) -> DMatrix<f64> {
        let sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
        self.map_entries(self.rows, self.columns, |entries| {
            entries.iter().map(|(&at, v)| (at, v.abs())).collect()
        })
        .value(&sizes)
    }

    /// True where some entry of the expression is not identically zero inside the given block.
    pub fn touches(&self, rows: std::ops::Range<usize>, columns: std::ops::Range<usize>) -> bool {
        let hit = |entries: &Entries| {
            entries
                .keys()
                .any(|(r, c)| rows.contains(r) && columns.contains(c))
        };
        hit(&self.constant) || self.coefficients.values().any(hit)
    }

    /// True when the expression equals its transpose, exactly.
    pub fn is_symmetric(&self) -> bool {
        let symmetric = |entries: &Entries| {
            entries
                .iter()
                .all(|(&(r, c), v)| r == c || entries.get(&(c, r)) == Some(v))
        };
        self.rows == self.columns
            && symmetric(&self.constant)
            && self.coefficients.values().all(symmetric)
    }

    fn map_entries(
        &self,
        rows: usize,
        columns: usize,
        map: impl Fn(&Entries) -> Entries,
    ) -> Affine {
        let coefficients = self.coefficients.iter().map(|(&k, e)| (k, map(e)));
        Affine {
            rows,
            columns,
            constant: map(&self.constant),
            coefficients: coefficients.filter(|(_, e)| !e.is_empty()).collect(),
        }
    }
}

fn accumulate(entries: &mut Entries, at: (usize, usize), value: f64) {
    if value == 0.0 {
        return;
    }
    let entry = entries.entry(at).or_insert(0.0);
    *entry += value;
    if *entry == 0.0 {
        entries.remove(&at);
    }
}

impl AddAssign<&Affine> for Affine {
    fn add_assign(&mut self, other: &Affine) {
        assert_eq!(
            (self.rows, self.columns),
            (other.rows, other.columns),
            "the shapes of a sum must agree"
        );
        self.add_block(0, 0, other);
    }
}

impl Add<&Affine> for &Affine {
    type Output = Affine;
    fn add(self, other: &Affine) -> Affine {
        let mut out = self.clone();
        out += other;
        out
    }
}

impl Add for Affine {
    type Output = Affine;
    fn add(mut self, other: Affine) -> Affine {
        self += &other;
        self
    }
}

impl Neg for &Affine {
    type Output = Affine;
    fn neg(self) -> Affine {
        -1.0 * self
    }
}

impl Neg for Affine {
    type Output = Affine;
    fn neg(self) -> Affine {
        -&self
    }
}

impl Sub<&Affine> for &Affine {
    type Output = Affine;
    fn sub(self, other: &Affine) -> Affine {
        self + &(-other)
    }
}

impl Sub for Affine {
    type Output = Affine;
    fn sub(self, other: Affine) -> Affine {
        &self - &other
    }
}

impl Mul<&Affine> for f64 {
    type Output = Affine;
    fn mul(self, expression: &Affine) -> Affine {
        expression.map_entries(expression.rows, expression.columns, |entries| {
            let scaled = entries.iter().map(|(&at, &v)| (at, self * v));
            scaled.filter(|&(_, v)| v != 0.0).collect()
        })
    }
}

impl Mul<Affine> for f64 {
    type Output = Affine;
    fn mul(self, expression: Affine) -> Affine {
        self * &expression
    }
}

impl Mul<&Affine> for &DMatrix<f64> {
    type Output = Affine;
    fn mul(self, expression: &Affine) -> Affine {
        assert_eq!(self.ncols(), expression.rows, "inner sizes must agree");
        expression.map_entries(self.nrows(), expression.columns, |entries| {
            let mut out = Entries::new();
            for (&(r, c), &v) in entries {
                for row in 0..self.nrows() {
                    accumulate(&mut out, (row, c), self[(row, r)] * v);
                }
            }
            out
        })
    }
}

impl Mul<&DMatrix<f64>> for &Affine {
    type Output = Affine;
    fn mul(self, matrix: &DMatrix<f64>) -> Affine {
        assert_eq!(self.columns, matrix.nrows(), "inner sizes must agree");
        self.map_entries(self.rows, matrix.ncols(), |entries| {
            let mut out = Entries::new();
            for (&(r, c), &v) in entries {
                for column in 0..matrix.ncols() {
                    accumulate(&mut out, (r, column), v * matrix[(c, column)]);
                }
            }
            out
        })
    }
}

impl Mul<Affine> for &DMatrix<f64> {
    type Output = Affine;
    fn mul(self, expression: Affine) -> Affine {
        self * &expression
    }
}

impl Mul<&DMatrix<f64>> for Affine {
    type Output = Affine;
    fn mul(self, matrix: &DMatrix<f64>) -> Affine {
        &self * matrix
    }
}

impl Mul<&Affine> for DMatrix<f64> {
    type Output = Affine;
    fn mul(self, expression: &Affine) -> Affine {
        &self * expression
    }
}

/// A symmetric matrix assembled block by block; only blocks on and above the diagonal are given,
/// the others are their transposes (the stars of the papers).
#[derive(Debug, Clone)]
pub struct SymmetricBlocks {
    offsets: Vec<usize>,
    matrix: Affine,
}

impl SymmetricBlocks {
    /// A zero matrix with the given block sizes.
    pub fn new(sizes: &[usize]) -> Self {
        let mut offsets = vec![0];
        for size in sizes {
            offsets.push(offsets[offsets.len() - 1] + size);
        }
        let side = offsets[sizes.len()];
        SymmetricBlocks {
            offsets,
            matrix: Affine::zeros(side, side),
        }
    }

    /// The whole matrix from its blocks on and above the diagonal, one list for each row of blocks, each beginning with
    /// the block on the diagonal.
    pub fn of(upper: &[&[&Affine]]) -> Affine {
        let sizes: Vec<usize> = upper.iter().map(|blocks| blocks[0].nrows()).collect();
        let mut out = SymmetricBlocks::new(&sizes);
        for (row, blocks) in upper.iter().enumerate() {
            for (k, block) in blocks.iter().enumerate() {
                out.add(row, row + k, block);
            }
        }
        out.finish()
    }

    /// Adds `block` at block position (row, column), row <= column, and its transpose at the
    /// mirrored position.
    ///
    /// # Panics
    /// When the block lies below the diagonal, has the wrong shape, or stands on the diagonal
    /// without being symmetric.
    pub fn add(&mut self, row: usize, column: usize, block: &Affine) {
        assert!(row <= column, "give the blocks on and above the diagonal");
        let size = |k: usize| self.offsets[k + 1] - self.offsets[k];
        assert_eq!((block.nrows(), block.ncols()), (size(row), size(column)));
        let (r, c) = (self.offsets[row], self.offsets[column]);
        if row == column {
            assert!(block.is_symmetric(), "a diagonal block must be symmetric");
            self.matrix.add_block(r, r, block);
        } else {
            self.matrix.add_block(r, c, block);
            self.matrix.add_block(c, r, &block.transposed());
        }
    }

    /// The whole matrix.
    pub fn finish(self) -> Affine {
        self.matrix
    }
}
