//! Two solves and a check, for any design problem.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use super::checked::Problem;
use super::design::{verify, ProblemDesignFile, ProblemProvenance, ProofFile};
use super::{with_problem, DesignTask};
use crate::certify::exclusion::exclude;
use crate::certify::{Report, Verdict};
use crate::conditions::state_feedback::{DesignProblem, Hatted, StateFeedback, Units, VertexPlant};
use crate::conditions::xu2020::Strictness;
use crate::design::{SolverRun, VerdictFile, DESIGN_SCHEMA_VERSION};
use crate::feasibility::centred;
use crate::lmi::{self, svec_index, Affine, Cone, Semidefinite, Unknowns};
use crate::optimality::Optimality;
use crate::solve::{alternative, Accuracy, Backend, Observer, Solution, Status};
use crate::synthesis::{blocking, generator, now, run_solver, sha256_of, Sought, SynthesisError};

/// Margin of every strict inequality in the first solve, in scaled units.
const MARGIN: f64 = 1e-6;

/// How far the exported design stays from the optimum, relative to it: the price of a margin. Tried one
/// after the other until the design is proved.
const ROOMS: [f64; 3] = [1e-3, 1e-2, 1e-1];

/// Unit of the margin that the second solve maximises.
const MARGIN_UNIT: f64 = 1e-3;

/// Margin that is asked for where the smallest slack is sought, in scaled units.
const SLACK_MARGIN: f64 = 1e-2;

/// Share of that margin which the smallest slack takes when the conditions cannot hold.
const SLACK_SHARE: f64 = 0.5;

/// Part of the slack above the margin that the weights of a proof keep; the rest moves them inside.
const KEPT: f64 = 0.25;

/// Shares of their mean eigenvalue by which dual matrices are pushed inside their cones.
const PUSHES: [f64; 4] = [1e-12, 1e-10, 1e-8, 1e-6];

/// A feedback and how it was found.
#[derive(Debug, Clone)]
pub struct ProblemSynthesized {
    /// The file, with its verdict.
    pub file: ProblemDesignFile,
    /// The check of the file's numbers.
    pub report: Report,
    /// Time spent in solvers (s).
    pub solve_seconds: f64,
    /// The guarantee beside the best one that a solver reported.
    pub optimality: Option<Optimality>,
}

/// Why there is no feedback.
#[derive(Debug, Clone)]
pub struct ProblemFailure {
    /// The smallest slack with which all conditions hold, in scaled units, where the solver found it.
    pub slack: Option<f64>,
    /// What is proved about solutions that there are not; [`Excluded::conclusive`] says whether that is all of them.
    pub excluded: Option<Excluded>,
    /// The conditions with the largest share of the dual solution: those that block.
    pub blocking: Vec<(String, f64)>,
    /// Time spent in solvers (s).
    pub solve_seconds: f64,
    /// The solver's runs.
    pub runs: Vec<SolverRun>,
}

/// What synthesis found.
#[derive(Debug, Clone)]
pub enum ProblemOutcome {
    /// A feedback; its report says whether it is proved.
    Solved(Box<ProblemSynthesized>),
    /// There is none: proved.
    Infeasible(ProblemFailure),
    /// Neither a feedback nor its impossibility is proved.
    Undecided(ProblemFailure),
    /// The solvers gave up.
    SolverFailed(ProblemFailure),
}

/// Which optimum is sought.
#[derive(Clone, Copy)]
enum Goal {
    SmallestObjective,
    LargestMargin {
        objective: f64,
    },
    SmallestSlack,
    /// No optimum: the conditions with this margin.
    Margin(f64),
}

impl Goal {
    fn name(self) -> &'static str {
        match self {
            Goal::SmallestObjective => "smallest objective",
            Goal::LargestMargin { .. } => "largest margin",
            Goal::SmallestSlack => "smallest slack",
            Goal::Margin(_) => "margin",
        }
    }

    fn accuracy(self) -> Accuracy {
        let (relative_gap, objective_unit) = match self {
            Goal::SmallestObjective => (1e-8, 1e-3),
            Goal::LargestMargin { .. } => (1e-2, 1.0),
            Goal::SmallestSlack | Goal::Margin(_) => (1e-6, SLACK_MARGIN),
        };
        Accuracy {
            relative_gap,
            objective_unit,
        }
    }
}

