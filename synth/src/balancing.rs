//! Units of states from the plant itself.
//!
//! A diagonal change of units x = D x' turns A, B, C into D^-1 A D, D^-1 B, C D. Here every column of B and every row
//! of C counts with a length of one, whatever the units of inputs and outputs, and D makes the row and the column of
//! each state equally long (E. E. Osborne, "On pre-conditioning of matrices", Journal of the ACM 7 (1960) 338-345). The
//! result does not depend on the units in which the plant is stated. A common factor that nothing fixes makes the state
//! that the disturbance reaches within a second about 1.

use nalgebra::{DMatrix, DVector};

use crate::fuzzy::TakagiSugeno;

/// Passes over the states.
const PASSES: usize = 1000;

/// Largest logarithm of a change that ends the passes.
const CONVERGED: f64 = 1e-9;

/// The largest change of a unit, as a power of two: a state that nothing drives or observes keeps a finite one.
const LARGEST_EXPONENT: f64 = 60.0;

/// An extent for each state: the known ones, and for the others what balances the plant.
pub fn balanced(system: &TakagiSugeno, known: &[Option<f64>]) -> DVector<f64> {
    let mut units = DVector::from_iterator(known.len(), known.iter().map(|d| d.unwrap_or(1.0)));
    if known.iter().all(Option::is_some) {
        return units;
    }
    let plant = Magnitudes::of(system);
    for _ in 0..PASSES {
        let mut change: f64 = 0.0;
        for state in (0..known.len()).filter(|&state| known[state].is_none()) {
            let (row, column) = plant.lengths(&units, state);
            if row > 0.0 && column > 0.0 {
                let factor = (row / column).sqrt();
                let limit = LARGEST_EXPONENT.exp2();
                units[state] = (units[state] * factor).clamp(1.0 / limit, limit);
                change = change.max(factor.ln().abs());
            }
        }
        if change < CONVERGED {
            break;
        }
    }
    match known.iter().any(Option::is_some) {
        true => units,
        false => &units * reached_within_a_second(system, &units),
    }
}

/// The largest scaled state that a constant disturbance reaches within a second when nothing else acts; 1 without one.
fn reached_within_a_second(system: &TakagiSugeno, units: &DVector<f64>) -> f64 {
    let columns = system.disturbance.column_iter();
    let lengths = columns.map(|column| column.component_div(units).norm());
    let reached = lengths.fold(0.0, f64::max) * system.disturbance_bound;
    match reached.is_normal() {
        true => reached,
        false => 1.0,
    }
}

/// Magnitudes of the plant's entries, the largest over all vertices.
struct Magnitudes {
    /// n x n, the diagonal left out.
    state: DMatrix<f64>,
    /// Inputs and disturbances side by side.
    driving: DMatrix<f64>,
    output: DMatrix<f64>,
}

impl Magnitudes {
    fn of(system: &TakagiSugeno) -> Self {
        let n = system.states();
        let mut state = DMatrix::<f64>::zeros(n, n);
        for vertex in &system.vertices {
            state.zip_apply(vertex, |largest, entry| *largest = largest.max(entry.abs()));
        }
        state.fill_diagonal(0.0);
        let columns = system
            .input
            .column_iter()
            .chain(system.disturbance.column_iter());
        let columns: Vec<DVector<f64>> = columns.map(|column| column.abs()).collect();
        Magnitudes {
            state,
            driving: DMatrix::from_columns(&columns),
            output: system.output.abs(),
        }
    }

    /// The lengths of a state's row in [A, B] and of its column in [A; C], in the given units.
    fn lengths(&self, units: &DVector<f64>, state: usize) -> (f64, f64) {
        let unit = units[state];
        let within =
            |row: f64, column: f64, other: f64| (row * other / unit, column * unit / other);
        let (mut row, mut column) = (0.0, 0.0);
        for other in 0..units.len() {
            let entry = (self.state[(state, other)], self.state[(other, state)]);
            let (a, b) = within(entry.0, entry.1, units[other]);
            row += a * a;
            column += b * b;
        }
        for input in self.driving.column_iter() {
            let length = input.component_div(units).norm();
            if length > 0.0 {
                row += (input[state] / unit / length).powi(2);
            }
        }
        for output in self.output.row_iter() {
            let length = output.transpose().component_mul(units).norm();
            if length > 0.0 {
                column += (output[state] * unit / length).powi(2);
            }
        }
        (row.sqrt(), column.sqrt())
    }
}
