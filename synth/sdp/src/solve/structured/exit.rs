//! What the iterations are given and how they end.

use super::layout::{Iterate, Layout};
use crate::lmi::Semidefinite;

/// Relative size of the residuals of both feasibilities at which a point counts as feasible.
pub const FEASIBLE: f64 = 1e-8;

/// Relative residual of `<A_i, Z> = c_i` that is small enough: the inequalities themselves do not depend on it.
const DUAL_FEASIBLE: f64 = 1e-7;

/// The same for reduced accuracy.
const NEARLY_FEASIBLE: f64 = 1e-6;

/// Relative gap of reduced accuracy.
const NEARLY_CLOSED: f64 = 1e-5;

/// Relative gap, and residual of `<A_i, Z> = c_i`, up to which a point whose y satisfies the inequalities is returned for
/// what it is where no start led further: its objective is attained.
const USABLE: f64 = 1e-4;

/// The same for the residual.
const USABLE_RESIDUAL: f64 = 1e-5;

/// What is known of a point.
#[derive(Debug, Clone, Copy, Default)]
pub struct Measures {
    /// `c'y`, in balanced units.
    pub objective: f64,
    /// `-<constant, Z>`, in balanced units.
    pub dual_objective: f64,
    /// Their distance, relative to the larger one or to the unit of the accuracy.
    pub relative_gap: f64,
    /// Residual of the inequalities' slack, relative.
    pub slack_residual: f64,
    /// Residual of `<A_i, Z> = c_i`, relative.
    pub dual_residual: f64,
}

impl Measures {
    /// How far from the goal: 1 or less is there.
    pub fn distance(&self, gap: f64) -> f64 {
        let gap = self.relative_gap / gap;
        let worst = gap
            .max(self.slack_residual / FEASIBLE)
            .max(self.dual_residual / DUAL_FEASIBLE);
        if worst.is_nan() {
            f64::INFINITY
        } else {
            worst
        }
    }

    /// True for a point of reduced accuracy.
    pub fn nearly_there(&self, gap: f64) -> bool {
        self.relative_gap <= gap.max(NEARLY_CLOSED)
            && self.slack_residual <= NEARLY_FEASIBLE
            && self.dual_residual <= NEARLY_FEASIBLE
    }

    /// True for a point that is near the optimum, if not for certain.
    fn usable(&self, gap: f64) -> bool {
        self.relative_gap <= gap.max(USABLE) && self.dual_residual <= USABLE_RESIDUAL
    }
}

/// How the iterations ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Termination {
    /// To the requested accuracy.
    Solved,
    /// To reduced accuracy: why not further.
    Reduced(&'static str),
    /// No point satisfies the inequalities; the point's Z is the ray.
    Infeasible,
    /// The objective has no lower bound; the point's y is the ray.
    Unbounded,
    /// No further progress: why.
    Stalled(&'static str),
    /// Stopped by the observer.
    Cancelled,
}

impl Termination {
    /// To the requested or to reduced accuracy.
    pub fn is_solved(&self) -> bool {
        matches!(self, Termination::Solved | Termination::Reduced(_))
    }

    /// Without further progress.
    pub fn is_stalled(&self) -> bool {
        matches!(self, Termination::Stalled(_))
    }
}

/// Where the time of a solve went (s).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Timings {
    /// Building the Schur complement.
    pub schur: f64,
    /// Factoring it and solving with it.
    pub linear: f64,
    /// Everything else in the iterations.
    pub rest: f64,
}

/// The last or the best point.
#[derive(Debug, Clone)]
pub struct SolverExit {
    /// How it ended.
    pub termination: Termination,
    /// The point, or the ray.
    pub point: Iterate,
    /// What is known of it.
    pub measures: Measures,
    /// Whether y itself satisfies the inequalities.
    pub feasible: bool,
    /// Iterations done.
    pub iterations: u32,
    /// Where the time went.
    pub timings: Timings,
}

impl SolverExit {
    /// The same, with reduced accuracy in the place of a stall where y satisfies the inequalities and is about optimal.
    pub fn or_reduced(mut self, gap: f64) -> Self {
        if let Termination::Stalled(why) = self.termination {
            if self.feasible && self.measures.usable(gap) {
                self.termination = Termination::Reduced(why);
            }
        }
        self
    }
}

/// The input of the iterations.
pub struct SolveTask<'a> {
    /// The problem.
    pub layout: &'a Layout,
    /// The problem as it was given.
    pub problem: &'a Semidefinite,
    /// Requested relative gap.
    pub relative_gap: f64,
    /// Most iterations.
    pub iterations: u32,
    /// Smallest size the gap is relative to, in balanced units.
    pub objective_unit: f64,
    /// Keeps nearer to the central path: more iterations, but fewer problems stall.
    pub cautious: bool,
    /// Threads that may be used.
    pub threads: usize,
    /// Called between iterations; `false` stops.
    pub observer: &'a (dyn Fn(u32, &Measures) -> bool + Sync),
}
