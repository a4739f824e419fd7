//! Two solves and a check.

use super::search::Search;
use super::subject::Subject;
use super::{Form, Goal};
use crate::certify::{Report, Verdict};
use crate::conditions::Task;
use crate::design::{recover, DesignFile, ProblemUnits, RecoverError};
use crate::feasibility::{self, Answer, Decision};
use crate::model::{Model, ModelError};
use crate::scaling::Scaling;
use crate::solve::{Backend, Observer, SolveError, Status};

/// The gain bound of the exported design, relative to the smallest one: the price of a margin.
const GAIN_ROOM: f64 = 1e-3;

/// State units tried one after the other, as fractions of the region's smallest extent.
pub(crate) const STATE_UNITS: [f64; 4] = [0.5, 1.0, 0.25, 2.0];

/// Weights rho of the containment condition tried when the model has must-contain states.
pub(crate) const CONTAINMENT_WEIGHTS: [f64; 4] = [0.5, 1.0, 0.25, 2.0];

/// The units tried first.
pub const FIRST_UNITS: ProblemUnits = ProblemUnits {
    state_fraction: STATE_UNITS[0],
    containment_weight: CONTAINMENT_WEIGHTS[0],
};

/// The model's task in the given units.
pub fn scaled_task(model: &Model, units: ProblemUnits) -> (Scaling, Task) {
    let mut task = model.task();
    task.specification.containment_weight = units.containment_weight;
    let scaling = Scaling::automatic(&task.system, units.state_fraction);
    let scaled = scaling.apply(&task);
    (scaling, scaled)
}

/// A design and how it was found.
#[derive(Debug, Clone)]
pub struct Synthesized {
    /// The file, with its verdict.
    pub file: DesignFile,
    /// The check of the file's numbers.
    pub report: Report,
    /// Time spent in solvers (s).
    pub solve_seconds: f64,
}

/// What synthesis found.
#[derive(Debug, Clone)]
pub enum Outcome {
    /// A design; its report says whether it is proved.
    Solved(Box<Synthesized>),
    /// No design exists: proved where the decision says so, the solver's opinion otherwise.
    Infeasible(Decision),
    /// The solver gave up on every attempt.
    SolverFailed(Decision),
}

/// The observer asked to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// Why synthesis could not run at all.
#[derive(Debug, thiserror::Error)]
pub enum SynthesisError {
    /// Stopped by the observer.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The solver refused the problem.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The recovered numbers are not a valid design file.
    #[error("the recovered design is not valid: {0}")]
    Invalid(#[from] ModelError),
}

/// One attempt's end.
enum Attempt {
    Designed(Box<Synthesized>),
    Infeasible,
    Stuck,
}

struct Run<'a> {
    subject: Subject<'a>,
    search: Search<'a>,
}

/// The weights rho of the containment condition to be tried for a model.
pub(crate) fn containment_weights(model: &Model) -> &'static [f64] {
    match model.file.specs.must_contain.is_empty() {
        true => &CONTAINMENT_WEIGHTS[..1],
        false => &CONTAINMENT_WEIGHTS,
    }
}

/// Synthesizes a design for a model and checks it. `model_text` is the file's text (its hash goes
/// into the provenance). Only the check decides whether the design is proved.
pub fn synthesize(
    model: &Model,
    model_text: &str,
    form: Form,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    let mut run = Run {
        subject: Subject {
            model,
            model_text,
            form,
        },
        search: Search::new(form, backend, observer),
    };
    let mut unproved: Option<Box<Synthesized>> = None;
    let mut infeasible = 0;
    let mut best: Option<Box<Synthesized>> = None;
    for &containment_weight in containment_weights(model) {
        for state_fraction in STATE_UNITS {
            let units = ProblemUnits {
                state_fraction,
                containment_weight,
            };
            match run.attempt(units)? {
                Attempt::Designed(design) if design.report.verdict == Verdict::Proved => {
                    best = Some(better(best, design));
                    break;
                }
                Attempt::Designed(design) => unproved = Some(design),
                Attempt::Infeasible => {
                    // A second opinion in other units, then no more.
                    infeasible += 1;
                    if infeasible > 1 {
                        break;
                    }
                }
                Attempt::Stuck => {}
            }
        }
    }
    if let Some(design) = best.or(unproved) {
        return Ok(Outcome::Solved(run.closed(design)));
    }
    let decision = feasibility::decide_after(run.subject, &mut run.search)?;
    let slack = decision.slack;
    Ok(match decision.answer {
        Answer::Infeasible(_) => Outcome::Infeasible(decision),
        // The point is a design too, if not one with a small gain.
        Answer::Feasible(design) => Outcome::Solved(run.closed(design)),
        Answer::Unknown if slack.map_or(infeasible > 0, |slack| slack > 0.0) => {
            Outcome::Infeasible(decision)
        }
        // The solver contradicts itself, or never got anywhere.
        Answer::Unknown => Outcome::SolverFailed(decision),
    })
}

fn better(best: Option<Box<Synthesized>>, other: Box<Synthesized>) -> Box<Synthesized> {
    let gamma = |design: &Synthesized| design.file.certificate.gamma;
    match best {
        Some(best) if gamma(&best) <= gamma(&other) => best,
        _ => other,
    }
}

impl Run<'_> {
    /// A design with the record of all runs so far.
    fn closed(&self, mut design: Box<Synthesized>) -> Box<Synthesized> {
        design.solve_seconds = self.search.seconds();
        design.file.provenance.solver_runs = self.search.runs.clone();
        design
    }

    fn attempt(&mut self, units: ProblemUnits) -> Result<Attempt, SynthesisError> {
        let model = self.subject.model;
        let (scaling, task) = scaled_task(model, units);
        let (_, smallest) = self.search.solve(&task, Goal::SmallestGain)?;
        match smallest.status {
            Status::Solved | Status::Inaccurate => {}
            Status::Infeasible => return Ok(Attempt::Infeasible),
            Status::Unbounded | Status::Failed | Status::Cancelled => return Ok(Attempt::Stuck),
        }
        let gain_bound = smallest.objective * (1.0 + GAIN_ROOM);
        if !(gain_bound.is_finite() && gain_bound > 0.0) {
            return Ok(Attempt::Stuck);
        }
        let (assembled, inside) = self
            .search
            .solve(&task, Goal::LargestMargin { gain_bound })?;
        match recover(model, &assembled.design, &inside.values, &scaling) {
            Ok(certificate) => {
                let design = self.subject.design(&certificate, units)?;
                Ok(Attempt::Designed(design))
            }
            Err(RecoverError::Singular { .. } | RecoverError::NotFinite { .. }) => {
                Ok(Attempt::Stuck)
            }
        }
    }
}
