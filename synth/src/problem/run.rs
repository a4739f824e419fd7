//! Two solves and a check, for any design problem.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use super::checked::Problem;
use super::design::{verify, ProblemDesignFile, ProblemProvenance, ProofFile};
use super::exclusion::{infeasibility_proof, InfeasibilityProof};
use super::program::{program, ProblemGoal, Program, SLACK_MARGIN};
use super::{with_problem, DesignTask};
use crate::conditions::state_feedback::{
    DesignProblem, StateFeedback, Transformed, Units, VertexPlant,
};
use crate::design::{SolverRun, DESIGN_SCHEMA_VERSION};
use crate::optimality::Optimality;
use crate::programs::{
    blocking, has_point, largest_magnitude, now, sha256_of, Decision, Outcome, Recorded, Session,
    Solvers, SynthesisError, Synthesized, GENERATOR,
};
use crate::synthesis::{Attempts, Smallest, Synthesis};
use sdp::solve::{Observer, Solution};

/// A feedback and how it was found.
pub type ProblemSynthesized = Synthesized<ProblemDesignFile>;

/// Why there is no feedback; with the proof that there is no solution, where there is one.
/// [`InfeasibilityProof::conclusive`] says whether it needs no bound that matters.
pub type ProblemFailure = Decision<Option<InfeasibilityProof>>;

/// The outcome of a synthesis.
pub type ProblemOutcome = Outcome<ProblemDesignFile, ProblemFailure>;

impl Recorded for ProblemDesignFile {
    fn solver_runs(&mut self) -> &mut Vec<SolverRun> {
        &mut self.provenance.solver_runs
    }
}

/// Back-offs of the exported design from the optimum, relative: they leave a margin for the proof. Tried in order
/// until the design is proved.
const BACK_OFFS: [f64; 3] = [1e-3, 1e-2, 1e-1];

/// The conditions count as infeasible where the smallest slack exceeds this fraction of the margin.
const SLACK_SHARE: f64 = 0.5;

/// Finds a feedback for a problem and checks it. `text` is the file's text (its hash goes into the
/// provenance). The conditions of these problems have one form. No solver is asked where a mode that no input reaches
/// rules every feedback out. Where the first solver finds no feedback that is proved, the second one is tried. Only the check decides whether the feedback is proved.
pub fn synthesize(
    problem: &Problem,
    text: &str,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<ProblemOutcome, SynthesisError> {
    let session = Session::new(solvers, observer);
    with_problem!(&problem.task, requested => solve(&Request::new(problem, text, requested), session))
}

/// A problem in the file's units and in those of the solver.
struct Request<'a, P> {
    problem: &'a Problem,
    text: &'a str,
    requested: &'a P,
    units: Units,
    scaled: P,
    plant: VertexPlant,
}

impl<'a, P: DesignProblem> Request<'a, P> {
    fn new(problem: &'a Problem, text: &'a str, requested: &'a P) -> Self {
        let units = requested.units(&problem.plant);
        Request {
            problem,
            text,
            requested,
            scaled: requested.in_units(&units),
            plant: problem.plant.in_units(&units),
            units,
        }
    }

    /// Undoes the transformation of the unknowns: P = Q^-1, F = Y P, H = Z P; then the units. `None` where that is
    /// not possible.
    fn recover(
        &self,
        transformed: &Transformed,
        solution: &Solution,
        objective: f64,
    ) -> Option<StateFeedback> {
        let (values, units) = (&solution.values, &self.units);
        let inverse = transformed.inverse.value(values).try_inverse()?;
        let scaled = 0.5 * (&inverse + inverse.transpose());
        let inputs = DMatrix::from_diagonal(&units.input);
        let in_file_units = |gain: DMatrix<f64>| &inputs * gain / units.state;
        let auxiliary = transformed.auxiliary.iter().zip(P::AUXILIARY_GAINS);
        let mut found = StateFeedback {
            gain: match &self.problem.plant.gain {
                Some(given) => given.clone(),
                None => in_file_units(transformed.gain.value(values) * &scaled),
            },
            auxiliary: auxiliary
                .map(|(z, name)| (name.to_string(), in_file_units(z.value(values) * &scaled)))
                .collect::<BTreeMap<_, _>>(),
            lyapunov: scaled / (units.state * units.state),
            guarantee: f64::NAN,
        };
        self.requested.claim(&mut found, objective, units);
        let finite = |matrix: &DMatrix<f64>| matrix.iter().all(|value| value.is_finite());
        let usable = finite(&found.gain)
            && finite(&found.lyapunov)
            && found.auxiliary.values().all(finite)
            && found.guarantee.is_finite()
            && found.guarantee > 0.0;
        usable.then_some(found)
    }

    /// Puts the file together and checks what a reader of its text would get; `None` for numbers that no design file
    /// may hold.
    fn design(&self, found: &StateFeedback) -> Option<Box<ProblemSynthesized>> {
        let report = verify(self.problem, found);
        let (controller, certificate) = ProofFile::split(found);
        let file = ProblemDesignFile {
            schema_version: DESIGN_SCHEMA_VERSION,
            name: self.problem.file.name.clone(),
            model: self.problem.file.clone(),
            controller,
            certificate,
            verdict: report.clone(),
            provenance: ProblemProvenance {
                generator: GENERATOR.to_string(),
                model_sha256: sha256_of(self.text),
                date: now(),
                solver_runs: Vec::new(),
            },
        };
        file.feedback(self.problem).ok()?;
        Some(Box::new(Synthesized {
            file,
            report,
            solve_seconds: 0.0,
            optimality: None,
        }))
    }
}

/// The numbers that solvers returned.
struct Returned {
    /// The largest scalar unknown, at least 1.
    largest: f64,
    /// The best guarantee.
    best: Option<f64>,
}

