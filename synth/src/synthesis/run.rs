//! Two solves and a check.

use nalgebra::DMatrix;

use super::attempts::{Attempt, Attempts, Smallest, Synthesis};
use super::{parameter_search, two_certificates};
use crate::conditions::GainPlan;
use crate::design::{matrix, DesignFile, ProblemUnits};
use crate::feasibility;
use crate::model::{Mismatch, Model, Objective};
use crate::optimality::Optimality;
use crate::programs::{
    containment_weights, scaled, Answer, ConditionSubset, DesignRequest, Form, Goal, Outcome,
    Session, SynthesisError, Synthesized, STATE_UNITS,
};
use crate::scaling::Scaling;
use sdp::solve::{Backend, Observer};

/// Back-off of the exported design's gain bound above the smallest one, relative: it leaves a margin for the proof.
const GAIN_BACK_OFF: f64 = 1e-3;

/// Larger back-offs, tried in this order where no design is proved with the first: the solver's smallest gain
/// bound may be inaccurate, or leave no margin for a proof.
const WIDER_BACK_OFFS: [f64; 3] = [1e-2, 1e-1, 1.0];

/// Units in which the larger back-offs are tried, the first ones that gave a gain bound.
const WIDENED_UNITS: usize = 2;

/// Range of the state units that a certified set may suggest.
const UNIT_RANGE: [f64; 2] = [1.0 / 4096.0, 4.0];

/// Synthesizes for the model's objective and checks the result: one design, the outcome of a parameter search where
/// the model requests one, or a design with two certificates. `model_text` is the file's text (its hash goes
/// into the provenance). Only the check decides whether the design is proved.
///
/// # Errors
/// Stopped by the observer; a problem that the solver refuses; numbers that no design file may hold; the
/// objective both without `specs.outer`.
pub fn synthesize(
    model: &Model,
    model_text: &str,
    form: Form,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    if model.file.specs.objective == Objective::Both {
        return two_certificates::synthesize(model, model_text, form, backend, observer);
    }
    if parameter_search::wanted(model) {
        return parameter_search::synthesize(model, model_text, form, backend, observer);
    }
    let task = model.task();
    let request = DesignRequest::of_model(model, model_text, &task, form);
    smallest_gain(request, Session::new(form, backend, observer))
}

/// Finds the smallest gain bound that can be proved for given gains (m x n each), with anti-windup
/// gains where they saturate. One gain is constant; as many as the model has rules, under its mismatch
/// bound, are scheduled by its memberships; any other number may be weighted in any way at any time.
/// `gains_text` is the gains file's text, for the provenance.
pub fn analyse(
    model: &Model,
    model_text: &str,
    gains: &[DMatrix<f64>],
    gains_text: &str,
    form: Form,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    let mut task = model.task();
    let mismatch = match model.file.mismatch {
        Mismatch::Kappa(kappa) if Some(gains.len()) == model.plant.membership_count() => {
            Some(kappa)
        }
        _ => None,
    };
    task.gains = GainPlan::given(gains, mismatch);
    let all: Vec<usize> = (0..gains.len()).collect();
    let request = DesignRequest {
        given: gains,
        part: ConditionSubset {
            gains: &all,
            vertices: None,
        },
        gains_text: Some(gains_text),
        ..DesignRequest::of_model(model, model_text, &task, form)
    };
    if let Some(decision) = feasibility::refute_given(request, observer.clone())? {
        return Ok(Outcome::Infeasible(decision));
    }
    smallest_gain(request, Session::new(form, backend, observer))
}

/// The design with the smallest gain bound that can be proved; without one, whether any design exists.
fn smallest_gain(request: DesignRequest, mut session: Session) -> Result<Outcome, SynthesisError> {
    let mut found = Attempts::with_each_solver(&mut session, |session| {
        let form = session.form;
        let request = DesignRequest { form, ..request };
        GainSynthesis { request, session }.in_all_settings()
    })?;
    let best_seen = found.smallest_bound();
    let solved = |design: Box<Synthesized>, session: &Session| {
        let mut design = design.with_runs(&session.runs);
        let gamma = design.file.certificate.gamma;
        design.optimality = Optimality::of_smallest(gamma, best_seen);
        Outcome::Solved(design)
    };
    if let Some(design) = found.best.take() {
        return Ok(solved(design, &session));
    }
    let decision = feasibility::decide_after(request, &mut session)?;
    let slack = decision.slack;
    let blocked = slack.map_or(found.infeasible > 0, |slack| slack > 0.0);
    Ok(match (&decision.answer, found.unproved.take()) {
        (Answer::Infeasible(_), _) => Outcome::Infeasible(decision),
        // The point is a design too, if not one with a small gain.
        (Answer::Feasible(design), _) => solved(design.clone(), &session),
        (Answer::Undecided(Some(_)), _) => Outcome::Undecided(decision),
        (Answer::Undecided(None), Some(design)) => solved(design, &session),
        (Answer::Undecided(None), None) if blocked => Outcome::Undecided(decision),
        // The solvers contradict themselves, or never got anywhere.
        (Answer::Undecided(None), None) => Outcome::SolverFailed(decision),
    })
}

