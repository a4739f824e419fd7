//! One solve, one proof. With an uncertain inertia the proof of a no is for the nominal one.

use super::candidate::Source;

use crate::certify::infeasible::{refute, DualMultipliers, Refutation};
use crate::certify::Verdict;
use crate::conditions::{GainPlan, Task};
use crate::design::{recover, ProblemUnits, SolverRun};
use crate::infeasibility::{InfeasibilityFile, WeightsFile};
use crate::model::Model;
use crate::programs::{
    blocking, containment_weights, scaled, Answer, Assembled, Decision, DesignRequest, Form, Goal,
    Infeasible, Session, SynthesisError, Synthesized, FIRST_UNITS, STATE_UNITS,
};
use crate::scaling::Scaling;
use sdp::centre::centred;
use sdp::lmi::Affine;
use sdp::solve::{Backend, Observer, Solution, Status, Structured};

/// Decides whether a design exists for a model. `model_text` is its file's text.
pub fn decide(
    model: &Model,
    model_text: &str,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Decision, SynthesisError> {
    let mut search = Session::new(Form::Chordal, backend, observer);
    let task = model.task();
    decide_after(
        DesignRequest::of_model(model, model_text, &task, Form::Chordal),
        &mut search,
    )
}

/// Looks for a design only: an answer that is not [`Answer::Feasible`] is [`Answer::Undecided`]. The other
/// solver is tried where the structured one, which is faster here, is undecided.
pub(super) fn look_for_a_design(
    model: &Model,
    structured: &Structured,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Decision, SynthesisError> {
    let mut searches = [
        Session::new(Form::VertexRelaxed, structured, observer.clone()),
        Session::new(Form::Chordal, backend, observer),
    ];
    let task = model.task();
    decide_with(
        DesignRequest::of_model(model, "", &task, Form::Chordal),
        &mut searches,
        DecisionGoal::Design,
        STATE_UNITS.len(),
    )
}

/// The same after other runs, which are counted.
pub(crate) fn decide_after(
    subject: DesignRequest,
    search: &mut Session,
) -> Result<Decision, SynthesisError> {
    let structured = Structured::default();
    let other = search.alternative();
    // The full form's dual solution has not the blocks of a proof.
    let mut searches = vec![
        search.fresh(Form::Chordal),
        search.with_backend(Form::VertexRelaxed, &structured),
    ];
    if let Some(other) = other
        .as_deref()
        .filter(|other| other.solver() != structured.solver())
    {
        searches.push(search.with_backend(Form::Chordal, other));
    }
    let subject = DesignRequest {
        form: Form::Chordal,
        ..subject
    };
    let found = decide_with(
        subject,
        &mut searches,
        DecisionGoal::Proof,
        STATE_UNITS.len(),
    );
    for other in &mut searches {
        search.runs.append(&mut other.runs);
    }
    let mut decision = found?;
    decision.solve_seconds = search.seconds();
    decision.runs = search.runs.clone();
    if let Answer::Feasible(design) = &mut decision.answer {
        design.solve_seconds = search.seconds();
        design.file.provenance.solver_runs = search.runs.clone();
    }
    Ok(decision)
}

/// Looks only for dual multipliers that refute the request's gains in its part of the conditions, in at most
/// `most_units` state units.
pub(super) fn refute_part(
    subject: DesignRequest,
    most_units: usize,
    observer: Option<Observer>,
) -> Result<Decision, SynthesisError> {
    let structured = Structured::default();
    let mut searches = [Session::new(Form::VertexRelaxed, &structured, observer)];
    let subject = DesignRequest {
        form: Form::VertexRelaxed,
        ..subject
    };
    decide_with(subject, &mut searches, DecisionGoal::Refutation, most_units)
}

/// What a decision is after.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DecisionGoal {
    /// A design, or a proof that there is none.
    Proof,
    /// A design; where the solver reports that there is none, the decision ends.
    Design,
    /// A proof that there is none; where the solver reports that there is one, the decision ends.
    Refutation,
}

struct SmallestSlack {
    slack: Option<f64>,
    blocking: Vec<(String, f64)>,
}

/// The result for one containment weight.
enum AttemptResult {
    Point(Box<Synthesized>),
    Refuted(Box<WeightsFile>, Refutation),
    /// The solver reports the opposite of the goal, and a proof of that is not requested.
    NotPursued,
    Undecided,
}

/// Runs the solvers in order, in one state unit after the other (at most `most_units`), until there is an answer.
fn decide_with(
    subject: DesignRequest,
    searches: &mut [Session],
    goal: DecisionGoal,
    most_units: usize,
) -> Result<Decision, SynthesisError> {
    let mut out = SmallestSlack {
        slack: None,
        blocking: Vec::new(),
    };
    let mut refuted = Vec::new();
    let mut design = None;
    let mut undecided = false;
    let mut units = FIRST_UNITS;
    let mut sequence = SolverSequence {
        searches,
        goal,
        most_units,
        out: &mut out,
    };
    for &containment_weight in containment_weights(subject.model) {
        units.containment_weight = containment_weight;
        match sequence.in_all_units(subject, &mut units)? {
            AttemptResult::Point(found) => {
                design = Some(found);
                break;
            }
            AttemptResult::Refuted(weights, refutation) => refuted.push((*weights, refutation)),
            AttemptResult::NotPursued | AttemptResult::Undecided => undecided = true,
        }
    }
    let contains = !subject.task.specification.must_contain.is_empty();
    if design.is_none() && contains && goal != DecisionGoal::Design {
        // What cannot hold without containment cannot hold for any rho.
        let mut task = subject.task.clone();
        task.specification.must_contain.clear();
        let free = DesignRequest {
            task: &task,
            ..subject
        };
        sequence.goal = DecisionGoal::Refutation;
        if let AttemptResult::Refuted(weights, refutation) =
            sequence.in_all_units(free, &mut units)?
        {
            refuted = vec![(*weights, refutation)];
            undecided = false;
        }
    }
    let runs: Vec<SolverRun> = searches.iter().flat_map(|s| s.runs.clone()).collect();
    let solve_seconds = searches.iter().map(Session::seconds).sum();
    let answer = match design {
        Some(mut design) => {
            design.solve_seconds = solve_seconds;
            design.file.provenance.solver_runs = runs.clone();
            Answer::Feasible(design)
        }
        None if refuted.is_empty() => Answer::Undecided(None),
        None => {
            let (weights, checked): (_, Vec<Refutation>) = refuted.into_iter().unzip();
            let bounds = checked.iter().map(|refutation| refutation.bound);
            let bound = bounds.fold(f64::MAX, f64::min);
            let mut provenance = subject.provenance(units);
            provenance.solver_runs = runs.clone();
            let file = InfeasibilityFile::new(subject.model, subject.given, weights, provenance);
            let limits = file.limits(subject.model, &checked)?;
            let all = !undecided && limits.is_empty();
            let proof = Box::new(Infeasible {
                file,
                bound,
                limits,
            });
            match all {
                true => Answer::Infeasible(proof),
                false => Answer::Undecided(Some(proof)),
            }
        }
    };
    Ok(Decision {
        answer,
        slack: out.slack,
        blocking: out.blocking,
        limiting_factors: None,
        solve_seconds,
        runs,
    })
}

/// The solvers that are run in order, and their goal.
struct SolverSequence<'a, 'b> {
    searches: &'a mut [Session<'b>],
    goal: DecisionGoal,
    most_units: usize,
    out: &'a mut SmallestSlack,
}

