//! A primal-dual point and the factors that belong to it.

use super::block::Block;
use super::dense;
use super::layout::{Iterate, Layout};
use super::threads::both;

/// Factors of a point's matrices, block by block.
#[derive(Debug, Clone)]
pub struct Factors {
    /// Cholesky factor of S.
    pub s_root: Vec<f64>,
    /// S^-1.
    pub s_inverse: Vec<f64>,
    /// Cholesky factor of Z.
    pub z_root: Vec<f64>,
}

impl Factors {
    /// Room for the problem's blocks.
    pub fn new(layout: &Layout) -> Self {
        let zeros = || vec![0.0; layout.length];
        Factors {
            s_root: zeros(),
            s_inverse: zeros(),
            z_root: zeros(),
        }
    }

    /// Factors a point. `false` when S or Z is not positive definite.
    #[must_use]
    pub fn update(&mut self, layout: &Layout, point: &Iterate, threads: usize) -> bool {
        self.s_root.copy_from_slice(&point.s);
        self.z_root.copy_from_slice(&point.z);
        let (before, after) = layout.blocks.split_at(layout.middle);
        let middle = layout.middle_offset();
        let (s_first, s_second) = self.s_root.split_at_mut(middle);
        let (i_first, i_second) = self.s_inverse.split_at_mut(middle);
        let (z_first, z_second) = self.z_root.split_at_mut(middle);
        let (first, second) = both(
            threads,
            || factor(before, 0, s_first, i_first, z_first),
            || factor(after, middle, s_second, i_second, z_second),
        );
        first && second
    }

    /// `out = sym(Z W S^-1)` block by block.
    pub fn sandwich(&self, layout: &Layout, z: &[f64], w: &[f64], threads: usize, out: &mut [f64]) {
        layout.fill_halves(threads, out, |blocks, base, out| {
            let mut work = Vec::new();
            dense::vectorised(
                #[inline(always)]
                || {
                    for block in blocks {
                        let (n, range) = (block.side, block.range());
                        work.resize(n * n, 0.0);
                        let out = &mut out[range.start - base..range.end - base];
                        dense::product(&z[range.clone()], &w[range.clone()], &mut work, n);
                        dense::product(&work, &self.s_inverse[range], out, n);
                        dense::mirror(out, n, |upper, lower| 0.5 * (upper + lower));
                    }
                },
            );
        });
    }
}

/// Factors S and Z in place and inverts S, for blocks whose packed storage begins at `base`.
fn factor(
    blocks: &[Block],
    base: usize,
    s: &mut [f64],
    inverse: &mut [f64],
    z: &mut [f64],
) -> bool {
    let mut work = Vec::new();
    dense::vectorised(
        #[inline(always)]
        || {
            for block in blocks {
                let n = block.side;
                let range = block.offset - base..block.range().end - base;
                let root = &mut s[range.clone()];
                if !dense::cholesky(root, n) || !dense::cholesky(&mut z[range.clone()], n) {
                    return false;
                }
                work.resize(n * n, 0.0);
                dense::invert_lower(root, &mut work, n);
                dense::gram_of_lower(&work, &mut inverse[range], n);
            }
            true
        },
    )
}

/// True when every block of packed W is positive definite.
pub fn positive_definite(layout: &Layout, w: &[f64]) -> bool {
    let mut copy = Vec::new();
    dense::vectorised(
        #[inline(always)]
        || {
            for block in &layout.blocks {
                copy.clear();
                copy.extend_from_slice(&w[block.range()]);
                if !dense::cholesky(&mut copy, block.side) {
                    return false;
                }
            }
            true
        },
    )
}

/// Scratch for step lengths in each half of the blocks, and the block that allowed the shortest one last time.
#[derive(Debug, Default)]
pub struct StepWork {
    halves: [HalfStep; 2],
}

#[derive(Debug, Default)]
struct HalfStep {
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
    threads: usize,
    work: &mut StepWork,
) -> f64 {
    // I + a W >= 0 for a <= -1 / (smallest eigenvalue of W).
    let bound = -1.0 / enough;
    let (before, after) = layout.blocks.split_at(layout.middle);
    let [first, second] = &mut work.halves;
    let (first, second) = both(
        threads,
        || first.smallest_of(before, w, root, direction, bound),
        || second.smallest_of(after, w, root, direction, bound),
    );
    if first.is_nan() || second.is_nan() {
        return 0.0;
    }
    -1.0 / first.min(second)
}

impl HalfStep {
    /// The smallest eigenvalue of `L^-1 D L^-T` over the blocks where it is below `bound`, else `bound`.
    fn smallest_of(
        &mut self,
        blocks: &[Block],
        w: &[f64],
        root: &[f64],
        direction: &[f64],
        bound: f64,
    ) -> f64 {
        let mut smallest = bound;
        let start = self.limiting.min(blocks.len());
        let (before, after) = blocks.split_at(start);
        dense::vectorised(
            #[inline(always)]
            || {
                for (index, block) in after.iter().chain(before).enumerate() {
                    let range = block.range();
                    let (w, root) = (&w[range.clone()], &root[range.clone()]);
                    let found = self.smallest(block.side, w, root, &direction[range], smallest);
                    if found.is_nan() {
                        return f64::NAN;
                    }
                    if found < smallest {
                        smallest = found;
                        self.limiting = (index + start) % blocks.len();
                    }
                }
                smallest
            },
        )
    }

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
        // Most blocks allow what another one allows: one factorization shows it.
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
