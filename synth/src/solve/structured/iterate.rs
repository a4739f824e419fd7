//! A primal-dual point and the factors that belong to it.

use super::dense;
use super::layout::Layout;

/// Unknowns y, slack matrices S (of the inequalities), multiplier matrices Z, packed.
#[derive(Debug, Clone)]
pub struct Point {
    /// Unknowns.
    pub y: Vec<f64>,
    /// Slack.
    pub s: Vec<f64>,
    /// Multipliers.
    pub z: Vec<f64>,
}

/// Factors of a point's matrices, block by block.
#[derive(Debug, Clone)]
pub struct Factors {
    /// Inverse of the Cholesky factor of S.
    pub s_root_inverse: Vec<f64>,
    /// S^-1.
    pub s_inverse: Vec<f64>,
    /// Inverse of the Cholesky factor of Z.
    pub z_root_inverse: Vec<f64>,
    work: Vec<f64>,
}

impl Factors {
    /// Room for the problem's blocks.
    pub fn new(layout: &Layout) -> Self {
        let zeros = || vec![0.0; layout.length];
        let largest = layout
            .blocks
            .iter()
            .map(|block| block.side)
            .max()
            .unwrap_or(0);
        Factors {
            s_root_inverse: zeros(),
            s_inverse: zeros(),
            z_root_inverse: zeros(),
            work: vec![0.0; largest * largest],
        }
    }

    /// Factors a point. `false` when S or Z is not positive definite.
    #[must_use]
    pub fn update(&mut self, layout: &Layout, point: &Point) -> bool {
        for block in &layout.blocks {
            let (n, range) = (block.side, block.range());
            let work = &mut self.work[..n * n];
            work.copy_from_slice(&point.s[range.clone()]);
            if !dense::cholesky(work, n) {
                return false;
            }
            dense::invert_lower(work, &mut self.s_root_inverse[range.clone()], n);
            let root = &self.s_root_inverse[range.clone()];
            dense::gram_of_lower(root, &mut self.s_inverse[range.clone()], n);
            work.copy_from_slice(&point.z[range.clone()]);
            if !dense::cholesky(work, n) {
                return false;
            }
            dense::invert_lower(work, &mut self.z_root_inverse[range], n);
        }
        true
    }
}

/// True when every block of packed W is positive definite.
pub fn positive_definite(layout: &Layout, w: &[f64]) -> bool {
    layout.blocks.iter().all(|block| {
        let mut copy = w[block.range()].to_vec();
        dense::cholesky(&mut copy, block.side)
    })
}

/// Scratch for step lengths.
#[derive(Debug, Default)]
pub struct StepWork {
    product: Vec<f64>,
    reduced: Vec<f64>,
    diagonal: Vec<f64>,
    off: Vec<f64>,
}

/// The largest step along `direction` that keeps the matrix positive semidefinite, at most `enough`;
/// `root_inverse` is the inverse of its Cholesky factor.
pub fn longest_step(
    layout: &Layout,
    root_inverse: &[f64],
    direction: &[f64],
    enough: f64,
    work: &mut StepWork,
) -> f64 {
    // I + a W >= 0 for a <= -1 / (smallest eigenvalue of W).
    let mut smallest = -1.0 / enough;
    for block in &layout.blocks {
        let (n, range) = (block.side, block.range());
        let (root, direction) = (&root_inverse[range.clone()], &direction[range]);
        if n == 1 {
            smallest = smallest.min(root[0] * root[0] * direction[0]);
            continue;
        }
        work.product.resize(n * n, 0.0);
        work.reduced.resize(n * n, 0.0);
        work.diagonal.resize(n, 0.0);
        work.off.resize(n, 0.0);
        let (product, reduced) = (&mut work.product[..n * n], &mut work.reduced[..n * n]);
        dense::congruence_by_lower(root, direction, product, reduced, n);
        let (diagonal, off) = (&mut work.diagonal[..n], &mut work.off[..n]);
        dense::tridiagonalise(reduced, n, diagonal, off);
        smallest = dense::smallest_eigenvalue(diagonal, off, smallest);
    }
    if smallest.is_nan() {
        return 0.0;
    }
    -1.0 / smallest
}

/// `out = sym(Z W S^-1)` block by block.
pub fn sandwich(
    layout: &Layout,
    z: &[f64],
    w: &[f64],
    s_inverse: &[f64],
    work: &mut Vec<f64>,
    out: &mut [f64],
) {
    for block in &layout.blocks {
        let (n, range) = (block.side, block.range());
        work.resize(n * n, 0.0);
        let out = &mut out[range.clone()];
        dense::product(&z[range.clone()], &w[range.clone()], &mut work[..n * n], n);
        dense::product(&work[..n * n], &s_inverse[range], out, n);
        dense::symmetrise(out, n);
    }
}