/// A problem for a solver, with handles on its unknowns.
struct Program {
    problem: lmi::Problem,
    hatted: Hatted,
}

/// States a problem in the units of `plant`.
fn program<P: DesignProblem>(asked: &P, plant: &VertexPlant, goal: Goal) -> Program {
    let mut unknowns = Unknowns::new();
    let mut hatted = Hatted::new::<P>(&mut unknowns, plant);
    let (strictness, objective) = match goal {
        Goal::SmallestObjective => (Strictness::fixed(MARGIN), hatted.objective.clone()),
        Goal::Margin(margin) => (Strictness::fixed(margin), hatted.objective.clone()),
        Goal::LargestMargin { objective } => {
            let margin = unknowns.scalar("margin");
            hatted.objective = Affine::identity(1, objective);
            (Strictness::unknown(MARGIN_UNIT * &margin), -margin)
        }
        Goal::SmallestSlack => {
            let slack = unknowns.scalar("slack");
            let margin = Affine::identity(1, SLACK_MARGIN) - slack.clone();
            (Strictness::unknown(margin), slack)
        }
    };
    let conditions = asked.conditions(plant, &hatted, &strictness);
    Program {
        problem: lmi::Problem {
            unknowns,
            objective,
            conditions,
        },
        hatted,
    }
}

/// The first problem that is solved, lowered, in its scaled units.
pub fn first_program(problem: &Problem) -> Semidefinite {
    fn lowered<P: DesignProblem>(asked: &P, plant: &VertexPlant) -> Semidefinite {
        let units = asked.units(plant);
        let (asked, plant) = (asked.in_units(&units), plant.in_units(&units));
        program(&asked, &plant, Goal::SmallestObjective)
            .problem
            .lower()
    }
    with_problem!(&problem.task, asked => lowered(asked, &problem.plant))
}

/// Undoes the hats: P = Q^-1, F = Y P, H = Z P; then the units. `None` where that is not possible.
fn recover<P: DesignProblem>(
    asked: &P,
    plant: &VertexPlant,
    units: &Units,
    hatted: &Hatted,
    solution: &Solution,
    objective: f64,
) -> Option<StateFeedback> {
    let values = &solution.values;
    let inverse = hatted.inverse.value(values).try_inverse()?;
    let scaled = 0.5 * (&inverse + inverse.transpose());
    let inputs = DMatrix::from_diagonal(&units.input);
    let in_file_units = |gain: DMatrix<f64>| &inputs * gain / units.state;
    let auxiliary = hatted.auxiliary.iter().zip(P::AUXILIARY_GAINS);
    let mut found = StateFeedback {
        gain: match &plant.gain {
            Some(given) => given.clone(),
            None => in_file_units(hatted.gain.value(values) * &scaled),
        },
        auxiliary: auxiliary
            .map(|(z, name)| (name.to_string(), in_file_units(z.value(values) * &scaled)))
            .collect::<BTreeMap<_, _>>(),
        lyapunov: scaled / (units.state * units.state),
        guarantee: f64::NAN,
    };
    asked.claim(&mut found, objective, units);
    let finite = |matrix: &DMatrix<f64>| matrix.iter().all(|value| value.is_finite());
    let usable = finite(&found.gain)
        && finite(&found.lyapunov)
        && found.auxiliary.values().all(finite)
        && found.guarantee.is_finite()
        && found.guarantee > 0.0;
    usable.then_some(found)
}

/// Where the conditions have no solution: proved for the numbers of the scaled problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excluded {
    /// No solution has all scalar unknowns below this in magnitude; infinite when no bound is needed.
    pub radius: f64,
    /// What every condition exceeds in such a solution; 0 excludes solutions that are not strict too. Conditions
    /// without a constant part hold at zero, and only a margin excludes anything.
    pub margin: f64,
    /// The largest scalar unknown that any solver returned for the problem or its relaxation, at least 1.
    pub largest_returned: f64,
}

/// A radius must exceed what solvers returned by this factor before it counts as no bound at all.
const RADIUS_FACTOR: f64 = 1e6;

impl Excluded {
    /// True when the statement needs no bound on the unknowns, or one so far beyond every point that a solver
    /// returned that it does not matter.
    pub fn conclusive(&self) -> bool {
        self.radius == f64::INFINITY || self.radius >= RADIUS_FACTOR * self.largest_returned
    }
}

