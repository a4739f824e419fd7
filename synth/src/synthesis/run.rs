//! Two solves and a check.

use nalgebra::DMatrix;

use super::parameter_search;
use super::two_certificates::synthesize_two_certificates;
use crate::certify::Verdict;
use crate::conditions::GainPlan;
use crate::design::{recover, ProblemUnits, RecoverError};
use crate::feasibility;
use crate::model::{Mismatch, Model, Objective};
use crate::optimality::Optimality;
use crate::programs::{
    containment_weights, scaled, Answer, ConditionSubset, DesignRequest, Form, Goal, Outcome,
    Session, SynthesisError, Synthesized, STATE_UNITS,
};
use sdp::solve::{alternative, Backend, Observer, Status};

/// Back-off of the exported design's gain bound above the smallest one, relative: it leaves a margin for the proof.
const GAIN_BACK_OFF: f64 = 1e-3;

/// Larger back-offs, tried in this order where no design is proved with the first: the solver's smallest gain
/// bound may be inaccurate, or leave no margin for a proof.
const WIDER_BACK_OFFS: [f64; 3] = [1e-2, 1e-1, 1.0];

/// Units in which the larger back-offs are tried, the first ones that gave a gain bound.
const WIDENED_UNITS: usize = 2;

/// Range of the state units that a certified set may suggest.
const UNIT_RANGE: [f64; 2] = [1.0 / 4096.0, 4.0];

/// One attempt's end.
enum Attempt {
    Designed(Box<Synthesized>),
    /// A design that is not proved, and the state unit that its certified set suggests.
    Unproved(Box<Synthesized>, f64),
    Infeasible,
    Stuck,
}

struct GainSynthesis<'a> {
    subject: DesignRequest<'a>,
    search: Session<'a>,
}

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
        let found = synthesize_two_certificates(model, model_text, form, backend, observer)?;
        return Ok(found.into());
    }
    if parameter_search::wanted(model) {
        return with_alternative(form, backend, |form, backend| {
            parameter_search::search(model, model_text, form, backend, observer.clone())
        });
    }
    let task = model.task();
    let subject = DesignRequest::of_model(model, model_text, &task, form);
    let search = Session::new(form, backend, observer);
    GainSynthesis { subject, search }.search()
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
    task.gains = GainPlan {
        count: gains.len(),
        mismatch,
        given: Some(gains.to_vec()),
    };
    let all: Vec<usize> = (0..gains.len()).collect();
    let subject = DesignRequest {
        model,
        model_text,
        task: &task,
        given: gains,
        part: ConditionSubset {
            gains: &all,
            vertices: None,
        },
        gains_text: Some(gains_text),
        form,
    };
    if let Some(decision) = feasibility::refute_given(subject, observer.clone())? {
        return Ok(Outcome::Infeasible(decision));
    }
    let search = Session::new(form, backend, observer);
    GainSynthesis { subject, search }.search()
}

/// Runs with a solver, and with the other one where it proves nothing. The better of the two outcomes is
/// returned, with the runs of both.
fn with_alternative(
    form: Form,
    backend: &dyn Backend,
    run: impl Fn(Form, &dyn Backend) -> Result<Outcome, SynthesisError>,
) -> Result<Outcome, SynthesisError> {
    let first = run(form, backend)?;
    let other = alternative(backend);
    let Some(other) = other.as_deref().filter(|_| !first.is_proved()) else {
        return Ok(first);
    };
    let second = run(form.for_backend(other), other)?;
    Ok(match second.rank() > first.rank() {
        true => second.after(&first),
        false => first.after(&second),
    })
}

/// The results of the attempts in all units.
#[derive(Default)]
struct Attempts {
    /// The best proved design.
    best: Option<Box<Synthesized>>,
    /// A design that is not proved.
    unproved: Option<Box<Synthesized>>,
    /// The units that gave a gain bound, with the solver's smallest in each.
    bounds: Vec<(ProblemUnits, f64)>,
    /// How often the solver called the problem infeasible.
    infeasible: u32,
}

