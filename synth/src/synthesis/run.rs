//! Two solves and a check.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;
use std::time::Instant;

use nalgebra::DMatrix;
use sha2::{Digest, Sha256};
use time::format_description::well_known::Rfc3339;
use time::OffsetDateTime;

use super::active::{self, MANY_VERTICES};
use super::{assemble_at, Assembled, Form, Goal};
use crate::certify::{Report, Verdict};
use crate::conditions::{GainPlan, Task};
use crate::design::{
    recover, CertificateFile, DesignFile, ProblemUnits, Provenance, RecoverError, SolverRun,
    VerdictFile, DESIGN_SCHEMA_VERSION,
};
use crate::lmi::svec_index;
use crate::model::{Mismatch, Model, ModelError};
use crate::scaling::Scaling;
use crate::solve::{Backend, Observer, Solution, SolveError, Status};

/// The gain bound of the exported design, relative to the smallest one: the price of a margin.
const GAIN_ROOM: f64 = 1e-3;

/// State units tried one after the other, as fractions of the region's smallest extent, until a design is
/// proved. Where the certified set of a design that is not proved asks for another unit, that comes next:
/// the set may be much smaller than the region.
const STATE_UNITS: [f64; 7] = [0.5, 1.0, 0.25, 2.0, 0.0625, 0.015625, 0.00390625];

/// Range of the state units that a certified set may ask for.
const UNIT_RANGE: [f64; 2] = [1.0 / 4096.0, 4.0];

/// Weights rho of the containment condition tried when the model has must-contain states.
const CONTAINMENT_WEIGHTS: [f64; 4] = [0.5, 1.0, 0.25, 2.0];

/// The units tried first.
pub const FIRST_UNITS: ProblemUnits = ProblemUnits {
    state_fraction: STATE_UNITS[0],
    containment_weight: CONTAINMENT_WEIGHTS[0],
};

/// The model's task in the given units.
pub fn scaled_task(model: &Model, units: ProblemUnits) -> (Scaling, Task) {
    scaled(&model.task(), units)
}

fn scaled(task: &Task, units: ProblemUnits) -> (Scaling, Task) {
    let mut task = task.clone();
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
    /// A design that is not proved, and the state unit that its certified set asks for.
    Unproved(Box<Synthesized>, f64),
    Infeasible,
    Stuck,
}

struct Run<'a> {
    model: &'a Model,
    /// The task in SI units.
    task: Task,
    /// SHA-256 of the file that the gains come from.
    gains_sha256: Option<String>,
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
    let run = Run {
        model,
        task: model.task(),
        gains_sha256: None,
        model_text,
        form,
        backend,
        observer,
        runs: Vec::new(),
        chosen: Vec::new(),
    };
    run.search()
}

/// Finds the smallest gain bound that can be proved for given gains (m x n each), with anti-windup
/// gains where they saturate. One gain is constant; as many as the model has rules, under its mismatch
/// bound, are scheduled by its memberships; any other number may be weighted in any way at any time.
/// `gains_text` is the gains file's text, for the provenance.
pub fn analyse(
    model: &Model,
    model_text: &str,
    gains: &[DMatrix<f64>],
    gains_text: &str,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    let mut task = model.task();
    let mismatch = match model.file.mismatch {
        Mismatch::Kappa(kappa) if Some(gains.len()) == model.plant.membership_count() => {
            Some(kappa)
        }
        _ => None,
    };
    task.gains = GainPlan {
        count: gains.len(),
        mismatch,
        given: Some(gains.to_vec()),
    };
    let run = Run {
        model,
        task,
        gains_sha256: Some(hex(&Sha256::digest(gains_text.as_bytes()))),
        model_text,
        form: Form::Reduced,
        backend,
        observer,
        runs: Vec::new(),
        chosen: Vec::new(),
    };
    run.search()
}

/// What the attempts in all units came to.
#[derive(Default)]
struct Found {
    /// The best proved design.
    best: Option<Box<Synthesized>>,
    /// A design that is not proved.
    unproved: Option<Box<Synthesized>>,
    /// How often the solver called the problem infeasible.
    infeasible: u32,
}