/// Dual weights of the smallest slack as a proof that there is no solution.
fn excluded<P: DesignProblem>(
    asked: &P,
    plant: &VertexPlant,
    smallest_slack: &Program,
    solution: &Solution,
    largest_returned: f64,
) -> Option<Excluded> {
    let problem = smallest_slack.problem.lower();
    let excess = solution.objective - SLACK_MARGIN;
    let targets = [SLACK_MARGIN + KEPT * excess.max(0.0), SLACK_MARGIN];
    let centres = targets.map(|target| centred(&problem, &solution.duals, -target));
    let pushes = PUSHES.iter();
    let pushed = pushes.map(|&push| pushed(&problem, &solution.duals, push));
    let carried = targets.map(|target| carried_only(&problem, &solution.duals, -target));
    let centres = centres.into_iter().chain(carried).flatten();
    let candidates: Vec<_> = centres.chain(pushed).collect();
    [0.0, SLACK_MARGIN].into_iter().find_map(|margin| {
        let bare = program(asked, plant, Goal::Margin(margin)).problem.lower();
        let radii = candidates
            .iter()
            .map(|weights| exclude(&bare, weights).radius);
        let radius = radii.fold(0.0, f64::max);
        (radius > 0.0).then_some(Excluded {
            radius,
            margin,
            largest_returned,
        })
    })
}

/// The centred weights of the cones that carry the dual solution, zero for all others. A weight that must vanish,
/// such as that of a bound on the objective, has no middle and would spoil the others'.
fn carried_only(problem: &Semidefinite, duals: &[Vec<f64>], target: f64) -> Option<Vec<Vec<f64>>> {
    let trace = |(cone, dual): (&Cone, &Vec<f64>)| -> f64 {
        (0..cone.side).map(|k| dual[svec_index(k, k)]).sum()
    };
    let traces: Vec<f64> = problem.cones.iter().zip(duals).map(trace).collect();
    let least = NEGLIGIBLE * traces.iter().sum::<f64>();
    let carries = |index: &usize| traces[*index] > least;
    let kept: Vec<usize> = (0..traces.len()).filter(carries).collect();
    let part = Semidefinite {
        cones: kept
            .iter()
            .map(|&index| problem.cones[index].clone())
            .collect(),
        ..problem.clone()
    };
    let own: Vec<Vec<f64>> = kept.iter().map(|&index| duals[index].clone()).collect();
    let centred = centred(&part, &own, target)?;
    let mut out: Vec<Vec<f64>> = duals.iter().map(|dual| vec![0.0; dual.len()]).collect();
    for (index, weight) in kept.into_iter().zip(centred) {
        out[index] = weight;
    }
    Some(out)
}

/// The dual matrices with a share of the mean of their eigenvalues added to each.
fn pushed(problem: &Semidefinite, duals: &[Vec<f64>], share: f64) -> Vec<Vec<f64>> {
    let diagonal = |side: usize| (0..side).map(|k| svec_index(k, k));
    let sides: usize = problem.cones.iter().map(|cone| cone.side).sum();
    let cones = || problem.cones.iter().zip(duals);
    let traces = cones().flat_map(|(cone, dual)| diagonal(cone.side).map(|k| dual[k]));
    let push = share * traces.sum::<f64>() / sides as f64;
    let one = |(cone, dual): (&Cone, &Vec<f64>)| {
        let mut out = dual.clone();
        diagonal(cone.side).for_each(|k| out[k] += push);
        out
    };
    cones().map(one).collect()
}

/// Cones whose dual matrix has less than this part of all traces carry nothing.
const NEGLIGIBLE: f64 = 1e-5;

