//! Two solves and a check, for any design problem.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use super::checked::Problem;
use super::design::{verify, ProblemDesignFile, ProblemProvenance, ProofFile};
use super::exclusion::infeasibility_proof;
use super::outcome::{ProblemFailure, ProblemOutcome, ProblemSynthesized};
use super::program::{program, ProblemGoal, Program, SLACK_MARGIN};
use super::{with_problem, DesignTask};
use crate::certify::Verdict;
use crate::conditions::state_feedback::{
    DesignProblem, StateFeedback, Transformed, Units, VertexPlant,
};
use crate::design::{SolverRun, VerdictFile, DESIGN_SCHEMA_VERSION};
use crate::optimality::Optimality;
use crate::programs::{
    blocking, generator, now, run_solver, sha256_of, SolveRequest, SynthesisError,
};
use sdp::solve::{alternative, Backend, Observer, Solution, Status};

/// Back-offs of the exported design from the optimum, relative: they leave a margin for the proof. Tried in order
/// until the design is proved.
const BACK_OFFS: [f64; 3] = [1e-3, 1e-2, 1e-1];

/// The conditions count as infeasible where the smallest slack exceeds this fraction of the margin.
const SLACK_SHARE: f64 = 0.5;

/// Undoes the transformation of the unknowns: P = Q^-1, F = Y P, H = Z P; then the units. `None` where that is not possible.
fn recover<P: DesignProblem>(
    requested: &P,
    plant: &VertexPlant,
    units: &Units,
    transformed: &Transformed,
    solution: &Solution,
    objective: f64,
) -> Option<StateFeedback> {
    let values = &solution.values;
    let inverse = transformed.inverse.value(values).try_inverse()?;
    let scaled = 0.5 * (&inverse + inverse.transpose());
    let inputs = DMatrix::from_diagonal(&units.input);
    let in_file_units = |gain: DMatrix<f64>| &inputs * gain / units.state;
    let auxiliary = transformed.auxiliary.iter().zip(P::AUXILIARY_GAINS);
    let mut found = StateFeedback {
        gain: match &plant.gain {
            Some(given) => given.clone(),
            None => in_file_units(transformed.gain.value(values) * &scaled),
        },
        auxiliary: auxiliary
            .map(|(z, name)| (name.to_string(), in_file_units(z.value(values) * &scaled)))
            .collect::<BTreeMap<_, _>>(),
        lyapunov: scaled / (units.state * units.state),
        guarantee: f64::NAN,
    };
    requested.claim(&mut found, objective, units);
    let finite = |matrix: &DMatrix<f64>| matrix.iter().all(|value| value.is_finite());
    let usable = finite(&found.gain)
        && finite(&found.lyapunov)
        && found.auxiliary.values().all(finite)
        && found.guarantee.is_finite()
        && found.guarantee > 0.0;
    usable.then_some(found)
}

struct FeedbackSynthesis<'a> {
    problem: &'a Problem,
    text: &'a str,
    observer: Option<Observer>,
    runs: Vec<SolverRun>,
    /// The largest scalar unknown that a solver returned, at least 1.
    largest_returned: f64,
    /// The best guarantee that a solver reported.
    best_seen: Option<f64>,
}