impl Attempts {
    /// Adds the results of another solver.
    fn extend(&mut self, other: Attempts) {
        self.best = self.best.take().or(other.best);
        self.unproved = self.unproved.take().or(other.unproved);
        self.bounds.extend(other.bounds);
        self.infeasible += other.infeasible;
    }

    /// The smallest gain bound that a solver reported.
    fn best_seen(&self) -> f64 {
        let bounds = self.bounds.iter().map(|(_, bound)| *bound);
        bounds.fold(f64::INFINITY, f64::min)
    }
}

impl GainSynthesis<'_> {
    fn search(mut self) -> Result<Outcome, SynthesisError> {
        let mut found = self.try_solver()?;
        let other = self.search.alternative();
        if let Some(other) = other.as_deref().filter(|_| found.best.is_none()) {
            let form = self.subject.form.for_backend(other);
            let mut second = GainSynthesis {
                subject: DesignRequest {
                    form,
                    ..self.subject
                },
                search: self.search.with_backend(form, other),
            };
            let tried = second.try_solver();
            self.search.runs.append(&mut second.search.runs);
            found.extend(tried?);
        }
        if let Some(design) = found.best.take() {
            return Ok(Outcome::Solved(self.closed(design, &found)));
        }
        let decision = feasibility::decide_after(self.subject, &mut self.search)?;
        let slack = decision.slack;
        let blocked = slack.map_or(found.infeasible > 0, |slack| slack > 0.0);
        Ok(match (&decision.answer, found.unproved.take()) {
            (Answer::Infeasible(_), _) => Outcome::Infeasible(decision),
            // The point is a design too, if not one with a small gain.
            (Answer::Feasible(design), _) => Outcome::Solved(self.closed(design.clone(), &found)),
            (Answer::Undecided(Some(_)), _) => Outcome::Undecided(decision),
            (Answer::Undecided(None), Some(design)) => Outcome::Solved(self.closed(design, &found)),
            (Answer::Undecided(None), None) if blocked => Outcome::Undecided(decision),
            // The solvers contradict themselves, or never got anywhere.
            (Answer::Undecided(None), None) => Outcome::SolverFailed(decision),
        })
    }

    /// Looks for a proved design with one solver.
    fn try_solver(&mut self) -> Result<Attempts, SynthesisError> {
        let mut found = Attempts::default();
        for &containment_weight in containment_weights(self.subject.model) {
            let first = self.unit_of_constant_gain(containment_weight)?;
            self.try_units(containment_weight, first, &mut found)?;
        }
        if found.best.is_none() {
            self.try_wider_back_offs(&mut found)?;
        }
        Ok(found)
    }

    /// Tries larger gain bounds where none was proved with the usual back-off.
    fn try_wider_back_offs(&mut self, found: &mut Attempts) -> Result<(), SynthesisError> {
        let bounds: Vec<(ProblemUnits, f64)> =
            found.bounds.iter().take(WIDENED_UNITS).copied().collect();
        for back_off in WIDER_BACK_OFFS {
            for &(units, smallest) in &bounds {
                match self.attempt_with(units, smallest * (1.0 + back_off))? {
                    Attempt::Designed(design) => {
                        found.best = Some(better(found.best.take(), design));
                    }
                    Attempt::Unproved(design, _) => found.unproved = Some(design),
                    Attempt::Infeasible | Attempt::Stuck => {}
                }
            }
            if found.best.is_some() {
                return Ok(());
            }
        }
        Ok(())
    }

    /// For scheduled gains: the units in which a constant gain is proved, a smaller problem that
    /// shows how large the certified set will be.
    fn unit_of_constant_gain(&mut self, weight: f64) -> Result<Option<f64>, SynthesisError> {
        if self.subject.task.gains.count == 1 || self.subject.task.gains.given.is_some() {
            return Ok(None);
        }
        let mut task = self.subject.task.clone();
        task.gains = GainPlan::constant();
        let mut constant = GainSynthesis {
            subject: DesignRequest {
                task: &task,
                ..self.subject
            },
            search: self.search.fresh(self.subject.form),
        };
        let mut found = Attempts::default();
        let outcome = constant.try_units(weight, None, &mut found);
        self.search.runs.append(&mut constant.search.runs);
        outcome?;
        let proved = found.best.map(|design| design.file.provenance.problem);
        Ok(proved.map(|units| units.state_fraction))
    }

    /// Tries units one after the other until a design is proved.
    fn try_units(
        &mut self,
        containment_weight: f64,
        first: Option<f64>,
        found: &mut Attempts,
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
            match self.attempt(units, &mut found.bounds)? {
                Attempt::Designed(design) => {
                    found.best = Some(better(found.best.take(), design));
                    return Ok(());
                }
                Attempt::Unproved(design, wanted) => {
                    found.unproved = Some(design);
                    next.push(wanted);
                }
                Attempt::Infeasible => {
                    // Confirmed once in other units, then given up.
                    found.infeasible += 1;
                    if found.infeasible > 1 {
                        return Ok(());
                    }
                }
                Attempt::Stuck => {}
            }
        }
        Ok(())
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
    if radius.is_finite() && radius > 0.0 {
        radius
    } else {
        1.0
    }
}

