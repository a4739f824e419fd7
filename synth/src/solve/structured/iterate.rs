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
    /// Cholesky factor of S.
    pub s_root: Vec<f64>,
    /// S^-1.
    pub s_inverse: Vec<f64>,
    /// Cholesky factor of Z.
    pub z_root: Vec<f64>,
    work: Vec<f64>,
}

impl Factors {
    /// Room for the problem's blocks.
    pub fn new(layout: &Layout) -> Self {
        let zeros = || vec![0.0; layout.length];
        let sides = layout.blocks.iter().map(|block| block.side);
        let largest = sides.max().unwrap_or(0);
        Factors {
            s_root: zeros(),
            s_inverse: zeros(),
            z_root: zeros(),
            work: vec![0.0; largest * largest],
        }
    }

    /// Factors a point. `false` when S or Z is not positive definite.
    #[must_use]
    pub fn update(&mut self, layout: &Layout, point: &Point) -> bool {
        self.s_root.copy_from_slice(&point.s);
        self.z_root.copy_from_slice(&point.z);
        dense::vectorised(
            #[inline(always)]
            || {
                layout.blocks.iter().all(|block| {
                    let (n, range) = (block.side, block.range());
                    let root = &mut self.s_root[range.clone()];
                    if !dense::cholesky(root, n) {
                        return false;
                    }
                    let inverse = &mut self.work[..n * n];
                    dense::invert_lower(root, inverse, n);
                    dense::gram_of_lower(inverse, &mut self.s_inverse[range.clone()], n);
                    dense::cholesky(&mut self.z_root[range], n)
                })
            },
        )
    }
}

/// True when every block of packed W is positive definite.
pub fn positive_definite(layout: &Layout, w: &[f64]) -> bool {
    layout.blocks.iter().all(|block| {
        let mut copy = w[block.range()].to_vec();
        dense::cholesky(&mut copy, block.side)
    })
}

/// Scratch for step lengths, and the block that allowed the shortest one last time.
#[derive(Debug, Default)]
pub struct StepWork {
    limiting: usize,
    inverse: Vec<f64>,
    product: Vec<f64>,
    reduced: Vec<f64>,
    diagonal: Vec<f64>,
    off: Vec<f64>,
}

/// The largest step along `direction` that keeps W positive semidefinite, at most `enough`; `root` is W's Cholesky
/// factor.
pub fn longest_step(
    layout: &Layout,
    w: &[f64],
    root: &[f64],
    direction: &[f64],
    enough: f64,
    work: &mut StepWork,
) -> f64 {
    // I + a W >= 0 for a <= -1 / (smallest eigenvalue of W).
    let mut smallest = -1.0 / enough;
    let first = work.limiting.min(layout.blocks.len());
    let (before, after) = layout.blocks.split_at(first);
    dense::vectorised(
        #[inline(always)]
        || {
            for (index, block) in after.iter().chain(before).enumerate() {
                let range = block.range();
                let (w, root) = (&w[range.clone()], &root[range.clone()]);
                let found = work.smallest(block.side, w, root, &direction[range], smallest);
                if found < smallest {
                    smallest = found;
                    work.limiting = (index + first) % layout.blocks.len();
                }
            }
        },
    );
    if smallest.is_nan() {
        return 0.0;
    }
    -1.0 / smallest
}

impl StepWork {
    /// The smallest eigenvalue of `L^-1 D L^-T` where it is below `enough`, else `enough`.
    #[inline(always)]
    fn smallest(&mut self, n: usize, w: &[f64], root: &[f64], along: &[f64], enough: f64) -> f64 {
        if n == 1 {
            return enough.min(along[0] / (root[0] * root[0]));
        }
        for scratch in [&mut self.inverse, &mut self.product, &mut self.reduced] {
            scratch.resize(n * n, 0.0);
        }
        let (inverse, reduced) = (&mut self.inverse[..n * n], &mut self.reduced[..n * n]);
        // Most blocks allow what another one allows: one factorization tells.
        let step = -1.0 / enough;
        for ((there, w), d) in reduced.iter_mut().zip(w).zip(along) {
            *there = w + step * d;
        }
        if dense::cholesky(reduced, n) {
            return enough;
        }
        let product = &mut self.product[..n * n];
        dense::invert_lower(root, inverse, n);
        dense::congruence_by_lower(inverse, along, product, reduced, n);
        self.diagonal.resize(n, 0.0);
        self.off.resize(n, 0.0);
        let (diagonal, off) = (&mut self.diagonal[..n], &mut self.off[..n]);
        dense::tridiagonalise(reduced, n, diagonal, off);
        dense::smallest_eigenvalue(diagonal, off, enough)
    }
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
    dense::vectorised(
        #[inline(always)]
        || {
            for block in &layout.blocks {
                let (n, range) = (block.side, block.range());
                work.resize(n * n, 0.0);
                let out = &mut out[range.clone()];
                dense::product(&z[range.clone()], &w[range.clone()], work, n);
                dense::product(work, &s_inverse[range], out, n);
                dense::symmetrise(out, n);
            }
        },
    );
}
