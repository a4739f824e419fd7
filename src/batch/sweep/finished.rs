//! A finished sweep.

use std::collections::BTreeMap;

use serde_json::json;

use super::outcome::PointOutcome;
use super::points::SweepIdentity;
use super::subject::{value_of, Subject};
use crate::batch::variation::grid::Grid;

/// Name of the table as comma-separated values.
pub const CSV_FILE: &str = "sweep.csv";
/// Name of the table as Parquet.
pub const PARQUET_FILE: &str = "sweep.parquet";
/// Name of the page.
pub const PAGE_FILE: &str = "sweep.html";
/// Name of the file that says how the table came about.
pub const PROVENANCE_FILE: &str = "sweep.json";

/// A finished sweep.
pub struct Finished<'a> {
    /// What was swept.
    pub subject: &'a Subject,
    /// The grid.
    pub grid: &'a Grid,
    /// The outcomes in its order.
    pub outcomes: &'a [PointOutcome],
    /// What makes it this sweep.
    pub identity: &'a SweepIdentity,
    /// Name of the file that was swept, without its folder.
    pub file: &'a str,
}

impl Finished<'_> {
    /// How many points have each verdict.
    pub fn verdicts(&self) -> BTreeMap<&str, usize> {
        let mut verdicts = BTreeMap::new();
        for outcome in self.outcomes {
            *verdicts.entry(outcome.verdict.as_str()).or_default() += 1;
        }
        verdicts
    }

    /// How many points the proof of the scenario's design covers; `None` without a design.
    pub fn covered(&self) -> Option<usize> {
        let known = self.outcomes.iter().filter_map(|point| point.proof_covers);
        let design = self.subject.design_sha256();
        design.map(|_| known.filter(|covers| *covers).count())
    }

    /// What the table says of itself.
    pub fn about(&self) -> Vec<(&'static str, String)> {
        let identity = self.identity.clone();
        let axes = serde_json::to_string(&identity.axes).unwrap_or_default();
        let about = [
            ("generator", Some(identity.generator)),
            ("kind", Some(identity.kind)),
            ("file", Some(self.file.to_string())),
            ("file_sha256", Some(identity.file_sha256)),
            ("axes", Some(axes)),
            ("design_sha256", identity.design_sha256),
            ("solver", identity.solver),
        ];
        let about = about.into_iter();
        about.filter_map(|(key, text)| Some((key, text?))).collect()
    }

    /// How the table came about, as JSON.
    pub fn provenance(&self) -> String {
        let mut value = value_of(self.identity);
        value["file"] = json!(self.file);
        value["points"] = json!(self.grid.points());
        value["verdicts"] = json!(self.verdicts());
        serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
    }
}
