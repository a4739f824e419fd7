//! One solve, one proof. With an uncertain inertia the proof of a no is for the nominal one.

use super::candidate::Source;

use crate::certify::infeasible::{refute, DualMultipliers, Refutation};
use crate::certify::theorem1::relative_supply;
use crate::conditions::LoopImperfections;
use crate::conditions::{GainPlan, Task};
use crate::design::{recover, ProblemUnits, SolverRun};
use crate::infeasibility::{InfeasibilityFile, WeightsFile};
use crate::model::Model;
use crate::programs::{
    complete, containment_weights, has_point, is_structured, scaled, Answer, Asked, Blocking,
    Decision, DesignRequest, Form, Goal, Infeasible, Session, Solved, Solvers, SynthesisError,
    Synthesized, FIRST_UNITS, STATE_UNITS,
};
use crate::scaling::Scaling;
use sdp::centre::centred;
use sdp::lmi::Affine;
use sdp::solve::Observer;

/// Decides whether a design exists for a model. `model_text` is its file's text.
///
/// # Errors
/// Stopped by the observer; a problem that a solver refuses; numbers that no design file may hold.
pub fn decide(
    model: &Model,
    model_text: &str,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Decision, SynthesisError> {
    let mut session = Session::new(solvers, observer);
    let mut candidates = model.in_candidate_forms();
    let last = candidates.pop().unwrap_or_else(|| model.clone());
    for candidate in &candidates {
        let task = candidate.task();
        let request = DesignRequest::of_model(candidate, model_text, &task, Form::Chordal);
        let decision = in_order(request, DecisionGoal::Design, &mut session)?;
        if let Answer::Feasible(_) = decision.answer {
            return Ok(decision);
        }
    }
    let task = last.task();
    let request = DesignRequest::of_model(&last, model_text, &task, Form::Chordal);
    decide_after(request, model, &mut session)
}

/// Looks for a design only, with the first form of the gyroscopic torque where it is free: an answer that is not
/// [`Answer::Feasible`] is [`Answer::Undecided`]. The solvers are asked in order.
pub(super) fn look_for_a_design(
    model: &Model,
    solvers: &[Asked],
    observer: Option<Observer>,
) -> Result<Decision, SynthesisError> {
    let mut sessions = Session::each_alone(solvers.iter().copied(), observer.as_ref());
    let candidates = model.in_candidate_forms();
    let model = candidates.first().unwrap_or(model);
    let task = model.task();
    let request = DesignRequest::of_model(model, "", &task, Form::Chordal);
    SolverSequence::new(&mut sessions, DecisionGoal::Design).decide(request)
}

/// Whether a design exists for a model, of which the request's has a form of the gyroscopic torque, after other runs, which
/// are counted. Only what covers every form refutes the model.
pub(crate) fn decide_after(
    request: DesignRequest,
    own: &Model,
    session: &mut Session,
) -> Result<Decision, SynthesisError> {
    let same = request.model == own && request.task.imperfections == LoopImperfections::default();
    if same {
        return in_order(request, DecisionGoal::Proof, session);
    }
    let decision = in_order(request, DecisionGoal::Design, session)?;
    if let Answer::Feasible(_) = decision.answer {
        return Ok(decision);
    }
    let task = own.task();
    let ideal = Task {
        imperfections: LoopImperfections::default(),
        gains: request.task.gains.clone(),
        ..task
    };
    let of_own = DesignRequest {
        model: own,
        task: &ideal,
        ..request
    };
    let goal = match own.is_refuted_by_ideal_loop() {
        true => DecisionGoal::Proof,
        false => DecisionGoal::Design,
    };
    in_order(of_own, goal, session)
}

/// Runs the session's solvers in order for a goal.
fn in_order(
    request: DesignRequest,
    goal: DecisionGoal,
    session: &mut Session,
) -> Result<Decision, SynthesisError> {
    // The full form's dual solution has not the blocks of a proof.
    let mut asked = Vec::new();
    for (index, &(backend, _)) in session.solvers().iter().enumerate() {
        if index == 0 || !is_structured(backend) {
            asked.push((backend, Form::Chordal));
        }
        if is_structured(backend) {
            asked.push((backend, Form::VertexRelaxed));
        }
    }
    let mut sessions = Session::each_alone(asked, session.observer());
    let request = DesignRequest {
        form: Form::Chordal,
        ..request
    };
    let found = SolverSequence::new(&mut sessions, goal).decide(request);
    for other in &mut sessions {
        session.runs.append(&mut other.runs);
    }
    let mut decision = found?.with_runs(&session.runs);
    if let Answer::Feasible(design) = decision.answer {
        decision.answer = Answer::Feasible(design.with_runs(&session.runs));
    }
    Ok(decision)
}

/// Looks only for dual multipliers that refute the request's gains in its part of the conditions, in at most
/// `most_units` state units.
pub(super) fn refute_part(
    request: DesignRequest,
    most_units: usize,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Decision, SynthesisError> {
    let form = Form::VertexRelaxed;
    let mut sessions = [Session::alone((solvers.for_searches(), form), observer)];
    let sequence = SolverSequence {
        most_units,
        ..SolverSequence::new(&mut sessions, DecisionGoal::Refutation)
    };
    sequence.decide(DesignRequest { form, ..request })
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

/// The result for one containment weight.
enum AttemptResult {
    Point(Box<Synthesized>),
    Refuted(Box<WeightsFile>, Refutation),
    /// The solver reports the opposite of the goal, and a proof of that is not requested.
    NotPursued,
    Undecided,
}

/// The solvers that are run in order, and their goal.
struct SolverSequence<'a, 'b> {
    sessions: &'a mut [Session<'b>],
    goal: DecisionGoal,
    /// State units that are tried.
    most_units: usize,
    /// The smallest slack so far.
    slack: Option<f64>,
    /// The conditions that determine it.
    blocking: Vec<Blocking>,
}

impl<'a, 'b> SolverSequence<'a, 'b> {
    fn new(sessions: &'a mut [Session<'b>], goal: DecisionGoal) -> Self {
        SolverSequence {
            sessions,
            goal,
            most_units: STATE_UNITS.len(),
            slack: None,
            blocking: Vec::new(),
        }
    }

    /// Runs the solvers in all units under every containment weight, until there is an answer.
    fn decide(mut self, request: DesignRequest) -> Result<Decision, SynthesisError> {
        let mut refuted = Vec::new();
        let mut design = None;
        let mut undecided = false;
        let mut units = FIRST_UNITS;
        for &containment_weight in containment_weights(request.model) {
            units.containment_weight = containment_weight;
            match self.in_all_units(request, &mut units)? {
                AttemptResult::Point(found) => {
                    design = Some(found);
                    break;
                }
                AttemptResult::Refuted(weights, refutation) => refuted.push((*weights, refutation)),
                AttemptResult::NotPursued | AttemptResult::Undecided => undecided = true,
            }
        }
        let contains = !request.task.specification.must_contain.is_empty();
        if design.is_none() && contains && self.goal != DecisionGoal::Design {
            // What cannot hold without containment cannot hold for any rho.
            let mut task = request.task.clone();
            task.specification.must_contain.clear();
            let free = DesignRequest {
                task: &task,
                ..request
            };
            self.goal = DecisionGoal::Refutation;
            let result = self.in_all_units(free, &mut units)?;
            if let AttemptResult::Refuted(weights, refutation) = result {
                refuted = vec![(*weights, refutation)];
                undecided = false;
            }
        }
        let runs: Vec<SolverRun> = self.sessions.iter().flat_map(|s| s.runs.clone()).collect();
        let answer = match design {
            Some(design) => Answer::Feasible(design.with_runs(&runs)),
            None if refuted.is_empty() => Answer::Undecided(None),
            None => {
                let (weights, checked): (_, Vec<Refutation>) = refuted.into_iter().unzip();
                let bounds = checked.iter().map(|refutation| refutation.bound);
                let bound = bounds.fold(f64::MAX, f64::min);
                let mut provenance = request.provenance(units.clone());
                provenance.solver_runs = runs.clone();
                let (model, given) = (request.model, request.given);
                let file = InfeasibilityFile::new(model, given, weights, provenance);
                let limits = file.limits(model, &checked)?;
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
            slack: self.slack,
            blocking: self.blocking,
            ..Decision::new(answer, &runs)
        })
    }

    /// Runs the solvers in order, in one state unit after the other, until there is an answer.
    fn in_all_units(
        &mut self,
        request: DesignRequest,
        units: &mut ProblemUnits,
    ) -> Result<AttemptResult, SynthesisError> {
        for &state_fraction in STATE_UNITS.iter().take(self.most_units) {
            units.state_fraction = state_fraction;
            for session in 0..self.sessions.len() {
                let result = self.attempt(request, session, units)?;
                if !matches!(result, AttemptResult::Undecided) {
                    return Ok(result);
                }
            }
        }
        Ok(AttemptResult::Undecided)
    }

    /// The smallest slack in these units with one of the sessions, and what its point or its dual solution proves.
    fn attempt(
        &mut self,
        request: DesignRequest,
        session: usize,
        units: &ProblemUnits,
    ) -> Result<AttemptResult, SynthesisError> {
        let session = &mut self.sessions[session];
        let solved = session.solve(solved_task(request.task, units), Goal::SmallestSlack)?;
        let slack = solved.solution.objective;
        let usable = has_point(&solved.solution);
        if usable && self.slack.is_none_or(|smallest| slack < smallest) {
            self.slack = Some(slack);
            self.blocking = solved.blocking();
        }
        let design = self.goal == DecisionGoal::Design;
        if slack < solved.task.specification.margin {
            if self.goal == DecisionGoal::Refutation {
                return Ok(AttemptResult::NotPursued);
            }
            if let Some(design) = point(request, &solved, units, session)? {
                return Ok(AttemptResult::Point(design));
            }
        }
        if usable && design {
            return Ok(AttemptResult::NotPursued);
        }
        if design || !refutable(&solved.task) {
            return Ok(AttemptResult::Undecided);
        }
        if request.model.plant.is_relaxed_for_refutations() {
            return refute_relaxed(request, session, units);
        }
        Ok(refuted(request, &solved))
    }
}

/// The task in its units, with a threshold that leaves its dual feasible set an interior.
fn solved_task(task: &Task, units: &ProblemUnits) -> (Scaling, Task) {
    let (scaling, mut task) = scaled(task, units);
    let threshold = &mut task.specification.trigger_threshold;
    *threshold = threshold.max(SMALLEST_THRESHOLD);
    (scaling, task)
}

/// A plant has no design when the one that it is relaxed to has none.
fn refute_relaxed(
    request: DesignRequest,
    session: &mut Session,
    units: &ProblemUnits,
) -> Result<AttemptResult, SynthesisError> {
    let mut relaxed = request.model.clone();
    relaxed.plant = relaxed.plant.relaxed();
    let mut task = request.task.clone();
    task.system = relaxed.plant.takagi_sugeno();
    let mut own = session.fresh(Form::Chordal);
    let solved = own.solve(solved_task(&task, units), Goal::SmallestSlack);
    session.runs.append(&mut own.runs);
    let request = DesignRequest {
        model: &relaxed,
        ..request
    };
    Ok(refuted(request, &solved?))
}

/// The proof that the dual solution gives, if it gives one.
fn refuted(request: DesignRequest, solved: &Solved) -> AttemptResult {
    let margin = solved.task.specification.margin;
    let excess = solved.solution.objective - margin;
    if excess.is_nan() || excess <= 0.0 {
        return AttemptResult::Undecided;
    }
    let problem = solved.assembled.problem.lower();
    let duals = &solved.solution.duals;
    for kept in KEPT {
        let centre = centred(&problem, duals, -(margin + kept * excess));
        let source = Source {
            request,
            solved,
            duals: centre.as_ref().unwrap_or(duals),
            size: kept * excess,
        };
        if let Some((file, weights)) = as_read(&source) {
            let refutation = refute(request.model, &weights);
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
    let weights = file
        .weights(source.request.model, source.request.given)
        .ok()?;
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

/// The solver's point, completed as in a synthesis, as a proved design with the gain bound it admits.
fn point(
    request: DesignRequest,
    solved: &Solved,
    units: &ProblemUnits,
    session: &mut Session,
) -> Result<Option<Box<Synthesized>>, SynthesisError> {
    let mut unknowns = solved.assembled.design.clone();
    unknowns.gain_bound = Affine::identity(1, UNKNOWN_GAIN);
    let (values, scaling) = (&solved.solution.values, &solved.scaling);
    let model = request.model;
    let Some(certificate) = recover(model, &unknowns, values, (scaling, &solved.task)) else {
        return Ok(None);
    };
    let Some(mut certificate) = complete(model, certificate, session)? else {
        return Ok(None);
    };
    let guaranteed = certificate.guaranteed_gain;
    let least = relative_supply(model, &certificate).max(certificate.disturbance_weight);
    let gain_bound = (guaranteed * guaranteed / least).max(least) * (1.0 + GAIN_BACK_OFF);
    if !(gain_bound > 0.0 && gain_bound.is_finite()) {
        return Ok(None);
    }
    certificate.gain_bound = gain_bound;
    certificate.guaranteed_gain = guaranteed.min(gain_bound);
    let design = request.design(&certificate, None, units);
    Ok(design.filter(|design| design.is_proved()))
}
