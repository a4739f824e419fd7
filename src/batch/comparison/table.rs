//! The table of a comparison.

use serde::Serialize;

use crate::base::csv::quoted;
use crate::run::summary::{CertificateOutcome, RunVerdict, Summary};
use crate::scenario::RequirementFile;
use crate::sim::link::LinkOutcome;
use crate::sim::metrics::{by_key, compared, Metric, MetricValue};

/// The version of the comparison's format.
pub const COMPARISON_SCHEMA_VERSION: u32 = 1;

/// Several controllers on one task.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// Program and version.
    pub generator: String,
    /// What is the same for all.
    pub task: TaskSummary,
    /// The standard faults: name and description.
    pub faults: Vec<(String, String)>,
    /// One row for each controller.
    pub runs: Vec<ControllerRow>,
}

/// What is the same for all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TaskSummary {
    /// The scenario whose task was imposed on all; null when all have it by themselves.
    pub taken_from: Option<String>,
    /// Length of a run, s.
    pub duration_s: f64,
    /// Torque that can act on each axis, N m.
    pub torque_limit_nm: [f64; 3],
    /// Settled means an error of at most this, deg.
    pub settle_tolerance_deg: f64,
    /// The root mean square is taken over the last so many seconds.
    pub tail_s: f64,
    /// What is required.
    pub requirements: Vec<RequirementFile>,
}

/// One controller.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ControllerRow {
    /// Its name in tables and figures.
    pub label: String,
    /// The controller as text.
    pub controller: String,
    /// When the sensor is sampled, as text.
    pub sampling: String,
    /// The answer without a standard fault.
    pub verdict: RunVerdict,
    /// What a certificate says of the run without a standard fault; null without a design.
    pub proof: Option<String>,
    /// Whether the proof covers that run; null without a design.
    pub proof_covers: Option<bool>,
    /// The compared metrics, each under its key.
    #[serde(flatten, serialize_with = "by_key")]
    pub metrics: Vec<MetricValue>,
    /// What the link to the actuators carried, where there is one.
    pub link: Option<LinkOutcome>,
    /// The runs with a standard fault.
    pub faults: Vec<FaultOutcome>,
    /// Number of them that were survived.
    pub faults_survived: usize,
    /// What else is worth saying.
    pub notes: Vec<String>,
    /// SHA-256 of the scenario file.
    pub scenario_sha256: String,
    /// SHA-256 of the design file.
    pub design_sha256: Option<String>,
}

/// A run with a standard fault.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaultOutcome {
    /// Name of the fault.
    pub name: String,
    /// Whether the run met every requirement (the settling tolerance when there is none) and stayed
    /// within the controller's prescribed bounds.
    pub survived: bool,
    /// Why not; empty when survived.
    pub reason: String,
    /// Time from which on the error stays within the tolerance, s.
    pub settle_seconds: Option<f64>,
    /// Attitude error at the end, deg.
    pub final_error_deg: Option<f64>,
    /// Root mean square of the attitude error over the tail, deg.
    pub rms_error_deg: Option<f64>,
    /// First time outside of the prescribed bounds, s.
    pub left_bounds_s: Option<f64>,
    /// What a certificate says of this run; null without a design.
    pub proof: Option<String>,
}

impl FaultOutcome {
    /// Judges a run with a fault.
    pub(super) fn new(name: &str, summary: &Summary) -> Self {
        let left_bounds_s = summary.funnel.as_ref().and_then(|f| f.first_outside_s);
        let reason = reason(summary, left_bounds_s);
        Self {
            name: name.to_string(),
            survived: reason.is_none(),
            reason: reason.unwrap_or_default(),
            settle_seconds: summary.settle_seconds,
            final_error_deg: summary.final_error_deg,
            rms_error_deg: summary.rms_error_deg,
            left_bounds_s,
            proof: summary
                .certificate
                .as_ref()
                .map(CertificateOutcome::as_text),
        }
    }
}

