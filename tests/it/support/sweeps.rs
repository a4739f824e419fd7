//! What the tests of sweeps share.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::{json, names_in, set, shipped, steadfast, write, Run};

/// A short scenario.
pub fn scenario(folder: &Path) -> PathBuf {
    let mut file = json(&shipped("wu2018.json"));
    set(&mut file, "/duration_s", json!(120));
    set(&mut file, "/metrics/tail_s", json!(20));
    let requirements = json!([{ "metric": "triggers", "at_most": 25 }]);
    set(&mut file, "/requirements", requirements);
    write(folder, "scenario.json", file.to_string())
}

/// Runs a sweep.
pub fn sweep(file: &Path, vary: &[&str], output: &Path, more: &[&str]) -> Run {
    let mut arguments = vec!["sweep".to_string(), file.display().to_string()];
    for axis in vary {
        arguments.extend(["--vary".to_string(), axis.to_string()]);
    }
    arguments.extend(["-o".to_string(), output.display().to_string()]);
    arguments.extend(more.iter().map(|text| text.to_string()));
    steadfast(arguments)
}

/// The rows of the table, by column.
pub struct Rows {
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Rows {
    pub fn read(folder: &Path) -> Self {
        let mut reader = csv::Reader::from_path(folder.join("sweep.csv")).expect("a table");
        let list = |record: &csv::StringRecord| record.iter().map(str::to_string).collect();
        let columns = list(reader.headers().expect("a header"));
        let rows = reader.records().map(|row| list(&row.expect("a row")));
        Rows {
            columns,
            rows: rows.collect(),
        }
    }

    #[track_caller]
    pub fn text(&self, row: usize, column: &str) -> &str {
        let index = self.columns.iter().position(|name| name == column);
        let index = index.unwrap_or_else(|| panic!("no column {column} in {:?}", self.columns));
        &self.rows[row][index]
    }

    #[track_caller]
    pub fn number(&self, row: usize, column: &str) -> f64 {
        let text = self.text(row, column);
        text.parse()
            .unwrap_or_else(|_| panic!("{column} is '{text}'"))
    }
}

/// Every file of a folder with its bytes.
pub fn everything_in(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let names = names_in(folder).into_iter();
    names
        .map(|name| {
            let bytes = std::fs::read(folder.join(&name)).expect("a file");
            (name, bytes)
        })
        .collect()
}
