//! The Schur complement `M_ij = <A_i, Z A_j S^-1>`, by the sparsity of the coefficients.
//!
//! Fujisawa, Kojima and Nakata ("Exploiting sparsity in primal-dual interior-point methods for semidefinite programming",
//! Mathematical Programming 79:235-253, 1997) choose for each unknown between a dense product (their F1, F2) and a
//! sum over pairs of entries (F3). The dense way here forms `V = U + U'`, `U = Z A_j S^-1`, as a sum of as many outer
//! products as A_j has nonzero columns, so that it is F1 for dense and cheap for sparse coefficients.

use super::dense;
use super::layout::{Block, Layout, Place};

/// Relative cost of a gathered operation to one in a vector loop.
const GATHER: usize = 4;

/// How each unknown of each block is treated, found once for a problem.
#[derive(Debug, Clone)]
pub struct SchurPlan {
    blocks: Vec<BlockPlan>,
    /// Blocks of each part. Parts are summed separately, whatever the number of threads.
    parts: Vec<std::ops::Range<usize>>,
}

#[derive(Debug, Clone)]
struct BlockPlan {
    /// For each unknown: its nonzero columns, or nothing where the sum over pairs is cheaper.
    columns: Vec<Option<Vec<usize>>>,
    cost: usize,
}

/// Work [multiplications] below which a second thread does not pay.
const WORTH_A_THREAD: usize = 2_000_000;

impl SchurPlan {
    /// The plan for a problem.
    pub fn new(layout: &Layout) -> Self {
        let blocks: Vec<BlockPlan> = layout.blocks.iter().map(BlockPlan::new).collect();
        let total: usize = blocks.iter().map(|block| block.cost).sum();
        let mut parts = Vec::new();
        if total < WORTH_A_THREAD {
            parts.push(0..blocks.len());
        } else {
            let mut sum = 0;
            let half = blocks.iter().position(|block| {
                sum += block.cost;
                2 * sum >= total
            });
            let middle = half.map_or(blocks.len(), |at| at + 1);
            parts.push(0..middle);
            parts.push(middle..blocks.len());
        }
        parts.retain(|part| !part.is_empty());
        SchurPlan { blocks, parts }
    }

    /// Fills the lower triangle of the m x m column-major `matrix`. `second` is scratch for the second part.
    pub fn assemble(
        &self,
        layout: &Layout,
        z: &[f64],
        s_inverse: &[f64],
        threads: usize,
        matrix: &mut Vec<f64>,
        second: &mut Vec<f64>,
    ) {
        let m = layout.cost.len();
        matrix.clear();
        matrix.resize(m * m, 0.0);
        let fill = |part: std::ops::Range<usize>, out: &mut [f64]| {
            let mut work = Work::default();
            for (plan, block) in self.blocks[part.clone()].iter().zip(&layout.blocks[part]) {
                let range = block.range();
                plan.add(
                    block,
                    &z[range.clone()],
                    &s_inverse[range],
                    m,
                    &mut work,
                    out,
                );
            }
        };
        match &self.parts[..] {
            [] => {}
            [only] => fill(only.clone(), matrix),
            [first, rest, ..] => {
                second.clear();
                second.resize(m * m, 0.0);
                if threads > 1 {
                    std::thread::scope(|scope| {
                        scope.spawn(|| fill(rest.clone(), second));
                        fill(first.clone(), matrix);
                    });
                } else {
                    fill(first.clone(), matrix);
                    fill(rest.clone(), second);
                }
                matrix.iter_mut().zip(second).for_each(|(a, b)| *a += *b);
            }
        }
    }
}

#[derive(Default)]
struct Work {
    basis: Vec<f64>,
    v: Vec<f64>,
}

impl BlockPlan {
    fn new(block: &Block) -> Self {
        let n = block.side;
        let count = block.unknowns.len();
        let mut columns = Vec::with_capacity(count);
        let mut cost = 0;
        for k in 0..count {
            let own = block.entries_of(k);
            let later = block.entries.len() - block.starts[k];
            let mut touched: Vec<usize> = own.iter().flat_map(|e| [e.row, e.column]).collect();
            touched.sort_unstable();
            touched.dedup();
            let dense = n * n * touched.len() + 2 * n * own.len() + GATHER * later;
            let pairs = 4 * GATHER * own.len() * later;
            cost += dense.min(pairs);
            columns.push((dense < pairs).then_some(touched));
        }
        BlockPlan { columns, cost }
    }

    fn add(
        &self,
        block: &Block,
        z: &[f64],
        s_inverse: &[f64],
        m: usize,
        work: &mut Work,
        out: &mut [f64],
    ) {
        for (k, &unknown) in block.unknowns.iter().enumerate() {
            let own = block.entries_of(k);
            if let Some(columns) = &self.columns[k] {
                dense_column(block.side, own, columns, z, s_inverse, work);
            }
            for (later, &other) in block.unknowns.iter().enumerate().skip(k) {
                let entries = block.entries_of(later);
                let value = match &self.columns[k] {
                    Some(_) => entries.iter().map(|e| e.weight * work.v[e.at]).sum(),
                    None => over_pairs(block.side, own, entries, z, s_inverse),
                };
                out[unknown.min(other) * m + unknown.max(other)] += value;
            }
        }
    }
}

/// `V = U + U'`, `U = Z A S^-1`, on and above the diagonal.
#[inline(always)]
fn dense_column(
    n: usize,
    entries: &[Place],
    columns: &[usize],
    z: &[f64],
    s_inverse: &[f64],
    work: &mut Work,
) {
    // Pairs of columns (Z A)_k and (S^-1)_k: V is the sum of p q' + q p' over the pairs.
    let basis = &mut work.basis;
    basis.clear();
    basis.resize(2 * columns.len() * n, 0.0);
    for (k, &column) in columns.iter().enumerate() {
        let (p, q) = basis[2 * k * n..(2 * k + 2) * n].split_at_mut(n);
        q.copy_from_slice(&s_inverse[column * n..(column + 1) * n]);
        for entry in entries {
            // Column `column` of the symmetric A has this entry's mate in its row.
            if entry.column == column {
                add_scaled(entry.value(), &z[entry.row * n..(entry.row + 1) * n], p);
            } else if entry.row == column {
                add_scaled(
                    entry.value(),
                    &z[entry.column * n..(entry.column + 1) * n],
                    p,
                );
            }
        }
    }
    work.v.resize(n * n, 0.0);
    dense::sum_of_pairs(basis, 2 * columns.len(), n, &mut work.v);
}

#[inline(always)]
fn add_scaled(a: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

/// `<A_i, Z A_j S^-1>` over the pairs of entries.
#[inline(always)]
fn over_pairs(n: usize, a: &[Place], b: &[Place], z: &[f64], s_inverse: &[f64]) -> f64 {
    let mut sum = 0.0;
    for e in b {
        let (r, c) = (e.row * n, e.column * n);
        for f in a {
            let (p, q) = (f.row, f.column);
            let mixed = z[c + p] * s_inverse[r + q]
                + z[c + q] * s_inverse[r + p]
                + z[r + p] * s_inverse[c + q]
                + z[r + q] * s_inverse[c + p];
            // Halved weights on the diagonal count each of the coinciding terms once.
            sum += e.weight * f.weight * mixed;
        }
    }
    sum
}