impl SolverSequence<'_, '_> {
    /// Runs the solvers in order, in one state unit after the other, until there is an answer.
    fn in_all_units(
        &mut self,
        subject: DesignRequest,
        units: &mut ProblemUnits,
    ) -> Result<AttemptResult, SynthesisError> {
        for &state_fraction in STATE_UNITS.iter().take(self.most_units) {
            units.state_fraction = state_fraction;
            for search in self.searches.iter_mut() {
                let result = attempt(subject, search, *units, self.goal, self.out)?;
                if !matches!(result, AttemptResult::Undecided) {
                    return Ok(result);
                }
            }
        }
        Ok(AttemptResult::Undecided)
    }
}

fn attempt(
    subject: DesignRequest,
    search: &mut Session,
    units: ProblemUnits,
    goal: DecisionGoal,
    out: &mut SmallestSlack,
) -> Result<AttemptResult, SynthesisError> {
    let (scaling, task) = solved_task(subject.task, units);
    let (assembled, solution) = search.solve(&task, Goal::SmallestSlack)?;
    let usable = matches!(solution.status, Status::Solved | Status::Inaccurate);
    if usable {
        let smaller = out.slack.is_none_or(|slack| solution.objective < slack);
        if smaller {
            out.slack = Some(solution.objective);
            out.blocking = blocking(&assembled.problem.conditions, &solution);
        }
    }
    let margin = task.specification.margin;
    if solution.objective < margin {
        if goal == DecisionGoal::Refutation {
            return Ok(AttemptResult::NotPursued);
        }
        if let Some(design) = point(subject, &assembled, &solution, &scaling, units)? {
            return Ok(AttemptResult::Point(design));
        }
    }
    if usable && goal == DecisionGoal::Design {
        return Ok(AttemptResult::NotPursued);
    }
    if goal == DecisionGoal::Design || !refutable(&task) {
        return Ok(AttemptResult::Undecided);
    }
    if subject.model.plant.has_uncertain_inertia() {
        return refute_nominal(subject, search, units);
    }
    Ok(refuted(subject, &scaling, &task, &assembled, &solution))
}

