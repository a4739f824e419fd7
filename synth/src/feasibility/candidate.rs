//! From a solver's dual solution, in scaled units, to dual multipliers in SI units.

use std::collections::HashMap;

use nalgebra::{DMatrix, DVector};

use crate::certify::infeasible::{
    DeadZoneMoments, DualMultipliers, GainDuals, HeldMoments, InputDual, Moments, RegionDual,
    VertexDual,
};
use crate::conditions::xu2020::{
    condition_name, gain_suffix, terms, Basis, SamplingEnd, Signal, DEAD_ZONE_UNIT,
};
use crate::programs::{Assembled, DesignRequest, Solved};
use crate::reduce::cliques::{elimination, members};
use crate::reduce::vertex_slack::ELIMINATED;
use sdp::lmi::dual_matrix;

/// Below this eps3 the moments E[v x(t_k^l)'] of r = 2 are not computed from the stationarity in the multiplier,
/// which divides by it.
const SMALLEST_SAMPLE_WEIGHT: f64 = 1e-3;

/// The dual matrices by the names of their conditions.
struct Duals<'a> {
    by_name: HashMap<&'a str, DMatrix<f64>>,
}

impl<'a> Duals<'a> {
    fn new(assembled: &'a Assembled, duals: &[Vec<f64>], factor: f64) -> Self {
        let pairs = assembled.problem.conditions.iter().zip(duals);
        let matrices = pairs.map(|(condition, dual)| {
            (
                condition.name(),
                dual_matrix(condition.side(), dual) * factor,
            )
        });
        Duals {
            by_name: matrices.collect(),
        }
    }

    fn get(&self, name: &str) -> Option<&DMatrix<f64>> {
        let found = self.by_name.get(name)?;
        found.iter().all(|entry| entry.is_finite()).then_some(found)
    }
}

use Signal::{DeadZone, Disturbance, Further, Held, Integral, Multiplied, Sample, State};

/// A clique's name and its signals, in the order of its rows.
type Clique = (&'static str, Vec<Signal>);

/// A dual solution and the problem that it belongs to.
pub struct Source<'a> {
    /// The model, and the given gains that the dual multipliers are about.
    pub request: DesignRequest<'a>,
    pub solved: &'a Solved,
    /// The dual solution, or another that is as good.
    pub duals: &'a [Vec<f64>],
    /// About minus the constant that they give.
    pub size: f64,
}

