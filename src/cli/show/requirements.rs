//! Requirements with what is proved of each.

use std::path::Path;

use serde::Serialize;
use synth::certify::Verdict;
use synth::claim::Claim;
use synth::requirements::{Answered, Best, Candidate, Facts, Suggestion};

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
    /// Stopped by the user before every way was tried.
    stopped: bool,
    /// Whether no design exists, as the disturbance reaches the smallest torque limit.
    disturbance_reaches_torque: bool,
    /// Bound on the disturbance and smallest torque limit (N m).
    #[serde(skip)]
    torques_nm: [f64; 2],
    /// Each requirement with what is proved by the best design found; null where none was found.
    requirements: Option<&'a [Answered]>,
    /// The smallest fraction of a requirement that it meets; null where none was found.
    fraction: Option<f64>,
    /// Changes of one quantity each with which every requirement was proved.
    changes: &'a [Suggestion],
}

impl<'a> MissedReport<'a> {
    /// From the best design and the changes that help.
    pub fn new(facts: &Facts, best: &'a Best, changes: &'a [Suggestion]) -> Self {
        let found = best.candidate.as_ref();
        let craft = facts.craft();
        MissedReport {
            verdict: Verdict::NotProved,
            stopped: best.stopped,
            disturbance_reaches_torque: facts.is_overwhelmed(),
            torques_nm: [craft.disturbance_bound_nm, facts.weakest_torque()],
            requirements: found.map(|found| found.answered.as_slice()),
            fraction: found.map(Candidate::fraction),
            changes,
        }
    }

    /// In words.
    pub fn lines(&self, path: &Path) -> Vec<String> {
        let title = match self.fraction {
            _ if self.disturbance_reaches_torque => {
                let [disturbance, weakest] = self.torques_nm.map(short);
                format!(
                    "{}: NO DESIGN: a disturbance of {disturbance} N m, held along an axis with {weakest} N m of torque, takes the momentum beyond \
                     every bound",
                    path.display()
                )
            }
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
            let fields = change.fields.iter().map(|one| {
                let values: Vec<String> = one.values.iter().map(|&value| short(value)).collect();
                format!("{} = {}", one.field, values.join(", "))
            });
            let fields: Vec<String> = fields.collect();
            format!("  {}", fields.join(" and "))
        });
        out.extend(titled(
            "with one of these changes every requirement is proved:",
            changes,
        ));
        out.extend(
            self.stopped
                .then(|| "stopped before every way was tried".to_string()),
        );
        if self.changes.is_empty() && !self.stopped {
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
        let required = format!("requirement {} {side} {}", one.requirement, one.required);
        match one.proved.is_finite() {
            true => format!("{required}: {proved} proved, {met}"),
            false => format!("{required}: nothing proved, {met}"),
        }
    };
    answered.iter().map(line).collect()
}
