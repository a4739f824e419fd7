//! Matrix products behind the level-2 and level-3 BLAS symbols.
//!
//! A transposed operand arrives as a transposed view, so no kernel here knows about transposition flags.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::reborrow::*;
use faer::{Accum, ColMut, ColRef, MatMut, MatRef, Par};

/// The part of a matrix a routine may read or write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Full,
    Lower,
    Upper,
}

impl Part {
    /// The rows of column `j` that belong to this part of a matrix with `n` rows.
    fn rows(self, j: usize, n: usize) -> core::ops::Range<usize> {
        match self {
            Part::Full => 0..n,
            Part::Lower => j.min(n)..n,
            Part::Upper => 0..(j + 1).min(n),
        }
    }

    fn structure(self) -> BlockStructure {
        match self {
            Part::Full => BlockStructure::Rectangular,
            Part::Lower => BlockStructure::TriangularLower,
            Part::Upper => BlockStructure::TriangularUpper,
        }
    }
}

/// Replaces every entry of the part by `update(entry)`; `update` is not given entries outside the part.
pub fn for_each(mut c: MatMut<'_, f64>, part: Part, mut update: impl FnMut(&mut f64)) {
    let n = c.nrows();
    for j in 0..c.ncols() {
        for i in part.rows(j, n) {
            update(&mut c[(i, j)]);
        }
    }
}

/// Applies `C <- beta C` on a part of `C` and returns whether a following product replaces or is added.
///
/// `beta = 0` does not read `C`, so that stale NaN values do not survive.
fn start(c: MatMut<'_, f64>, part: Part, beta: f64, has_product: bool) -> Accum {
    if beta == 0.0 {
        if !has_product {
            for_each(c, part, |entry| *entry = 0.0);
        }
        return Accum::Replace;
    }
    if beta != 1.0 {
        for_each(c, part, |entry| *entry *= beta);
    }
    Accum::Add
}

/// `C <- alpha A B + beta C`.
pub fn product(
    alpha: f64,
    a: MatRef<'_, f64>,
    b: MatRef<'_, f64>,
    beta: f64,
    mut c: MatMut<'_, f64>,
) {
    let has_product = alpha != 0.0 && a.ncols() > 0;
    let accum = start(c.rb_mut(), Part::Full, beta, has_product);
    if has_product {
        matmul(c, accum, a, b, alpha, Par::Seq);
    }
}

/// `C <- alpha A A' + beta C`, or with a B `C <- alpha (A B' + B A') + beta C`, on one triangle of the symmetric `C`.
pub fn rank_update(
    alpha: f64,
    a: MatRef<'_, f64>,
    b: Option<MatRef<'_, f64>>,
    beta: f64,
    mut c: MatMut<'_, f64>,
    part: Part,
) {
    let has_product = alpha != 0.0 && a.ncols() > 0;
    let accum = start(c.rb_mut(), part, beta, has_product);
    if has_product {
        triangle_product(alpha, a, b.unwrap_or(a), accum, c.rb_mut(), part);
        if let Some(b) = b {
            triangle_product(alpha, b, a, Accum::Add, c, part);
        }
    }
}

/// One triangle of `alpha A B'`, replacing or added to `C`.
fn triangle_product(
    alpha: f64,
    a: MatRef<'_, f64>,
    b: MatRef<'_, f64>,
    accum: Accum,
    c: MatMut<'_, f64>,
    part: Part,
) {
    let rectangular = BlockStructure::Rectangular;
    triangular::matmul(
        c,
        part.structure(),
        accum,
        a,
        rectangular,
        b.transpose(),
        rectangular,
        alpha,
        Par::Seq,
    );
}

/// `y <- alpha A x + beta y`.
pub fn product_with_vector(
    alpha: f64,
    a: MatRef<'_, f64>,
    x: ColRef<'_, f64>,
    beta: f64,
    mut y: ColMut<'_, f64>,
) {
    start(y.rb_mut().as_mat_mut(), Part::Full, beta, false);
    if alpha == 0.0 {
        return;
    }
    for j in 0..a.ncols() {
        let weight = alpha * x[j];
        for i in 0..a.nrows() {
            y[i] += weight * a[(i, j)];
        }
    }
}

/// `y <- alpha A x + beta y` for a symmetric `A` of which only one triangle is read.
pub fn symmetric_product_with_vector(
    alpha: f64,
    a: MatRef<'_, f64>,
    part: Part,
    x: ColRef<'_, f64>,
    beta: f64,
    mut y: ColMut<'_, f64>,
) {
    start(y.rb_mut().as_mat_mut(), Part::Full, beta, false);
    if alpha == 0.0 {
        return;
    }
    for j in 0..a.ncols() {
        for i in part.rows(j, a.nrows()) {
            y[i] += alpha * a[(i, j)] * x[j];
            if i != j {
                y[j] += alpha * a[(i, j)] * x[i];
            }
        }
    }
}
