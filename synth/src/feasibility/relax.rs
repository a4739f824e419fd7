//! Which requirement, relaxed alone, first makes a model feasible, and at what value.

use serde::Serialize;

use super::decide::{in_promising_form, look_for_a_design};
use crate::model::Model;
use crate::programs::{is_structured, Answer, Asked, Form, Parameter, Solvers, SynthesisError};
use sdp::solve::{Observer, Structured};

/// A requirement that can be relaxed alone.
struct Requirement {
    parameter: Parameter,
    /// Its symbol in the conditions.
    symbol: &'static str,
    /// Signs of the logarithm of the factor to be searched. Larger limits and shorter intervals only
    /// help, a larger weight up to where xi_max taubar^2 = phi. The others act in more than one place: a wider region
    /// has wider vertices.
    directions: &'static [f64],
}

const fn requirement(
    parameter: Parameter,
    symbol: &'static str,
    directions: &'static [f64],
) -> Requirement {
    Requirement {
        parameter,
        symbol,
        directions,
    }
}

/// All of them.
const REQUIREMENTS: [Requirement; 6] = [
    requirement(Parameter::InputLimits, "ubar", &[1.0]),
    requirement(Parameter::SamplingInterval, "hbar", &[-1.0]),
    requirement(Parameter::Threshold, "nu", &[-1.0]),
    requirement(Parameter::DecayRate, "phi", &[-1.0, 1.0]),
    requirement(Parameter::Region, "box", &[1.0, -1.0]),
    requirement(Parameter::DisturbanceWeight, "xi_max", &[1.0]),
];

/// The effect of relaxing one requirement alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Relaxation {
    /// The requirement's symbol in the conditions.
    pub requirement: &'static str,
    /// The value that first makes the model feasible, proved, in the file's unit; of several limits the first. `None`,
    /// as the next two, when no factor that was tried does.
    pub value: Option<f64>,
    /// The value relative to the model's.
    pub factor: Option<f64>,
    /// The nearest factor tried at which a design was not found.
    pub not_at_factor: Option<f64>,
    /// The largest and the smallest factor that was tried.
    pub tried: [f64; 2],
    /// Solver calls it took.
    pub solves: usize,
}

/// A value of a requirement that makes the model feasible.
#[derive(Clone, Copy)]
struct RelaxedValue {
    value: Option<f64>,
    factor: f64,
    not_at: f64,
}

/// Logarithms of the factors tried in one direction, until one is feasible.
const OUTWARD: [f64; 4] = [0.25, 0.75, 2.0, 5.0];

/// The bracket around the first feasible value, as a difference of logarithms.
const RESOLUTION: f64 = 0.01;

/// Solver calls to narrow the bracket.
const REFINEMENTS: usize = 7;

/// Relaxes each requirement alone. Those that need the smallest relative change come first, those
/// that do not help last.
pub fn relaxations(
    model: &Model,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Vec<Relaxation>, SynthesisError> {
    let mut out = Vec::new();
    // One form of the gyroscopic torque serves all neighbours.
    let model = &in_promising_form(model, solvers, observer.clone())?;
    // Neighbours of one model: each is warm-started from the iterates of the last.
    let structured = Structured::warm();
    let may = is_structured(solvers.for_searches());
    let warm = may.then_some::<Asked>((&structured, Form::VertexRelaxed));
    let others = solvers.in_order().into_iter();
    let others = others.filter(|(backend, _)| !is_structured(*backend));
    let asked: Vec<Asked> = warm.into_iter().chain(others).collect();
    for requirement in REQUIREMENTS {
        let mut search = Relaxing {
            model,
            solvers: &asked,
            observer: observer.clone(),
            parameter: requirement.parameter,
            tried: [1.0; 2],
            solves: 0,
        };
        let mut best: Option<RelaxedValue> = None;
        for &direction in requirement.directions {
            let reach = best.map_or(f64::INFINITY, |value| value.factor.ln().abs());
            if let Some(found) = search.along(direction, reach)? {
                best = Some(found);
            }
        }
        out.push(Relaxation {
            requirement: requirement.symbol,
            value: best.and_then(|best| best.value),
            factor: best.map(|best| best.factor),
            not_at_factor: best.map(|best| best.not_at),
            tried: search.tried,
            solves: search.solves,
        });
    }
    let change = |relaxation: &Relaxation| {
        let change = relaxation.factor.map(|factor| factor.ln().abs());
        change.unwrap_or(f64::INFINITY)
    };
    out.sort_by(|a, b| change(a).total_cmp(&change(b)));
    Ok(out)
}

struct Relaxing<'a> {
    model: &'a Model,
    solvers: &'a [Asked<'a>],
    observer: Option<Observer>,
    parameter: Parameter,
    /// The largest and the smallest factor tried.
    tried: [f64; 2],
    solves: usize,
}

