//! What a solver's numbers show, whatever status it gave them.

use super::certificates::{descent, refutation, Descent, Refutation};
use super::residuals::{residuals, Residuals};
use crate::backend::{Solution, Status};
use crate::lmi::Semidefinite;

/// Largest residual of a certificate that there is no solution.
const CERTIFICATE: f64 = 1e-7;

/// Largest residual of a direction without a lower bound.
const DIRECTION: f64 = 1e-8;

/// What the numbers show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// An optimum: every error measure is below [`SOLVED`].
    Solved,
    /// Near an optimum: every error measure is below [`INACCURATE`].
    Inaccurate,
    /// No point satisfies the conditions: a certificate with a small residual.
    Infeasible,
    /// The objective has no lower bound: a direction with a small residual.
    Unbounded,
    /// None of these.
    Failed,
    /// Stopped by the progress observer.
    Cancelled,
}

/// Largest error measures of a solved problem. What the residual of the dual equations can do to the objective is part
/// of the uncertainty, so that it may be larger by itself.
pub const SOLVED: Limits = Limits {
    objective: 1e-6,
    dual_residual: 1e-5,
    violation: 1e-7,
};

/// The same of an inaccurate solution.
pub const INACCURATE: Limits = Limits {
    objective: 1e-3,
    dual_residual: 1e-3,
    violation: 1e-3,
};

/// Largest error measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Of the relative gap (and of the uncertainty of a solved problem).
    pub objective: f64,
    /// Of the dual equations.
    pub dual_residual: f64,
    /// Of the conditions and of the dual conditions.
    pub violation: f64,
}

/// What the numbers show, with the evidence.
#[derive(Debug, Clone)]
pub struct Judgement {
    /// In a word.
    pub outcome: Outcome,
    /// Error measures of the point; `None` where the solver returned a certificate instead.
    pub residuals: Option<Residuals>,
    /// The certificate that there is no solution, where the solver claims one.
    pub refutation: Option<Refutation>,
    /// The direction without a lower bound, where the solver claims one.
    pub descent: Option<Descent>,
}

impl Judgement {
    /// Judges what a solver returned.
    pub fn new(problem: &Semidefinite, solution: &Solution) -> Self {
        let mut judgement = Judgement {
            outcome: Outcome::Failed,
            residuals: None,
            refutation: None,
            descent: None,
        };
        match solution.status {
            Status::Cancelled => judgement.outcome = Outcome::Cancelled,
            Status::Infeasible => {
                let found = refutation(problem, &solution.duals);
                if found.residual <= CERTIFICATE && found.exclusion.radius > 0.0 {
                    judgement.outcome = Outcome::Infeasible;
                }
                judgement.refutation = Some(found);
            }
            Status::Unbounded => {
                let found = descent(problem, &solution.values);
                if found
                    .as_ref()
                    .is_some_and(|found| found.residual <= DIRECTION)
                {
                    judgement.outcome = Outcome::Unbounded;
                }
                judgement.descent = found;
            }
            Status::Solved | Status::Inaccurate | Status::Failed => {
                let measured = residuals(problem, solution);
                judgement.outcome = of_point(&measured);
                judgement.residuals = Some(measured);
            }
        }
        judgement
    }

    /// Whether no other solver has to be asked.
    pub fn decides(&self) -> bool {
        match self.outcome {
            Outcome::Solved | Outcome::Infeasible | Outcome::Unbounded | Outcome::Cancelled => true,
            Outcome::Inaccurate | Outcome::Failed => false,
        }
    }

    /// For choosing among several: the smaller is better. A proof that there is no solution is better than a point that
    /// violates the conditions, and worse than one that does not; of two that do not, the lower objective is nearer to
    /// the optimum.
    pub fn rank(&self) -> (u8, f64) {
        let number = |read: fn(&Residuals) -> f64| self.residuals.as_ref().map_or(0.0, read);
        let holds = self
            .residuals
            .as_ref()
            .is_some_and(|own| own.violation <= 0.0);
        let class = match self.outcome {
            Outcome::Cancelled => 0,
            Outcome::Solved => 1,
            Outcome::Inaccurate if holds => 2,
            Outcome::Infeasible | Outcome::Unbounded => 3,
            Outcome::Inaccurate => 4,
            Outcome::Failed => 5,
        };
        let within = match class {
            2 => number(|own| own.objective),
            _ => number(|own| own.uncertainty),
        };
        (class, within)
    }
}

fn of_point(measured: &Residuals) -> Outcome {
    // A comparison with NaN is false.
    let within = |limits: Limits| {
        measured.relative_gap.abs() <= limits.objective
            && measured.dual_residual <= limits.dual_residual
            && measured.violation <= limits.violation
            && measured.dual_violation <= limits.violation
    };
    if within(SOLVED) && measured.uncertainty <= SOLVED.objective {
        Outcome::Solved
    } else if within(INACCURATE) && measured.uncertainty.is_finite() {
        Outcome::Inaccurate
    } else {
        Outcome::Failed
    }
}
