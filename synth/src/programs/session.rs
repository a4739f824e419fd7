//! Runs of a solver for one model.

use super::active;
use super::assemble::{assemble_at, Assembled, Form, Goal};
use super::outcome::SynthesisError;
use super::solver::{run_solver, SolveRequest};
use crate::conditions::Task;
use crate::design::SolverRun;
use sdp::solve::{alternative, Accuracy, Backend, Observer, Solution, Status};

/// A solver with the form of its problems, and its runs so far.
pub(crate) struct Session<'a> {
    form: Form,
    backend: &'a dyn Backend,
    observer: Option<Observer>,
    /// The solver's runs.
    pub runs: Vec<SolverRun>,
    /// The vertices that mattered so far, where not all are used.
    chosen: Vec<usize>,
}

impl<'a> Session<'a> {
    pub fn new(form: Form, backend: &'a dyn Backend, observer: Option<Observer>) -> Self {
        Session {
            form,
            backend,
            observer,
            runs: Vec::new(),
            chosen: Vec::new(),
        }
    }

    /// A search with the same solver that has not begun.
    pub fn fresh(&self, form: Form) -> Self {
        Session::new(form, self.backend, self.observer.clone())
    }

    /// The same with another solver.
    pub fn with_backend<'b>(&self, form: Form, backend: &'b dyn Backend) -> Session<'b> {
        Session::new(form, backend, self.observer.clone())
    }

    /// The other solver.
    pub fn alternative(&self) -> Option<Box<dyn Backend>> {
        alternative(self.backend)
    }

    /// Time spent in solvers (s).
    pub fn seconds(&self) -> f64 {
        self.runs.iter().map(|run| run.seconds).sum()
    }

    /// Solves with all vertices, or, where there are many, with those that matter: vertices that the
    /// solution violates are added until there are none, so that it solves the whole problem.
    pub fn solve(
        &mut self,
        task: &Task,
        goal: Goal,
    ) -> Result<(Assembled, Solution), SynthesisError> {
        let all: Vec<usize> = (0..task.system.vertices.len()).collect();
        let few = all.len() <= self.backend.vertices_at_once() || task.gains.count > 1;
        if self.form == Form::Full || few {
            return self.solve_at(task, goal, &all);
        }
        if self.chosen.is_empty() {
            self.chosen = active::first_choice(&task.system);
        }
        loop {
            let chosen = self.chosen.clone();
            let (assembled, solution) = self.solve_at(task, goal, &chosen)?;
            let usable = matches!(solution.status, Status::Solved | Status::Inaccurate);
            let violated = match usable {
                true => active::violated(task, goal, &assembled, &solution, &chosen),
                // A relaxation that cannot be solved decides the whole problem.
                false => Vec::new(),
            };
            if violated.is_empty() {
                return Ok((assembled, solution));
            }
            self.chosen.extend(violated);
        }
    }

    fn solve_at(
        &mut self,
        task: &Task,
        goal: Goal,
        chosen: &[usize],
    ) -> Result<(Assembled, Solution), SynthesisError> {
        let assembled = assemble_at(task, self.form, goal, chosen);
        let request = SolveRequest {
            goal: goal.name(),
            vertices: chosen.len(),
            accuracy: accuracy(task, goal),
        };
        let observer = self.observer.as_ref();
        let (solution, run) = run_solver(self.backend, &assembled.problem, &request, observer)?;
        self.runs.push(run);
        Ok((assembled, solution))
    }
}

/// Relative gap that is enough for the smallest gain where vertices are chosen for an uncertain inertia: a
/// hundredth of the design's back-off above it. Closing the gap further doubles the time of each round.
const GAP_OF_SET: f64 = 1e-5;

fn accuracy(task: &Task, goal: Goal) -> Accuracy {
    let mut accuracy = goal.accuracy(task);
    if !task.system.descriptors.is_empty() {
        accuracy.relative_gap = accuracy.relative_gap.max(GAP_OF_SET);
    }
    accuracy
}
