//! Requirements with what is proved of each.

use std::path::Path;

use serde::Serialize;
use synth::certify::Verdict;
use synth::claim::Claim;
use synth::requirements::{Answered, Candidate, Suggestion};

use super::design::SynthesisReport;
use super::facts::titled;
use crate::base::number::short;

/// A design that meets every requirement.
#[derive(Debug, Serialize)]
pub struct RequirementsReport<'a> {
    /// Each requirement with its proved value.
    pub requirements: &'a [Answered],
    /// The design.
    #[serde(flatten)]
    pub design: SynthesisReport<'a>,
}

/// No design that meets every requirement.
#[derive(Debug, Serialize)]
pub struct MissedReport<'a> {
    /// Always `not_proved`.
    verdict: Verdict,
    /// Each requirement with what is proved by the best design found; null where none was found.
    requirements: Option<&'a [Answered]>,
    /// The smallest fraction of a requirement that it meets; null where none was found.
    fraction: Option<f64>,
    /// Changes of one quantity each with which every requirement was proved.
    changes: &'a [Suggestion],
}

impl<'a> MissedReport<'a> {
    /// From the best design and the changes that help.
    pub fn new(found: Option<&'a Candidate>, changes: &'a [Suggestion]) -> Self {
        MissedReport {
            verdict: Verdict::NotProved,
            requirements: found.map(|found| found.answered.as_slice()),
            fraction: found.map(Candidate::fraction),
            changes,
        }
    }

    /// In words.
    pub fn lines(&self, path: &Path) -> Vec<String> {
        let title = match self.fraction {
            Some(fraction) => format!(
                "{}: UNDECIDED: no design that meets every requirement was found; the best one meets {:.2} % of the \
                 hardest",
                path.display(),
                Claim::AtLeast(100.0 * fraction)
            ),
            None => format!(
                "{}: UNDECIDED: no design was found, and none was proved not to exist",
                path.display()
            ),
        };
        let mut out = vec![title];
        out.extend(self.requirements.map_or(Vec::new(), lines));
        let changes = self.changes.iter().map(|change| {
            let values: Vec<String> = change.values.iter().map(|&value| short(value)).collect();
            format!("  {} = {}", change.field, values.join(", "))
        });
        out.extend(titled(
            "with one of these changes every requirement is proved:",
            changes,
        ));
        if self.changes.is_empty() {
            out.push(
                "no change of torque, disturbance or sampling that was tried meets them".into(),
            );
        }
        out
    }
}

/// One line for each requirement.
pub fn lines(answered: &[Answered]) -> Vec<String> {
    let line = |one: &Answered| {
        let (side, proved) = match one.at_least {
            true => ("at least", Claim::AtLeast(one.proved)),
            false => ("at most", Claim::AtMost(one.proved)),
        };
        let met = match one.is_met() {
            true => "met",
            false => "missed",
        };
        format!(
            "requirement {} {side} {}: {proved} proved, {met}",
            one.requirement, one.required
        )
    };
    answered.iter().map(line).collect()
}