fn better(best: Option<Box<Synthesized>>, other: Box<Synthesized>) -> Box<Synthesized> {
    let gamma = |design: &Synthesized| design.file.certificate.gamma;
    match best {
        Some(best) if gamma(&best) <= gamma(&other) => best,
        _ => other,
    }
}

impl GainSynthesis<'_> {
    /// A design with the record of all runs so far.
    fn closed(&self, mut design: Box<Synthesized>, found: &Attempts) -> Box<Synthesized> {
        let gamma = design.file.certificate.gamma;
        design.optimality = Optimality::of_smallest(gamma, found.best_seen());
        design.solve_seconds = self.search.seconds();
        design.file.provenance.solver_runs = self.search.runs.clone();
        design
    }

    fn attempt(
        &mut self,
        units: ProblemUnits,
        bounds: &mut Vec<(ProblemUnits, f64)>,
    ) -> Result<Attempt, SynthesisError> {
        let (_, task) = scaled(self.subject.task, units);
        let (_, smallest) = self.search.solve(&task, Goal::SmallestGain)?;
        match smallest.status {
            Status::Solved | Status::Inaccurate => {}
            Status::Infeasible => return Ok(Attempt::Infeasible),
            Status::Unbounded | Status::Failed | Status::Cancelled => return Ok(Attempt::Stuck),
        }
        let gain_bound = smallest.objective;
        if !(gain_bound.is_finite() && gain_bound > 0.0) {
            return Ok(Attempt::Stuck);
        }
        bounds.push((units, gain_bound));
        self.attempt_with(units, gain_bound * (1.0 + GAIN_BACK_OFF))
    }

    /// The design with the largest margin at a gain bound (scaled units).
    fn attempt_with(
        &mut self,
        units: ProblemUnits,
        gain_bound: f64,
    ) -> Result<Attempt, SynthesisError> {
        let model = self.subject.model;
        let (scaling, task) = scaled(self.subject.task, units);
        let goal = Goal::LargestMargin { gain_bound };
        let (assembled, inside) = self.search.solve(&task, goal)?;
        match recover(model, &assembled.design, &inside.values, &scaling) {
            Ok(certificate) => {
                let radius = certified_radius(&certificate.lyapunov);
                let design = match self.subject.design(&certificate, units) {
                    Ok(design) => design,
                    // Numbers that no design file may hold: a failed attempt.
                    Err(SynthesisError::Invalid(_)) => return Ok(Attempt::Stuck),
                    Err(other) => return Err(other),
                };
                Ok(match design.report.verdict {
                    Verdict::Proved => Attempt::Designed(design),
                    Verdict::NotProved => {
                        let extent = scaling.state.min() / units.state_fraction;
                        let wanted = (radius / extent).clamp(UNIT_RANGE[0], UNIT_RANGE[1]);
                        Attempt::Unproved(design, wanted)
                    }
                })
            }
            Err(RecoverError::Singular { .. } | RecoverError::NotFinite { .. }) => {
                Ok(Attempt::Stuck)
            }
        }
    }
}
