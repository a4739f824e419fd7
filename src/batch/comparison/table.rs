//! The table of a comparison.

use serde::Serialize;

use crate::batch::verdict::verdict_name;
use crate::run::summary::{RunVerdict, Summary};
use crate::scenario::RequirementFile;
use crate::sim::link::LinkOutcome;

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
    pub runs: Vec<Row>,
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
pub struct Row {
    /// Its name in tables and figures.
    pub label: String,
    /// The controller in words.
    pub controller: String,
    /// When the sensor is sampled, in words.
    pub sampling: String,
    /// The answer without a standard fault.
    pub verdict: RunVerdict,
    /// What a certificate says of the run without a standard fault; null without a design.
    pub proof: Option<String>,
    /// Time from which on the error stays within the tolerance, s.
    pub settle_seconds: Option<f64>,
    /// Attitude error at the end, deg.
    pub final_error_deg: Option<f64>,
    /// Root mean square of the attitude error over the tail, deg.
    pub rms_error_deg: Option<f64>,
    /// Largest norm of the body rate, rad/s.
    pub max_rate: Option<f64>,
    /// Largest torque of any axis, N m.
    pub max_torque: f64,
    /// Integral of the magnitudes of all axes' torques, N m s.
    pub impulse: f64,
    /// Changes of the torque that acts.
    pub updates: u64,
    /// Messages of the controller.
    pub triggers: u64,
    /// Their bits.
    pub bits: u64,
    /// Their bytes.
    pub bytes: u64,
    /// Shortest time between two messages, s.
    pub shortest_interval_s: Option<f64>,
    /// Mean time between two messages, s.
    pub mean_interval_s: Option<f64>,
    /// Largest share of the prescribed bounds on the error, for a controller that has them.
    pub funnel_ratio: Option<f64>,
    /// Steps at which a claim or a prescribed bound was broken.
    pub violations: u64,
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
    let value = missed.value;
    let value = value.map_or("none".to_string(), |value| format!("{value:.4}"));
    Some(format!("{} {}: {value}", missed.name, missed.limit))
}

/// Name of a line of the table and its value for a controller.
type Line = (&'static str, fn(&Row) -> String);

/// The lines of the table, in the order of every output.
pub(crate) const LINES: [Line; 14] = [
    ("settle_seconds", |row| optional(row.settle_seconds)),
    ("final_error_deg", |row| optional(row.final_error_deg)),
    ("rms_error_deg", |row| optional(row.rms_error_deg)),
    ("max_rate", |row| optional(row.max_rate)),
    ("max_torque", |row| row.max_torque.to_string()),
    ("impulse", |row| row.impulse.to_string()),
    ("updates", |row| row.updates.to_string()),
    ("triggers", |row| row.triggers.to_string()),
    ("bits", |row| row.bits.to_string()),
    ("bytes", |row| row.bytes.to_string()),
    ("shortest_interval_s", |row| {
        optional(row.shortest_interval_s)
    }),
    ("mean_interval_s", |row| optional(row.mean_interval_s)),
    ("funnel_ratio", |row| optional(row.funnel_ratio)),
    ("faults_survived", |row| row.faults_survived.to_string()),
];

fn optional(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

impl Comparison {
    /// Comma-separated values: one row for each controller, one column for each metric and fault.
    pub fn to_csv(&self) -> String {
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
        let mut header = vec!["label".to_string(), "verdict".to_string()];
        header.extend(LINES.iter().map(|(name, _)| name.to_string()));
        header.extend(["link_bits".to_string(), "link_bytes".to_string()]);
        header.extend(self.faults.iter().map(|(name, _)| format!("fault_{name}")));
        let mut text = header.join(",") + "\n";
        for row in &self.runs {
            let mut cells = vec![quoted(&row.label), verdict_name(row.verdict).to_string()];
            cells.extend(LINES.iter().map(|(_, value)| value(row)));
            let link = |count: fn(&LinkOutcome) -> u64| {
                row.link
                    .as_ref()
                    .map_or(String::new(), |link| count(link).to_string())
            };
            cells.extend([link(|link| link.bits), link(|link| link.bytes)]);
            let outcomes = row.faults.iter();
            cells.extend(outcomes.map(|outcome| u8::from(outcome.survived).to_string()));
            text += &(cells.join(",") + "\n");
        }
        text
    }

    /// The table as text: one column for each controller.
    pub fn to_text(&self) -> String {
        let mut lines: Vec<Vec<String>> = Vec::new();
        let labels = self.runs.iter().map(|row| row.label.clone());
        lines.push(std::iter::once(String::new()).chain(labels).collect());
        let verdicts = self
            .runs
            .iter()
            .map(|row| verdict_name(row.verdict).to_string());
        lines.push(
            std::iter::once("verdict".to_string())
                .chain(verdicts)
                .collect(),
        );
        for (name, value) in LINES {
            let total = self.faults.len();
            if name == "faults_survived" && total == 0 {
                continue;
            }
            let cells = self.runs.iter().map(|row| match name {
                "faults_survived" => format!("{} of {total}", row.faults_survived),
                _ => short(&value(row)),
            });
            lines.push(std::iter::once(name.to_string()).chain(cells).collect());
        }
        for (index, (name, _)) in self.faults.iter().enumerate() {
            let cells = self.runs.iter().map(|row| match row.faults.get(index) {
                Some(outcome) if outcome.survived => "yes".to_string(),
                _ => "NO".to_string(),
            });
            let name = format!("  {name}");
            lines.push(std::iter::once(name).chain(cells).collect());
        }
        aligned(&lines)
    }
}

/// A number of a table with five significant digits.
fn short(text: &str) -> String {
    match text.parse::<f64>() {
        _ if text.is_empty() => "none".to_string(),
        Ok(value) if text.contains(['.', 'e']) => crate::base::number::short(value),
        _ => text.to_string(),
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
