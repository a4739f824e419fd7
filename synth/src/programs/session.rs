//! Runs of a solver for one model, with their records.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;
use std::time::Instant;

use nalgebra::DMatrix;

use super::active;
use super::assemble::{assemble_at, Assembled, Form, Goal};
use super::outcome::{Cancelled, SynthesisError};
use super::record::{blocking, Blocking};
use super::solvers::{Asked, Solvers};
use super::trigger_weight::with_weight;
use crate::certify::theorem1::Certificate;
use crate::conditions::Task;
use crate::design::{recover, SolverRun};
use crate::model::Model;
use crate::scaling::Scaling;
use sdp::lmi::LmiProblem;
use sdp::solve::{Accuracy, Backend, Observer, Solution, Status};

/// A solver with the form of its problems, and its runs so far.
pub(crate) struct Session<'a> {
    /// How its problems are stated.
    pub form: Form,
    backend: &'a (dyn Backend + Send + Sync),
    /// The solvers that may be asked, this one first.
    solvers: Vec<Asked<'a>>,
    observer: Option<Observer>,
    /// The solver's runs.
    pub runs: Vec<SolverRun>,
    /// The vertices that mattered so far, where not all are used.
    chosen: Vec<usize>,
}

/// A program in units of its own, with its solution.
pub(crate) struct Solved {
    /// The units.
    pub scaling: Scaling,
    /// The task in these units.
    pub task: Task,
    /// The program.
    pub assembled: Assembled,
    /// What the solver returned.
    pub solution: Solution,
}

impl Solved {
    /// The solver's point as numbers of a certificate, in SI units.
    pub fn recover(&self, model: &Model) -> Option<Certificate> {
        let values = &self.solution.values;
        let unknowns = with_weight(&self.task, &self.assembled.design, values)?;
        recover(model, &unknowns, values, (&self.scaling, &self.task))
    }

    /// Uh^-1 Qh of the solver's point, in SI units: about it the containment condition is exact there.
    pub fn linearisation(&self) -> Option<DMatrix<f64>> {
        let (design, values) = (&self.assembled.design, &self.solution.values);
        let inverse = design.lyapunov.value(values).try_inverse()?;
        let point = inverse * design.multiplier.value(values);
        let units = DMatrix::from_diagonal(&self.scaling.state);
        let point = self.scaling.to_state() * point * units;
        point.iter().all(|entry| entry.is_finite()).then_some(point)
    }

    /// The conditions that carry the dual solution.
    pub fn blocking(&self) -> Vec<Blocking> {
        blocking(&self.assembled.problem.conditions, &self.solution)
    }
}

/// True when a solver returned a point.
pub(crate) fn has_point(solution: &Solution) -> bool {
    matches!(solution.status, Status::Solved | Status::Inaccurate)
}

/// The largest magnitude of numbers that a solver returned; infinite where one is not a number.
pub(crate) fn largest_magnitude<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    let magnitudes = values.into_iter().map(|value| match value.is_nan() {
        true => f64::INFINITY,
        false => value.abs(),
    });
    magnitudes.fold(0.0, f64::max)
}

impl<'a> Session<'a> {
    /// A session with the first of the solvers.
    pub fn new(solvers: &'a Solvers, observer: Option<Observer>) -> Self {
        Session {
            solvers: solvers.in_order(),
            ..Session::alone(solvers.first(), observer)
        }
    }

    /// A session with one solver.
    pub fn alone(asked: Asked<'a>, observer: Option<Observer>) -> Self {
        let (backend, form) = asked;
        Session {
            form,
            backend,
            solvers: vec![asked],
            observer,
            runs: Vec::new(),
            chosen: Vec::new(),
        }
    }

    /// A session with the same solver alone that has not begun.
    pub fn fresh(&self, form: Form) -> Self {
        Session::alone((self.backend, form), self.observer.clone())
    }

    /// Sessions with each of these solvers alone, which have not begun.
    pub fn each_alone(
        asked: impl IntoIterator<Item = Asked<'a>>,
        observer: Option<&Observer>,
    ) -> Vec<Self> {
        let alone = |asked| Session::alone(asked, observer.cloned());
        asked.into_iter().map(alone).collect()
    }

    /// Reported to after every iteration; may stop the solver.
    pub fn observer(&self) -> Option<&Observer> {
        self.observer.as_ref()
    }

    /// The solvers that may be asked, in order.
    pub fn solvers(&self) -> &[Asked<'a>] {
        &self.solvers
    }

    /// What `run` returns with the second solver; `None` without one.
    pub fn with_other<T>(
        &mut self,
        run: impl FnOnce(&mut Session) -> Result<T, SynthesisError>,
    ) -> Result<Option<T>, SynthesisError> {
        let Some(&second) = self.solvers.get(1) else {
            return Ok(None);
        };
        let mut session = Session::alone(second, self.observer.clone());
        let found = run(&mut session);
        self.runs.append(&mut session.runs);
        found.map(Some)
    }

    /// Lowers and solves a problem; a run that the observer stopped is an error. The number of vertices is for the
    /// record.
    pub fn run(
        &mut self,
        problem: &LmiProblem,
        goal: &str,
        accuracy: Accuracy,
        vertices: usize,
    ) -> Result<Solution, SynthesisError> {
        let cancelled = Arc::new(AtomicBool::new(false));
        let observer = self.observer.clone().map(|observer| -> Observer {
            let cancelled = Arc::clone(&cancelled);
            Arc::new(move |progress| {
                let go_on = observer(progress);
                if !go_on {
                    cancelled.store(true, Ordering::Relaxed);
                }
                go_on
            })
        });
        let start = Instant::now();
        let solution = self.backend.solve(&problem.lower(), accuracy, observer)?;
        if cancelled.load(Ordering::Relaxed) {
            return Err(Cancelled.into());
        }
        let objective = solution.objective;
        self.runs.push(SolverRun {
            goal: goal.to_string(),
            vertices,
            solver: self.backend.name(),
            status: solution.status_text.clone(),
            objective: if objective.is_finite() {
                objective
            } else {
                0.0
            },
            iterations: solution.iterations,
            seconds: start.elapsed().as_secs_f64(),
            state_units: Vec::new(),
            margin: None,
        });
        Ok(solution)
    }

    /// Solves with all vertices, or, where there are many, with those that matter: vertices that the
    /// solution violates are added until there are none, so that it solves the whole problem.
    pub fn solve(
        &mut self,
        (scaling, task): (Scaling, Task),
        goal: Goal,
    ) -> Result<Solved, SynthesisError> {
        let before = self.runs.len();
        let (assembled, solution) = self.solve_task(&task, goal)?;
        for run in self.runs.iter_mut().skip(before) {
            run.state_units = scaling.state.iter().copied().collect();
            let margin = goal.margin(task.specification.margin, run.objective);
            run.margin = Some(margin).filter(|margin| margin.is_finite());
        }
        Ok(Solved {
            scaling,
            task,
            assembled,
            solution,
        })
    }

    fn solve_task(
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
            let violated = match has_point(&solution) {
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
        let accuracy = accuracy(task, goal);
        let solution = self.run(&assembled.problem, goal.name(), accuracy, chosen.len())?;
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
