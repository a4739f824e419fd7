//! The verdict of a proof as text.

use synth::certify::{ConditionMargin, Report, Verdict};

/// The verdict as text, with a remark on its line where there is one. What is not proved claims nothing and ends
/// with its verdict.
pub fn describe(report: &Report, remark: Option<&str>) -> String {
    let failed = report.conditions.iter();
    let failed = failed.filter(|condition| condition.margin < 0.0);
    let failed = failed.map(|condition| format!("  not proved: {}", describe_margin(condition)));
    let worst = report.worst();
    let worst = worst.map(|worst| format!("worst condition: {}", describe_margin(worst)));
    let count = format!("{} conditions checked", report.conditions.len());
    let mut lines: Vec<String> = worst.into_iter().chain(failed).chain([count]).collect();
    match report.verdict {
        Verdict::Proved => {
            let remark = remark.map_or(String::new(), |remark| format!(", {remark}"));
            lines.insert(0, format!("verdict: PROVED{remark}"));
            lines.push("the proof assumes:".to_string());
            lines.extend(report.not_covered.iter().map(|item| format!("  - {item}")));
        }
        Verdict::NotProved => lines.push("verdict: NOT PROVED".to_string()),
    }
    lines.join("\n")
}

fn describe_margin(condition: &ConditionMargin) -> String {
    format!("{}, margin {:.3e}", condition.name, condition.margin)
}