/// The smallest objective of a problem, with one solver.
struct FeedbackSynthesis<'a, 'b, 'c, P> {
    request: &'a Request<'a, P>,
    session: &'b mut Session<'c>,
    returned: &'b mut Returned,
}

impl<P: DesignProblem> Synthesis for FeedbackSynthesis<'_, '_, '_, P> {
    type Settings = ();
    type File = ProblemDesignFile;

    fn smallest(&mut self, (): &()) -> Result<Smallest, SynthesisError> {
        let (program, solution) = self.run(ProblemGoal::SmallestObjective)?;
        let smallest = Smallest::of(&solution);
        if let Smallest::Bound(objective) = smallest {
            let transformed = &program.transformed;
            let found = self.request.recover(transformed, &solution, objective);
            let better = match P::LARGER_IS_BETTER {
                true => f64::max,
                false => f64::min,
            };
            let seen = self.returned.best.into_iter();
            let all = seen.chain(found.map(|found| found.guarantee));
            self.returned.best = all.reduce(better);
        }
        Ok(smallest)
    }

    fn design(
        &mut self,
        (): &(),
        objective: f64,
    ) -> Result<Option<Box<ProblemSynthesized>>, SynthesisError> {
        let (program, solution) = self.run(ProblemGoal::LargestMargin { objective })?;
        let transformed = &program.transformed;
        let found = self.request.recover(transformed, &solution, objective);
        Ok(found.and_then(|found| self.request.design(&found)))
    }

    fn objective(file: &ProblemDesignFile) -> f64 {
        match P::LARGER_IS_BETTER {
            true => -file.certificate.guarantee,
            false => file.certificate.guarantee,
        }
    }
}

impl<P: DesignProblem> FeedbackSynthesis<'_, '_, '_, P> {
    fn run(&mut self, goal: ProblemGoal) -> Result<(Program, Solution), SynthesisError> {
        let plant = &self.request.plant;
        let program = program(&self.request.scaled, plant, goal);
        let (problem, accuracy) = (&program.problem, goal.accuracy());
        let vertices = plant.vertices.len();
        let solution = self.session.run(problem, goal.name(), accuracy, vertices)?;
        let largest = largest_magnitude(&solution.values);
        self.returned.largest = self.returned.largest.max(largest);
        Ok((program, solution))
    }
}

fn solve<P: DesignProblem>(
    request: &Request<P>,
    mut session: Session,
) -> Result<ProblemOutcome, SynthesisError> {
    if let Some(mode) = request.problem.unreachable_mode() {
        let proof = InfeasibilityProof::of_mode(mode);
        return Ok(Outcome::Infeasible(Decision::new(Some(proof), &[])));
    }
    let mut returned = Returned {
        largest: 1.0,
        best: None,
    };
    let proved = |found: &Attempts<(), ProblemDesignFile>| found.best.is_some();
    let found =
        Attempts::with_each_solver::<FeedbackSynthesis<P>>(&mut session, proved, |session| {
            let mut synthesis = FeedbackSynthesis {
                request,
                session,
                returned: &mut returned,
            };
            let mut found = Attempts::default();
            found.attempt(&mut synthesis, &(), &BACK_OFFS)?;
            Ok(found)
        })?;
    if let Some(design) = found.best.or(found.unproved) {
        let mut design = design.with_runs(&session.runs);
        let guarantee = design.file.certificate.guarantee;
        design.optimality = returned.best.and_then(|best| match P::LARGER_IS_BETTER {
            true => Optimality::of_largest(guarantee, best),
            false => Optimality::of_smallest(guarantee, best),
        });
        return Ok(Outcome::Solved(design));
    }
    let failure = explain(request, &mut session, &mut returned)?;
    let blocked = match failure.slack {
        Some(slack) => slack > (SLACK_SHARE - 1.0) * SLACK_MARGIN,
        None => found.infeasible > 0,
    };
    Ok(match failure.answer {
        Some(proof) if proof.conclusive() => Outcome::Infeasible(failure),
        Some(_) => Outcome::Undecided(failure),
        None if blocked => Outcome::Undecided(failure),
        // The solvers contradict themselves, or never got anywhere.
        None => Outcome::SolverFailed(failure),
    })
}

/// The smallest slack, the conditions that determine it, and the infeasibility proof from the solvers' dual solutions.
fn explain<P: DesignProblem>(
    request: &Request<P>,
    session: &mut Session,
    returned: &mut Returned,
) -> Result<ProblemFailure, SynthesisError> {
    let mut smallest_slack = |session: &mut Session| {
        let mut synthesis = FeedbackSynthesis {
            request,
            session,
            returned,
        };
        synthesis.run(ProblemGoal::SmallestSlack)
    };
    let mut found = vec![smallest_slack(session)?];
    found.extend(session.with_other(smallest_slack)?);
    let largest = returned.largest;
    let proofs = found.iter().filter_map(|(program, solution)| {
        let original = (request.requested, &request.problem.plant);
        let scaled = (&request.scaled, &request.plant);
        infeasibility_proof(original, scaled, program, solution, largest)
    });
    let proof = proofs.max_by(|a, b| a.radius.total_cmp(&b.radius));
    let solved = found.iter().filter(|(_, solution)| has_point(solution));
    let smallest = solved.min_by(|a, b| a.1.objective.total_cmp(&b.1.objective));
    let carrier = smallest.or(found.first());
    Ok(Decision {
        // Without the margin that was asked for.
        slack: smallest.map(|(_, solution)| solution.objective - SLACK_MARGIN),
        blocking: carrier.map_or(Vec::new(), |(program, solution)| {
            blocking(&program.problem.conditions, solution)
        }),
        ..Decision::new(proof, &session.runs)
    })
}
