//! The Schur complement `M_ij = <A_i, Z A_j S^-1>`, by the sparsity of the coefficients.
//!
//! Fujisawa, Kojima and Nakata ("Exploiting sparsity in primal-dual interior-point methods for semidefinite programming",
//! Mathematical Programming 79:235-253, 1997) choose for each unknown between a dense product (their F1, F2) and a
//! sum over pairs of entries (F3). The dense method here forms `V = U + U'`, `U = Z A_j S^-1`, as a sum of a few outer
//! products, and only in the rows that later unknowns read, so that it is F1 for dense and cheap for sparse
//! coefficients. Small blocks with many unknowns use a Kronecker product instead.

use super::block::Block;
use super::dense;
use super::kronecker::{KroneckerPlan, KroneckerWork};
use super::layout::Layout;
use super::threads::{both, halfway};
use crate::lmi::Entry;

/// Cost of one product of the sum over pairs, in gathered entries of V.
const PAIR: usize = 10;

/// Work [entries] below which a second thread does not pay.
const WORTH_A_THREAD: usize = 150_000;

/// How each unknown of each block is treated, found once for a problem.
#[derive(Debug, Clone)]
pub struct SchurPlan {
    blocks: Vec<BlockMethod>,
    /// Blocks of each part. Parts are summed separately, whatever the number of threads.
    parts: Vec<std::ops::Range<usize>>,
}

/// Scratch of [`SchurPlan::assemble`].
#[derive(Debug, Default)]
pub struct SchurWork {
    second: Vec<f64>,
    parts: [PartWork; 2],
}

#[derive(Debug, Default)]
struct PartWork {
    products: Work,
    sums: KroneckerWork,
}

/// How one block is treated.
#[derive(Debug, Clone)]
enum BlockMethod {
    Products(BlockPlan),
    Kronecker(KroneckerPlan),
}

impl BlockMethod {
    /// The cheaper method and its cost in multiplications.
    fn new(block: &Block) -> (Self, usize) {
        let products = BlockPlan::new(block);
        let cost = products.cost;
        match KroneckerPlan::new(block).filter(|(_, other)| *other < cost) {
            None => (BlockMethod::Products(products), cost),
            Some((plan, cost)) => (BlockMethod::Kronecker(plan), cost),
        }
    }
}

/// One entry of a coefficient: where V is read and which unknown it belongs to.
#[derive(Debug, Clone, Copy)]
struct Read {
    weight: f64,
    /// Place in V, whose columns are `stride` apart.
    at: u32,
    unknown: u32,
}

/// `A = sum (e_c f' + f e_c')` over terms, or, one-sided, `A = sum f e_c'`.
#[derive(Debug, Clone)]
struct Term {
    center: usize,
    /// Rows of f and its values there.
    rest: Vec<(usize, f64)>,
    two_sided: bool,
}

#[derive(Debug, Clone)]
struct BlockPlan {
    /// Side, rounded up to a multiple of the lanes.
    stride: usize,
    reads: Vec<Read>,
    /// For each unknown: the outer products of its V and how many leading rows of it are read, or nothing where the
    /// sum over pairs is cheaper.
    dense: Vec<Option<(Vec<Term>, usize)>>,
    cost: usize,
}

impl SchurPlan {
    /// The plan for a problem.
    pub fn new(layout: &Layout) -> Self {
        let methods = layout.blocks.iter().map(BlockMethod::new);
        let (blocks, costs): (Vec<BlockMethod>, Vec<usize>) = methods.unzip();
        let middle = match costs.iter().sum::<usize>() < WORTH_A_THREAD {
            true => blocks.len(),
            false => halfway(&costs),
        };
        let mut parts = vec![0..middle, middle..blocks.len()];
        parts.retain(|part| !part.is_empty());
        SchurPlan { blocks, parts }
    }

