//! The results as a table of typed columns.

use arrow_array::{Float64Array, Int64Array, StringArray};
use serde_json::Number;
use synth::model::Kind;

use super::outcome::PointOutcome;
use super::subject::Subject;
use crate::base::parquet::Column;
use crate::batch::variation::grid::Grid;

/// Names of the metrics in the order in which they first appear.
pub fn metric_names(outcomes: &[PointOutcome]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (name, _) in outcomes.iter().flat_map(|outcome| &outcome.metrics) {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

/// The columns: the numbers that are varied, `verdict`, `reason`, for a scenario with a design `proof_covers` and
/// `not_covered`, the metrics, and for a model
/// `worst_condition`. A row is a point; the rows are in the order of the grid.
pub fn columns(subject: &Subject, grid: &Grid, outcomes: &[PointOutcome]) -> Vec<Column> {
    let numbers = |name: &str, whole: bool, of: &dyn Fn(&PointOutcome) -> Option<Number>| {
        let (unit, values) = (subject.unit(name), outcomes.iter().map(of));
        match whole {
            true => {
                let values = values.map(|value| value?.as_i64());
                Column::new(name, unit, values.collect::<Int64Array>())
            }
            false => {
                let values = values.map(|value| value?.as_f64());
                Column::new(name, unit, values.collect::<Float64Array>())
            }
        }
    };
    let texts = |name: &str, of: fn(&PointOutcome) -> Option<&str>| {
        let texts: StringArray = outcomes.iter().map(of).collect();
        Column::new(name, subject.unit(name), texts)
    };
    let mut columns = Vec::new();
    for (index, axis) in grid.axes.iter().enumerate() {
        let whole = axis.parameter.whole;
        let value = |outcome: &PointOutcome| match outcome.values.get(index) {
            Some(&value) if whole => Some(Number::from(value as i64)),
            value => Number::from_f64(*value?),
        };
        columns.push(numbers(&axis.parameter.name, whole, &value));
    }
    columns.push(texts("verdict", |outcome| Some(&outcome.verdict)));
    columns.push(texts("reason", |outcome| outcome.reason.as_deref()));
    if subject.design_sha256().is_some() {
        columns.push(texts("proof_covers", |outcome| {
            outcome.proof_covers.map(|covers| match covers {
                true => "yes",
                false => "no",
            })
        }));
        columns.push(texts("not_covered", |outcome| {
            outcome.not_covered.as_deref()
        }));
    }
    for name in metric_names(outcomes) {
        let number = |outcome: &PointOutcome| outcome.number(&name).cloned();
        let mut known = outcomes.iter().filter_map(number).peekable();
        let whole = known.peek().is_some() && known.all(|number| number.is_i64());
        columns.push(numbers(&name, whole, &number));
    }
    if subject.kind() == Kind::Model {
        let worst = texts("worst_condition", |outcome| {
            outcome.worst_condition.as_deref()
        });
        columns.push(worst);
    }
    columns
}
