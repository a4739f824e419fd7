//! The results as a table.

use super::grid::Grid;
use super::outcome::PointOutcome;

/// The table could not be put together.
#[derive(Debug, thiserror::Error)]
#[error("the table cannot be written: {0}")]
pub struct TableError(#[from] csv::Error);

/// Columns that every table has, after the varied numbers.
const ANSWER: [&str; 2] = ["verdict", "reason"];

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

/// The results as comma-separated values: a header, then a row for each point. Numbers read back
/// exactly; a metric that a run does not have is empty.
///
/// # Errors
/// Never for tables in memory, as far as is known.
pub fn to_csv(grid: &Grid, outcomes: &[PointOutcome]) -> Result<String, TableError> {
    let metrics = metric_names(outcomes);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header = grid.names().into_iter();
    let header = header.chain(ANSWER.map(str::to_string));
    writer.write_record(header.chain(metrics.iter().cloned()))?;
    for outcome in outcomes {
        let values = outcome.values.iter().map(f64::to_string);
        let reason = outcome.reason.clone().unwrap_or_default();
        let answer = [outcome.verdict.clone(), reason];
        let numbers = metrics.iter().map(|name| {
            let value = outcome.metric(name);
            value.map_or(String::new(), |value| value.to_string())
        });
        writer.write_record(values.chain(answer).chain(numbers))?;
    }
    let bytes = writer
        .into_inner()
        .map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
