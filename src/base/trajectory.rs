//! What makes a table the trajectory of a run.

use crate::base::table::Table;

/// Column of the time; the first.
pub const TIME_COLUMN: &str = "time_s";
/// Columns that every trajectory has beside the time: whether there was a sample, and whether a message was sent.
const EVENT_COLUMNS: [&str; 2] = ["sample", "sent"];

/// Why a table is no trajectory.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrajectoryError {
    /// The first column is another one.
    #[error("the first column is '{found}'; it must be time_s")]
    FirstColumn {
        /// Its name.
        found: String,
    },
    /// A column is missing.
    #[error("there is no column {missing}")]
    Missing {
        /// Its name.
        missing: &'static str,
    },
    /// There is no row below the header.
    #[error("there is no row below the header")]
    NoRow,
    /// The time does not rise.
    #[error("line {line}: the time is {time_s} s after {before_s} s; it must be a number and rise from row to row")]
    Time {
        /// Line, from 1.
        line: usize,
        /// The time there, s.
        time_s: f64,
        /// The time of the row before, s; minus infinity in the first row.
        before_s: f64,
    },
    /// A sample or a message that is neither there nor not there.
    #[error("line {line}: {column} is {value}; it must be 0 or 1")]
    Event {
        /// Line, from 1.
        line: usize,
        /// The column.
        column: &'static str,
        /// The value.
        value: f64,
    },
}

/// Refuses a table that no run writes. Other columns may hold what is not finite: a run may diverge, and a signal may
/// be undefined.
///
/// # Errors
/// The first thing that is not as a run writes it.
pub fn check_trajectory(table: &Table) -> Result<(), TrajectoryError> {
    let first = table.columns.first().map_or("", String::as_str);
    if first != TIME_COLUMN {
        let found = first.chars().take(40).collect();
        return Err(TrajectoryError::FirstColumn { found });
    }
    let times = table.column(TIME_COLUMN).unwrap_or_default();
    if times.is_empty() {
        return Err(TrajectoryError::NoRow);
    }
    let mut before_s = f64::NEG_INFINITY;
    for (row, &time_s) in times.iter().enumerate() {
        if !time_s.is_finite() || time_s <= before_s {
            let line = row + FIRST_LINE;
            return Err(TrajectoryError::Time {
                line,
                time_s,
                before_s,
            });
        }
        before_s = time_s;
    }
    EVENT_COLUMNS
        .into_iter()
        .try_for_each(|name| check_events(table, name))
}

/// Line of the first row.
const FIRST_LINE: usize = 2;

fn check_events(table: &Table, column: &'static str) -> Result<(), TrajectoryError> {
    let missing = TrajectoryError::Missing { missing: column };
    let values = table.column(column).ok_or(missing)?;
    let wrong = values.iter().position(|value| ![0.0, 1.0].contains(value));
    match wrong {
        None => Ok(()),
        Some(row) => Err(TrajectoryError::Event {
            line: row + FIRST_LINE,
            column,
            value: values[row],
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(text: &str) -> Result<(), TrajectoryError> {
        check_trajectory(&Table::from_csv(text).expect("a table"))
    }

    #[test]
    fn only_a_table_as_a_run_writes_it_is_a_trajectory() {
        let head = "time_s,x,sample,sent\n";
        assert_eq!(checked(&format!("{head}0,NaN,1,1\n0.5,inf,0,0\n")), Ok(()));
        assert_eq!(checked(head), Err(TrajectoryError::NoRow));
        let error = |rows: &str| checked(&format!("{head}{rows}")).expect_err("refused");
        for (rows, at) in [("NaN,1,1,1\n", 2), ("0,1,1,1\n0,1,1,1\n", 3)] {
            assert!(matches!(error(rows), TrajectoryError::Time { line, .. } if line == at));
        }
        assert!(matches!(
            error("0,1,1,NaN\n"),
            TrajectoryError::Event {
                line: 2,
                column: "sent",
                ..
            }
        ));
        let foreign = checked("a,b\n1,2\n");
        assert!(matches!(foreign, Err(TrajectoryError::FirstColumn { .. })));
        let missing = TrajectoryError::Missing { missing: "sample" };
        assert_eq!(checked("time_s,sent\n0,1\n"), Err(missing));
    }
}
