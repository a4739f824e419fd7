//! A primal-dual interior-point method on the inequality form, for few unknowns and many small cones.
//!
//! It solves `min c'y  s.t.  S = F0 + sum_i y_i F_i >= 0` together with its dual,
//! `max -<F0, Z>  s.t.  <F_i, Z> = c_i, Z >= 0`, block by block. Each iteration solves one linear system whose
//! size is the number of unknowns, whatever the number of cones; see the modules for the sources.

mod block;
mod dense;
mod exit;
mod interior_point;
mod iterate;
mod kronecker;
mod layout;
mod ray;
mod schur;
mod start;
mod system;
mod threads;
mod warm;

use std::time::Instant;

use crate::backend::{
    check_finite, Accuracy, Backend, Observer, Progress, Solution, SolveError, Solver, Status,
};
use crate::lmi::{inner_product, svec_index, Semidefinite};
use crate::memory;
use exit::{Measures, SolveTask, SolverExit, Termination};
use interior_point::ITERATIONS;
use layout::{zero_duals, Layout};
use start::{cold_start, feasible_start};
use threads::Running;
use warm::{Iterates, Memory};

pub use exit::Timings;

const NAME: &str = "structured";

/// Most unknowns: the system is a dense matrix of this side.
const LARGEST_SYSTEM: usize = 20_000;

/// Most entries of all blocks together.
const LARGEST_BLOCKS: usize = 100_000_000;

/// How much larger the second cold start is.
const LARGER_START: f64 = 100.0;

/// Iterations after which a warm start has not helped.
const WARM_ITERATIONS: u32 = 16;

/// The structured solver.
#[derive(Debug, Clone)]
pub struct Structured {
    /// Threads that may be used while no other solve is in progress; the result does not depend on their number.
    pub threads: usize,
    memory: Option<Memory>,
    /// Whether the memory is not updated.
    frozen: bool,
}

impl Default for Structured {
    fn default() -> Self {
        let available = std::thread::available_parallelism().map_or(1, |count| count.get());
        Structured {
            threads: available.min(2),
            memory: None,
            frozen: false,
        }
    }
}

impl Structured {
    /// A solver that remembers the iterates of the last solves and starts from them when the next problem has the same
    /// shape and is near enough: for sweeps and bisections. Where that does not help it starts afresh. The last
    /// digits of a result then depend on what was solved before.
    pub fn warm() -> Self {
        Structured {
            memory: Some(Memory::default()),
            ..Structured::default()
        }
    }

    /// The same solver, which remembers nothing more: its results do not depend on what it solved before. Where
    /// [`warm`](Structured::warm) solvers share their memory, this one has its own.
    pub fn frozen(&self) -> Self {
        Structured {
            memory: self.memory.as_ref().map(Memory::copied),
            frozen: true,
            ..self.clone()
        }
    }

    /// As [`Backend::solve`], with timings.
    pub fn solve_timed(
        &self,
        problem: &Semidefinite,
        accuracy: Accuracy,
        observer: Option<Observer>,
    ) -> Result<(Solution, Timings), SolveError> {
        let begin = Instant::now();
        let _running = Running::enter();
        check_finite(NAME, problem)?;
        check_size(problem)?;
        memory::check(NAME, memory_needed(problem), problem.widest())?;
        let layout = Layout::new(problem);
        if let Some((cone, direction)) = &layout.contradiction {
            let found = contradicted(problem, *cone, direction, begin);
            return Ok((found, Timings::default()));
        }
        let unit = layout.objective_unit;
        let watch = |iteration: u32, measures: &Measures| match &observer {
            None => true,
            Some(observer) => observer(&Progress {
                iteration,
                objective: measures.objective * unit + problem.offset,
                relative_gap: measures.relative_gap,
            }),
        };
        let task = SolveTask {
            layout: &layout,
            problem,
            relative_gap: accuracy.relative_gap,
            objective_unit: accuracy.objective_unit / unit,
            iterations: ITERATIONS,
            cautious: problem.cones.len() > MANY_CONES,
            threads: self.threads,
            observer: &watch,
        };
        let mut outcome = self.warm_or_cold(&task);
        if layout.unbounded_unknown && outcome.termination.is_solved() {
            outcome.termination = Termination::Unbounded;
        }
        let timings = outcome.timings;
        Ok((solution(problem, &layout, outcome, begin), timings))
    }