impl Source<'_> {
    /// The dual multipliers that the dual solution gives, scaled so that their constant is about -1; `None`
    /// when it is not finite. Where the model's trigger threshold is below that of the problem, the
    /// held state is taken for the sample, which it almost is.
    pub fn weights(&self) -> Option<DualMultipliers> {
        let duals = Duals::new(&self.solved.assembled, self.duals, 1.0 / self.size);
        let count = self.solved.task.gains.count;
        let gains = (0..count).map(|rule| self.gain(&duals, rule));
        let system = self.request.model.plant.relaxed().takagi_sugeno();
        let n = system.states();
        let bounds = system.region.iter().zip(&self.solved.task.system.region);
        let region = bounds.map(|(bound, scaled)| {
            let dual = duals.get(&format!("box {}", bound.name))?;
            let rows = bound.rows.nrows();
            let unit = (bound.bound_squared / scaled.bound_squared).sqrt();
            let state = self.state(&dual.view((0, 0), (n, n)).into_owned());
            let cross = self.solved.scaling.to_state() * dual.view((0, n), (n, rows));
            Some(RegionDual {
                state: state / (unit * unit),
                cross: cross / unit,
                unit: dual.view((n, n), (rows, rows)).into_owned(),
            })
        });
        let contained = self.solved.task.specification.must_contain.len();
        let must_contain = (1..=contained).map(|state| {
            let dual = duals.get(&format!("must contain state {state}"))?;
            Some(self.state(dual))
        });
        Some(DualMultipliers {
            given: self.request.given.to_vec(),
            containment_weight: self.solved.task.specification.containment_weight,
            gains: gains.collect::<Option<_>>()?,
            region: region.collect::<Option<_>>()?,
            must_contain: must_contain.collect::<Option<_>>()?,
        })
    }

    /// The dual multipliers of one gain of the task.
    fn gain(&self, duals: &Duals, rule: usize) -> Option<GainDuals> {
        let suffix = gain_suffix(self.solved.task.gains.count, rule);
        let mut start = self.moments(duals, SamplingEnd::Start, &suffix)?;
        let mut end = self.moments(duals, SamplingEnd::End, &suffix)?;
        if self.request.model.file.specs.nu < self.solved.task.specification.trigger_threshold {
            start.held = None;
            end.held = None;
        }
        let divisible = self.request.model.file.specs.eps[2].abs() >= SMALLEST_SAMPLE_WEIGHT;
        let determinable = self.request.given.is_empty() || end.held.is_some();
        if rule == 0 && divisible && determinable {
            end.multiplied_sample = None;
        }
        let cliques = self.cliques(SamplingEnd::End);
        let at = |a, b| self.moment(duals, (&cliques, SamplingEnd::End, &suffix), (a, b));
        let n = self.solved.task.system.states();
        let inputs = (0..self.solved.task.system.inputs()).map(|input| {
            let dual = duals.get(&format!("anti-windup input {}{suffix}", input + 1))?;
            let unit = self.solved.scaling.input[input];
            Some(InputDual {
                state: self.state(&dual.view((0, 0), (n, n)).into_owned()) / (unit * unit),
                unit: dual[(n, n)],
            })
        });
        Some(GainDuals {
            gain: self.request.part.gains.get(rule)? + 1,
            integral: at(Integral, Integral)?,
            state_integral: match rule {
                0 => None,
                _ => Some(at(State, Integral)?),
            },
            sample_integral: match rule {
                0 => None,
                _ => Some(at(Sample, Integral)?),
            },
            inputs: inputs.collect::<Option<_>>()?,
            start,
            end,
        })
    }

    fn moments(&self, duals: &Duals, interval: SamplingEnd, suffix: &str) -> Option<Moments> {
        let cliques = self.cliques(interval);
        let at = |a, b| self.moment(duals, (&cliques, interval, suffix), (a, b));
        let vertices = (0..self.solved.task.system.vertices.len()).filter_map(|vertex| {
            let dual = duals.get(&(condition_name(interval, vertex) + suffix))?;
            let moments = self.pair(dual);
            let vertex = match self.request.part.vertices {
                Some(chosen) => *chosen.get(vertex)?,
                None => vertex,
            };
            let vertex = vertex + 1;
            Some(VertexDual { vertex, moments })
        });
        let dead_zone = match self.request.given {
            [] => None,
            _ => Some(DeadZoneMoments {
                multiplied: at(Multiplied, DeadZone)?,
                held: at(Held, DeadZone)?,
                own: at(DeadZone, DeadZone)?,
            }),
        };
        Some(Moments {
            vertices: vertices.collect(),
            state_sample: at(State, Sample)?,
            multiplied_sample: Some(at(Multiplied, Sample)?),
            sample: at(Sample, Sample)?,
            multiplied_disturbance: at(Multiplied, Disturbance)?,
            disturbance: at(Disturbance, Disturbance)?,
            held: Some(HeldMoments {
                multiplied_held: at(Multiplied, Held)?,
                sample_held: at(Sample, Held)?,
                held: at(Held, Held)?,
            }),
            dead_zone,
        })
    }

    /// The cliques of (18) at one end with their signals in the order of their rows, those of the split form and
    /// the one of the whole form; the root first.
    fn cliques(&self, interval: SamplingEnd) -> Vec<Clique> {
        let design = &self.solved.assembled.design;
        let basis = Basis::reduced(&self.solved.task, interval, design);
        let splits = elimination(
            &basis,
            &terms(&self.solved.task, interval, design),
            &ELIMINATED,
        );
        let split = members(&basis, &splits).into_iter().rev();
        split.chain(members(&basis, &[])).collect()
    }

    /// Second moments of two signals, SI, from a clique that has both.
    fn moment(
        &self,
        duals: &Duals,
        (cliques, interval, suffix): (&[Clique], SamplingEnd, &str),
        (row, column): (Signal, Signal),
    ) -> Option<DMatrix<f64>> {
        cliques.iter().find_map(|(name, signals)| {
            let sizes = signals.iter().map(|&of| (of, self.units(of).len()));
            let place = |wanted: Signal| {
                signals.contains(&wanted).then(|| {
                    let before = sizes.clone().take_while(|(of, _)| *of != wanted);
                    before.map(|(_, size)| size).sum::<usize>()
                })
            };
            let (from_row, from_column) = (place(row)?, place(column)?);
            let name = format!("decrease r={}{suffix} clique {name}", interval.index());
            let side: usize = sizes.clone().map(|(_, size)| size).sum();
            let dual = duals.get(&name).filter(|dual| dual.nrows() == side)?;
            let (rows, columns) = (self.units(row), self.units(column));
            let view = dual.view((from_row, from_column), (rows.len(), columns.len()));
            Some(DMatrix::from_fn(rows.len(), columns.len(), |r, c| {
                rows[r] * view[(r, c)] * columns[c]
            }))
        })
    }

    /// What turns each entry of a signal's solver coordinate into SI units.
    fn units(&self, signal: Signal) -> Vec<f64> {
        let state = self.solved.scaling.state.iter().map(|unit| 1.0 / unit);
        match signal {
            // The solver's coordinate is the root of this factor times the proof's.
            Integral => {
                let root = self.integral_factor().sqrt();
                state.map(|unit| unit / root).collect()
            }
            DeadZone if self.request.given.is_empty() => Vec::new(),
            DeadZone => {
                let inputs = self.solved.scaling.input.iter();
                inputs.map(|unit| DEAD_ZONE_UNIT / unit).collect()
            }
            Disturbance | Further(_) => {
                let size = signal.size(&self.solved.task, &self.solved.assembled.design);
                vec![self.solved.scaling.disturbance; size]
            }
            _ => state.collect(),
        }
    }

    /// Moments of two quantities in units of the state.
    fn state(&self, moments: &DMatrix<f64>) -> DMatrix<f64> {
        self.solved.scaling.to_state() * moments * self.solved.scaling.to_state()
    }

    /// Moments of a pair of such quantities.
    fn pair(&self, moments: &DMatrix<f64>) -> DMatrix<f64> {
        let units = &self.solved.scaling.state;
        let n = units.len();
        let both = DVector::from_fn(2 * n, |row, _| 1.0 / units[row % n]);
        let to_state = DMatrix::from_diagonal(&both);
        &to_state * moments * &to_state
    }

    /// hbar e^(phi hbar): the solver's integral coordinate is its root times the proof's.
    fn integral_factor(&self) -> f64 {
        let specs = &self.request.model.file.specs;
        specs.hbar_s * (specs.phi_per_s * specs.hbar_s).exp()
    }
}
