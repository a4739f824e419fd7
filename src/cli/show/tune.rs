//! A parameter search.
use synth::claim::Claim;

use crate::batch::tune::report::{RunReport, TuneReport};

/// What the search found, and the runs that miss a requirement.
pub fn lines(report: &TuneReport) -> Vec<String> {
    let training = match report.training_met {
        true => "every training run meets the requirements with a margin",
        false => "some training run does not meet the requirements with a margin",
    };
    let mut lines = vec![
        format!("requirements: {}", report.name),
        format!(
            "shortest turn that any controller could make: {:.5} s",
            Claim::AtLeast(report.least_time_s)
        ),
        format!("candidates tried: {}; {training}", report.candidates),
        format!(
            "validation: {} of {} random axes meet every requirement over {} s, with and without the disturbance",
            report.axes_met, report.axes, report.duration_s
        ),
    ];
    lines.extend(report.runs.iter().filter(|run| !run.met).map(missed));
    lines
}

fn missed(run: &RunReport) -> String {
    let [x, y, z] = run.axis;
    let disturbance = if run.disturbed { "with" } else { "without" };
    let what = run.missed.iter().map(|one| one.as_text());
    let what = match what.collect::<Vec<_>>() {
        none if none.is_empty() => "the run diverged or could not be made".to_string(),
        all => all.join("; "),
    };
    format!("  missed about [{x:.3}, {y:.3}, {z:.3}] {disturbance} disturbance: {what}")
}