struct Run<'a> {
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
/// provenance). Where the given solver finds no feedback that is proved, the other one is asked. Only the check
/// decides whether the feedback is proved.
pub fn synthesize(
    problem: &Problem,
    text: &str,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<ProblemOutcome, SynthesisError> {
    let mut run = Run {
        problem,
        text,
        observer,
        runs: Vec::new(),
        largest_returned: 1.0,
        best_seen: None,
    };
    let other = alternative(backend);
    let solvers: Vec<&dyn Backend> = [backend].into_iter().chain(other.as_deref()).collect();
    with_problem!(&problem.task, asked => run.solve(asked, &solvers))
}

fn usable(solution: &Solution) -> bool {
    matches!(solution.status, Status::Solved | Status::Inaccurate)
}

/// What a solver came to without a proved feedback.
struct Attempt {
    unproved: Option<Box<ProblemSynthesized>>,
    refused: bool,
}

impl Run<'_> {
    fn solve<P: DesignProblem>(
        &mut self,
        asked: &P,
        solvers: &[&dyn Backend],
    ) -> Result<ProblemOutcome, SynthesisError> {
        let units = asked.units(&self.problem.plant);
        let mut unproved = None;
        let mut refused = false;
        for &backend in solvers {
            match self.attempt(asked, &units, backend)? {
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
        let failure = self.explain(asked, &units, solvers)?;
        let blocked = match failure.slack {
            Some(slack) => slack > SLACK_SHARE * SLACK_MARGIN,
            None => refused,
        };
        Ok(match failure.excluded {
            Some(excluded) if excluded.conclusive() => ProblemOutcome::Infeasible(failure),
            Some(_) => ProblemOutcome::Undecided(failure),
            None if blocked => ProblemOutcome::Undecided(failure),
            // The solvers contradict themselves, or never got anywhere.
            None => ProblemOutcome::SolverFailed(failure),
        })
    }

    /// A proved feedback by one solver, or what it came to.
    fn attempt<P: DesignProblem>(
        &mut self,
        asked: &P,
        units: &Units,
        backend: &dyn Backend,
    ) -> Result<Result<Box<ProblemSynthesized>, Attempt>, SynthesisError> {
        let scaled = asked.in_units(units);
        let given = &self.problem.plant;
        let plant = given.in_units(units);
        let (program, smallest) = self.run(&scaled, &plant, Goal::SmallestObjective, backend)?;
        let mut unproved = None;
        if usable(&smallest) && smallest.objective > 0.0 {
            let objective = smallest.objective;
            let best = recover(asked, given, units, &program.hatted, &smallest, objective);
            self.note::<P>(best.map(|best| best.guarantee));
            for room in ROOMS {
                let objective = smallest.objective * (1.0 + room);
                let goal = Goal::LargestMargin { objective };
                let (inside, solution) = self.run(&scaled, &plant, goal, backend)?;
                let found = recover(asked, given, units, &inside.hatted, &solution, objective);
                let Some(found) = found else { continue };
                let design = self.finish::<P>(&found)?;
                if design.report.verdict == Verdict::Proved {
                    return Ok(Ok(design));
                }
                unproved = Some(design);
            }
        }
        Ok(Err(Attempt {
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
        asked: &P,
        plant: &VertexPlant,
        goal: Goal,
        backend: &dyn Backend,
    ) -> Result<(Program, Solution), SynthesisError> {
        let program = program(asked, plant, goal);
        let sought = Sought {
            goal: goal.name(),
            vertices: plant.vertices.len(),
            accuracy: goal.accuracy(),
        };
        let observer = self.observer.as_ref();
        let (solution, run) = run_solver(backend, &program.problem, &sought, observer)?;
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

    /// The smallest slack, the conditions that hold it up, and what the solvers' dual weights exclude.
    fn explain<P: DesignProblem>(
        &mut self,
        asked: &P,
        units: &Units,
        solvers: &[&dyn Backend],
    ) -> Result<ProblemFailure, SynthesisError> {
        let scaled = asked.in_units(units);
        let plant = self.problem.plant.in_units(units);
        let mut found = Vec::new();
        for &backend in solvers {
            found.push(self.run(&scaled, &plant, Goal::SmallestSlack, backend)?);
        }
        let largest = self.largest_returned;
        let excluded = found
            .iter()
            .filter_map(|(program, solution)| excluded(&scaled, &plant, program, solution, largest))
            .max_by(|a, b| a.radius.total_cmp(&b.radius));
        let solved = found.iter().filter(|(_, solution)| usable(solution));
        let smallest = solved.min_by(|a, b| a.1.objective.total_cmp(&b.1.objective));
        let carrier = smallest.or(found.first());
        Ok(ProblemFailure {
            excluded,
            slack: smallest.map(|(_, solution)| solution.objective),
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
