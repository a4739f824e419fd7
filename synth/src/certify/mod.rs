//! The check: is the closed loop of a design file proved to do what the file states?
//!
//! Nothing but the numbers of the file is used. Each condition of Theorem 1 is assembled in interval
//! arithmetic and its positive definiteness proved in floating point; no solver takes part.

mod assumptions;
mod certificate;
mod certified_set;
pub mod controller_rounding;
mod exactly;
pub mod held_command;
pub mod infeasible;
pub mod plant;
pub mod reach;
mod signals;
pub mod theorem1;

pub use sdp::exclusion;
pub use verified::{definite, exact, interval, matrix, rounding, scalar};

use serde::{Deserialize, Serialize};
use verified::definite::{prove_positive_definite, IntervalMatrix};
use verified::interval::Interval;
use verified::matrix::Matrix;

use crate::model::Model;
use assumptions::not_covered;
pub use certificate::{
    Certificate, FinalBounds, FirstTorque, HandOver, HeldWeights, MeasurementWeights,
    MismatchSlack, RuleGains,
};
pub use exactly::{check_exactly, decide_all, ExactReport};
use theorem1::{for_each_condition, Statement};

/// The answer of the check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every condition is proved.
    Proved,
    /// Some condition is not.
    NotProved,
}

/// One condition of the check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConditionMargin {
    /// Name of the condition.
    pub name: String,
    /// Smallest eigenvalue after scaling the diagonal to about 1: a proved lower bound when the
    /// condition is proved (0 or above), an estimate below 0 when it is not.
    pub margin: f64,
}

/// The outcome of a check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "VerdictFile")]
pub struct Report {
    /// Proved or not.
    pub verdict: Verdict,
    /// Margin of each condition.
    pub conditions: Vec<ConditionMargin>,
    /// What the proof does not cover.
    pub not_covered: Vec<String>,
}

impl Report {
    /// The condition with the smallest margin.
    pub fn worst(&self) -> Option<&ConditionMargin> {
        self.conditions
            .iter()
            .min_by(|a, b| a.margin.total_cmp(&b.margin))
    }
}

/// Checks every condition of Theorem 1 for the given numbers.
pub fn check(model: &Model, certificate: &Certificate) -> Report {
    judge_all(not_covered(model, certificate), |emit| {
        for_each_condition::<Interval>(model, certificate, |statement| {
            emit(statement.name, statement.matrix);
        });
    })
}

/// Judges every statement that `emit` receives: a name and a matrix that must be positive definite.
pub fn judge_all(
    not_covered: Vec<String>,
    emit: impl FnOnce(&mut dyn FnMut(String, Matrix<Interval>)),
) -> Report {
    let mut conditions = Vec::new();
    let mut verdict = Verdict::Proved;
    emit(&mut |name, matrix| {
        let statement = Statement { name, matrix };
        let (proved, margin) = judge(&statement);
        if !proved {
            verdict = Verdict::NotProved;
        }
        conditions.push(ConditionMargin {
            name: statement.name,
            margin,
        });
    });
    Report {
        verdict,
        conditions,
        not_covered,
    }
}

pub(crate) fn judge(statement: &Statement<Interval>) -> (bool, f64) {
    let matrix = &statement.matrix;
    let symmetric = IntervalMatrix::from_upper(matrix.nrows(), |r, c| *matrix.at(r, c));
    match prove_positive_definite(&symmetric) {
        Ok(margin) => (true, margin.proved),
        // "Not proved" must never look proved, whatever the estimate says.
        Err(reason) => (false, reason.estimate.clamp(f64::MIN, -f64::MIN_POSITIVE)),
    }
}