/// The results of the attempts in all units.
type UnitAttempts = Attempts<ProblemUnits, DesignFile>;

/// The smallest gain bound of one certificate, with one solver.
struct GainSynthesis<'a, 'b, 'c> {
    request: DesignRequest<'a>,
    session: &'b mut Session<'c>,
}

impl Synthesis for GainSynthesis<'_, '_, '_> {
    type Settings = ProblemUnits;
    type File = DesignFile;

    fn smallest(&mut self, units: ProblemUnits) -> Result<Smallest, SynthesisError> {
        let program = scaled(self.request.task, units);
        let solved = self.session.solve(program, Goal::SmallestGain)?;
        Ok(Smallest::of(&solved.solution))
    }

    fn design(
        &mut self,
        units: ProblemUnits,
        gain_bound: f64,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let program = scaled(self.request.task, units);
        let goal = Goal::LargestMargin { gain_bound };
        let certificate = self
            .session
            .solve(program, goal)?
            .recover(self.request.model);
        Ok(certificate.and_then(|certificate| self.request.design(&certificate, None, units)))
    }

    fn objective(file: &DesignFile) -> f64 {
        file.certificate.gamma
    }
}

impl GainSynthesis<'_, '_, '_> {
    /// Tries units under every containment weight; then larger back-offs, where nothing is proved.
    fn in_all_settings(&mut self) -> Result<UnitAttempts, SynthesisError> {
        let mut found = Attempts::default();
        for &containment_weight in containment_weights(self.request.model) {
            let first = self.unit_of_constant_gain(containment_weight)?;
            self.try_units(containment_weight, first, &mut found)?;
        }
        if found.best.is_none() {
            let widened: Vec<_> = found.bounds.iter().take(WIDENED_UNITS).copied().collect();
            found.back_off(self, &widened, &WIDER_BACK_OFFS)?;
        }
        Ok(found)
    }

    /// For scheduled gains: the units in which a constant gain is proved, a smaller problem that
    /// shows how large the certified set will be.
    fn unit_of_constant_gain(&mut self, weight: f64) -> Result<Option<f64>, SynthesisError> {
        if self.request.task.gains.count == 1 || self.request.task.gains.given.is_some() {
            return Ok(None);
        }
        let mut task = self.request.task.clone();
        task.gains = GainPlan::constant();
        let mut session = self.session.fresh(self.request.form);
        let mut constant = GainSynthesis {
            request: DesignRequest {
                task: &task,
                ..self.request
            },
            session: &mut session,
        };
        let mut found = Attempts::default();
        let outcome = constant.try_units(weight, None, &mut found);
        self.session.runs.append(&mut session.runs);
        outcome?;
        let proved = found.best.map(|design| design.file.provenance.problem);
        Ok(proved.map(|units| units.state_fraction))
    }

    /// Tries units one after the other until a design is proved. A design that is not suggests the next unit.
    fn try_units(
        &mut self,
        containment_weight: f64,
        first: Option<f64>,
        found: &mut UnitAttempts,
    ) -> Result<(), SynthesisError> {
        let mut tried: Vec<f64> = Vec::new();
        let mut next: Vec<f64> = STATE_UNITS.iter().rev().copied().chain(first).collect();
        while let Some(state_fraction) = next.pop() {
            if tried.iter().any(|&other| same_unit(other, state_fraction)) {
                continue;
            }
            tried.push(state_fraction);
            let units = ProblemUnits {
                state_fraction,
                containment_weight,
            };
            match found.attempt(self, units, &[GAIN_BACK_OFF])? {
                Attempt::Proved => return Ok(()),
                Attempt::Unproved => {
                    let design = found.unproved.as_ref();
                    next.extend(design.map(|design| self.suggested_unit(design, state_fraction)));
                }
                // Confirmed once in other units, then given up.
                Attempt::Infeasible if found.infeasible > 1 => return Ok(()),
                Attempt::Infeasible | Attempt::Failed => {}
            }
        }
        Ok(())
    }

    /// The state unit that the certified set of a design suggests: its largest radius, as a fraction of the region.
    fn suggested_unit(&self, design: &Synthesized, state_fraction: f64) -> f64 {
        let scaling = Scaling::automatic(&self.request.task.system, state_fraction);
        let extent = scaling.state.min() / state_fraction;
        let radius = certified_radius(&matrix(&design.file.certificate.lyapunov));
        (radius / extent).clamp(UNIT_RANGE[0], UNIT_RANGE[1])
    }
}

/// True when two fractions round to the same power of two.
fn same_unit(a: f64, b: f64) -> bool {
    a.log2().round() == b.log2().round()
}

/// Largest distance from the origin to the edge of x'Ux <= 1; 1 where that has no meaning.
fn certified_radius(lyapunov: &DMatrix<f64>) -> f64 {
    let smallest = lyapunov.symmetric_eigenvalues().min();
    let radius = smallest.sqrt().recip();
    match radius.is_finite() && radius > 0.0 {
        true => radius,
        false => 1.0,
    }
}
