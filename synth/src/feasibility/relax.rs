//! Which requirement, relaxed alone, first makes a model feasible, and at what value.

use super::decide::look_for_a_design;
use crate::model::{Model, ModelFile, PlantFile, RulesSystem};
use crate::programs::{Answer, SynthesisError};
use sdp::solve::{Backend, Observer, Structured};

/// A requirement that can be relaxed alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Requirement {
    /// The torque limits (input limits), all by one factor.
    InputLimit,
    /// The longest sampling interval.
    SamplingInterval,
    /// The largest trigger threshold.
    Threshold,
    /// The decay rate.
    DecayRate,
    /// The extents of the region, all by one factor; for a spacecraft the rates and the vector part.
    Region,
    /// The largest disturbance weight.
    DisturbanceWeight,
}

impl Requirement {
    /// All of them.
    pub const ALL: [Requirement; 6] = [
        Requirement::InputLimit,
        Requirement::SamplingInterval,
        Requirement::Threshold,
        Requirement::DecayRate,
        Requirement::Region,
        Requirement::DisturbanceWeight,
    ];

    /// Its symbol in the conditions.
    pub fn symbol(self) -> &'static str {
        match self {
            Requirement::InputLimit => "ubar",
            Requirement::SamplingInterval => "hbar",
            Requirement::Threshold => "nu",
            Requirement::DecayRate => "phi",
            Requirement::Region => "box",
            Requirement::DisturbanceWeight => "xi_max",
        }
    }

    /// Signs of the logarithm of the factor to be searched. Larger limits and shorter intervals only
    /// help. The others act in more than one place: a smaller decay rate or a larger weight raises the
    /// level k2 = max(1, xi_max taubar^2 / phi) of the set, a wider region has wider vertices.
    fn directions(self) -> &'static [f64] {
        match self {
            Requirement::InputLimit => &[1.0],
            Requirement::SamplingInterval | Requirement::Threshold => &[-1.0],
            Requirement::DecayRate => &[-1.0, 1.0],
            Requirement::Region | Requirement::DisturbanceWeight => &[1.0, -1.0],
        }
    }

    /// The model with the requirement multiplied by a factor, and its value then (for several
    /// limits the first); `None` when the model does not have it or does not allow it.
    pub fn scaled(self, model: &Model, factor: f64) -> Option<(Model, f64)> {
        let mut file = model.file.clone();
        let value = match self {
            Requirement::InputLimit => scale_limits(&mut file, factor),
            Requirement::Region => scale_region(&mut file, factor)?,
            Requirement::SamplingInterval => {
                let specs = &mut file.specs;
                specs.hbar_s *= factor;
                specs.hmin_s = specs.hmin_s.map(|hmin| hmin.min(specs.hbar_s));
                specs.hbar_s
            }
            Requirement::Threshold => {
                let specs = &mut file.specs;
                specs.nu *= factor;
                specs.nu_min = specs.nu_min.map(|nu_min| nu_min.min(specs.nu));
                specs.nu
            }
            Requirement::DecayRate => {
                file.specs.phi_per_s *= factor;
                file.specs.phi_per_s
            }
            Requirement::DisturbanceWeight => {
                file.specs.xi_max *= factor;
                file.specs.xi_max
            }
        };
        let changed = file != model.file;
        let scaled = Model::new(file).ok().filter(|_| changed)?;
        Some((scaled, value))
    }
}

fn scale_limits(file: &mut ModelFile, factor: f64) -> f64 {
    let limits: &mut [f64] = match &mut file.plant {
        PlantFile::Exact(craft) => &mut craft.torque_limit_nm,
        PlantFile::Vertices(system) => &mut system.input_limit,
        PlantFile::Rules(rules) => match &mut rules.system {
            RulesSystem::Spacecraft(craft) => &mut craft.torque_limit_nm,
            RulesSystem::Linear(system) => &mut system.input_limit,
        },
    };
    limits.iter_mut().for_each(|limit| *limit *= factor);
    limits.first().copied().unwrap_or_default()
}

fn scale_region(file: &mut ModelFile, factor: f64) -> Option<f64> {
    match &mut file.plant {
        PlantFile::Exact(craft) => {
            let rates = craft.rate_rad_s.iter_mut();
            rates.for_each(|rate| *rate *= factor);
            let vector = (1.0 - craft.q0_min * craft.q0_min).max(0.0) * factor * factor;
            craft.q0_min = (1.0 - vector).max(0.0).sqrt();
            Some(craft.rate_rad_s[0])
        }
        PlantFile::Vertices(system) => {
            let bounds = system.region.iter_mut();
            bounds.for_each(|bound| bound.bound *= factor);
            system.region.first().map(|bound| bound.bound)
        }
        PlantFile::Rules(rules) => {
            let bounds = rules.state_bounds.iter_mut();
            bounds.for_each(|bound| *bound *= factor);
            rules.state_bounds.first().copied()
        }
    }
}

/// The effect of relaxing one requirement alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation {
    /// The requirement.
    pub requirement: Requirement,
    /// Where it first makes the model feasible, proved; `None` when no factor that was tried does.
    pub feasible: Option<RelaxedValue>,
    /// Solver calls it took.
    pub solves: usize,
}

/// A value of a requirement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxedValue {
    /// The value, in the file's unit; of several limits the first.
    pub value: f64,
    /// The value relative to the model's.
    pub factor: f64,
    /// The nearest factor tried at which a design was not found.
    pub not_at: f64,
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
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Vec<Relaxation>, SynthesisError> {
    let mut out = Vec::new();
    // Neighbours of one model: each is warm-started from the iterates of the last.
    let structured = Structured::warm();
    for requirement in Requirement::ALL {
        let mut search = Relaxing {
            model,
            structured: &structured,
            backend,
            observer: observer.clone(),
            requirement,
            solves: 0,
        };
        let mut best: Option<RelaxedValue> = None;
        for &direction in requirement.directions() {
            let reach = best.map_or(f64::INFINITY, |value| value.factor.ln().abs());
            if let Some(found) = search.along(direction, reach)? {
                best = Some(found);
            }
        }
        out.push(Relaxation {
            requirement,
            feasible: best,
            solves: search.solves,
        });
    }
    let change = |relaxation: &Relaxation| {
        let factor = relaxation.feasible.map(|value| value.factor.ln().abs());
        factor.unwrap_or(f64::INFINITY)
    };
    out.sort_by(|a, b| change(a).total_cmp(&change(b)));
    Ok(out)
}

struct Relaxing<'a> {
    model: &'a Model,
    structured: &'a Structured,
    backend: &'a dyn Backend,
    observer: Option<Observer>,
    requirement: Requirement,
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
        for at in OUTWARD {
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
        let value = self.requirement.scaled(self.model, factor);
        Ok(RelaxedValue {
            value: value.map_or(f64::NAN, |(_, value)| value),
            factor,
            not_at: (direction * below.at).exp(),
        })
    }

    /// Whether the model is feasible at a factor; `None` when the factor is not allowed.
    fn probe(&mut self, direction: f64, at: f64) -> Result<Option<Probe>, SynthesisError> {
        let factor = (direction * at).exp();
        let Some((model, _)) = self.requirement.scaled(self.model, factor) else {
            return Ok(None);
        };
        let decision =
            look_for_a_design(&model, self.structured, self.backend, self.observer.clone())?;
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
