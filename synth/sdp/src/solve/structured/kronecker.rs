//! A block's part of the Schur complement by the symmetric Kronecker product of Z and S^-1.
//!
//! `<A_i, Z A_j S^-1> = a_i' K a_j` with `a` the entries of a coefficient on and above the diagonal and
//! `K[(r,c), (p,q)] = (Z_rp S_qc + Z_rq S_pc + Z_cp S_qr + Z_cq S_pr) / 4` (S for S^-1). Where a small block has more
//! unknowns than places, as one vertex of many has, K and its products with sparse columns cost less than a
//! product for each unknown, and all of them run along contiguous memory.

use super::block::Block;
use super::dense::{add_vectors, LANES};

/// Columns of K A formed before they are transposed.
const TOGETHER: usize = 8;

/// Largest K [numbers].
const LARGEST: usize = 1 << 19;

/// How a block is treated, found once for a problem.
#[derive(Debug, Clone)]
pub struct KroneckerPlan {
    side: usize,
    /// Length of a column of K: the upper triangle by columns, each rounded up to a multiple of the lanes.
    height: usize,
    /// Places (row, column) that coefficients use, and where they stand in a column of K.
    places: Vec<(usize, usize)>,
    at: Vec<usize>,
    /// For the k-th unknown: `entries[starts[k]..starts[k + 1]]`, an index of a place and a weight each.
    starts: Vec<usize>,
    entries: Vec<(usize, f64)>,
}

/// Scratch, and the sum over consecutive blocks with the same unknowns.
#[derive(Debug, Default)]
pub struct KroneckerWork {
    /// Columns of Z and of S^-1, with zeros up to a multiple of the lanes.
    basis: Vec<f64>,
    /// K, one column for each place.
    kronecker: Vec<f64>,
    /// A few of K a_j.
    columns: Vec<f64>,
    /// K a_j for all unknowns j: one row for each place.
    rows: Vec<f64>,
    /// The sum, one row for each unknown: entries up to the diagonal.
    sum: Vec<f64>,
    unknowns: Vec<usize>,
}

/// Where column c of the upper triangle begins when each is rounded up to a multiple of the lanes.
fn column_start(c: usize) -> usize {
    let (whole, part) = (c / LANES, c % LANES);
    LANES * (LANES * whole * (whole + 1) / 2 + part * (whole + 1))
}

impl KroneckerPlan {
    /// The plan for a block and its cost in multiplications, `None` when K would be too large.
    pub fn new(block: &Block) -> Option<(Self, usize)> {
        let n = block.side;
        let height = column_start(n);
        let mut index = vec![usize::MAX; n * n];
        let mut places = Vec::new();
        let mut entries = Vec::with_capacity(block.entries.len());
        for e in &block.entries {
            let known = &mut index[e.column * n + e.row];
            if *known == usize::MAX {
                *known = places.len();
                places.push((e.row, e.column));
            }
            entries.push((*known, e.count() * e.value));
        }
        if height * places.len() > LARGEST {
            return None;
        }
        let unknowns = block.unknowns.len();
        let whole = 4 * height * places.len() + entries.len() * (height + unknowns / 2);
        let scattered = places.len() * unknowns;
        let plan = KroneckerPlan {
            side: n,
            height,
            at: places.iter().map(|&(r, c)| column_start(c) + r).collect(),
            places,
            starts: block.starts.clone(),
            entries,
        };
        Some((plan, whole / LANES + scattered / 2))
    }

