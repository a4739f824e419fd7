//! The smallest gain bound of one certificate in given units, with one solver.
//!
//! An optimum that a solver reports is a hint: a design at a small back-off from it is made well inside the conditions,
//! and the check decides. The set of a solver's point suggests the units of the next attempt, in which it reaches about
//! as far along every state.

use nalgebra::DMatrix;

use super::attempts::{Attempts, Smallest, Synthesis};
use crate::certify::theorem1::Certificate;
use crate::conditions::units::power_of_two;
use crate::conditions::xu2020::GAIN_ABOVE;
use crate::conditions::Task;
use crate::design::{DesignFile, ProblemUnits};
use crate::model::Objective;
use crate::programs::{
    complete, scaled, DesignRequest, Form, Goal, Session, Solved, SynthesisError, Synthesized,
};
use crate::scaling::Scaling;
use sdp::solve::Status;

/// Back-offs of the exported design's bound above the smallest one, relative: they leave a margin for the proof.
pub(super) const BACK_OFFS: [f64; 2] = [1e-3, 1e-2];

/// How far gamma lies above max(g, xi) where the guaranteed gain is the objective.
const GAMMA_ALLOWANCE: f64 = 1e-6;

/// Up to this many vertices an inaccurate optimum is not accepted at once.
const FEW_VERTICES: usize = 8;

/// The margin in units that a point suggested, relative to the model's.
const SHARE_OF_MARGIN: f64 = 1e-2;

/// The results of the attempts in all units.
pub(super) type UnitAttempts = Attempts<ProblemUnits, DesignFile>;

/// The smallest gain bound of one certificate, with one solver.
pub(super) struct GainSynthesis<'a, 'b, 'c> {
    pub(super) request: DesignRequest<'a>,
    /// The gain that is asked for in the place of the smallest.
    pub(super) asked: Option<f64>,
    pub(super) session: &'b mut Session<'c>,
    /// Units that the last point suggests.
    pub(super) suggested: Option<Vec<f64>>,
    /// Whether the last point may pass for an optimum; unverified.
    pub(super) accurate: bool,
    /// What the containment condition may be stated about after the last solve.
    pub(super) linearisation: Option<DMatrix<f64>>,
    /// The multiplier of w xi <= m in the last solve for the smallest m = max(g, w xi), from 0 to 1.
    pub(super) weight_share: f64,
}

impl Synthesis for GainSynthesis<'_, '_, '_> {
    type Settings = ProblemUnits;
    type File = DesignFile;

    fn smallest(&mut self, units: &ProblemUnits) -> Result<Smallest, SynthesisError> {
        let program = self.scaled(units);
        let solved = self.session.solve(program, Goal::SmallestGain)?;
        self.suggested = suggested_units(&solved);
        self.linearisation = solved.linearisation();
        self.weight_share = weight_share(&solved);
        self.accurate = match solved.solution.status {
            Status::Solved => true,
            // Where an attempt is cheap, the next one may do better.
            Status::Inaccurate => {
                units.state_units.is_empty()
                    && self.request.task.system.vertices.len() > FEW_VERTICES
            }
            _ => false,
        };
        let smallest = Smallest::of(&solved.assembled.problem, &solved.solution);
        Ok(match smallest {
            Smallest::Bound { bound, satisfied } => Smallest::Bound {
                bound: bound / self.gain_ratio(),
                satisfied,
            },
            _ => smallest,
        })
    }

    fn design(
        &mut self,
        units: &ProblemUnits,
        bound: f64,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let program = self.scaled(units);
        let gain_bound = bound * self.gain_ratio();
        let goal = Goal::LargestMargin { gain_bound };
        let model = self.request.model;
        let solved = self.session.solve(program, goal)?;
        self.suggested = suggested_units(&solved);
        self.linearisation = solved.linearisation();
        let Some(mut certificate) = solved.recover(model) else {
            return Ok(None);
        };
        if model.file.specs.objective.is_guaranteed_gain() {
            certificate = with_paper_gamma(self.request.task, certificate, gain_bound);
        }
        let complete = complete(model, certificate, self.session)?;
        Ok(complete.and_then(|certificate| self.request.design(&certificate, None, units)))
    }

    fn objective(file: &DesignFile) -> f64 {
        let certificate = &file.certificate;
        match file.model.specs.objective {
            Objective::Gain | Objective::Pointing => certificate.guaranteed_gain,
            _ => certificate.gamma,
        }
    }
}

impl<'a, 'b, 'c> GainSynthesis<'a, 'b, 'c> {
    /// Attempts at a gain that is asked for, or at the smallest.
    pub fn new(
        request: DesignRequest<'a>,
        asked: Option<f64>,
        session: &'b mut Session<'c>,
    ) -> Self {
        GainSynthesis {
            request,
            asked,
            session,
            suggested: None,
            accurate: false,
            linearisation: None,
            weight_share: 0.5,
        }
    }

