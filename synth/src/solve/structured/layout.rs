//! The problem as the iterations see it: rows and unknowns that matter, in balanced units, packed.

use super::iterate::Point;
use crate::lmi::{self, Entry, Semidefinite};

/// Passes of the balancing.
const BALANCING_PASSES: usize = 4;

/// One entry of a symmetric coefficient on or above the diagonal.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Row, not below the column's place on the diagonal.
    pub row: usize,
    /// Column.
    pub column: usize,
    /// Place of (row, column) in the column-major block.
    pub at: usize,
    /// Place of (column, row).
    pub mirror: usize,
    /// The value off the diagonal, half the value on it: `<A, W>` for the symmetric part of any W is the sum of
    /// weight (W\[at\] + W\[mirror\]).
    pub weight: f64,
}

impl Place {
    /// The entry itself.
    pub fn value(&self) -> f64 {
        if self.row == self.column {
            2.0 * self.weight
        } else {
            self.weight
        }
    }
}

/// One block: `constant + sum_i y_i coefficient_i >= 0`.
#[derive(Debug, Clone)]
pub struct Block {
    /// Side.
    pub side: usize,
    /// Where its side * side entries begin in packed storage.
    pub offset: usize,
    /// Constant matrix.
    pub constant: Vec<Place>,
    /// Unknowns that occur, those with the most entries first.
    pub unknowns: Vec<usize>,
    /// Entries of the k-th of these unknowns: `entries[starts[k]..starts[k + 1]]`.
    pub starts: Vec<usize>,
    /// See `starts`.
    pub entries: Vec<Place>,
    /// Index of the cone it comes from.
    source: usize,
    /// Its rows in that cone.
    rows: Vec<usize>,
    /// Factor of each row: the block is `D X D` of the cone's X.
    scale: Vec<f64>,
}

impl Block {
    /// Where it lies in packed storage.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.offset..self.offset + self.side * self.side
    }

    /// Entries of the k-th unknown.
    pub fn entries_of(&self, k: usize) -> &[Place] {
        &self.entries[self.starts[k]..self.starts[k + 1]]
    }
}

/// The problem in balanced units.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Cost of each kept unknown.
    pub cost: Vec<f64>,
    /// Blocks.
    pub blocks: Vec<Block>,
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
        layout
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
        // The rows of the last unknowns first: what the last unknowns ask for then lies in the leading rows.
        let mut rows: Vec<usize> = (0..cone.side)
            .filter(|&row| last_touched[row].is_some())
            .collect();
        rows.sort_by_key(|&row| (std::cmp::Reverse(last_touched[row]), row));
        let side = rows.len();
        let mut position = vec![0; cone.side];
        rows.iter()
            .enumerate()
            .for_each(|(k, &row)| position[row] = k);
        let places = |entries: &[Entry]| -> Vec<Place> {
            let kept = entries.iter().filter(|entry| entry.value != 0.0);
            kept.map(|e| place_of(position[e.row], position[e.column], e.value, side))
                .collect()
        };
        let mut block = Block {
            side,
            offset: self.length,
            constant: places(&cone.constant),
            unknowns: coefficients.iter().map(|(unknown, _)| *unknown).collect(),
            starts: vec![0],
            entries: Vec::new(),
            source,
            rows,
            scale: vec![1.0; side],
        };
        for (_, entries) in &coefficients {
            block.entries.extend(places(entries));
            block.starts.push(block.entries.len());
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
                        largest[unknown] = largest[unknown].max(entry.value().abs());
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
        let largest_constant = constants.fold(0.0_f64, |max, entry| max.max(entry.value().abs()));
        let cost_unit = power_of_two(largest_cost);
        self.constant_unit = power_of_two(largest_constant);
        self.objective_unit = cost_unit * self.constant_unit;
        self.cost.iter_mut().for_each(|cost| *cost /= cost_unit);
        for block in &mut self.blocks {
            for entry in &mut block.constant {
                entry.weight /= self.constant_unit;
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
            for (j, &column) in block.rows.iter().enumerate() {
                for (i, &row) in block.rows.iter().enumerate().take(j + 1) {
                    out[block.source][lmi::svec_index(row.min(column), row.max(column))] =
                        cost_unit * block.scale[i] * block.scale[j] * packed[j * block.side + i];
                }
            }
        }
        out
    }

    /// The point of the balanced problem that belongs to values and duals of the problem; its slack is
    /// computed from the values.
    pub fn point(&self, values: &[f64], duals: &[Vec<f64>]) -> Point {
        let cost_unit = self.objective_unit / self.constant_unit;
        let kept = self.unknown_source.iter().zip(&self.unknown_unit);
        let y = kept.map(|(&source, unit)| values[source] / (unit * self.constant_unit));
        let mut point = Point {
            y: y.collect(),
            s: vec![0.0; self.length],
            z: vec![0.0; self.length],
        };
        for block in &self.blocks {
            let packed = &mut point.z[block.range()];
            for (j, &column) in block.rows.iter().enumerate() {
                for (i, &row) in block.rows.iter().enumerate() {
                    let at = lmi::svec_index(row.min(column), row.max(column));
                    let unit = cost_unit * block.scale[i] * block.scale[j];
                    packed[j * block.side + i] = duals[block.source][at] / unit;
                }
            }
        }
        self.evaluate(1.0, &point.y, &mut point.s);
        point
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
            block.unknowns.push(shift);
            block
                .entries
                .extend((0..block.side).map(|k| place_of(k, k, 1.0, block.side)));
            block.starts.push(block.entries.len());
        }
        out.blocks.push(Block {
            side: 1,
            offset: out.length,
            constant: vec![place_of(0, 0, 1.0, 1)],
            unknowns: vec![shift],
            starts: vec![0, 1],
            entries: vec![place_of(0, 0, 1.0, 1)],
            source: 0,
            rows: Vec::new(),
            scale: Vec::new(),
        });
        out.length += 1;
        out.order += 1;
        out
    }

    /// `out = constant * factor + sum_i y_i coefficient_i`, packed and full.
    pub fn evaluate(&self, factor: f64, y: &[f64], out: &mut [f64]) {
        for block in &self.blocks {
            block.evaluate(factor, y, &mut out[block.range()]);
        }
    }

    /// `out_i = <A_i, W>` with the symmetric part of W.
    pub fn adjoint(&self, w: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for block in &self.blocks {
            let w = &w[block.range()];
            for (k, &unknown) in block.unknowns.iter().enumerate() {
                out[unknown] += inner(block.entries_of(k), w);
            }
        }
    }

    /// `<constant, W>` with the symmetric part of W.
    pub fn against_constant(&self, w: &[f64]) -> f64 {
        let blocks = self.blocks.iter();
        blocks
            .map(|block| inner(&block.constant, &w[block.range()]))
            .sum()
    }

    /// Frobenius norm of the constant.
    pub fn constant_norm(&self) -> f64 {
        let squares = |e: &Place| {
            let count = if e.row == e.column { 1.0 } else { 2.0 };
            count * e.value() * e.value()
        };
        let entries = self.blocks.iter().flat_map(|block| &block.constant);
        entries.map(squares).sum::<f64>().sqrt()
    }

    /// Frobenius norm of each unknown's coefficients, over all blocks.
    pub fn coefficient_norms(&self) -> Vec<f64> {
        let mut squares = vec![0.0; self.cost.len()];
        for block in &self.blocks {
            for (k, &unknown) in block.unknowns.iter().enumerate() {
                for e in block.entries_of(k) {
                    let count = if e.row == e.column { 1.0 } else { 2.0 };
                    squares[unknown] += count * e.value() * e.value();
                }
            }
        }
        squares.iter().map(|square: &f64| square.sqrt()).collect()
    }
}

