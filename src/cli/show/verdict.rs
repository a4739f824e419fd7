//! The verdict of a proof.

use serde::Serialize;
use synth::certify::{ConditionMargin, Report, Verdict};

/// What was proved of a design, and under which assumptions.
#[derive(Debug, Serialize)]
pub struct ProofReport<'a> {
    /// Whether every condition is proved.
    pub verdict: Verdict,
    /// The condition with the smallest margin.
    worst: Option<&'a ConditionMargin>,
    /// Every condition.
    conditions: &'a [ConditionMargin],
    /// The assumptions.
    not_covered: &'a [String],
}

impl<'a> ProofReport<'a> {
    /// From the outcome of the check.
    pub fn new(report: &'a Report) -> Self {
        ProofReport {
            verdict: report.verdict,
            worst: report.worst(),
            conditions: &report.conditions,
            not_covered: &report.not_covered,
        }
    }

    /// In words, with a remark on the line of the verdict where there is one. What is not proved claims nothing
    /// and ends with its verdict.
    pub fn lines(&self, remark: Option<&str>) -> Vec<String> {
        let worst = self.worst;
        let mut lines = Vec::new();
        if self.verdict == Verdict::Proved {
            let remark = remark.map_or(String::new(), |remark| format!(", {remark}"));
            lines.push(format!("verdict: PROVED{remark}"));
        }
        lines.extend(worst.map(|worst| format!("worst condition: {}", margin(worst))));
        lines.extend(not_proved(self.conditions));
        lines.push(format!("{} conditions checked", self.conditions.len()));
        match self.verdict {
            Verdict::Proved => {
                lines.push("the proof assumes:".to_string());
                lines.extend(self.not_covered.iter().map(|item| format!("  - {item}")));
            }
            Verdict::NotProved => lines.push("verdict: NOT PROVED".to_string()),
        }
        lines
    }
}

/// One line for each condition that is not proved.
pub fn not_proved<'a>(conditions: impl IntoIterator<Item = &'a ConditionMargin>) -> Vec<String> {
    let failed = conditions.into_iter();
    let failed = failed.filter(|condition| condition.margin < 0.0);
    let line = |condition| format!("  not proved: {}", margin(condition));
    failed.map(line).collect()
}

fn margin(condition: &ConditionMargin) -> String {
    format!("{}, margin {:.3e}", condition.name, condition.margin)
}
