//! Two solves and a check.

use nalgebra::DMatrix;

use super::attempts::{Attempts, Synthesis};
use super::gain::{GainSynthesis, UnitAttempts};
use super::gyroscopic_form::{self, with_chosen_form};
use super::smallest_gain::is_enough;
use super::{measured, parameter_search, two_certificates};
use crate::claim::Claim;
use crate::conditions::GainPlan;
use crate::design::DesignFile;
use crate::feasibility;
use crate::model::{Mismatch, Model, Objective};
use crate::optimality::Optimality;
use crate::programs::{
    is_small, Answer, Asked, ConditionSubset, Decision, DesignRequest, Form, LimitingFactors,
    Outcome, Session, Solvers, SynthesisError, Synthesized,
};
use sdp::solve::Observer;

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
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    if parameter_search::wanted(model) && model.file.specs.objective != Objective::Both {
        return parameter_search::synthesize(model, model_text, solvers, observer);
    }
    let own = model;
    let model = &with_chosen_form(model, solvers, observer.clone())?;
    if model.file.specs.objective == Objective::Both {
        return two_certificates::synthesize(model, model_text, solvers, observer);
    }
    let mut search = Session::each_alone(solvers.fastest_first(), observer.as_ref());
    let task = measured::linearised(model, &model.task(), &mut search)?;
    let mut session = Session::new(solvers, observer);
    for other in &mut search {
        session.runs.append(&mut other.runs);
    }
    let request = DesignRequest::of_model(model, model_text, &task, solvers.first().1);
    smallest_gain(request, own, session)
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
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    let own = model;
    let constant = GainPlan::given(gains, None);
    let model = &gyroscopic_form::chosen(model, &constant, solvers, observer.clone())?;
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
        ..DesignRequest::of_model(model, model_text, &task, solvers.first().1)
    };
    let of_own = DesignRequest {
        model: own,
        ..request
    };
    if let Some(decision) = feasibility::refute_given(of_own, solvers, observer.clone())? {
        return Ok(Outcome::Infeasible(decision));
    }
    smallest_gain(request, own, Session::new(solvers, observer))
}

/// The design with the smallest gain bound that can be proved; without one, whether any design exists for the model `own`,
/// of which the request's has a form of the gyroscopic torque.
fn smallest_gain(
    request: DesignRequest,
    own: &Model,
    mut session: Session,
) -> Result<Outcome, SynthesisError> {
    let mut found =
        Attempts::with_each_solver::<GainSynthesis>(&mut session, is_enough, |session| {
            let form = session.form;
            let request = DesignRequest { form, ..request };
            let asked = request.model.file.specs.gamma;
            GainSynthesis::new(request, asked, session).in_all_settings()
        })?;
    let asked = request.model.file.specs.gamma;
    let met = |design: &Synthesized| {
        asked.is_some_and(|asked| GainSynthesis::objective(&design.file) <= asked)
    };
    let poor = !is_enough(&found);
    if found
        .best
        .as_ref()
        .is_some_and(|design| poor && !met(design))
    {
        // Before a design is called much worse than the best objective seen.
        let other = in_other_forms(request, &mut session)?;
        found.keep::<GainSynthesis>(other.best);
        found.best_seen = found.best_seen.min(other.best_seen);
    }
    let best_seen = found.best_seen;
    let solved = |design: Box<Synthesized>, best_seen: f64, session: &Session| {
        let mut design = design.with_runs(&session.runs);
        let objective = GainSynthesis::objective(&design.file);
        design.optimality = Optimality::of_smallest(objective, best_seen);
        match missed(&design.file).filter(|_| design.is_proved()) {
            Some(reason) => {
                let factors = LimitingFactors::unknown(reason);
                let decision = Decision::of_search(factors, Vec::new(), &session.runs);
                Outcome::Undecided(decision)
            }
            None => Outcome::Solved(design),
        }
    };
    if let Some(design) = found.best.take() {
        return Ok(solved(design, best_seen, &session));
    }
    let mut decision = feasibility::decide_after(request, own, &mut session)?;
    if let Some(point) = decision.linearisation.take() {
        // The weights tried did not suit the set that must be contained.
        let about = GainSynthesis::about_points(request, point, &mut session)?;
        if let Some(design) = about.best {
            let before = best_seen.min(about.best_seen);
            return Ok(solved(design, before, &session));
        }
    }
    if let Answer::Undecided(_) = decision.answer {
        let other = in_other_forms(request, &mut session)?;
        if let Some(design) = other.best {
            return Ok(solved(design, best_seen.min(other.best_seen), &session));
        }
    }
    let slack = decision.slack;
    let blocked = slack.map_or(found.infeasible > 0, |slack| slack > 0.0);
    Ok(match (&decision.answer, found.unproved.take()) {
        (Answer::Infeasible(_), _) => Outcome::Infeasible(decision),
        // The point is a design too, if not one with a small gain.
        (Answer::Feasible(design), _) => solved(design.clone(), best_seen, &session),
        (Answer::Undecided(Some(_)), _) => Outcome::Undecided(decision),
        (Answer::Undecided(None), Some(design)) => solved(design, best_seen, &session),
        (Answer::Undecided(None), None) if blocked => Outcome::Undecided(decision),
        // The solvers contradict themselves, or never got anywhere.
        (Answer::Undecided(None), None) => Outcome::SolverFailed(decision),
    })
}

/// The designs of each solver in the form that suits it less: the forms have the same solutions, but a solver may fail in
/// one of them only. None where that form would be large, or where another form than the one that suits was chosen.
fn in_other_forms(
    request: DesignRequest,
    session: &mut Session,
) -> Result<UnitAttempts, SynthesisError> {
    let mut found = UnitAttempts::default();
    if !is_small(request.task) {
        return Ok(found);
    }
    let solvers = session.solvers().iter();
    let suited =
        solvers.filter(|(backend, form)| backend.solver().map(Form::suited_to) == Some(*form));
    let asked: Vec<Asked> = suited
        .filter_map(|&(backend, form)| Some((backend, form.other()?)))
        .collect();
    for mut own in Session::each_alone(asked, session.observer()) {
        let form = own.form;
        let request = DesignRequest { form, ..request };
        let asked = request.model.file.specs.gamma;
        let outcome = GainSynthesis::new(request, asked, &mut own).in_all_settings();
        session.runs.append(&mut own.runs);
        let other = outcome?;
        found.keep::<GainSynthesis>(other.best);
        found.bounds.extend(other.bounds);
        found.best_seen = found.best_seen.min(other.best_seen);
        if is_enough(&found) {
            break;
        }
    }
    Ok(found)
}

/// The gain that a model asks for and a design does not meet, as a sentence.
fn missed(design: &DesignFile) -> Option<String> {
    let specs = &design.model.specs;
    let (limit, key) = match (specs.gamma, specs.gamma_max) {
        (Some(asked), _) => (asked, "gamma"),
        (None, Some(largest)) => (largest, "gamma_max"),
        (None, None) => return None,
    };
    let what = match specs.objective {
        Objective::Gain | Objective::Pointing => "guaranteed gain",
        _ => "gamma",
    };
    let found = GainSynthesis::objective(design);
    (found > limit).then(|| {
        let found = Claim::AtMost(found);
        format!("the smallest {what} proved is {found}; {key} is {limit}")
    })
}
