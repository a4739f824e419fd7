//! What a sweep came to.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::facts::written;
use crate::batch::sweep::finished::{Finished, CSV_FILE, PAGE_FILE, PARQUET_FILE, PROVENANCE_FILE};
use crate::cli::answer::{Answer, Exit};

/// What a sweep came to, and where its tables are.
#[derive(Debug, Serialize)]
struct SweepReport<'a> {
    /// Points of the grid.
    points: usize,
    /// Those that were done before.
    resumed: usize,
    /// The numbers that were varied.
    varied: Vec<String>,
    /// How many points have each verdict.
    verdicts: BTreeMap<&'a str, usize>,
    /// How many points the proof of the scenario's design covers; null without a design.
    covered: Option<usize>,
    /// The table.
    table: String,
    /// The same for other programs.
    parquet: String,
    /// The page.
    page: String,
}

/// Yes, whatever the verdicts of the points.
pub fn answer(finished: &Finished, resumed: usize, folder: &Path) -> Answer {
    let path = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let report = SweepReport {
        points: finished.grid.points(),
        resumed,
        varied: finished.grid.names(),
        verdicts: finished.verdicts(),
        covered: finished.covered(),
        table: path(CSV_FILE),
        parquet: path(PARQUET_FILE),
        page: path(PAGE_FILE),
    };
    let before = match resumed {
        0 => String::new(),
        resumed => format!(" ({resumed} were done before)"),
    };
    let mut lines = vec![format!("points: {}{before}", report.points)];
    let verdicts = report.verdicts.iter();
    lines.extend(verdicts.map(|(verdict, count)| format!("  {verdict}: {count}")));
    lines.extend(report.covered.map(|covered| {
        format!(
            "points that the proof covers: {covered} of {}",
            report.points
        )
    }));
    let others = [PARQUET_FILE, PAGE_FILE, PROVENANCE_FILE].join(", ");
    lines.push(format!("{}, {others}", written(&folder.join(CSV_FILE))));
    Answer::new(Exit::Yes, &report, &lines)
}