/// One factor tried.
#[derive(Clone, Copy)]
struct Probe {
    /// Magnitude of the logarithm of the factor.
    at: f64,
    /// The smallest slack.
    slack: f64,
    feasible: bool,
}

impl Relaxing<'_> {
    /// The first feasible factor in one direction that needs less change than `reach`.
    fn along(
        &mut self,
        direction: f64,
        reach: f64,
    ) -> Result<Option<RelaxedValue>, SynthesisError> {
        let mut below = Probe {
            at: 0.0,
            slack: f64::NAN,
            feasible: false,
        };
        for at in OUTWARD.into_iter().chain(self.last()) {
            if below.at >= reach {
                return Ok(None);
            }
            let Some(probe) = self.probe(direction, at)? else {
                return Ok(None);
            };
            if probe.feasible {
                return self.narrowed(direction, below, probe).map(Some);
            }
            below = probe;
        }
        Ok(None)
    }

    /// Beyond the usual factors: the xi at which its supply reaches phi, where a larger one gains nothing.
    fn last(&self) -> Option<f64> {
        let useful = self.model.task().largest_useful_weight();
        let at = (useful / self.model.file.specs.xi_max).ln();
        let farthest = OUTWARD[OUTWARD.len() - 1];
        let weight = matches!(self.parameter, Parameter::DisturbanceWeight);
        Some(at).filter(|at| weight && at.is_finite() && *at > farthest)
    }

    fn narrowed(
        &mut self,
        direction: f64,
        mut below: Probe,
        mut above: Probe,
    ) -> Result<RelaxedValue, SynthesisError> {
        for _ in 0..REFINEMENTS {
            if above.at - below.at <= RESOLUTION {
                break;
            }
            let Some(probe) = self.probe(direction, between(below, above))? else {
                break;
            };
            match probe.feasible {
                true => above = probe,
                false => below = probe,
            }
        }
        let factor = (direction * above.at).exp();
        let model = self.parameter.scaled(self.model, factor);
        let value = model.and_then(|model| self.parameter.of(&model.file));
        Ok(RelaxedValue {
            value,
            factor,
            not_at: (direction * below.at).exp(),
        })
    }

    /// Whether the model is feasible at a factor; `None` when the factor is not allowed.
    fn probe(&mut self, direction: f64, at: f64) -> Result<Option<Probe>, SynthesisError> {
        let factor = (direction * at).exp();
        let Some(model) = self.parameter.scaled(self.model, factor) else {
            return Ok(None);
        };
        self.tried = [self.tried[0].max(factor), self.tried[1].min(factor)];
        let decision = look_for_a_design(&model, self.solvers, self.observer.clone())?;
        self.solves += decision.runs.len();
        Ok(Some(Probe {
            at,
            slack: decision.slack.unwrap_or(f64::NAN),
            feasible: matches!(decision.answer, Answer::Feasible(_)),
        }))
    }
}

/// Where the slack is expected to vanish, moved a little towards the farther end so that both ends
/// close in; the middle where the slack gives no information.
fn between(below: Probe, above: Probe) -> f64 {
    let width = above.at - below.at;
    let share = below.slack / (below.slack - above.slack);
    if !(share > 0.0 && share < 1.0) {
        return below.at + 0.5 * width;
    }
    let nudge = 0.4 * RESOLUTION / width;
    let share = match share < 0.5 {
        true => share + nudge,
        false => share - nudge,
    };
    below.at + share.clamp(0.05, 0.95) * width
}
