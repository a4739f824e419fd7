//! One solve, one proof. With an uncertain inertia the proof of a no is for the nominal one.

use nalgebra::DMatrix;

use super::dual::{refutable, refute_relaxed, refuted, solved_task, Proof};

use crate::certify::infeasible::Refutation;
use crate::certify::theorem1::relative_supply;
use crate::conditions::LoopImperfections;
use crate::conditions::Task;
use crate::design::{recover, ProblemUnits, SolverRun};
use crate::infeasibility::{InfeasibilityFile, WeightsFile};
use crate::model::Model;
use crate::programs::{
    best_form, complete, containment_weights, has_point, is_structured, slack_in, Answer, Asked,
    Blocking, Decision, DesignRequest, Form, Goal, Infeasible, Session, Solved, Solvers,
    SynthesisError, Synthesized, FIRST_UNITS, STATE_UNITS,
};
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
    let own = model;
    let model = &in_promising_form(model, solvers, session.observer().cloned())?;
    let task = model.task();
    let request = DesignRequest::of_model(model, model_text, &task, Form::Chordal);
    decide_after(request, own, &mut session)
}

/// The model in a form of the gyroscopic torque, where that is free, in which the conditions hold; in the one that comes
/// closest where none is found.
pub(super) fn in_promising_form(
    model: &Model,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Model, SynthesisError> {
    if !model.has_free_form() {
        return Ok(model.clone());
    }
    let asked = (solvers.for_searches(), Form::VertexRelaxed);
    let mut session = Session::alone(asked, observer);
    let gains = model.task().gains;
    let mut slack = |form| slack_in(form, model, &gains, &mut session);
    let (form, _) = best_form(&mut slack, -model.task().specification.margin)?;
    Ok(model.with_form(form).unwrap_or_else(|| model.clone()))
}

/// Looks for a design only, of a model whose form of the gyroscopic torque is chosen: an answer that is not
/// [`Answer::Feasible`] is [`Answer::Undecided`]. The solvers are asked in order.
pub(super) fn look_for_a_design(
    model: &Model,
    solvers: &[Asked],
    observer: Option<Observer>,
) -> Result<Decision, SynthesisError> {
    let mut sessions = Session::each_alone(solvers.iter().copied(), observer.as_ref());
    let task = model.task();
    let request = DesignRequest::of_model(model, "", &task, Form::Chordal);
    let sequence = SolverSequence {
        most_linearisations: 0,
        ..SolverSequence::new(&mut sessions, DecisionGoal::Design)
    };
    sequence.decide(request)
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

impl From<Option<Proof>> for AttemptResult {
    fn from(proof: Option<Proof>) -> Self {
        match proof {
            Some((weights, refutation)) => AttemptResult::Refuted(Box::new(weights), refutation),
            None => AttemptResult::Undecided,
        }
    }
}

/// The solvers that are run in order, and their goal.
struct SolverSequence<'a, 'b> {
    sessions: &'a mut [Session<'b>],
    goal: DecisionGoal,
    /// State units that are tried.
    most_units: usize,
    /// How often the containment condition may be stated about the last point.
    most_linearisations: usize,
    /// The smallest slack so far.
    slack: Option<f64>,
    /// The conditions that determine it.
    blocking: Vec<Blocking>,
    /// The point with that slack: its units, and what the containment condition may be stated about.
    nearest: Option<Nearest>,
}

/// The point with the smallest slack.
#[derive(Clone)]
struct Nearest {
    units: ProblemUnits,
    session: usize,
    /// See [`Containment`](crate::conditions::Containment).
    linearisation: DMatrix<f64>,
}

impl<'a, 'b> SolverSequence<'a, 'b> {
    fn new(sessions: &'a mut [Session<'b>], goal: DecisionGoal) -> Self {
        SolverSequence {
            sessions,
            goal,
            most_units: STATE_UNITS.len(),
            most_linearisations: LINEARISATIONS,
            slack: None,
            blocking: Vec::new(),
            nearest: None,
        }
    }

    /// Runs the solvers in all units under every containment weight, until there is an answer.
    fn decide(mut self, request: DesignRequest) -> Result<Decision, SynthesisError> {
        let mut refuted = Vec::new();
        let mut design = None;
        let mut undecided = false;
        let mut units = FIRST_UNITS;
        for &containment_weight in containment_weights(request.task) {
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
        if design.is_none() && contains && self.goal != DecisionGoal::Refutation {
            design = self.about_last_points(request)?;
        }
        if design.is_none() && contains && self.goal != DecisionGoal::Design {
            // What cannot hold without containment cannot hold for any rho.
            let with_containment = (self.slack, self.blocking.clone());
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
            } else {
                // The rest alone says nothing about the slack of the whole.
                (self.slack, self.blocking) = with_containment;
            }
        }
        let found = design.is_some() && contains;
        let nearest = self.nearest.filter(|_| found);
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
            linearisation: nearest.map(|nearest| nearest.linearisation),
            ..Decision::new(answer, &runs)
        })
    }

    /// A design whose containment condition is stated about the point of the smallest slack, then about the next one's,
    /// as long as the slack falls: no weight rho has to suit the set.
    fn about_last_points(
        &mut self,
        request: DesignRequest,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let goal = std::mem::replace(&mut self.goal, DecisionGoal::Design);
        let mut before = f64::INFINITY;
        let mut design = None;
        for _ in 0..self.most_linearisations {
            let (Some(slack), Some(nearest)) = (self.slack, self.nearest.clone()) else {
                break;
            };
            if slack >= before - SLACK_PROGRESS * before.abs() {
                break;
            }
            before = slack;
            let task = request.task.containing_about(nearest.linearisation);
            let request = DesignRequest {
                task: &task,
                ..request
            };
            let attempt = self.attempt(request, nearest.session, &nearest.units)?;
            if let AttemptResult::Point(found) = attempt {
                design = Some(found);
                break;
            }
        }
        self.goal = goal;
        Ok(design)
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
        let index = session;
        let session = &mut self.sessions[index];
        let solved = session.solve(solved_task(request.task, units), Goal::SmallestSlack)?;
        let slack = solved.solution.objective;
        let usable = has_point(&solved.solution);
        if usable && self.slack.is_none_or(|smallest| slack < smallest) {
            self.slack = Some(slack);
            self.blocking = solved.blocking();
            self.nearest = solved.linearisation().map(|linearisation| Nearest {
                units: units.clone(),
                session: index,
                linearisation,
            });
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
            return Ok(refute_relaxed(request, session, units)?.into());
        }
        Ok(refuted(request, &solved).into())
    }
}

/// How often the containment condition is stated about the last point.
const LINEARISATIONS: usize = 12;

/// A slack that falls by less than this, relative, ends that.
const SLACK_PROGRESS: f64 = 1e-3;

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