/// Why a run was not survived.
fn reason(summary: &Summary, left_bounds_s: Option<f64>) -> Option<String> {
    match summary.verdict {
        RunVerdict::Diverged => return Some("diverged".to_string()),
        RunVerdict::ProofBroken => return Some("a proved bound was broken".to_string()),
        RunVerdict::RequirementsMet | RunVerdict::RequirementsMissed => {}
    }
    if let Some(time) = left_bounds_s {
        return Some(format!("left its prescribed bounds at {time:.2} s"));
    }
    if summary.requirements.is_empty() && summary.settle_seconds.is_none() {
        return Some("did not settle".to_string());
    }
    let missed = summary.requirements.iter().find(|outcome| !outcome.met)?;
    Some(missed.as_text())
}

/// The compared metrics of a run, then the steps outside of a bound, which no table shows.
pub(super) fn compared_metrics(summary: &Summary) -> Vec<MetricValue> {
    let shown = compared().into_iter().map(|entry| entry.metric);
    let all = shown.chain([Metric::Violations]);
    all.map(|metric| (metric, summary.metric(metric))).collect()
}

impl ControllerRow {
    /// The metrics that tables show.
    pub fn shown(&self) -> &[MetricValue] {
        let shown = self.metrics.len().saturating_sub(1);
        &self.metrics[..shown]
    }
}

impl Comparison {
    /// Comma-separated values: one row for each controller, one column for each metric and fault.
    pub fn to_csv(&self) -> String {
        let text = |value: Option<String>| value.unwrap_or_default();
        let mut header = ["label", "verdict", "proof_covers"]
            .map(str::to_string)
            .to_vec();
        header.extend(compared().iter().map(|entry| entry.key.to_string()));
        header.extend(["faults_survived", "link_bits", "link_bytes"].map(str::to_string));
        header.extend(self.faults.iter().map(|(name, _)| format!("fault_{name}")));
        let mut csv = header.join(",") + "\n";
        for row in &self.runs {
            let covers = row.proof_covers.map(|covers| covers.to_string());
            let verdict = row.verdict.name().to_string();
            let mut cells = vec![quoted(&row.label), verdict, text(covers)];
            let shown = row.shown().iter().map(|(_, value)| *value);
            cells.extend(shown.map(|value| text(value.map(|value| value.to_string()))));
            cells.push(row.faults_survived.to_string());
            let link = row.link.as_ref();
            cells.push(text(link.map(|link| link.bits.to_string())));
            cells.push(text(link.map(|link| link.bytes.to_string())));
            let outcomes = row.faults.iter();
            cells.extend(outcomes.map(|outcome| u8::from(outcome.survived).to_string()));
            csv += &(cells.join(",") + "\n");
        }
        csv
    }

    /// The table as text: one column for each controller.
    pub fn to_text(&self) -> String {
        let line = |head: &str, cell: &dyn Fn(&ControllerRow) -> String| -> Vec<String> {
            let cells = self.runs.iter().map(cell);
            std::iter::once(head.to_string()).chain(cells).collect()
        };
        let mut lines = vec![
            line("", &|row| row.label.clone()),
            line("verdict", &|row| row.verdict.name().to_string()),
        ];
        for (index, entry) in compared().iter().enumerate() {
            lines.push(line(entry.key, &|row| match row.shown()[index].1 {
                Some(whole) if whole.fract() == 0.0 => whole.to_string(),
                value => entry.text(value),
            }));
        }
        let total = self.faults.len();
        lines.push(line("proof_covers", &|row| {
            let words = row
                .proof_covers
                .map(|covers| if covers { "yes" } else { "no" });
            words.unwrap_or("nothing proved").to_string()
        }));
        if total > 0 {
            let survived = |row: &ControllerRow| format!("{} of {total}", row.faults_survived);
            lines.push(line("faults_survived", &survived));
        }
        for (index, (name, _)) in self.faults.iter().enumerate() {
            lines.push(line(&format!("  {name}"), &|row| {
                let survived = row
                    .faults
                    .get(index)
                    .is_some_and(|outcome| outcome.survived);
                if survived { "yes" } else { "NO" }.to_string()
            }));
        }
        aligned(&lines)
    }
}

/// Columns of equal width, the first to the left and the others to the right.
fn aligned(lines: &[Vec<String>]) -> String {
    let columns = lines.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = lines.iter().filter_map(|line| line.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let rows = lines.iter().map(|line| {
        let cells = line.iter().zip(&widths).enumerate();
        let cells = cells.map(|(index, (cell, &width))| match index {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_string()
    });
    rows.collect::<Vec<_>>().join("\n")
}
