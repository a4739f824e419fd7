//! Two solves and a check.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;
use std::time::Instant;

use sha2::{Digest, Sha256};
use time::format_description::well_known::Rfc3339;
use time::OffsetDateTime;

use super::active;
use super::{assemble_at, Assembled, Form, Goal};
use crate::certify::{Report, Verdict};
use crate::conditions::Task;
use crate::design::{
    recover, CertificateFile, DesignFile, ProblemUnits, Provenance, RecoverError, SolverRun,
    VerdictFile, DESIGN_SCHEMA_VERSION,
};
use crate::lmi::svec_index;
use crate::model::{Model, ModelError};
use crate::scaling::Scaling;
use crate::solve::{Backend, Observer, Solution, SolveError, Status};

/// The gain bound of the exported design, relative to the smallest one: the price of a margin.
const GAIN_ROOM: f64 = 1e-3;

/// State units tried one after the other, as fractions of the region's smallest extent.
const STATE_UNITS: [f64; 4] = [0.5, 1.0, 0.25, 2.0];

/// Weights rho of the containment condition tried when the model has must-contain states.
const CONTAINMENT_WEIGHTS: [f64; 4] = [0.5, 1.0, 0.25, 2.0];

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

/// Why there is no proved design.
#[derive(Debug, Clone)]
pub struct Failure {
    /// The smallest slack with which all conditions hold, in scaled units, where the solver found
    /// it; above 0 it says that the conditions cannot hold with their margin.
    pub slack: Option<f64>,
    /// The conditions with the largest share of the dual solution: those that block.
    pub blocking: Vec<(String, f64)>,
    /// Time spent in solvers (s).
    pub solve_seconds: f64,
    /// The solver's runs.
    pub runs: Vec<SolverRun>,
}