    /// Adds the block's part to the sum in `work`, which goes to `out` (m x m) first when it belongs to other unknowns.
    #[inline(always)]
    pub fn add(
        &self,
        unknowns: &[usize],
        z: &[f64],
        s_inverse: &[f64],
        m: usize,
        work: &mut KroneckerWork,
        out: &mut [f64],
    ) {
        let count = unknowns.len();
        if work.unknowns != unknowns {
            work.flush(m, out);
            work.unknowns.extend_from_slice(unknowns);
            work.sum.resize(count * count, 0.0);
        }
        self.form(z, s_inverse, work);
        let stride = count.next_multiple_of(TOGETHER);
        work.rows.resize(self.places.len() * stride, 0.0);
        work.columns.resize(TOGETHER * self.height, 0.0);
        let column_of = |k: usize| &work.kronecker[k * self.height..(k + 1) * self.height];
        for first in (0..count).step_by(TOGETHER) {
            let columns = work.columns.chunks_exact_mut(self.height);
            for (k, column) in (first..count).zip(columns) {
                combine(self.entries_of(k), column_of, true, column);
            }
            for (row, &at) in work.rows.chunks_exact_mut(stride).zip(&self.at) {
                let part = &mut row[first..first + TOGETHER];
                for (k, value) in part.iter_mut().enumerate() {
                    *value = work.columns[k * self.height + at];
                }
            }
        }
        for k in 0..count {
            let row_of = |place: usize| &work.rows[place * stride..place * stride + k + 1];
            let sum = &mut work.sum[k * count..k * count + k + 1];
            combine(self.entries_of(k), row_of, false, sum);
        }
    }

    #[inline(always)]
    fn entries_of(&self, k: usize) -> &[(usize, f64)] {
        &self.entries[self.starts[k]..self.starts[k + 1]]
    }

    /// K's columns, four times as large.
    #[inline(always)]
    fn form(&self, z: &[f64], s_inverse: &[f64], work: &mut KroneckerWork) {
        let n = self.side;
        let padded = n.next_multiple_of(LANES);
        work.kronecker.resize(self.height * self.places.len(), 0.0);
        work.basis.clear();
        work.basis.resize(4 * padded, 0.0);
        let columns = work.kronecker.chunks_exact_mut(self.height);
        for (out, &(p, q)) in columns.zip(&self.places) {
            let from = [
                &z[p * n..(p + 1) * n],
                &z[q * n..(q + 1) * n],
                &s_inverse[p * n..(p + 1) * n],
                &s_inverse[q * n..(q + 1) * n],
            ];
            for (x, from) in work.basis.chunks_exact_mut(padded).zip(from) {
                x[..n].copy_from_slice(from);
            }
            let (zs, ss) = work.basis.split_at(2 * padded);
            let ((zp, zq), (sp, sq)) = (zs.split_at(padded), ss.split_at(padded));
            let mut rest = out;
            for c in 0..n {
                let top = (c / LANES + 1) * LANES;
                let (y, next) = rest.split_at_mut(top);
                rest = next;
                let a = [sq[c], sp[c], zp[c], zq[c]];
                add_vectors(a, [&zp[..top], &zq[..top], &sq[..top], &sp[..top]], true, y);
            }
        }
    }
}

/// `out = sum of weight * vector(index)`, or, unless `fresh`, added to what is there.
#[inline(always)]
fn combine<'a>(
    entries: &[(usize, f64)],
    vector: impl Fn(usize) -> &'a [f64],
    mut fresh: bool,
    out: &mut [f64],
) {
    let (fours, rest) = pulp::as_arrays::<4, _>(entries);
    for e in fours {
        add_vectors(e.map(|e| e.1), e.map(|e| vector(e.0)), fresh, out);
        fresh = false;
    }
    match *rest {
        [] => {}
        [a] => add_vectors([a.1], [vector(a.0)], fresh, out),
        [a, b] => add_vectors([a.1, b.1], [vector(a.0), vector(b.0)], fresh, out),
        [a, b, c, ..] => {
            let vectors = [vector(a.0), vector(b.0), vector(c.0)];
            add_vectors([a.1, b.1, c.1], vectors, fresh, out);
        }
    }
}

impl KroneckerWork {
    /// Adds the sum to the m x m matrix, each pair of unknowns once, and starts anew.
    pub fn flush(&mut self, m: usize, out: &mut [f64]) {
        let count = self.unknowns.len();
        for (k, &i) in self.unknowns.iter().enumerate() {
            let row = &mut out[i * m..(i + 1) * m];
            let sum = &self.sum[k * count..k * count + k + 1];
            for (&j, value) in self.unknowns.iter().zip(sum) {
                // K was four times as large.
                row[j] += 0.25 * value;
            }
        }
        self.unknowns.clear();
        self.sum.clear();
    }
}