/// Finds a feedback for a problem and checks it. `text` is the file's text (its hash goes into the
/// provenance). Where the given solver finds no feedback that is proved, the other one is tried. Only the check
/// decides whether the feedback is proved.
pub fn synthesize(
    problem: &Problem,
    text: &str,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<ProblemOutcome, SynthesisError> {
    let mut run = FeedbackSynthesis {
        problem,
        text,
        observer,
        runs: Vec::new(),
        largest_returned: 1.0,
        best_seen: None,
    };
    let other = alternative(backend);
    let solvers: Vec<&dyn Backend> = [backend].into_iter().chain(other.as_deref()).collect();
    with_problem!(&problem.task, requested => run.solve(requested, &solvers))
}

fn usable(solution: &Solution) -> bool {
    matches!(solution.status, Status::Solved | Status::Inaccurate)
}

/// The result of a solver without a proved feedback.
struct FailedAttempt {
    unproved: Option<Box<ProblemSynthesized>>,
    refused: bool,
}

impl FeedbackSynthesis<'_> {
    fn solve<P: DesignProblem>(
        &mut self,
        requested: &P,
        solvers: &[&dyn Backend],
    ) -> Result<ProblemOutcome, SynthesisError> {
        let units = requested.units(&self.problem.plant);
        let mut unproved = None;
        let mut refused = false;
        for &backend in solvers {
            match self.attempt(requested, &units, backend)? {
                Ok(design) => return Ok(ProblemOutcome::Solved(design)),
                Err(attempt) => {
                    unproved = unproved.or(attempt.unproved);
                    refused |= attempt.refused;
                }
            }
        }
        if let Some(design) = unproved {
            return Ok(ProblemOutcome::Solved(design));
        }
        let failure = self.explain(requested, &units, solvers)?;
        let blocked = match failure.slack {
            Some(slack) => slack > (SLACK_SHARE - 1.0) * SLACK_MARGIN,
            None => refused,
        };
        Ok(match failure.infeasibility {
            Some(infeasibility_proof) if infeasibility_proof.conclusive() => {
                ProblemOutcome::Infeasible(failure)
            }
            Some(_) => ProblemOutcome::Undecided(failure),
            None if blocked => ProblemOutcome::Undecided(failure),
            // The solvers contradict themselves, or never got anywhere.
            None => ProblemOutcome::SolverFailed(failure),
        })
    }

    /// A proved feedback by one solver, or its failed attempt.
    fn attempt<P: DesignProblem>(
        &mut self,
        requested: &P,
        units: &Units,
        backend: &dyn Backend,
    ) -> Result<Result<Box<ProblemSynthesized>, FailedAttempt>, SynthesisError> {
        let scaled = requested.in_units(units);
        let given = &self.problem.plant;
        let plant = given.in_units(units);
        let (program, smallest) =
            self.run(&scaled, &plant, ProblemGoal::SmallestObjective, backend)?;
        let mut unproved = None;
        if usable(&smallest) && smallest.objective > 0.0 {
            let objective = smallest.objective;
            let best = recover(
                requested,
                given,
                units,
                &program.transformed,
                &smallest,
                objective,
            );
            self.note::<P>(best.map(|best| best.guarantee));
            for back_off in BACK_OFFS {
                let objective = smallest.objective * (1.0 + back_off);
                let goal = ProblemGoal::LargestMargin { objective };
                let (inside, solution) = self.run(&scaled, &plant, goal, backend)?;
                let found = recover(
                    requested,
                    given,
                    units,
                    &inside.transformed,
                    &solution,
                    objective,
                );
                let Some(found) = found else { continue };
                let design = match self.finish::<P>(&found) {
                    Ok(design) => design,
                    // Numbers that no design file may hold: a failed attempt.
                    Err(SynthesisError::Invalid(_)) => continue,
                    Err(other) => return Err(other),
                };
                if design.report.verdict == Verdict::Proved {
                    return Ok(Ok(design));
                }
                unproved = Some(design);
            }
        }
        Ok(Err(FailedAttempt {
            unproved,
            refused: smallest.status == Status::Infeasible,
        }))
    }

    /// Keeps the best guarantee seen.
    fn note<P: DesignProblem>(&mut self, guarantee: Option<f64>) {
        let better: fn(f64, f64) -> f64 = match P::LARGER_IS_BETTER {
            true => f64::max,
            false => f64::min,
        };
        self.best_seen = match (self.best_seen, guarantee) {
            (Some(best), Some(guarantee)) => Some(better(best, guarantee)),
            (best, guarantee) => best.or(guarantee),
        };
    }

    fn optimality<P: DesignProblem>(&self, found: &StateFeedback) -> Option<Optimality> {
        let best = self.best_seen?;
        match P::LARGER_IS_BETTER {
            true => Optimality::of_largest(found.guarantee, best),
            false => Optimality::of_smallest(found.guarantee, best),
        }
    }

    fn run<P: DesignProblem>(
        &mut self,
        requested: &P,
        plant: &VertexPlant,
        goal: ProblemGoal,
        backend: &dyn Backend,
    ) -> Result<(Program, Solution), SynthesisError> {
        let program = program(requested, plant, goal);
        let request = SolveRequest {
            goal: goal.name(),
            vertices: plant.vertices.len(),
            accuracy: goal.accuracy(),
        };
        let observer = self.observer.as_ref();
        let (solution, run) = run_solver(backend, &program.problem, &request, observer)?;
        self.runs.push(run);
        let sizes = solution.values.iter().map(|value| match value.is_nan() {
            true => f64::INFINITY,
            false => value.abs(),
        });
        self.largest_returned = sizes.fold(self.largest_returned, f64::max);
        Ok((program, solution))
    }

    /// Puts the file together and checks what a reader of its text would get.
    fn finish<P: DesignProblem>(
        &self,
        found: &StateFeedback,
    ) -> Result<Box<ProblemSynthesized>, SynthesisError> {
        let report = verify(self.problem, found);
        let (controller, certificate) = ProofFile::split(found);
        let file = ProblemDesignFile {
            schema_version: DESIGN_SCHEMA_VERSION,
            name: self.problem.file.name.clone(),
            model: self.problem.file.clone(),
            controller,
            certificate,
            verdict: VerdictFile::new(&report),
            provenance: ProblemProvenance {
                generator: generator(),
                model_sha256: sha256_of(self.text),
                date: now(),
                solver_runs: self.runs.clone(),
            },
        };
        // The numbers must be ones that a reader accepts.
        file.feedback(self.problem)?;
        Ok(Box::new(ProblemSynthesized {
            file,
            report,
            solve_seconds: self.seconds(),
            optimality: self.optimality::<P>(found),
        }))
    }

    /// The smallest slack, the conditions that determine it, and the infeasibility proof from the solvers' dual solutions.
    fn explain<P: DesignProblem>(
        &mut self,
        requested: &P,
        units: &Units,
        solvers: &[&dyn Backend],
    ) -> Result<ProblemFailure, SynthesisError> {
        let scaled = requested.in_units(units);
        let plant = self.problem.plant.in_units(units);
        let mut found = Vec::new();
        for &backend in solvers {
            found.push(self.run(&scaled, &plant, ProblemGoal::SmallestSlack, backend)?);
        }
        let largest = self.largest_returned;
        let infeasibility = found
            .iter()
            .filter_map(|(program, solution)| {
                let original = (requested, &self.problem.plant);
                infeasibility_proof(original, (&scaled, &plant), program, solution, largest)
            })
            .max_by(|a, b| a.radius.total_cmp(&b.radius));
        let solved = found.iter().filter(|(_, solution)| usable(solution));
        let smallest = solved.min_by(|a, b| a.1.objective.total_cmp(&b.1.objective));
        let carrier = smallest.or(found.first());
        Ok(ProblemFailure {
            infeasibility,
            // Without the margin that was asked for.
            slack: smallest.map(|(_, solution)| solution.objective - SLACK_MARGIN),
            blocking: carrier.map_or(Vec::new(), |(program, solution)| {
                blocking(&program.problem.conditions, solution)
            }),
            solve_seconds: self.seconds(),
            runs: self.runs.clone(),
        })
    }

    fn seconds(&self) -> f64 {
        self.runs.iter().map(|run| run.seconds).sum()
    }
}
