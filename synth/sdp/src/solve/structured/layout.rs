//! The problem as the iterations see it: rows and unknowns that matter, in balanced units, packed.

use nalgebra::DMatrix;

use super::block::{power_of_two, Block};
use super::dense::LANES;
use super::threads::{both, halfway};
use crate::lmi::{self, Entry, Semidefinite};

/// Work of an iteration outside of the Schur complement [multiplications] below which a second thread does not pay.
const WORTH_A_THREAD: usize = 4_000_000;

/// Passes of the balancing.
const BALANCING_PASSES: usize = 4;

/// The problem in balanced units.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Cost of each kept unknown.
    pub cost: Vec<f64>,
    /// Blocks.
    pub blocks: Vec<Block>,
    /// Index of the first block of the second half: the halves are worked on by one thread each, where it pays.
    pub middle: usize,
    /// Length of packed storage.
    pub length: usize,
    /// Sum of the sides.
    pub order: usize,
    /// Balanced unit of the objective: the problem's cost is this times the balanced one.
    pub objective_unit: f64,
    /// Unit of each kept unknown.
    unknown_unit: Vec<f64>,
    /// Index of each kept unknown in the problem.
    unknown_source: Vec<usize>,
    /// Unit of the constants' size.
    constant_unit: f64,
    /// Unknowns without any entry whose cost is not zero.
    pub unbounded_unknown: bool,
    /// A constant cone that is not semidefinite: its index and eigenvector.
    pub contradiction: Option<(usize, Vec<f64>)>,
}

impl Layout {
    /// Drops rows and unknowns without entries and balances the rest. All numbers must be finite.
    pub fn new(problem: &Semidefinite) -> Self {
        let mut used = vec![false; problem.cost.len()];
        for (unknown, entries) in problem.cones.iter().flat_map(|cone| &cone.coefficients) {
            used[*unknown] |= entries.iter().any(|entry| entry.value != 0.0);
        }
        let kept: Vec<usize> = (0..used.len()).filter(|&u| used[u]).collect();
        let mut place = vec![usize::MAX; used.len()];
        kept.iter().enumerate().for_each(|(k, &u)| place[u] = k);
        let lost_cost = |u: usize| !used[u] && problem.cost[u] != 0.0;
        let mut layout = Layout {
            cost: kept.iter().map(|&u| problem.cost[u]).collect(),
            blocks: Vec::new(),
            middle: 0,
            length: 0,
            order: 0,
            objective_unit: 1.0,
            unknown_unit: vec![1.0; kept.len()],
            constant_unit: 1.0,
            unbounded_unknown: (0..used.len()).any(lost_cost),
            unknown_source: kept,
            contradiction: None,
        };
        for (source, cone) in problem.cones.iter().enumerate() {
            layout.add(source, cone, &place);
        }
        layout.balance();
        layout.finish();
        layout
    }

    /// Once nothing changes any more: the blocks' compact entries, and the halves.
    fn finish(&mut self) {
        self.blocks.iter_mut().for_each(Block::finish);
        let work = |block: &Block| {
            let padded = block.side.next_multiple_of(LANES);
            12 * block.side * padded * padded + 16 * block.entries.len()
        };
        let work: Vec<usize> = self.blocks.iter().map(work).collect();
        self.middle = match work.iter().sum::<usize>() >= WORTH_A_THREAD {
            true => halfway(&work),
            false => work.len(),
        };
    }

    /// Where the second half begins in packed storage.
    pub fn middle_offset(&self) -> usize {
        self.blocks
            .get(self.middle)
            .map_or(self.length, |block| block.offset)
    }

    fn add(&mut self, source: usize, cone: &lmi::Cone, place: &[usize]) {
        let nonzero = |entries: &[Entry]| entries.iter().any(|entry| entry.value != 0.0);
        let varying = cone.coefficients.iter().filter(|(_, e)| nonzero(e));
        let mut coefficients: Vec<(usize, &[Entry])> =
            varying.map(|(u, e)| (place[*u], e.as_slice())).collect();
        if coefficients.is_empty() {
            if self.contradiction.is_none() {
                self.contradiction = negative_direction(cone).map(|v| (source, v));
            }
            return;
        }
        // The most entries first: what is left for each unknown to meet is then the cheapest.
        coefficients.sort_by_key(|(unknown, entries)| (usize::MAX - entries.len(), *unknown));
        let mut last_touched: Vec<Option<usize>> = vec![None; cone.side];
        let constant = std::iter::once(cone.constant.as_slice());
        let all = constant.chain(coefficients.iter().map(|(_, entries)| *entries));
        for (place, entries) in all.enumerate() {
            for entry in entries.iter().filter(|e| e.value != 0.0) {
                last_touched[entry.row] = Some(place);
                last_touched[entry.column] = Some(place);
            }
        }
        // The rows of the last unknowns first: what the last unknowns read then lies in the leading rows.
        let mut rows: Vec<usize> = (0..cone.side)
            .filter(|&row| last_touched[row].is_some())
            .collect();
        rows.sort_by_key(|&row| (std::cmp::Reverse(last_touched[row]), row));
        let side = rows.len();
        let mut position = vec![0; cone.side];
        rows.iter()
            .enumerate()
            .for_each(|(k, &row)| position[row] = k);
        let places = |entries: &[Entry]| -> Vec<Entry> {
            let kept = entries.iter().filter(|entry| entry.value != 0.0);
            kept.map(|e| Entry::new(position[e.row], position[e.column], e.value))
                .collect()
        };
        let mut block = Block::new(source, rows, self.length, places(&cone.constant));
        for (unknown, entries) in &coefficients {
            block.push(*unknown, places(entries));
        }
        self.length += side * side;
        self.order += side;
        self.blocks.push(block);
    }

