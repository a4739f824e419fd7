//! Change of units by powers of two, which undoes exactly.
//!
//! x = D x', u = E u', tau = c tau' with D, E diagonal. Without it the solver stalls: in SI units the
//! entries of one condition span many orders of magnitude.

use nalgebra::{DMatrix, DVector};

use crate::balancing::balanced;
use crate::conditions::units::power_of_two;
use crate::conditions::xu2020::Containment;
use crate::conditions::{FloorSupply, FurtherSignal, LoopImperfections, Task};
use crate::fuzzy::{BoxCondition, TakagiSugeno};

/// Units of the scaled problem; every entry is a power of two.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaling {
    /// Unit of each state.
    pub state: DVector<f64>,
    /// Unit of each input.
    pub input: DVector<f64>,
    /// Unit of the disturbance.
    pub disturbance: f64,
}

impl Scaling {
    /// Units from the model: a state's unit is `fraction` of the smallest extent of the region along
    /// it, or balances the plant; an input's is half its limit, or less where that keeps the scaled column of B below 1; the
    /// disturbance's makes the largest scaled column of B_w about 1/3.
    pub fn automatic(system: &TakagiSugeno, fraction: f64) -> Self {
        Self::with_state_units(system, state_units(system, fraction))
    }

    /// The same for one state unit near a given size, in place of a fraction of the region.
    pub fn of_size(system: &TakagiSugeno, size: f64) -> Self {
        let unit = power_of_two(size);
        Self::with_state_units(system, DVector::from_element(system.states(), unit))
    }

    /// The same with the given units of the state, powers of two.
    pub fn with_state_units(system: &TakagiSugeno, state: DVector<f64>) -> Self {
        let largest = |column: nalgebra::DVectorView<f64>| -> f64 {
            let scaled = column.component_div(&state);
            scaled.norm().max(f64::MIN_POSITIVE)
        };
        let inputs = system.input.column_iter().zip(system.input_limit.iter());
        let inputs =
            inputs.map(|(column, limit)| power_of_two((0.5 * limit).min(1.0 / largest(column))));
        let disturbance = system
            .disturbance
            .column_iter()
            .map(largest)
            .fold(f64::MIN_POSITIVE, f64::max);
        Scaling {
            input: DVector::from_iterator(system.inputs(), inputs),
            disturbance: power_of_two(1.0 / (3.0 * disturbance)),
            state,
        }
    }

    /// D^-1: from a state in SI units to one in these.
    pub fn to_state(&self) -> DMatrix<f64> {
        DMatrix::from_diagonal(&self.state.map(|unit| 1.0 / unit))
    }

    /// The task in the scaled units.
    pub fn apply(&self, task: &Task) -> Task {
        let system = &task.system;
        let d = DMatrix::from_diagonal(&self.state);
        let d_inverse = self.to_state();
        let e = DMatrix::from_diagonal(&self.input);
        let c = self.disturbance;
        let region = system.region.iter().map(|bound| {
            let rows = &bound.rows * &d;
            let longest = rows.row_iter().map(|row| row.norm()).fold(0.0, f64::max);
            let unit = power_of_two(longest.max(f64::MIN_POSITIVE));
            BoxCondition {
                name: bound.name.clone(),
                rows: rows / unit,
                bound_squared: bound.bound_squared / (unit * unit),
            }
        });
        let mut specification = task.specification.clone();
        specification.disturbance_weight_max *= c * c;
        for state in &mut specification.must_contain {
            *state = &d_inverse * &*state;
        }
        let e_inverse = DMatrix::from_diagonal(&self.input.map(|unit| 1.0 / unit));
        let mut gains = task.gains.clone();
        for gain in gains.given.iter_mut().flatten() {
            *gain = &e_inverse * &*gain * &d;
        }
        let containment = task.containment.as_ref().map(|containment| {
            let scaled = |sets: &[DMatrix<f64>]| sets.iter().map(|set| &d_inverse * set).collect();
            Containment {
                linearisation: &d * &containment.linearisation * &d_inverse,
                contained: scaled(&containment.contained),
                scaled: scaled(&containment.scaled),
            }
        });
        let further = task.further_signals.iter().map(|signal| FurtherSignal {
            name: signal.name,
            coefficient: &d_inverse * &signal.coefficient * c,
            bound: signal.bound / c,
        });
        let loop_of = &task.imperfections;
        let imperfections = LoopImperfections {
            oldest_sample: loop_of.oldest_sample,
            gain_error: loop_of
                .gain_error
                .as_ref()
                .map(|error| error.in_units(&self.input)),
            measurement: loop_of
                .measurement
                .as_ref()
                .map(|error| error.in_units(&self.state, &self.input, c)),
            floor: FloorSupply {
                constant: loop_of.floor.constant * c * c,
                ..loop_of.floor
            },
        };
        Task {
            imperfections,
            further_signals: further.collect(),
            containment,
            gains,
            system: TakagiSugeno {
                vertices: system
                    .vertices
                    .iter()
                    .map(|a| &d_inverse * a * &d)
                    .collect(),
                descriptors: system
                    .descriptors
                    .iter()
                    .map(|descriptor| &d_inverse * descriptor * &d)
                    .collect(),
                input: &d_inverse * &system.input * &e,
                disturbance: &d_inverse * &system.disturbance * c,
                output: &system.output * &d,
                input_limit: system.input_limit.component_div(&self.input),
                disturbance_bound: system.disturbance_bound / c,
                region: region.collect(),
            },
            specification,
            disturbance_weight_unit: task.disturbance_weight_unit / (c * c),
            gain_per_weight: task.gain_per_weight,
            held_is_sample: task.held_is_sample,
        }
    }
}