/// The task in its units, with a threshold that leaves its dual feasible set an interior.
fn solved_task(task: &Task, units: ProblemUnits) -> (Scaling, Task) {
    // A larger xi makes k2 > 1 and is no gain: see `certify::infeasible::Level`.
    let mut task = task.clone();
    task.specification.disturbance_weight_max /= task.invariant_level();
    let (scaling, mut task) = scaled(&task, units);
    let threshold = &mut task.specification.trigger_threshold;
    *threshold = threshold.max(SMALLEST_THRESHOLD);
    (scaling, task)
}

/// A set of inertias has no design when the nominal one, which belongs to it, has none. Given gains are
/// undecided.
fn refute_nominal(
    subject: DesignRequest,
    search: &mut Session,
    units: ProblemUnits,
) -> Result<AttemptResult, SynthesisError> {
    if !subject.given.is_empty() {
        return Ok(AttemptResult::Undecided);
    }
    let mut nominal = subject.model.clone();
    nominal.plant = nominal.plant.nominal();
    let (scaling, task) = solved_task(&nominal.task(), units);
    let mut own = search.fresh(Form::Chordal);
    let solved = own.solve(&task, Goal::SmallestSlack);
    search.runs.append(&mut own.runs);
    let (assembled, solution) = solved?;
    let subject = DesignRequest {
        model: &nominal,
        ..subject
    };
    Ok(refuted(subject, &scaling, &task, &assembled, &solution))
}

/// The proof that the dual solution gives, if it gives one.
fn refuted(
    subject: DesignRequest,
    scaling: &Scaling,
    task: &Task,
    assembled: &Assembled,
    solution: &Solution,
) -> AttemptResult {
    let margin = task.specification.margin;
    let excess = solution.objective - margin;
    if excess.is_nan() || excess <= 0.0 {
        return AttemptResult::Undecided;
    }
    let problem = assembled.problem.lower();
    for kept in KEPT {
        let centre = centred(&problem, &solution.duals, -(margin + kept * excess));
        let source = Source {
            model: subject.model,
            scaling,
            task,
            assembled,
            duals: centre.as_ref().unwrap_or(&solution.duals),
            size: kept * excess,
            given: subject.given,
            part: subject.part,
        };
        if let Some((file, weights)) = as_read(&source) {
            let refutation = refute(subject.model, &weights);
            if refutation.proved {
                return AttemptResult::Refuted(Box::new(file), refutation);
            }
        }
    }
    AttemptResult::Undecided
}

/// Dual multipliers are about one free gain; or about given gains, in any mixture or each with its own vertex.
fn refutable(task: &Task) -> bool {
    let gains = &task.gains;
    let stated = gains.given.is_some() && gains.matched().is_none_or(|kappa| kappa == 0.0);
    *gains == GainPlan::constant() || stated
}

/// The dual multipliers as a reader of their file gets them, `None` where no file may hold them.
fn as_read(source: &Source) -> Option<(WeightsFile, DualMultipliers)> {
    let file = WeightsFile::new(source.weights()?)?;
    let weights = file.weights(source.model, source.given).ok()?;
    Some((file, weights))
}

/// The smallest trigger threshold with which the problem is solved: with 0 its dual feasible set has no
/// interior. A design for a larger threshold is one for the model's; the dual multipliers leave the held state
/// out, see [`Source::weights`].
const SMALLEST_THRESHOLD: f64 = 1e-6;

/// Fractions of the slack above the margin that the dual multipliers of a proof keep, tried in order; the rest moves
/// them into the interior. Close to feasibility only the second leaves enough.
const KEPT: [f64; 2] = [0.25, 0.02];

/// Stands for a gain bound that is not known yet.
const UNKNOWN_GAIN: f64 = 1e300;

/// Relative back-off above the smallest gain bound that a point admits.
const GAIN_BACK_OFF: f64 = 1e-3;

/// The solver's point as a proved design, with the gain bound it admits.
fn point(
    subject: DesignRequest,
    assembled: &Assembled,
    solution: &Solution,
    scaling: &Scaling,
    units: ProblemUnits,
) -> Result<Option<Box<Synthesized>>, SynthesisError> {
    let mut unknowns = assembled.design.clone();
    unknowns.gain_bound = Affine::identity(1, UNKNOWN_GAIN);
    let Ok(mut certificate) = recover(subject.model, &unknowns, &solution.values, scaling) else {
        return Ok(None);
    };
    let xi = certificate.disturbance_weight;
    let guaranteed = certificate.guaranteed_gain;
    let gain_bound = (guaranteed * guaranteed / xi).max(xi) * (1.0 + GAIN_BACK_OFF);
    if !(gain_bound > 0.0 && gain_bound.is_finite()) {
        return Ok(None);
    }
    certificate.gain_bound = gain_bound;
    certificate.guaranteed_gain = guaranteed.min(gain_bound);
    let design = match subject.design(&certificate, units) {
        Ok(design) => design,
        // Numbers that no design file may hold prove nothing.
        Err(SynthesisError::Invalid(_)) => return Ok(None),
        Err(other) => return Err(other),
    };
    Ok((design.report.verdict == Verdict::Proved).then_some(design))
}