    /// Scales unknowns, rows, the objective and the constants by powers of two so that their largest
    /// entries come near one (Ruiz's iteration; D X D keeps a block definite).
    fn balance(&mut self) {
        for _ in 0..BALANCING_PASSES {
            let mut largest = vec![0.0_f64; self.cost.len()];
            for block in &self.blocks {
                for (k, &unknown) in block.unknowns.iter().enumerate() {
                    for entry in block.entries_of(k) {
                        largest[unknown] = largest[unknown].max(entry.value.abs());
                    }
                }
            }
            let factors: Vec<f64> = largest
                .iter()
                .map(|&size| power_of_two(1.0 / size))
                .collect();
            for block in &mut self.blocks {
                block.scale_unknowns(&factors);
                block.balance_rows();
            }
            for ((unit, cost), factor) in self
                .unknown_unit
                .iter_mut()
                .zip(&mut self.cost)
                .zip(&factors)
            {
                *unit *= factor;
                *cost *= factor;
            }
        }
        let largest_cost = self
            .cost
            .iter()
            .fold(0.0_f64, |max, cost| max.max(cost.abs()));
        let constants = self.blocks.iter().flat_map(|block| &block.constant);
        let largest_constant = constants.fold(0.0_f64, |max, entry| max.max(entry.value.abs()));
        let cost_unit = power_of_two(largest_cost);
        self.constant_unit = power_of_two(largest_constant);
        self.objective_unit = cost_unit * self.constant_unit;
        self.cost.iter_mut().for_each(|cost| *cost /= cost_unit);
        for block in &mut self.blocks {
            for entry in &mut block.constant {
                entry.value /= self.constant_unit;
            }
        }
    }

    /// Values of all unknowns of the problem.
    pub fn values(&self, y: &[f64], unknowns: usize) -> Vec<f64> {
        let mut out = vec![0.0; unknowns];
        for ((&source, &unit), value) in self.unknown_source.iter().zip(&self.unknown_unit).zip(y) {
            out[source] = value * unit * self.constant_unit;
        }
        out
    }

    /// Dual matrices of all cones of the problem (upper triangles by columns) from packed ones.
    pub fn duals(&self, z: &[f64], problem: &Semidefinite) -> Vec<Vec<f64>> {
        let cost_unit = self.objective_unit / self.constant_unit;
        let mut out: Vec<Vec<f64>> = zero_duals(problem);
        for block in &self.blocks {
            let packed = &z[block.range()];
            for ((i, j), at, scale) in block.places().filter(|((i, j), ..)| i <= j) {
                out[block.source][at] = cost_unit * scale * packed[j * block.side + i];
            }
        }
        out
    }

    /// The point of the balanced problem that belongs to values and duals of the problem; its slack is
    /// computed from the values.
    pub fn point(&self, values: &[f64], duals: &[Vec<f64>]) -> Iterate {
        let cost_unit = self.objective_unit / self.constant_unit;
        let kept = self.unknown_source.iter().zip(&self.unknown_unit);
        let y = kept.map(|(&source, unit)| values[source] / (unit * self.constant_unit));
        let mut point = self.origin();
        point.y = y.collect();
        for block in &self.blocks {
            let packed = &mut point.z[block.range()];
            for ((i, j), at, scale) in block.places() {
                packed[j * block.side + i] = duals[block.source][at] / (cost_unit * scale);
            }
        }
        self.evaluate(1.0, &point.y, 1, &mut point.s);
        point
    }

    /// The point at which everything is zero.
    pub fn origin(&self) -> Iterate {
        Iterate {
            y: vec![0.0; self.cost.len()],
            s: vec![0.0; self.length],
            z: vec![0.0; self.length],
        }
    }

    /// Adds a multiple of the identity to a packed matrix.
    pub fn add_identity(&self, multiple: f64, w: &mut [f64]) {
        for block in &self.blocks {
            for k in 0..block.side {
                w[block.offset + k * block.side + k] += multiple;
            }
        }
    }

    /// Norm of `<A_i, Z> - c_i` from all `<A_i, Z>`.
    pub fn dual_residual(&self, products: &[f64]) -> f64 {
        let pairs = products.iter().zip(&self.cost);
        let squares = pairs.map(|(a, c)| (a - c) * (a - c));
        squares.sum::<f64>().sqrt()
    }

