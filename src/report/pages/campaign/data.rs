//! The worst runs of a campaign.

use std::path::Path;

use crate::batch::campaign::folder::{run_folder, RUNS_FILE};
use crate::batch::campaign::record::Results;
use crate::batch::campaign::table::{column_f64, column_text};
use crate::batch::campaign::CampaignError;
use crate::run::files::{REPORT_FILE, TRAJECTORY_FILE};
use crate::run::summary::RunVerdict;

/// Runs in the list of the worst.
const LISTED: usize = 20;
/// Metrics shown of them, where the campaign has them.
const SHOWN: [&str; 6] = [
    "settle_seconds",
    "final_error_deg",
    "tail_error_deg",
    "final_state_norm",
    "triggers",
    "lyapunov_ratio",
];

/// A run of the list.
#[derive(Debug, Clone, PartialEq)]
pub struct ListedRun {
    /// Its index.
    pub run: u64,
    /// Its verdict as files have it.
    pub verdict: String,
    /// The requirement with the smallest margin.
    pub requirement: Option<String>,
    /// That margin, relative to the limit; negative when it is missed.
    pub margin: Option<f64>,
    /// Values of the metrics shown.
    pub values: Vec<Option<f64>>,
    /// True when its trajectory is kept.
    pub trajectory: bool,
    /// True when its page is there.
    pub page: bool,
}

/// What the page says about single runs.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignData {
    /// Names of the metrics shown.
    pub shown: Vec<&'static str>,
    /// The worst runs first.
    pub worst: Vec<ListedRun>,
}

impl CampaignData {
    /// Reads the tables of a folder.
    ///
    /// # Errors
    /// A table that cannot be read.
    pub fn read(folder: &Path, results: &Results) -> Result<Self, CampaignError> {
        let runs = folder.join(RUNS_FILE);
        let verdicts = column_text(&runs, "verdict")?;
        let requirements = column_text(&runs, "worst_requirement")?;
        let margins = column_f64(&runs, "worst_margin")?;
        let indices = column_f64(&runs, "run")?;
        let margin = |place: usize| margins.get(place).copied().flatten();
        let severity = |place: usize| {
            let verdict = verdicts.get(place).and_then(Option::as_deref);
            let known = verdict.and_then(RunVerdict::named);
            known.map_or(RunVerdict::ALL.len(), RunVerdict::severity)
        };
        let mut order: Vec<usize> = (0..verdicts.len()).collect();
        order.sort_by(|&a, &b| {
            let key = |place| (severity(place), margin(place).unwrap_or(0.0));
            let ((first, low), (second, high)) = (key(a), key(b));
            first
                .cmp(&second)
                .then(low.total_cmp(&high))
                .then(a.cmp(&b))
        });
        order.truncate(LISTED);
        let shown: Vec<&'static str> = SHOWN
            .into_iter()
            .filter(|name| results.metrics.contains_key(*name))
            .collect();
        let columns: Vec<Vec<Option<f64>>> = shown
            .iter()
            .map(|name| column_f64(&runs, name))
            .collect::<Result<_, _>>()?;
        let text = |texts: &[Option<String>], place: usize| texts.get(place).cloned().flatten();
        let worst = order.into_iter().map(|place| {
            let run = indices.get(place).copied().flatten().unwrap_or(0.0) as u64;
            let kept = run_folder(folder, run);
            let value = |column: &Vec<Option<f64>>| column.get(place).copied().flatten();
            ListedRun {
                run,
                verdict: text(&verdicts, place).unwrap_or_default(),
                requirement: text(&requirements, place),
                margin: margin(place),
                values: columns.iter().map(value).collect(),
                trajectory: kept.join(TRAJECTORY_FILE).exists(),
                page: kept.join(REPORT_FILE).exists(),
            }
        });
        Ok(Self {
            worst: worst.collect(),
            shown,
        })
    }
}