    /// Fills the lower triangle of the m x m column-major `matrix`.
    pub fn assemble(
        &self,
        layout: &Layout,
        z: &[f64],
        s_inverse: &[f64],
        threads: usize,
        matrix: &mut Vec<f64>,
        work: &mut SchurWork,
    ) {
        let m = layout.cost.len();
        let fill = |part: std::ops::Range<usize>, work: &mut PartWork, out: &mut Vec<f64>| {
            out.clear();
            out.resize(m * m, 0.0);
            let blocks = &layout.blocks[part.clone()];
            let plans = &self.blocks[part];
            dense::vectorised(
                #[inline(always)]
                || {
                    for (method, block) in plans.iter().zip(blocks) {
                        let range = block.range();
                        let (z, s_inverse) = (&z[range.clone()], &s_inverse[range]);
                        match method {
                            BlockMethod::Kronecker(plan) => {
                                let sums = &mut work.sums;
                                plan.add(&block.unknowns, z, s_inverse, m, sums, out);
                            }
                            BlockMethod::Products(plan) => {
                                let products = &mut work.products;
                                plan.add(block, z, s_inverse, m, products, out);
                            }
                        }
                    }
                    work.sums.flush(m, out);
                },
            );
        };
        match &self.parts[..] {
            [] => {
                matrix.clear();
                matrix.resize(m * m, 0.0);
            }
            [only] => fill(only.clone(), &mut work.parts[0], matrix),
            [first, rest, ..] => {
                let SchurWork { second, parts } = work;
                let [here, there] = parts;
                both(
                    threads,
                    || fill(first.clone(), here, matrix),
                    || fill(rest.clone(), there, second),
                );
                matrix.iter_mut().zip(second).for_each(|(a, b)| *a += *b);
            }
        }
        // Each pair of unknowns was met once, on either side of the diagonal.
        for j in 0..m {
            for i in j + 1..m {
                matrix[j * m + i] += matrix[i * m + j];
            }
        }
    }
}

#[derive(Debug, Default)]
struct Work {
    basis: Vec<f64>,
    v: Vec<f64>,
}

impl BlockPlan {
    fn new(block: &Block) -> Self {
        let n = block.side;
        let stride = n.next_multiple_of(dense::LANES);
        let count = block.unknowns.len();
        let mut reads = Vec::with_capacity(block.entries.len());
        for (k, &unknown) in block.unknowns.iter().enumerate() {
            reads.extend(block.entries_of(k).iter().map(|e| Read {
                weight: e.count() * e.value / 2.0,
                at: (e.column * stride + e.row) as u32,
                unknown: unknown as u32,
            }));
        }
        let mut dense = Vec::with_capacity(count);
        let mut cost = 0;
        let mut rows = 0;
        for k in (0..count).rev() {
            let own = block.entries_of(k);
            rows = own.iter().fold(rows, |rows, e| rows.max(e.column + 1));
            let later = block.entries.len() - block.starts[k];
            let terms = terms(own);
            let products: usize = terms.iter().map(|t| 1 + usize::from(t.two_sided)).sum();
            let gathered: usize = terms.iter().map(|t| t.rest.len()).sum();
            let lanes = dense::LANES;
            let by_terms = (rows * (rows + 8) * products + rows * (2 * gathered + 4 * products))
                / lanes
                + later;
            let by_pairs = PAIR * own.len() * later;
            cost += by_terms.min(by_pairs);
            dense.push((by_terms < by_pairs).then_some((terms, rows)));
        }
        dense.reverse();
        BlockPlan {
            stride,
            reads,
            dense,
            cost,
        }
    }

