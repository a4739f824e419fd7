//! The results as a table: typed columns, and comma-separated values of them.

use synth::model::Kind;

use super::outcome::PointOutcome;
use super::subject::Subject;
use crate::base::csv::{self, CsvError};
use crate::base::parquet::{Cells, Column};
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

/// The columns: the numbers that are varied, `verdict`, `reason`, the metrics, and for a model
/// `worst_condition`. A row is a point; the rows are in the order of the grid.
pub fn columns(subject: &Subject, grid: &Grid, outcomes: &[PointOutcome]) -> Vec<Column> {
    let column = |name: &str, cells: Cells| Column {
        name: name.to_string(),
        unit: subject.unit(name).to_string(),
        cells,
    };
    let mut columns: Vec<Column> = Vec::new();
    for (index, (name, whole)) in grid.names().iter().zip(grid.whole()).enumerate() {
        let values = outcomes
            .iter()
            .map(|outcome| outcome.values.get(index).copied());
        let cells = match whole {
            true => Cells::Whole(values.map(|value| value.map(|v| v as i64)).collect()),
            false => Cells::Real(values.collect()),
        };
        columns.push(column(name, cells));
    }
    let verdicts = outcomes.iter().map(|outcome| Some(outcome.verdict.clone()));
    columns.push(column("verdict", Cells::Text(verdicts.collect())));
    let reasons = outcomes.iter().map(|outcome| outcome.reason.clone());
    columns.push(column("reason", Cells::Text(reasons.collect())));
    for name in metric_names(outcomes) {
        let cells = metric_cells(&name, outcomes);
        columns.push(column(&name, cells));
    }
    if subject.kind() == Kind::Model {
        let names = outcomes
            .iter()
            .map(|outcome| outcome.worst_condition.clone());
        columns.push(column("worst_condition", Cells::Text(names.collect())));
    }
    columns
}

/// Whole numbers where all are.
fn metric_cells(name: &str, outcomes: &[PointOutcome]) -> Cells {
    let numbers = || outcomes.iter().map(|outcome| outcome.number(name));
    let whole = numbers().flatten().all(|number| number.is_i64());
    match whole && numbers().flatten().next().is_some() {
        true => Cells::Whole(
            numbers()
                .map(|number| number.and_then(|number| number.as_i64()))
                .collect(),
        ),
        false => Cells::Real(
            numbers()
                .map(|number| number.and_then(|number| number.as_f64()))
                .collect(),
        ),
    }
}

/// The columns as comma-separated values: a header, then a row for each point. Numbers read back
/// exactly; an entry that is missing is empty.
///
/// # Errors
/// Never for tables in memory, as far as is known.
pub fn to_csv(columns: &[Column]) -> Result<String, CsvError> {
    let rows = columns.first().map_or(0, |column| column.cells.rows());
    let header = columns.iter().map(|column| column.name.clone());
    let cells = |row| -> Vec<String> {
        let cells = columns.iter().map(|column| column.cells.text(row));
        cells.collect()
    };
    let records = (0..rows).map(cells);
    csv::to_text(std::iter::once(header.collect::<Vec<String>>()).chain(records))
}