impl Run<'_> {
    fn search(mut self) -> Result<Outcome, SynthesisError> {
        let weights: &[f64] = match self.model.file.specs.must_contain.is_empty() {
            true => &CONTAINMENT_WEIGHTS[..1],
            false => &CONTAINMENT_WEIGHTS,
        };
        let mut found = Found::default();
        for &containment_weight in weights {
            let first = self.unit_of_constant_gain(containment_weight)?;
            self.try_units(containment_weight, first, &mut found)?;
        }
        let seconds: f64 = self.runs.iter().map(|run| run.seconds).sum();
        if let Some(mut design) = found.best.or(found.unproved) {
            design.solve_seconds = seconds;
            design.file.provenance.solver_runs = self.runs;
            return Ok(Outcome::Solved(design));
        }
        let failure = self.explain()?;
        Ok(match failure.slack {
            Some(slack) if slack > 0.0 => Outcome::Infeasible(failure),
            None if found.infeasible > 0 => Outcome::Infeasible(failure),
            // The solver contradicts itself, or never got anywhere.
            _ => Outcome::SolverFailed(failure),
        })
    }

    /// For scheduled gains: the units in which a constant gain is proved, a smaller problem that says
    /// how large the certified set will be.
    fn unit_of_constant_gain(&mut self, weight: f64) -> Result<Option<f64>, SynthesisError> {
        if self.task.gains.count == 1 || self.task.gains.given.is_some() {
            return Ok(None);
        }
        let scheduled = std::mem::replace(&mut self.task.gains, GainPlan::constant());
        let mut found = Found::default();
        let outcome = self.try_units(weight, None, &mut found);
        self.task.gains = scheduled;
        outcome?;
        let proved = found.best.map(|design| design.file.provenance.problem);
        Ok(proved.map(|units| units.state_fraction))
    }

    /// Tries units one after the other until a design is proved.
    fn try_units(
        &mut self,
        containment_weight: f64,
        first: Option<f64>,
        found: &mut Found,
    ) -> Result<(), SynthesisError> {
        let mut tried: Vec<f64> = Vec::new();
        let mut next: Vec<f64> = STATE_UNITS.iter().rev().copied().chain(first).collect();
        while let Some(state_fraction) = next.pop() {
            if tried.iter().any(|&other| same_unit(other, state_fraction)) {
                continue;
            }
            tried.push(state_fraction);
            let units = ProblemUnits {
                state_fraction,
                containment_weight,
            };
            match self.attempt(units)? {
                Attempt::Designed(design) => {
                    found.best = Some(better(found.best.take(), design));
                    return Ok(());
                }
                Attempt::Unproved(design, wanted) => {
                    found.unproved = Some(design);
                    next.push(wanted);
                }
                Attempt::Infeasible => {
                    // A second opinion in other units, then no more.
                    found.infeasible += 1;
                    if found.infeasible > 1 {
                        return Ok(());
                    }
                }
                Attempt::Stuck => {}
            }
        }
        Ok(())
    }
}

/// True when two fractions round to the same power of two.
fn same_unit(a: f64, b: f64) -> bool {
    a.log2().round() == b.log2().round()
}

/// Largest distance from the origin to the edge of x'Ux <= 1; 1 where that has no meaning.
fn certified_radius(lyapunov: &DMatrix<f64>) -> f64 {
    let smallest = lyapunov.symmetric_eigenvalues().min();
    let radius = smallest.sqrt().recip();
    if radius.is_finite() && radius > 0.0 {
        radius
    } else {
        1.0
    }
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
        let (scaling, task) = scaled(&self.task, units);
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
                let radius = certified_radius(&certificate.lyapunov);
                let (controller, certificate) = CertificateFile::split(&certificate);
                let design = self.finish(controller, certificate, units)?;
                Ok(match design.report.verdict {
                    Verdict::Proved => Attempt::Designed(design),
                    Verdict::NotProved => {
                        let extent = scaling.state.min() / units.state_fraction;
                        Attempt::Unproved(
                            design,
                            (radius / extent).clamp(UNIT_RANGE[0], UNIT_RANGE[1]),
                        )
                    }
                })
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
        let few = all.len() <= MANY_VERTICES || task.gains.count > 1;
        if self.form == Form::Full || few {
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
            gains_sha256: self.gains_sha256.clone(),
            form: self.form.name().to_string(),
            problem,
            solver_runs: Vec::new(),
        }
    }

    /// The smallest slack and the conditions that hold it up.
    fn explain(&mut self) -> Result<Failure, SynthesisError> {
        let (_, task) = scaled(&self.task, FIRST_UNITS);
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