    /// The problem of the smallest t with `constant + A(y) + t I >= 0`, t >= -1: it always has an interior, and
    /// where its optimum is above zero its multipliers prove that this problem has no solution. Not for
    /// [`values`](Layout::values).
    pub fn smallest_shift(&self) -> Layout {
        let mut out = self.clone();
        let shift = out.cost.len();
        out.cost.iter_mut().for_each(|cost| *cost = 0.0);
        out.cost.push(1.0);
        for block in &mut out.blocks {
            block.push(shift, (0..block.side).map(|k| Entry::new(k, k, 1.0)));
        }
        let one = Entry::new(0, 0, 1.0);
        let mut bound = Block::new(0, vec![0], out.length, vec![one]);
        bound.push(shift, [one]);
        out.blocks.push(bound);
        out.length += 1;
        out.order += 1;
        out.finish();
        out
    }

    /// `out = constant * factor + sum_i y_i coefficient_i`, packed and full.
    pub fn evaluate(&self, factor: f64, y: &[f64], threads: usize, out: &mut [f64]) {
        self.fill_halves(threads, out, |blocks, base, out| {
            for block in blocks {
                let range = block.offset - base..block.range().end - base;
                block.evaluate(factor, y, &mut out[range]);
            }
        });
    }

    /// Fills packed storage half by half: the blocks of a half, where its storage begins, and its storage.
    pub fn fill_halves(
        &self,
        threads: usize,
        out: &mut [f64],
        fill: impl Fn(&[Block], usize, &mut [f64]) + Sync,
    ) {
        let middle = self.middle_offset();
        let (first, second) = out.split_at_mut(middle);
        let (before, after) = self.blocks.split_at(self.middle);
        both(
            threads,
            || fill(before, 0, first),
            || fill(after, middle, second),
        );
    }

    /// `out_i = <A_i, W>` for a symmetric W.
    pub fn adjoint(&self, w: &[f64], threads: usize, out: &mut [f64]) {
        let add = |blocks: &[Block], out: &mut [f64]| {
            out.fill(0.0);
            for block in blocks {
                block.adjoint(&w[block.range()], out);
            }
        };
        let (before, after) = self.blocks.split_at(self.middle);
        if after.is_empty() {
            return add(before, out);
        }
        let mut second = vec![0.0; out.len()];
        both(threads, || add(before, out), || add(after, &mut second));
        out.iter_mut().zip(&second).for_each(|(a, b)| *a += b);
    }

    /// `<constant, W>` for a symmetric W.
    pub fn against_constant(&self, w: &[f64]) -> f64 {
        let blocks = self.blocks.iter();
        blocks
            .map(|block| block.against_constant(&w[block.range()]))
            .sum()
    }

    /// Frobenius norm of the constant.
    pub fn constant_norm(&self) -> f64 {
        let squares = |e: &Entry| e.count() * e.value * e.value;
        let entries = self.blocks.iter().flat_map(|block| &block.constant);
        entries.map(squares).sum::<f64>().sqrt()
    }

    /// Frobenius norm of each unknown's coefficients, over all blocks.
    pub fn coefficient_norms(&self) -> Vec<f64> {
        let mut squares = vec![0.0; self.cost.len()];
        for block in &self.blocks {
            for (k, &unknown) in block.unknowns.iter().enumerate() {
                for e in block.entries_of(k) {
                    squares[unknown] += e.count() * e.value * e.value;
                }
            }
        }
        squares.iter().map(|square: &f64| square.sqrt()).collect()
    }
}

/// Zero dual matrices for all cones.
pub fn zero_duals(problem: &Semidefinite) -> Vec<Vec<f64>> {
    let zeros = problem.cones.iter().map(|cone| vec![0.0; cone.height()]);
    zeros.collect()
}

/// An eigenvector of a constant cone that is clearly not semidefinite.
fn negative_direction(cone: &lmi::Cone) -> Option<Vec<f64>> {
    if cone.constant.is_empty() {
        return None;
    }
    let mut full = DMatrix::zeros(cone.side, cone.side);
    for entry in &cone.constant {
        full[(entry.row, entry.column)] = entry.value;
        full[(entry.column, entry.row)] = entry.value;
    }
    let found = full.symmetric_eigen();
    let (worst, smallest) = found.eigenvalues.argmin();
    let eigenvector = found.eigenvectors.column(worst);
    (smallest < -1e-12 * found.eigenvalues.amax()).then(|| eigenvector.iter().copied().collect())
}

/// Unknowns y, slack matrices S (of the inequalities), multiplier matrices Z, packed.
#[derive(Debug, Clone)]
pub struct Iterate {
    /// Unknowns.
    pub y: Vec<f64>,
    /// Slack.
    pub s: Vec<f64>,
    /// Multipliers.
    pub z: Vec<f64>,
}
