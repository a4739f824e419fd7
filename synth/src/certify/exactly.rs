//! The same statements decided once more in exact rational arithmetic: no rounding, no bound, no margin.

use serde::Serialize;
use verified::exact::{holds, Exact};
use verified::matrix::Matrix;

use super::theorem1::for_each_condition;
use super::{Certificate, Verdict};
use crate::model::Model;

/// The outcome of an exact check.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExactReport {
    /// Proved when every condition holds.
    pub verdict: Verdict,
    /// How many conditions were decided.
    pub conditions: usize,
    /// Names of the conditions that do not hold.
    pub failed: Vec<String>,
}

impl ExactReport {
    /// Both reports as one.
    pub(crate) fn and(mut self, other: ExactReport) -> Self {
        self.conditions += other.conditions;
        self.failed.extend(other.failed);
        if other.verdict == Verdict::NotProved {
            self.verdict = Verdict::NotProved;
        }
        self
    }
}

/// Decides every statement that `emit` receives: a name and a matrix that must be positive definite.
pub fn decide_all(emit: impl FnOnce(&mut dyn FnMut(String, Matrix<Exact>))) -> ExactReport {
    let mut report = ExactReport {
        verdict: Verdict::Proved,
        conditions: 0,
        failed: Vec::new(),
    };
    emit(&mut |name, matrix| {
        report.conditions += 1;
        if !holds(&matrix) {
            report.verdict = Verdict::NotProved;
            report.failed.push(name);
        }
    });
    report
}

/// Decides every condition of Theorem 1 for the given numbers.
pub fn check_exactly(model: &Model, certificate: &Certificate) -> ExactReport {
    decide_all(|emit| {
        for_each_condition::<Exact>(model, certificate, |statement| {
            emit(statement.name, statement.matrix);
        });
    })
}
