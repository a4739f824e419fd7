//! What a point of a sweep came to.

use serde_json::{Number, Value};

/// One row of the results.
#[derive(Debug, Clone, PartialEq)]
pub struct PointOutcome {
    /// Values of the numbers that are varied, in the order of the axes.
    pub values: Vec<f64>,
    /// The answer in one word; [`INVALID`] when the file of the point is.
    pub verdict: String,
    /// Why the answer is no; `None` when it is yes.
    pub reason: Option<String>,
    /// Measured numbers with their names; `None` where the run does not have it.
    pub metrics: Vec<(String, Option<Number>)>,
    /// The condition with the smallest margin, of a design.
    pub worst_condition: Option<String>,
}

/// Verdict of a point whose file is not valid or cannot be run.
pub const INVALID: &str = "invalid";
/// Verdict of a point at which the program itself stopped.
pub const FAILED: &str = "failed";
/// Verdicts that say yes.
const YES: [&str; 2] = ["proved", "requirements_met"];

impl PointOutcome {
    /// A point without numbers.
    pub fn without_numbers(values: Vec<f64>, verdict: &str, reason: impl ToString) -> Self {
        PointOutcome {
            values,
            verdict: verdict.to_string(),
            reason: Some(reason.to_string()),
            metrics: Vec::new(),
            worst_condition: None,
        }
    }

    /// A point that could not be run.
    pub fn invalid(values: Vec<f64>, reason: impl ToString) -> Self {
        PointOutcome::without_numbers(values, INVALID, reason)
    }

    /// A metric's value.
    pub fn metric(&self, name: &str) -> Option<f64> {
        self.number(name).and_then(Number::as_f64)
    }

    /// A metric's value as it was measured: whole numbers are told from others.
    pub fn number(&self, name: &str) -> Option<&Number> {
        let found = self.metrics.iter().find(|(own, _)| own == name);
        found.and_then(|(_, value)| value.as_ref())
    }

    /// Whether the answer is yes.
    pub fn good(&self) -> bool {
        YES.contains(&self.verdict.as_str())
    }
}

/// Parts of a summary that are no metrics.
const NOT_METRICS: [&str; 9] = [
    "schema_version",
    "scenario",
    "source",
    "system",
    "controller",
    "verdict",
    "first_hold",
    "scales",
    "provenance",
];

/// Parts of a summary that hold several numbers, and are null for runs that have none of them.
const GROUPS: [&str; 3] = ["certificate", "funnel", "threshold"];

/// Every number of a summary: top-level ones by their key, those of an object by `object.key`. A
/// null number is `None`.
pub fn numbers_of(summary: &Value) -> Vec<(String, Option<Number>)> {
    let mut out = Vec::new();
    let fields = summary.as_object().into_iter().flatten();
    for (key, value) in fields.filter(|(key, _)| !NOT_METRICS.contains(&key.as_str())) {
        match value {
            Value::Number(number) => out.push((key.clone(), Some(number.clone()))),
            Value::Null if !GROUPS.contains(&key.as_str()) => out.push((key.clone(), None)),
            Value::Object(inner) => {
                for (name, value) in inner {
                    if let Value::Number(number) = value {
                        out.push((format!("{key}.{name}"), Some(number.clone())));
                    }
                }
            }
            Value::Null | Value::Bool(_) | Value::String(_) | Value::Array(_) => {}
        }
    }
    out
}
