//! A table of numbers with named columns.

/// A table of numbers with named columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Names of the columns, with units.
    pub columns: Vec<String>,
    /// Rows one after the other.
    pub values: Vec<f64>,
}

/// Why a text is not a table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TableError {
    /// There is no header.
    #[error("the file is empty")]
    Empty,
    /// A row has the wrong length.
    #[error("line {line}: {found} values; the header has {expected}")]
    Length {
        /// Line, from 1.
        line: usize,
        /// Values in it.
        found: usize,
        /// Values needed.
        expected: usize,
    },
    /// A value is not a number.
    #[error("line {line}: '{text}' is not a number")]
    NotANumber {
        /// Line, from 1.
        line: usize,
        /// What stands there.
        text: String,
    },
}

impl Table {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.values.len() / self.columns.len().max(1)
    }

    /// A column's values; `None` when there is no such column.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.columns.iter().position(|column| column == name)?;
        let rows = self.values.chunks_exact(self.columns.len());
        Some(rows.map(|row| row[index]).collect())
    }

    /// Comma-separated values with a header. Numbers read back exactly.
    pub fn to_csv(&self) -> String {
        use std::fmt::Write;
        let mut text = self.columns.join(",") + "\n";
        for row in self.values.chunks_exact(self.columns.len().max(1)) {
            for (index, value) in row.iter().enumerate() {
                let separator = if index == 0 { "" } else { "," };
                // Writing to a string cannot fail.
                let _ = write!(text, "{separator}{value}");
            }
            text.push('\n');
        }
        text
    }

    /// Reads what [`Table::to_csv`] writes.
    ///
    /// # Errors
    /// A line that is no row of numbers.
    pub fn from_csv(text: &str) -> Result<Self, TableError> {
        let mut lines = text.lines().enumerate();
        let (_, header) = lines.next().ok_or(TableError::Empty)?;
        let columns: Vec<String> = header.split(',').map(str::to_string).collect();
        let mut values = Vec::new();
        for (index, line) in lines {
            let before = values.len();
            for text in line.split(',') {
                let value = text.parse().map_err(|_| TableError::NotANumber {
                    line: index + 1,
                    text: text.chars().take(40).collect(),
                })?;
                values.push(value);
            }
            if values.len() - before != columns.len() {
                return Err(TableError::Length {
                    line: index + 1,
                    found: values.len() - before,
                    expected: columns.len(),
                });
            }
        }
        Ok(Self { columns, values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Vec<String> {
        vec!["time_s".to_string(), "x".to_string()]
    }

    #[test]
    fn a_table_reads_back_exactly() {
        let table = Table {
            columns: columns(),
            values: vec![0.1, 1.0 / 3.0, 1e-300, -2.5e17, 5e-324, 0.0],
        };
        assert_eq!(Table::from_csv(&table.to_csv()), Ok(table));
    }

    #[test]
    fn a_broken_table_is_refused_with_its_line() {
        let length = TableError::Length {
            line: 3,
            found: 1,
            expected: 2,
        };
        assert_eq!(Table::from_csv("time_s,x\n0,1\n2\n"), Err(length));
        let text = Table::from_csv("time_s,x\n0,one\n");
        assert!(matches!(text, Err(TableError::NotANumber { line: 2, .. })));
        assert_eq!(Table::from_csv(""), Err(TableError::Empty));
    }
}
