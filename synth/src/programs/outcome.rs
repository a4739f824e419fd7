//! The outcomes of synthesis and of the feasibility check.

use nalgebra::DMatrix;
use serde::Serialize;

use super::record::Blocking;
use crate::certify::infeasible::Limit;
use crate::certify::{Report, Verdict};
use crate::design::{DesignFile, SolverRun};
use crate::infeasibility::InfeasibilityFile;
use crate::model::ModelError;
use crate::optimality::Optimality;
use sdp::solve::SolveError;

/// A file that synthesis makes, with the record of the solver's runs.
pub trait Recorded {
    /// The solver's runs, in order.
    fn solver_runs(&mut self) -> &mut Vec<SolverRun>;
}

impl Recorded for DesignFile {
    fn solver_runs(&mut self) -> &mut Vec<SolverRun> {
        &mut self.provenance.solver_runs
    }
}

/// A design and how it was found.
#[derive(Debug, Clone)]
pub struct Synthesized<File = DesignFile> {
    /// The file, with its verdict.
    pub file: File,
    /// The check of the file's numbers.
    pub report: Report,
    /// Time spent in solvers (s).
    pub solve_seconds: f64,
    /// The objective with the best one that a solver reported, which is not proved.
    pub optimality: Option<Optimality>,
}

impl<File> Synthesized<File> {
    /// True when the check proved the file's numbers.
    pub(crate) fn is_proved(&self) -> bool {
        self.report.verdict == Verdict::Proved
    }
}

impl<File: Recorded> Synthesized<File> {
    /// The design with the record of these runs.
    pub(crate) fn with_runs(mut self: Box<Self>, runs: &[SolverRun]) -> Box<Self> {
        self.solve_seconds = seconds(runs);
        *self.file.solver_runs() = runs.to_vec();
        self
    }
}

/// Time spent in solvers (s).
fn seconds(runs: &[SolverRun]) -> f64 {
    runs.iter().map(|run| run.seconds).sum()
}

/// The outcome of a synthesis.
#[derive(Debug, Clone)]
pub enum Outcome<File = DesignFile, Unsolved = Decision> {
    /// A design; its report says whether it is proved.
    Solved(Box<Synthesized<File>>),
    /// No design exists: proved.
    Infeasible(Unsolved),
    /// Neither a design nor its impossibility is proved.
    Undecided(Unsolved),
    /// The solvers gave up on every attempt.
    SolverFailed(Unsolved),
}

/// Stopped by the observer.
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

impl Outcome {
    /// True for a proved design and for a proof that there is none.
    pub fn is_proved(&self) -> bool {
        self.rank() >= 3
    }

    /// Higher where more is proved.
    pub(crate) fn rank(&self) -> u8 {
        match self {
            Outcome::Solved(design) if design.is_proved() => 4,
            Outcome::Infeasible(_) => 3,
            Outcome::Undecided(_) => 2,
            Outcome::Solved(_) => 1,
            Outcome::SolverFailed(_) => 0,
        }
    }

    fn runs(&self) -> &[SolverRun] {
        match self {
            Outcome::Solved(design) => &design.file.provenance.solver_runs,
            Outcome::Infeasible(decision)
            | Outcome::Undecided(decision)
            | Outcome::SolverFailed(decision) => &decision.runs,
        }
    }

    /// The outcome with the runs of another one before its own.
    pub(crate) fn after(self, other: &Outcome) -> Self {
        let runs = [other.runs(), self.runs()].concat();
        match self {
            Outcome::Solved(design) => Outcome::Solved(design.with_runs(&runs)),
            Outcome::Infeasible(decision) => Outcome::Infeasible(decision.with_runs(&runs)),
            Outcome::Undecided(decision) => Outcome::Undecided(decision.with_runs(&runs)),
            Outcome::SolverFailed(decision) => Outcome::SolverFailed(decision.with_runs(&runs)),
        }
    }
}