impl Block {
    fn scale_unknowns(&mut self, factors: &[f64]) {
        for (k, &unknown) in self.unknowns.iter().enumerate() {
            for entry in &mut self.entries[self.starts[k]..self.starts[k + 1]] {
                entry.weight *= factors[unknown];
            }
        }
    }

    fn balance_rows(&mut self) {
        let mut largest = vec![0.0_f64; self.side];
        for entry in &self.entries {
            let size = entry.value().abs();
            largest[entry.row] = largest[entry.row].max(size);
            largest[entry.column] = largest[entry.column].max(size);
        }
        let factors: Vec<f64> = largest
            .iter()
            .map(|&size| power_of_two(1.0 / size.sqrt()))
            .collect();
        for entry in self.entries.iter_mut().chain(&mut self.constant) {
            entry.weight *= factors[entry.row] * factors[entry.column];
        }
        for (scale, factor) in self.scale.iter_mut().zip(&factors) {
            *scale *= factor;
        }
    }

    fn evaluate(&self, factor: f64, y: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        // The mirrored entry of a diagonal one is itself: it gets its two halves.
        let mut add = |entry: &Place, factor: f64| {
            out[entry.at] += factor * entry.weight;
            out[entry.mirror] += factor * entry.weight;
        };
        if factor != 0.0 {
            self.constant.iter().for_each(|entry| add(entry, factor));
        }
        for (k, &unknown) in self.unknowns.iter().enumerate() {
            let value = y[unknown];
            self.entries_of(k)
                .iter()
                .for_each(|entry| add(entry, value));
        }
    }
}

/// `<A, W>` for the symmetric part of W.
#[inline(always)]
fn inner(entries: &[Place], w: &[f64]) -> f64 {
    entries
        .iter()
        .map(|e| e.weight * (w[e.at] + w[e.mirror]))
        .sum()
}

fn place_of(row: usize, column: usize, value: f64, side: usize) -> Place {
    let (row, column) = (row.min(column), row.max(column));
    Place {
        row,
        column,
        at: column * side + row,
        mirror: row * side + column,
        weight: if row == column { 0.5 * value } else { value },
    }
}

/// The power of two nearest to a positive number; 1 for zero and infinity, which stand for "nothing there".
fn power_of_two(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return 1.0;
    }
    x.log2().round().clamp(-500.0, 500.0).exp2()
}

/// Zero dual matrices for all cones.
pub fn zero_duals(problem: &Semidefinite) -> Vec<Vec<f64>> {
    let height = |cone: &lmi::Cone| cone.side * (cone.side + 1) / 2;
    problem
        .cones
        .iter()
        .map(|cone| vec![0.0; height(cone)])
        .collect()
}

/// An eigenvector of a constant cone that is clearly not semidefinite.
fn negative_direction(cone: &lmi::Cone) -> Option<Vec<f64>> {
    let n = cone.side;
    let mut full = vec![0.0; n * n];
    for entry in &cone.constant {
        full[entry.column * n + entry.row] = entry.value;
        full[entry.row * n + entry.column] = entry.value;
    }
    let (values, vectors) = super::dense::eigen(&full, n);
    let size = values
        .iter()
        .fold(0.0_f64, |max, value| max.max(value.abs()));
    let worst = (0..n).min_by(|&a, &b| values[a].total_cmp(&values[b]))?;
    (values[worst] < -1e-12 * size).then(|| vectors[worst * n..(worst + 1) * n].to_vec())
}