    #[inline(always)]
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
            let row = &mut out[unknown * m..(unknown + 1) * m];
            let later = block.starts[k];
            match &self.dense[k] {
                Some((terms, rows)) => {
                    self.form(block.side, terms, *rows, z, s_inverse, work);
                    let v = &work.v[..];
                    for read in &self.reads[later..] {
                        row[read.unknown as usize] += read.weight * v[read.at as usize];
                    }
                }
                None => {
                    let own = block.entries_of(k);
                    for (read, entry) in self.reads[later..].iter().zip(&block.entries[later..]) {
                        row[read.unknown as usize] +=
                            read.weight * over_pairs(block.side, own, entry, z, s_inverse);
                    }
                }
            }
        }
    }

    /// The leading rows of `V = U + U'`, `U = Z A S^-1`, on and above the diagonal.
    #[inline(always)]
    fn form(
        &self,
        n: usize,
        terms: &[Term],
        rows: usize,
        z: &[f64],
        s_inverse: &[f64],
        work: &mut Work,
    ) {
        let stride = self.stride;
        let basis = &mut work.basis;
        // One column after the other; with A = f e_c', U = (Z f) (S^-1 e_c)'.
        basis.resize(4 * terms.len() * stride, 0.0);
        let mut columns = basis.chunks_exact_mut(stride);
        let mut count = 0;
        let column = |of: &[f64], at: usize| at * n..at * n + rows.min(of.len());
        for term in terms {
            let mut next = || {
                columns
                    .next()
                    .map_or(&mut [][..], |column| &mut column[..rows])
            };
            let (zf, sc) = (next(), next());
            zf.fill(0.0);
            for &(row, weight) in &term.rest {
                add_scaled(weight, &z[column(z, row)], zf);
            }
            sc.copy_from_slice(&s_inverse[column(z, term.center)]);
            count += 2;
            if term.two_sided {
                let (zc, sf) = (next(), next());
                zc.copy_from_slice(&z[column(z, term.center)]);
                sf.fill(0.0);
                for &(row, weight) in &term.rest {
                    add_scaled(weight, &s_inverse[column(z, row)], sf);
                }
                count += 2;
            }
        }
        work.v.resize(stride * stride, 0.0);
        dense::sum_of_pairs(&work.basis, count, stride, rows, &mut work.v);
    }
}

/// The terms of a coefficient: one-sided ones, one for each of its nonzero columns, or two-sided ones around the rows
/// and columns that hold most of its entries, whichever needs fewer outer products.
fn terms(entries: &[Entry]) -> Vec<Term> {
    let mut columns: Vec<usize> = entries.iter().flat_map(|e| [e.row, e.column]).collect();
    columns.sort_unstable();
    columns.dedup();
    let mut left: Vec<Entry> = entries.to_vec();
    let mut stars = Vec::new();
    while let Some(center) = columns.iter().copied().max_by_key(|&c| {
        let touches = left.iter().filter(|e| e.row == c || e.column == c).count();
        (touches, usize::MAX - c)
    }) {
        let mut rest = Vec::new();
        left.retain(|e| {
            rest.push(match (e.row == center, e.column == center) {
                (true, true) => (center, 0.5 * e.value),
                (true, false) => (e.column, e.value),
                (false, true) => (e.row, e.value),
                (false, false) => return true,
            });
            false
        });
        if rest.is_empty() {
            break;
        }
        stars.push(Term {
            center,
            rest,
            two_sided: true,
        });
    }
    if 2 * stars.len() < columns.len() {
        return stars;
    }
    let column = |center: usize| {
        let meets = entries
            .iter()
            .filter(move |e| e.row == center || e.column == center);
        let mate = move |e: &Entry| if e.row == center { e.column } else { e.row };
        Term {
            center,
            rest: meets.map(|e| (mate(e), e.value)).collect(),
            two_sided: false,
        }
    };
    columns.into_iter().map(column).collect()
}

