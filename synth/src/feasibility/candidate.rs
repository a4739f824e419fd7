//! From a solver's dual solution, in scaled units, to weights in SI units.

use std::collections::HashMap;

use nalgebra::{DMatrix, DVector};

use crate::certify::infeasible::{
    HeldMoments, InputWeight, Moments, RegionWeight, VertexWeight, Weights,
};
use crate::conditions::xu2020::{condition_name, Interval};
use crate::conditions::Task;
use crate::lmi::svec_index;
use crate::model::Model;
use crate::scaling::Scaling;
use crate::synthesis::Assembled;

/// Below this eps3 the moments E[v x(t_k^l)'] of r = 2 are not left to the balance of the multiplier,
/// which divides by it.
const SMALLEST_SAMPLE_WEIGHT: f64 = 1e-3;

/// The dual matrices by the names of their conditions.
struct Duals<'a> {
    by_name: HashMap<&'a str, DMatrix<f64>>,
}

impl<'a> Duals<'a> {
    fn new(assembled: &'a Assembled, duals: &[Vec<f64>], factor: f64) -> Self {
        let pairs = assembled.problem.conditions.iter().zip(duals);
        let full = pairs.map(|(condition, dual)| {
            let side = condition.side();
            let matrix = DMatrix::from_fn(side, side, |r, c| {
                factor * dual[svec_index(r.min(c), r.max(c))]
            });
            (condition.name(), matrix)
        });
        Duals {
            by_name: full.collect(),
        }
    }

    fn get(&self, name: &str) -> Option<&DMatrix<f64>> {
        let found = self.by_name.get(name)?;
        found.iter().all(|entry| entry.is_finite()).then_some(found)
    }
}

/// Where the dual solution came from.
pub struct Source<'a> {
    pub model: &'a Model,
    pub scaling: &'a Scaling,
    pub task: &'a Task,
    pub assembled: &'a Assembled,
    pub duals: &'a [Vec<f64>],
    /// About minus the constant that they give.
    pub size: f64,
}

impl Source<'_> {
    /// The weights that the dual solution gives, scaled so that their constant is about -1; `None`
    /// when it is not finite. Where the model's trigger threshold is below that of the problem, the
    /// held state is taken for the sample, which it almost is.
    pub fn weights(&self) -> Option<Weights> {
        let duals = Duals::new(self.assembled, self.duals, 1.0 / self.size);
        let system = self.model.plant.nominal().takagi_sugeno();
        let mut start = self.moments(&duals, Interval::Start)?;
        let mut end = self.moments(&duals, Interval::End)?;
        if self.model.file.specs.nu < self.task.specification.trigger_threshold {
            start.held = None;
            end.held = None;
        }
        if self.model.file.specs.eps[2].abs() >= SMALLEST_SAMPLE_WEIGHT {
            end.multiplied_sample = None;
        }
        let n = system.states();
        let integral = duals.get("decrease r=2 clique integral")?;
        let integral = self.state(&integral.view((0, 0), (n, n)).into_owned());
        let inputs = (0..system.inputs()).map(|input| {
            let dual = duals.get(&format!("anti-windup input {}", input + 1))?;
            let unit = self.scaling.input[input];
            Some(InputWeight {
                state: self.state(&dual.view((0, 0), (n, n)).into_owned()) / (unit * unit),
                unit: dual[(n, n)],
            })
        });
        let bounds = system.region.iter().zip(&self.task.system.region);
        let region = bounds.map(|(bound, scaled)| {
            let dual = duals.get(&format!("box {}", bound.name))?;
            let rows = bound.rows.nrows();
            let unit = (bound.bound_squared / scaled.bound_squared).sqrt();
            let state = self.state(&dual.view((0, 0), (n, n)).into_owned());
            let cross = self.to_state() * dual.view((0, n), (n, rows));
            Some(RegionWeight {
                state: state / (unit * unit),
                cross: cross / unit,
                unit: dual.view((n, n), (rows, rows)).into_owned(),
            })
        });
        let contained = self.model.file.specs.must_contain.len();
        let must_contain = (1..=contained).map(|state| {
            let dual = duals.get(&format!("must contain state {state}"))?;
            Some(self.state(dual))
        });
        Some(Weights {
            containment_weight: self.task.specification.containment_weight,
            integral: integral / self.integral_factor(),
            start,
            end,
            inputs: inputs.collect::<Option<_>>()?,
            region: region.collect::<Option<_>>()?,
            must_contain: must_contain.collect::<Option<_>>()?,
        })
    }

    fn moments(&self, duals: &Duals, interval: Interval) -> Option<Moments> {
        let system = &self.task.system;
        let (n, d) = (system.states(), system.disturbance.ncols());
        let clique = |name: &str| {
            let name = format!("decrease r={} clique {name}", interval.index());
            duals.get(&name)
        };
        let root = clique("root")?;
        let disturbance = clique("disturbance")?;
        let held = clique("held state")?;
        let part = |matrix: &DMatrix<f64>, row: usize, column: usize| {
            self.state(&matrix.view((row, column), (n, n)).into_owned())
        };
        let vertices = (0..system.vertices.len()).filter_map(|vertex| {
            let dual = duals.get(&condition_name(interval, vertex))?;
            let moments = self.pair(dual);
            Some(VertexWeight { vertex, moments })
        });
        let unit = self.scaling.disturbance;
        let cross = disturbance.view((0, d), (d, n)).transpose();
        Some(Moments {
            vertices: vertices.collect(),
            state_sample: part(root, 0, 2 * n),
            multiplied_sample: Some(part(root, n, 2 * n)),
            sample: part(root, 2 * n, 2 * n),
            multiplied_disturbance: unit * self.to_state() * cross,
            disturbance: unit * unit * disturbance.view((0, 0), (d, d)),
            held: Some(HeldMoments {
                multiplied_held: part(held, n, 0),
                sample_held: part(held, 2 * n, 0),
                held: part(held, 0, 0),
            }),
        })
    }

    fn to_state(&self) -> DMatrix<f64> {
        DMatrix::from_diagonal(&self.scaling.state.map(|unit| 1.0 / unit))
    }

    /// Moments of two quantities in units of the state.
    fn state(&self, moments: &DMatrix<f64>) -> DMatrix<f64> {
        self.to_state() * moments * self.to_state()
    }

    /// Moments of a pair of such quantities.
    fn pair(&self, moments: &DMatrix<f64>) -> DMatrix<f64> {
        let units = &self.scaling.state;
        let n = units.len();
        let both = DVector::from_fn(2 * n, |row, _| 1.0 / units[row % n]);
        let to_state = DMatrix::from_diagonal(&both);
        &to_state * moments * &to_state
    }

    /// hbar e^(phi hbar): the solver's integral coordinate is its root times the proof's.
    fn integral_factor(&self) -> f64 {
        let specs = &self.model.file.specs;
        specs.hbar_s * (specs.phi_per_s * specs.hbar_s).exp()
    }
}
