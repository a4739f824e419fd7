//! The trajectory of a run as a table.

use crate::base::table::Table;

/// Collects rows at every event and at least every `interval_s` seconds.
#[derive(Clone, Debug)]
pub struct Recorder {
    table: Table,
    interval_s: f64,
    due_s: f64,
    last_s: f64,
}

impl Recorder {
    /// Recorder of the given columns; the first must be the time.
    pub fn new(columns: Vec<String>, interval_s: f64) -> Self {
        Self {
            table: Table {
                columns,
                values: Vec::new(),
            },
            interval_s,
            due_s: 0.0,
            last_s: f64::NAN,
        }
    }

    /// True when a row is due at `time_s` even without an event.
    #[inline]
    pub fn due(&self, time_s: f64) -> bool {
        time_s >= self.due_s
    }

    /// Writes a row; one at the same time is replaced.
    pub fn write(&mut self, row: &[f64]) {
        let time = row[0];
        if time == self.last_s {
            let start = self.table.values.len() - row.len();
            self.table.values.truncate(start);
        }
        self.table.values.extend_from_slice(row);
        self.last_s = time;
        // Rounding must not make the same time due again.
        let grid = ((time / self.interval_s).floor() + 1.0) * self.interval_s;
        self.due_s = grid.max(time + 2.0 * f64::EPSILON * time);
    }

    /// The last row, when it is at `time_s`.
    pub fn last_row_at(&mut self, time_s: f64) -> Option<&mut [f64]> {
        if self.last_s != time_s {
            return None;
        }
        let width = self.table.columns.len();
        self.table.values.rchunks_exact_mut(width).next()
    }

    /// The table.
    pub fn into_table(self) -> Table {
        self.table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Vec<String> {
        vec!["time_s".to_string(), "x".to_string()]
    }

    #[test]
    fn rows_come_at_the_interval_and_one_at_the_same_time_is_replaced() {
        let mut recorder = Recorder::new(columns(), 0.5);
        for index in 0..11 {
            let time = 0.125 * f64::from(index);
            if recorder.due(time) {
                recorder.write(&[time, 1.0]);
            }
        }
        recorder.write(&[1.25, 1.0]);
        recorder.write(&[1.25, 2.0]);
        let table = recorder.into_table();
        assert_eq!(table.column("time_s"), Some(vec![0.0, 0.5, 1.0, 1.25]));
        assert_eq!(table.column("x"), Some(vec![1.0, 1.0, 1.0, 2.0]));
    }
}