#[inline(always)]
fn add_scaled(a: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

/// The entry of V at one place, over the entries of A.
#[inline(always)]
fn over_pairs(n: usize, a: &[Entry], e: &Entry, z: &[f64], s_inverse: &[f64]) -> f64 {
    let mut sum = 0.0;
    let (r, c) = (e.row * n, e.column * n);
    for f in a {
        let (p, q) = (f.row, f.column);
        let mixed = z[c + p] * s_inverse[r + q]
            + z[c + q] * s_inverse[r + p]
            + z[r + p] * s_inverse[c + q]
            + z[r + q] * s_inverse[c + p];
        // Halved weights on the diagonal count each of the coinciding terms once.
        sum += 0.5 * f.count() * f.value * mixed;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lmi::{Cone, Semidefinite};
    use proptest::prelude::*;

    /// One cone: every place of every unknown is nonzero with the given chance.
    fn problem(side: usize, unknowns: usize, filled: f64, numbers: &[f64]) -> Semidefinite {
        let mut next = numbers.iter().cycle().copied();
        let mut coefficients = Vec::new();
        for unknown in 0..unknowns {
            let mut entries = Vec::new();
            for column in 0..side {
                for row in 0..=column {
                    let (chance, value) = (next.next(), next.next());
                    if chance.is_some_and(|chance| chance.abs() < filled) {
                        entries.extend(value.map(|value| Entry { row, column, value }));
                    }
                }
            }
            coefficients.push((unknown, entries));
        }
        Semidefinite {
            cost: vec![1.0; unknowns],
            offset: 0.0,
            cones: vec![Cone {
                name: "test".to_string(),
                side,
                constant: Vec::new(),
                coefficients,
            }],
        }
    }

    /// A symmetric matrix, packed.
    fn symmetric(side: usize, numbers: &[f64]) -> Vec<f64> {
        let at = |row: usize, column: usize| numbers[(row * column + row + column) % numbers.len()];
        let pairs = (0..side).flat_map(|column| (0..side).map(move |row| (row, column)));
        pairs.map(|(row, column)| at(row, column)).collect()
    }

    fn full(block: &Block, k: usize) -> nalgebra::DMatrix<f64> {
        let mut out = nalgebra::DMatrix::zeros(block.side, block.side);
        for e in block.entries_of(k) {
            out[(e.row, e.column)] = e.value;
            out[(e.column, e.row)] = e.value;
        }
        out
    }

    /// Lower triangle of M by each method that this block can be treated.
    fn by_each_way(layout: &Layout, z: &[f64], inverse: &[f64]) -> Vec<Vec<f64>> {
        let m = layout.cost.len();
        let (kronecker, _) = KroneckerPlan::new(&layout.blocks[0]).expect("a small block");
        let of = |method: BlockMethod| {
            let plan = SchurPlan {
                blocks: vec![method],
                parts: std::iter::once(0..1).collect(),
            };
            let (mut matrix, mut work) = (Vec::new(), SchurWork::default());
            plan.assemble(layout, z, inverse, 1, &mut matrix, &mut work);
            matrix
        };
        let lower = |matrix: Vec<f64>| -> Vec<f64> {
            let places = (0..m).flat_map(|j| (j..m).map(move |i| (i, j)));
            places.map(|(i, j)| matrix[j * m + i]).collect()
        };
        let methods = [
            BlockMethod::Products(BlockPlan::new(&layout.blocks[0])),
            BlockMethod::Kronecker(kronecker),
        ];
        methods.map(|method| lower(of(method))).to_vec()
    }

    proptest! {
        #[test]
        fn every_way_gives_the_definition_of_the_schur_complement(
            side in 1_usize..14,
            unknowns in 1_usize..40,
            filled in 0.05_f64..0.9,
            numbers in prop::collection::vec(-1.0_f64..1.0, 97..211),
        ) {
            let layout = Layout::new(&problem(side, unknowns, filled, &numbers));
            prop_assume!(layout.blocks.len() == 1);
            let block = &layout.blocks[0];
            let n = block.side;
            let z = symmetric(n, &numbers);
            let inverse = symmetric(n, &numbers[13..]);
            let m = layout.cost.len();
            let matrix = |packed: &[f64]| nalgebra::DMatrix::from_column_slice(n, n, packed);
            let mut expected = vec![0.0; m * m];
            for (a, &i) in block.unknowns.iter().enumerate() {
                for (b, &j) in block.unknowns.iter().enumerate() {
                    let product = matrix(&z) * full(block, b) * matrix(&inverse);
                    expected[i.min(j) * m + i.max(j)] = full(block, a).dot(&product);
                }
            }
            for found in by_each_way(&layout, &z, &inverse) {
                let places = (0..m).flat_map(|j| (j..m).map(move |i| j * m + i));
                for (at, value) in places.zip(found) {
                    prop_assert!((value - expected[at]).abs() < 1e-11 * (1.0 + expected[at].abs()));
                }
            }
        }
    }
}