/// What synthesis found.
#[derive(Debug, Clone)]
pub enum Outcome {
    /// A design; its report says whether it is proved.
    Solved(Box<Synthesized>),
    /// The solver says that no design exists.
    Infeasible(Failure),
    /// The solver gave up on every attempt.
    SolverFailed(Failure),
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
    model: &'a Model,
    model_text: &'a str,
    form: Form,
    backend: &'a dyn Backend,
    observer: Option<Observer>,
    runs: Vec<SolverRun>,
    /// The vertices that mattered so far, where not all are used.
    chosen: Vec<usize>,
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
        model,
        model_text,
        form,
        backend,
        observer,
        runs: Vec::new(),
        chosen: Vec::new(),
    };
    let mut unproved: Option<Box<Synthesized>> = None;
    let mut infeasible = 0;
    let weights: &[f64] = match model.file.specs.must_contain.is_empty() {
        true => &CONTAINMENT_WEIGHTS[..1],
        false => &CONTAINMENT_WEIGHTS,
    };
    let mut best: Option<Box<Synthesized>> = None;
    for &containment_weight in weights {
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
    let seconds: f64 = run.runs.iter().map(|run| run.seconds).sum();
    if let Some(mut design) = best.or(unproved) {
        design.solve_seconds = seconds;
        design.file.provenance.solver_runs = run.runs;
        return Ok(Outcome::Solved(design));
    }
    let failure = run.explain()?;
    Ok(match failure.slack {
        Some(slack) if slack > 0.0 => Outcome::Infeasible(failure),
        None if infeasible > 0 => Outcome::Infeasible(failure),
        // The solver contradicts itself, or never got anywhere.
        _ => Outcome::SolverFailed(failure),
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
    fn attempt(&mut self, units: ProblemUnits) -> Result<Attempt, SynthesisError> {
        let (scaling, task) = scaled_task(self.model, units);
        let (_, smallest) = self.solve(&task, Goal::SmallestGain)?;
        match smallest.status {
            Status::Solved | Status::Inaccurate => {}
            Status::Infeasible => return Ok(Attempt::Infeasible),
            Status::Unbounded | Status::Failed | Status::Cancelled => return Ok(Attempt::Stuck),
        }
        let gain_bound = smallest.objective * (1.0 + GAIN_ROOM);
        if !(gain_bound.is_finite() && gain_bound > 0.0) {
            return Ok(Attempt::Stuck);
        }
        let (assembled, inside) = self.solve(&task, Goal::LargestMargin { gain_bound })?;
        let recovered = recover(self.model, &assembled.design, &inside.values, &scaling);
        match recovered {
            Ok(certificate) => {
                let (controller, certificate) = CertificateFile::split(&certificate);
                Ok(Attempt::Designed(self.finish(
                    controller,
                    certificate,
                    units,
                )?))
            }
            Err(RecoverError::Singular { .. } | RecoverError::NotFinite { .. }) => {
                Ok(Attempt::Stuck)
            }
        }
    }

    /// Solves with all vertices, or, where there are many, with those that matter: vertices that the
    /// solution violates are added until there are none, which makes the solution that of the whole.
    fn solve(&mut self, task: &Task, goal: Goal) -> Result<(Assembled, Solution), SynthesisError> {
        let all: Vec<usize> = (0..task.system.vertices.len()).collect();
        if self.form == Form::Full || all.len() <= self.backend.vertices_at_once() {
            return self.solve_at(task, goal, &all);
        }
        if self.chosen.is_empty() {
            self.chosen = active::first_choice(&task.system.vertices);
        }
        loop {
            let chosen = self.chosen.clone();
            let (assembled, solution) = self.solve_at(task, goal, &chosen)?;
            let usable = matches!(solution.status, Status::Solved | Status::Inaccurate);
            let violated = match usable {
                true => active::violated(task, goal, &assembled, &solution, &chosen),
                // A relaxation that cannot be solved settles the whole.
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
        let solution =
            self.backend
                .solve(&assembled.problem.lower(), goal.accuracy(task), observer)?;
        if cancelled.load(Ordering::Relaxed) {
            return Err(Cancelled.into());
        }
        self.runs.push(SolverRun {
            goal: goal.name().to_string(),
            vertices: chosen.len(),
            solver: self.backend.name(),
            status: solution.status_text.clone(),
            objective: finite_or_zero(solution.objective),
            iterations: solution.iterations,
            seconds: start.elapsed().as_secs_f64(),
        });
        Ok((assembled, solution))
    }

    /// Puts the file together and checks what a reader of its text would get.
    fn finish(
        &self,
        controller: crate::design::ControllerFile,
        certificate: CertificateFile,
        units: ProblemUnits,
    ) -> Result<Box<Synthesized>, SynthesisError> {
        let mut file = DesignFile {
            schema_version: DESIGN_SCHEMA_VERSION,
            name: self.model.file.name.clone(),
            model: self.model.file.clone(),
            controller,
            certificate,
            verdict: VerdictFile {
                verdict: Verdict::NotProved,
                conditions: Vec::new(),
                not_covered: Vec::new(),
            },
            provenance: self.provenance(units),
        };
        let report = file.verify(self.model)?;
        file.verdict = VerdictFile::new(&report);
        Ok(Box::new(Synthesized {
            file,
            report,
            solve_seconds: 0.0,
        }))
    }

    fn provenance(&self, problem: ProblemUnits) -> Provenance {
        let now = OffsetDateTime::now_utc().replace_nanosecond(0);
        let date = now.ok().and_then(|now| now.format(&Rfc3339).ok());
        Provenance {
            generator: concat!("steadfast ", env!("CARGO_PKG_VERSION")).to_string(),
            model_sha256: hex(&Sha256::digest(self.model_text.as_bytes())),
            date: date.unwrap_or_default(),
            form: self.form.name().to_string(),
            problem,
            solver_runs: Vec::new(),
        }
    }

    /// The smallest slack and the conditions that hold it up.
    fn explain(&mut self) -> Result<Failure, SynthesisError> {
        let (_, task) = scaled_task(self.model, FIRST_UNITS);
        let (assembled, solution) = self.solve(&task, Goal::SmallestSlack)?;
        let trusted = matches!(solution.status, Status::Solved | Status::Inaccurate);
        Ok(Failure {
            slack: trusted.then_some(solution.objective),
            blocking: blocking(&assembled, &solution),
            solve_seconds: self.runs.iter().map(|run| run.seconds).sum(),
            runs: self.runs.clone(),
        })
    }
}

/// Conditions by their share of the dual solution's trace, largest first, those below 1 % left out.
/// The cliques of a reduced condition (18) count together, at all its vertices.
fn blocking(assembled: &Assembled, solution: &Solution) -> Vec<(String, f64)> {
    let mut traces = BTreeMap::<String, f64>::new();
    for (condition, dual) in assembled.problem.conditions.iter().zip(&solution.duals) {
        let diagonal = (0..condition.side()).map(|k| dual[svec_index(k, k)]);
        let trace: f64 = diagonal.sum();
        let whole = match condition.name().split_once(" clique ") {
            Some((whole, _)) => format!("{whole} all vertices"),
            None => condition.name().to_string(),
        };
        if trace.is_finite() {
            *traces.entry(whole).or_default() += trace;
        }
    }
    let mut shares: Vec<(String, f64)> = traces.into_iter().collect();
    let total: f64 = shares.iter().map(|(_, trace)| trace).sum();
    shares
        .iter_mut()
        .for_each(|(_, trace)| *trace /= total.max(f64::MIN_POSITIVE));
    shares.retain(|(_, share)| *share >= 0.01);
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    shares
}

fn finite_or_zero(value: f64) -> f64 {
    if value.is_finite() {
        value
    } else {
        0.0
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