    /// The task in these units; with nu = 0 without the trigger's error, except in the published form. In units that
    /// suit the set a smaller margin leaves a proof, and costs less.
    fn scaled(&self, units: &ProblemUnits) -> (Scaling, Task) {
        let (scaling, mut task) = scaled(self.request.task, units);
        let always = task.specification.trigger_threshold == 0.0;
        if !units.state_units.is_empty() {
            task.specification.margin *= SHARE_OF_MARGIN;
        }
        task.held_is_sample =
            always && self.request.form != Form::Full && task.gains.mismatch.is_none();
        (scaling, task)
    }

    /// From bounds on the guaranteed gain, where that is the objective, to bounds on g.
    fn gain_ratio(&self) -> f64 {
        self.request.task.gain_per_weight.sqrt()
    }
}

/// A certificate with C'C <= peak phi U whose gamma is that of the paper, at least xi. Where no region bounds the set
/// its size is free within the input limits and the largest xi: it is made the one with the smallest gamma.
fn with_paper_gamma(task: &Task, mut certificate: Certificate, peak: f64) -> Certificate {
    let mut peak = peak;
    let xi = certificate.disturbance_weight;
    let contains = !task.specification.must_contain.is_empty() || task.containment.is_some();
    let free = task.system.region.is_empty() && !contains;
    if free && certificate.mismatch.is_empty() {
        let smallest = smallest_scale(task, &certificate);
        let largest = task.specification.disturbance_weight_max / xi;
        if smallest < largest {
            let scale = (peak / xi).sqrt().clamp(smallest, largest);
            certificate.scale_functional(scale);
            peak /= scale;
        }
    }
    let above = peak.max(certificate.disturbance_weight);
    certificate.gain_bound = above * (1.0 + GAMMA_ALLOWANCE);
    certificate
}

/// The smallest factor on U with which every command still stays within its limit where x'Ux <= 1, and a little.
fn smallest_scale(task: &Task, certificate: &Certificate) -> f64 {
    let Some(inverse) = certificate.lyapunov.clone().try_inverse() else {
        return f64::INFINITY;
    };
    let pairs = certificate.gains().zip(certificate.anti_windups());
    let shares = pairs.flat_map(|(gain, anti_windup)| {
        let beyond = gain - anti_windup;
        let squares = (&beyond * &inverse * beyond.transpose()).diagonal();
        let limits = task.system.input_limit.iter();
        let shares: Vec<f64> = squares
            .iter()
            .zip(limits)
            .map(|(s, l)| s / (l * l))
            .collect();
        shares
    });
    shares.fold(0.0, f64::max) * (1.0 + SCALE_ALLOWANCE)
}

/// Relative distance of a command to its limit, so that it can be proved.
const SCALE_ALLOWANCE: f64 = 1e-3;

/// The objective of the best design; infinite without one.
pub(super) fn best_objective(found: &UnitAttempts) -> f64 {
    let best = found.best.as_ref();
    best.map_or(f64::INFINITY, |design| {
        GainSynthesis::objective(&design.file)
    })
}

/// The multipliers of the conditions that bound the weights of all signals, relative to what the objective costs.
fn weight_share(solved: &Solved) -> f64 {
    let conditions = solved.assembled.problem.conditions.iter();
    let weights = conditions.zip(&solved.solution.duals);
    let weights = weights.filter(|(condition, _)| condition.name().starts_with(GAIN_ABOVE));
    let sum: f64 = weights.flat_map(|(_, dual)| dual.first()).sum();
    (sum / solved.task.gain_unit()).clamp(0.0, 1.0)
}

/// The unit of each state in which the set x'Ux <= 1 of a solver's point reaches about as far along every state,
/// whatever the status of the point; `None` where it has no such set.
fn suggested_units(solved: &Solved) -> Option<Vec<f64>> {
    let values = &solved.solution.values;
    let multiplier = solved.assembled.design.multiplier.value(values);
    let lyapunov = solved.assembled.design.lyapunov.value(values);
    // U^-1 = Qh' Uh^-1 Qh.
    let inverse = multiplier.transpose() * lyapunov.try_inverse()? * &multiplier;
    let reach = inverse.diagonal().map(f64::sqrt);
    let usable = |reach: &f64| (1.0 / LARGEST_RESCALING..LARGEST_RESCALING).contains(reach);
    let units = solved.scaling.state.component_mul(&reach);
    let units = units.map(|unit| power_of_two(UNIT_SHARE * unit));
    reach
        .iter()
        .all(usable)
        .then(|| units.iter().copied().collect())
}

/// The largest factor by which a point may change a unit.
const LARGEST_RESCALING: f64 = 1e9;

/// A unit relative to the reach of the set along its state.
const UNIT_SHARE: f64 = 0.5;
