//! From a problem to a checked feedback, or to what is known of there being none.

use super::checked::Problem;
use super::design::ProblemDesignFile;
use super::exclusion::{infeasibility_proof, InfeasibilityProof};
use super::program::SLACK_MARGIN;
use super::request::{ProblemSynthesized, Request};
use super::search::Search;
use super::{with_problem, DesignTask};
use crate::certify::Verdict;
use crate::conditions::state_feedback::DesignProblem;
use crate::optimality::Optimality;
use crate::programs::{
    blocking, has_point, Decision, Form, Outcome, Session, Solvers, SynthesisError,
};
use sdp::solve::{Observer, Solver};

/// Why there is no feedback.
pub type ProblemFailure = Decision<NoFeedback>;

/// What is known where no feedback was found.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NoFeedback {
    /// That there is no solution, where something of the kind is proved.
    /// [`InfeasibilityProof::conclusive`] says whether it needs no bound that matters.
    pub excluded: Option<InfeasibilityProof>,
    /// The number that a proved feedback guarantees, which is worse than the one that the file asks for.
    pub nearest: Option<f64>,
}

impl From<Option<InfeasibilityProof>> for NoFeedback {
    fn from(excluded: Option<InfeasibilityProof>) -> Self {
        NoFeedback {
            excluded,
            nearest: None,
        }
    }
}

/// The outcome of a synthesis.
pub type ProblemOutcome = Outcome<ProblemDesignFile, ProblemFailure>;

/// The order in which the solvers are asked where none is named: the structured one first where the unknowns are many.
pub fn solver_order(problem: &Problem) -> [Solver; 2] {
    match problem.plant.states() > FEW_STATES {
        true => [Solver::Structured, Solver::Clarabel],
        false => [Solver::Clarabel, Solver::Structured],
    }
}

/// Up to this many states Clarabel takes no longer than the structured solver.
const FEW_STATES: usize = 12;

/// The conditions count as infeasible where the smallest slack exceeds this fraction of the margin.
const SLACK_SHARE: f64 = 0.5;

/// Finds a feedback for a problem and checks it. `text` is the file's text (its hash goes into the
/// provenance). No solver is asked where a mode that no input reaches rules every feedback out, or where a Riccati
/// equation gives a feedback that is proved. The solvers are asked in the order given, each only where those before it
/// leave something to be wished for. Only the check decides whether the feedback is proved.
pub fn synthesize(
    problem: &Problem,
    text: &str,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<ProblemOutcome, SynthesisError> {
    let outcome = attempt(problem, text, solvers, observer.clone())?;
    let undecided = matches!(outcome, Outcome::Undecided(_) | Outcome::SolverFailed(_));
    if !undecided || problem.task.wanted().exactly.is_none() {
        return Ok(outcome);
    }
    // The best that there is in the place of what is wanted.
    let relaxed = Problem {
        task: problem.task.without_wanted(),
        ..problem.clone()
    };
    let other = attempt(&relaxed, text, solvers, observer)?;
    Ok(match (outcome, other) {
        (Outcome::Undecided(failure) | Outcome::SolverFailed(failure), Outcome::Solved(design))
            if design.is_proved() =>
        {
            let own = design.file.provenance.solver_runs.clone();
            let runs = [failure.runs.clone(), own].concat();
            nearest(problem, *design, failure.with_runs(&runs))
        }
        (outcome, _) => outcome,
    })
}

/// A design for the problem without what is wanted of the number: it may serve all the same.
fn nearest(
    problem: &Problem,
    mut design: ProblemSynthesized,
    mut failure: ProblemFailure,
) -> ProblemOutcome {
    if let Ok(report) = design.file.verify(problem) {
        if report.verdict == Verdict::Proved {
            design.file.verdict = report.clone();
            design.report = report;
            design.optimality = None;
            return Outcome::Solved(Box::new(design).with_runs(&failure.runs));
        }
    }
    failure.answer.nearest = Some(design.file.certificate.guarantee);
    Outcome::Undecided(failure)
}

fn attempt(
    problem: &Problem,
    text: &str,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<ProblemOutcome, SynthesisError> {
    // The conditions of these problems have one form.
    let asked = solvers.in_order().into_iter();
    let asked = asked.map(|(backend, _)| (backend, Form::Full));
    let mut sessions = Session::each_alone(asked, observer.as_ref());
    with_problem!(&problem.task, requested => solve(&Request::new(problem, text, requested), &mut sessions))
}

fn solve<P: DesignProblem>(
    request: &Request<P>,
    sessions: &mut [Session],
) -> Result<ProblemOutcome, SynthesisError> {
    if let Some(mode) = request.problem.unreachable_mode() {
        let proof = InfeasibilityProof::of_mode(mode);
        return Ok(Outcome::Infeasible(Decision::new(Some(proof).into(), &[])));
    }
    let mut search = Search::new(request);
    search.directly();
    for session in sessions.iter_mut() {
        if search.is_settled() {
            break;
        }
        search.with_solver(session)?;
    }
    for session in sessions.iter_mut() {
        if search.is_settled() {
            break;
        }
        search.between(session)?;
    }
    if let Some(design) = search.best.take() {
        let mut design = design.with_runs(&search.runs);
        let guarantee = design.file.certificate.guarantee;
        let wanted = request.requested.wanted();
        let seen = search.seen.filter(|_| wanted.exactly.is_none());
        design.optimality = seen
            .map(P::guarantee_of)
            .and_then(|best| match P::LARGER_IS_BETTER {
                true => Optimality::of_largest(guarantee, best),
                false => Optimality::of_smallest(guarantee, best),
            });
        return Ok(Outcome::Solved(design));
    }
    let failure = explain(request, &mut search, sessions)?;
    let blocked = match failure.slack {
        Some(slack) => slack > (SLACK_SHARE - 1.0) * SLACK_MARGIN,
        None => search.infeasible > 0,
    };
    Ok(match failure.answer.excluded {
        Some(proof) if proof.conclusive() => Outcome::Infeasible(failure),
        Some(_) => Outcome::Undecided(failure),
        None if blocked => Outcome::Undecided(failure),
        None => match search.unproved {
            Some(design) => Outcome::Solved(design.with_runs(&failure.runs)),
            // The solvers contradict themselves, or never got anywhere.
            None => Outcome::SolverFailed(failure),
        },
    })
}

/// The smallest slack, the conditions that determine it, and the infeasibility proof from the solvers' dual solutions.
fn explain<P: DesignProblem>(
    request: &Request<P>,
    search: &mut Search<P>,
    sessions: &mut [Session],
) -> Result<ProblemFailure, SynthesisError> {
    let mut found = Vec::new();
    for session in sessions.iter_mut() {
        found.extend(search.smallest_slack(session)?);
    }
    let largest = search.largest;
    let proofs = found.iter().filter_map(|(scaled, program, solution)| {
        let original = (request.requested, &request.problem.plant);
        infeasibility_proof(original, scaled, program, solution, largest)
    });
    let proof = proofs.max_by(|a, b| a.radius.total_cmp(&b.radius));
    let solved = found.iter().filter(|(_, _, solution)| has_point(solution));
    let smallest = solved.min_by(|a, b| a.2.objective.total_cmp(&b.2.objective));
    let carrier = smallest.or(found.first());
    Ok(Decision {
        // Without the margin that was asked for.
        slack: smallest.map(|(_, _, solution)| solution.objective - SLACK_MARGIN),
        blocking: carrier.map_or(Vec::new(), |(_, program, solution)| {
            blocking(&program.problem.conditions, solution)
        }),
        ..Decision::new(proof.into(), &search.runs)
    })
}