    fn warm_or_cold(&self, task: &SolveTask<'_>) -> SolverExit {
        let Some(memory) = &self.memory else {
            return cold(task, None);
        };
        let shape = warm::shape(task.problem);
        let keep = |outcome: &SolverExit, iterates: Option<Iterates>| {
            if let Some(iterates) = iterates.filter(|_| outcome.termination.is_solved()) {
                memory.keep(shape, iterates);
            }
        };
        let known = memory
            .recall(shape)
            .and_then(|iterates| iterates.start(task.layout));
        let mut spent = 0;
        if let Some((start, before)) = known {
            let short = SolveTask {
                iterations: WARM_ITERATIONS,
                ..*task
            };
            let mut iterates = (!self.frozen).then_some(before);
            let outcome = interior_point::solve(&short, start, iterates.as_mut());
            match outcome.termination {
                Termination::Unbounded | Termination::Stalled(_) => spent = outcome.iterations,
                _ => {
                    keep(&outcome, iterates);
                    return outcome;
                }
            }
        }
        let mut iterates = (!self.frozen).then(Iterates::default);
        let mut outcome = cold(task, iterates.as_mut());
        outcome.iterations += spent;
        keep(&outcome, iterates);
        outcome
    }
}

/// With more cones than these the bold directions run to the boundary before they are feasible.
const MANY_CONES: usize = 128;

/// From a cold start. When that stalls, from a larger one, or, where nothing feasible was found, cautiously, then from
/// the solution for the smallest shift.
fn cold(task: &SolveTask<'_>, mut iterates: Option<&mut Iterates>) -> SolverExit {
    let start = cold_start(task.layout, 1.0);
    let outcome = interior_point::solve(task, start, iterates.as_deref_mut());
    if !outcome.termination.is_stalled() {
        return outcome;
    }
    if !outcome.feasible && !task.cautious {
        let start = cold_start(task.layout, 1.0);
        let cautious = SolveTask {
            cautious: true,
            ..*task
        };
        let mut second = interior_point::solve(&cautious, start, iterates.as_deref_mut());
        second.iterations += outcome.iterations;
        if !second.termination.is_stalled() {
            return second;
        }
    }
    if !outcome.feasible {
        let shifted = by_smallest_shift(task, &outcome, iterates.as_deref_mut());
        if let Some(answer) = shifted.filter(|answer| !answer.termination.is_stalled()) {
            return answer;
        }
    }
    let start = cold_start(task.layout, LARGER_START);
    let mut second = interior_point::solve(task, start, iterates);
    second.iterations += outcome.iterations;
    let best = match second.termination.is_stalled() && outcome.feasible {
        true => outcome,
        false => second,
    };
    best.or_reduced(task.relative_gap)
}

impl Backend for Structured {
    fn name(&self) -> String {
        format!("{NAME} {}", env!("CARGO_PKG_VERSION"))
    }

    fn solver(&self) -> Option<Solver> {
        Some(Solver::Structured)
    }

    fn solve(
        &self,
        problem: &Semidefinite,
        accuracy: Accuracy,
        observer: Option<Observer>,
    ) -> Result<Solution, SolveError> {
        let timed = self.solve_timed(problem, accuracy, observer);
        timed.map(|(solution, _)| solution)
    }
}

fn check_size(problem: &Semidefinite) -> Result<(), SolveError> {
    let unknowns = problem.cost.len();
    let sides = problem.cones.iter().map(|cone| cone.side);
    let entries = sides.map(|side| side.saturating_mul(side));
    let entries = entries.fold(0_usize, usize::saturating_add);
    let reason = if unknowns > LARGEST_SYSTEM {
        format!("{unknowns} unknowns, at most {LARGEST_SYSTEM} fit")
    } else if entries > LARGEST_BLOCKS {
        format!("its cones have {entries} entries, at most {LARGEST_BLOCKS} fit")
    } else {
        return Ok(());
    };
    Err(SolveError::Refused {
        backend: NAME,
        reason,
    })
}

