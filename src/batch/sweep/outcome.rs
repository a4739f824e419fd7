//! What a point of a sweep came to.

use serde::{Deserialize, Serialize};
use serde_json::{Number, Value};

use crate::batch::variation::grid::Grid;

/// One row of the results, and a line of the journal.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointOutcome {
    /// The point's number in the grid.
    pub point: usize,
    /// Values of the numbers that are varied, in the order of the axes. In the journal the point's
    /// number stands for them.
    #[serde(skip)]
    pub values: Vec<f64>,
    /// The answer in one word; [`INVALID`] when the file of the point is.
    pub verdict: String,
    /// Why the answer is no; `None` when it is yes.
    pub reason: Option<String>,
    /// Measured numbers with their names; `None` where the run does not have it.
    pub metrics: Vec<(String, Option<Number>)>,
    /// The condition with the smallest margin, of a design.
    pub worst_condition: Option<String>,
    /// Whether the proof of the scenario's design covers the point; `None` without a design.
    #[serde(default)]
    pub proof_covers: Option<bool>,
    /// Why it does not.
    #[serde(default)]
    pub not_covered: Option<String>,
}

/// Verdict of a point whose file is not valid or cannot be run.
pub const INVALID: &str = "invalid";
/// Verdict of a point at which the program itself stopped.
pub const FAILED: &str = "failed";
/// Verdicts that say yes.
const YES: [&str; 2] = ["proved", "requirements_met"];

impl PointOutcome {
    /// An answer without numbers, of any point.
    pub fn without_numbers(verdict: &str, reason: impl ToString) -> Self {
        PointOutcome {
            verdict: verdict.to_string(),
            reason: Some(reason.to_string()),
            ..PointOutcome::default()
        }
    }

    /// The same at a point of a grid.
    pub fn at(self, point: usize, grid: &Grid) -> Self {
        PointOutcome {
            point,
            values: grid.point(point),
            ..self
        }
    }

    /// A metric's value.
    pub fn metric(&self, name: &str) -> Option<f64> {
        self.number(name).and_then(Number::as_f64)
    }

    /// A metric's value as it was measured: whole numbers are distinguished from others.
    pub fn number(&self, name: &str) -> Option<&Number> {
        let found = self.metrics.iter().find(|(own, _)| own == name);
        found.and_then(|(_, value)| value.as_ref())
    }

    /// Whether there is a proof and it does not cover the point: what is shown was simulated only.
    pub fn uncovered(&self) -> bool {
        self.proof_covers == Some(false)
    }

    /// Whether the answer is yes.
    pub fn good(&self) -> bool {
        YES.contains(&self.verdict.as_str())
    }
}

/// Parts of a summary whose nulls are no metrics: texts, and groups of numbers.
const NO_METRICS: [&str; 4] = ["first_hold", "certificate", "funnel", "threshold"];
/// Parts of a summary whose numbers are no metrics.
const NOT_MEASURED: [&str; 3] = ["schema_version", "scales", "provenance"];

/// Every number of a summary: top-level ones by their key, those of an object by `object.key`. A
/// null number is `None`.
pub fn numbers_of(summary: &Value) -> Vec<(String, Option<Number>)> {
    let fields = summary.as_object().into_iter().flatten();
    let fields = fields.filter(|(key, _)| !NOT_MEASURED.contains(&key.as_str()));
    let mut out = Vec::new();
    for (key, value) in fields {
        match value {
            Value::Number(number) => out.push((key.clone(), Some(number.clone()))),
            Value::Null if !NO_METRICS.contains(&key.as_str()) => out.push((key.clone(), None)),
            Value::Object(inner) => out.extend(inner.iter().filter_map(|(name, value)| {
                let number = value.as_number()?;
                Some((format!("{key}.{name}"), Some(number.clone())))
            })),
            _ => {}
        }
    }
    out
}