/// An infeasibility certificate, and the designs that it does not cover.
#[derive(Debug, Clone)]
pub struct Infeasible {
    /// The file that proves it.
    pub file: InfeasibilityFile,
    /// No design exists whose multiplier Qh has all entries (SI units) within this bound; the largest
    /// double when none is needed.
    pub bound: f64,
    /// The designs that are not covered; none in a proof that no design exists.
    pub limits: Vec<Limit>,
}

/// The answer.
#[derive(Debug, Clone)]
pub enum Answer {
    /// A design exists: this one is proved. Its gain is not the smallest.
    Feasible(Box<Synthesized>),
    /// No design exists: proved.
    Infeasible(Box<Infeasible>),
    /// Neither is proved; with the certificate for a part of the designs, where there is one.
    Undecided(Option<Box<Infeasible>>),
}

/// The answer, with the evidence of the solvers.
#[derive(Debug, Clone)]
pub struct Decision<A = Answer> {
    /// The answer.
    pub answer: A,
    /// The smallest slack t with which every condition but the gain's holds, in scaled units, where
    /// the solver found it: an estimate, not proved. Above 0 they cannot hold with the margin of the
    /// model.
    pub slack: Option<f64>,
    /// The conditions with the largest fractions of the dual solution's trace: those that block, when t is
    /// above 0.
    pub blocking: Vec<Blocking>,
    /// What a parameter search reached, where there was one.
    pub limiting_factors: Option<Box<LimitingFactors>>,
    /// How many couplings of two certificates were tried; 0 for one certificate.
    pub couplings: usize,
    /// Of a feasible answer whose set must contain states: a point about which their condition may be stated.
    pub(crate) linearisation: Option<DMatrix<f64>>,
    /// Time spent in solvers (s).
    pub solve_seconds: f64,
    /// The solver's runs.
    pub runs: Vec<SolverRun>,
}

impl<A> Decision<A> {
    /// An answer with the runs that gave it, without further evidence.
    pub(crate) fn new(answer: A, runs: &[SolverRun]) -> Self {
        Decision {
            answer,
            slack: None,
            blocking: Vec::new(),
            limiting_factors: None,
            couplings: 0,
            linearisation: None,
            solve_seconds: seconds(runs),
            runs: runs.to_vec(),
        }
    }

    /// The answer with the record of these runs.
    pub(crate) fn with_runs(mut self, runs: &[SolverRun]) -> Self {
        self.solve_seconds = seconds(runs);
        self.runs = runs.to_vec();
        self
    }
}

impl Decision {
    /// The record of a parameter search without the requested design.
    pub(crate) fn of_search(
        limiting_factors: LimitingFactors,
        blocking: Vec<Blocking>,
        runs: &[SolverRun],
    ) -> Self {
        Decision {
            blocking,
            limiting_factors: Some(Box::new(limiting_factors)),
            ..Decision::new(Answer::Undecided(None), runs)
        }
    }
}

/// What a parameter search reached where it missed a requirement, and what limits it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitingFactors {
    /// Why, in one sentence with its numbers.
    pub reason: String,
    /// The largest scale s so that s times every requested state is in a proved set.
    pub scale: Option<f64>,
    /// The angle there, the smallest over states that are attitudes at rest (deg).
    pub angle_deg: Option<f64>,
    /// What would change the outcome most, largest first.
    pub limits: Vec<Sensitivity>,
}

impl LimitingFactors {
    /// A reason without numbers of its own.
    pub(crate) fn unknown(reason: String) -> Self {
        LimitingFactors {
            reason,
            scale: None,
            angle_deg: None,
            limits: Vec::new(),
        }
    }
}

/// How the outcome depends on a number: by how much per cent it gets better when the number grows by 1 %.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivity {
    /// The number, with its unit.
    pub what: String,
    /// Its value.
    pub value: f64,
    /// Per cent per per cent: of the scale for a region, of 1/gain for a gain. Below 0: it gets worse.
    #[serde(rename = "percent_per_percent")]
    pub per_cent: f64,
}