/// Estimate of the memory that a solve takes [bytes]: the system of equations and its factor, about thirty matrices of
/// each cone's side, and the entries.
fn memory_needed(problem: &Semidefinite) -> u64 {
    let square = |side: usize| (side as u64).saturating_mul(side as u64);
    let cones = problem.cones.iter().map(|cone| square(cone.side));
    let cones = cones.fold(0, u64::saturating_add).saturating_mul(240);
    cones.saturating_add(square(problem.cost.len()).saturating_mul(24))
}

/// Solves for the smallest t with `S + t I >= 0`, which always has an interior. Its multipliers prove infeasibility, or
/// its unknowns are a feasible start.
fn by_smallest_shift(
    task: &SolveTask<'_>,
    stalled: &SolverExit,
    iterates: Option<&mut Iterates>,
) -> Option<SolverExit> {
    let layout = task.layout;
    let shifted = layout.smallest_shift();
    let found = interior_point::solve(
        &SolveTask {
            layout: &shifted,
            relative_gap: 1e-4,
            objective_unit: 1e-6,
            ..*task
        },
        cold_start(&shifted, 1.0),
        None,
    );
    let iterations = stalled.iterations + found.iterations;
    let mut outcome = SolverExit {
        iterations,
        ..stalled.clone()
    };
    if found.termination == Termination::Cancelled {
        outcome.termination = Termination::Cancelled;
        return Some(outcome);
    }
    if let Some(ray) = ray::accepted(layout, &found.point.z[..layout.length]) {
        outcome.termination = Termination::Infeasible;
        outcome.point.z = ray;
        return Some(outcome);
    }
    let start = feasible_start(layout, &found.point.y[..layout.cost.len()])?;
    let mut outcome = interior_point::solve(task, start, iterates);
    outcome.iterations += iterations;
    Some(outcome)
}

/// A condition without unknowns that does not hold: the eigenvector makes the ray.
fn contradicted(
    problem: &Semidefinite,
    cone: usize,
    direction: &[f64],
    begin: Instant,
) -> Solution {
    let mut duals = zero_duals(problem);
    for column in 0..direction.len() {
        for row in 0..=column {
            duals[cone][svec_index(row, column)] = direction[row] * direction[column];
        }
    }
    let strength = -inner_product(&problem.cones[cone].constant, &duals[cone]);
    duals[cone].iter_mut().for_each(|entry| *entry /= strength);
    Solution {
        status: Status::Infeasible,
        status_text: "Infeasible".to_string(),
        values: vec![0.0; problem.cost.len()],
        duals,
        objective: f64::NAN,
        iterations: 0,
        seconds: begin.elapsed().as_secs_f64(),
    }
}

fn solution(
    problem: &Semidefinite,
    layout: &Layout,
    outcome: SolverExit,
    begin: Instant,
) -> Solution {
    let (status, text) = match outcome.termination {
        Termination::Solved => (Status::Solved, "Solved".to_string()),
        Termination::Reduced(why) => (Status::Inaccurate, format!("ReducedAccuracy: {why}")),
        Termination::Infeasible => (Status::Infeasible, "Infeasible".to_string()),
        Termination::Unbounded => (Status::Unbounded, "Unbounded".to_string()),
        Termination::Stalled(why) => (Status::Failed, format!("Stalled: {why}")),
        Termination::Cancelled => (Status::Cancelled, "Cancelled".to_string()),
    };
    let objective = match status {
        Status::Infeasible | Status::Unbounded => f64::NAN,
        _ => outcome.measures.objective * layout.objective_unit + problem.offset,
    };
    let mut duals = layout.duals(&outcome.point.z, problem);
    if status == Status::Infeasible {
        // The ray's strength in the problem's own units is one.
        let strength = layout.objective_unit;
        let scale = |entry: &mut f64| *entry /= strength;
        duals.iter_mut().flatten().for_each(scale);
    }
    Solution {
        status,
        status_text: text,
        values: layout.values(&outcome.point.y, problem.cost.len()),
        duals,
        objective,
        iterations: outcome.iterations,
        seconds: begin.elapsed().as_secs_f64(),
    }
}