/// A unit for each state: `fraction` of the smallest extent of the region along it. A state that the region does not
/// bound has one that balances the plant, beside the others.
fn state_units(system: &TakagiSugeno, fraction: f64) -> DVector<f64> {
    extents(system).map(|extent| power_of_two(fraction * extent))
}

/// The size of each state: the smallest extent of the region along it, or what balances the plant. Where the region
/// bounds no state, the state that the disturbance reaches within a second is about 1.
fn extents(system: &TakagiSugeno) -> DVector<f64> {
    let known: Vec<Option<f64>> = (0..system.states())
        .map(|state| system.extent(state))
        .collect();
    if let Some(all) = known.iter().copied().collect::<Option<Vec<f64>>>() {
        return DVector::from_vec(all);
    }
    let inputs = system.input.column_iter();
    let driving: Vec<_> = inputs.chain(system.disturbance.column_iter()).collect();
    let sizes = balanced(&system.vertices, &DMatrix::from_columns(&driving), &known);
    match known.iter().any(Option::is_some) {
        true => sizes,
        false => &sizes * reached_within_a_second(system, &sizes),
    }
}

/// The largest state, relative to the sizes, that a constant disturbance reaches within a second when nothing else acts;
/// 1 without one.
fn reached_within_a_second(system: &TakagiSugeno, sizes: &DVector<f64>) -> f64 {
    let columns = system.disturbance.column_iter();
    let lengths = columns.map(|column| column.component_div(sizes).norm());
    let reached = lengths.fold(0.0, f64::max) * system.disturbance_bound;
    match reached.is_normal() {
        true => reached,
        false => 1.0,
    }
}

/// The largest natural disturbance, relative to its bound: limits that are hardly any are no measure.
const LARGEST_DISTURBANCE: f64 = 1e3;

/// `(y0 tau0)^2` for an output y0 at the edge of the region and a disturbance tau0 that acts on the plant as much as
/// the inputs can: what makes g and xi comparable whatever the units of disturbances, inputs, states and outputs.
pub fn natural_gain_per_weight(system: &TakagiSugeno) -> f64 {
    let sizes = extents(system);
    let acts = |column: nalgebra::DVectorView<f64>| column.component_div(&sizes).norm();
    let authorities = system.input.column_iter().zip(&system.input_limit);
    let authority = authorities
        .map(|(column, limit)| acts(column) * limit)
        .fold(0.0, f64::max);
    let disturbance = system
        .disturbance
        .column_iter()
        .map(acts)
        .fold(0.0, f64::max);
    let tau0 = (authority / disturbance).min(LARGEST_DISTURBANCE * system.disturbance_bound);
    let seen = system
        .output
        .row_iter()
        .map(|row| row.transpose().component_mul(&sizes).norm());
    let ratio = (seen.fold(0.0, f64::max) * tau0).powi(2);
    match ratio.is_normal() {
        true => ratio,
        false => 1.0,
    }
}
