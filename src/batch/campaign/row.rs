//! One run as a row of the tables.

use std::cmp::Ordering;

use crate::run::outcome::RunOutcome;
use crate::run::summary::{RunVerdict, Summary};
use crate::scenario::{RequirementFile, Scenario};
use crate::sim::metrics::METRICS;

/// What is known of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRow {
    /// Its index.
    pub run: u64,
    /// Seed of its noise, jitter and losses.
    pub seed: u64,
    /// The answer.
    pub verdict: RunVerdict,
    /// Whether the design's proof covers it.
    pub proof_covers: Option<bool>,
    /// x'Ux at the start.
    pub start_level: Option<f64>,
    /// The requirement with the smallest margin, and its margin.
    pub worst: Option<(String, f64)>,
    /// One value for each of [`METRICS`].
    pub metrics: Vec<Option<f64>>,
    /// The drawn numbers, in the order of the campaign's columns.
    pub drawn: Vec<Option<f64>>,
    /// The profile, one quantity after the other; not a number where the run had ended.
    pub profile: Vec<f32>,
}

impl RunRow {
    /// The row of a run of a scenario with these drawn numbers.
    pub fn new(
        run: u64,
        scenario: &Scenario,
        drawn: Vec<Option<f64>>,
        outcome: RunOutcome,
    ) -> Self {
        let summary = &outcome.summary;
        let certificate = summary.certificate.as_ref();
        let metrics = METRICS.iter().map(|entry| summary.metric(entry.metric));
        let finite = metrics.map(|value| value.filter(|value| value.is_finite()));
        RunRow {
            run,
            seed: scenario.seed,
            verdict: summary.verdict,
            proof_covers: certificate.map(|outcome| outcome.covers_run),
            start_level: certificate.map(|outcome| outcome.start_level),
            worst: worst(summary, &scenario.requirements),
            metrics: finite.collect(),
            drawn,
            profile: outcome.profile,
        }
    }

    /// Whether every requirement is met.
    pub fn passed(&self) -> bool {
        self.verdict == RunVerdict::RequirementsMet
    }
}

/// How bad a run is.
#[derive(Debug, Clone, Copy)]
pub struct Rank {
    severity: usize,
    margin: f64,
    /// The run.
    pub run: u64,
}

impl Rank {
    /// Of a run with this verdict and this smallest margin of a requirement, where it has one.
    pub fn new(verdict: RunVerdict, margin: Option<f64>, run: u64) -> Self {
        Rank {
            severity: verdict.severity(),
            margin: margin.unwrap_or(0.0),
            run,
        }
    }

    /// The order of two runs, the worse one first.
    pub fn compare(&self, other: &Self) -> Ordering {
        let severity = self.severity.cmp(&other.severity);
        let margin = self.margin.total_cmp(&other.margin);
        severity.then(margin).then(self.run.cmp(&other.run))
    }
}

/// The requirement with the smallest margin relative to its limit. Nothing can be close to a limit of 0 that is met,
/// such as that of a count that must be 0: such a requirement counts where there is no other only.
fn worst(summary: &Summary, requirements: &[RequirementFile]) -> Option<(String, f64)> {
    let outcomes = summary.requirements.iter().zip(requirements);
    let margins: Vec<(bool, &String, f64)> = outcomes
        .filter_map(|(outcome, requirement)| {
            let margin = requirement.limit()?.margin(outcome.value);
            let counts = outcome.limit != 0.0 || !outcome.met;
            Some((counts, &outcome.name, margin))
        })
        .collect();
    let smallest = |counted: bool| {
        let margins = margins.iter().filter(|(counts, ..)| *counts == counted);
        margins.min_by(|a, b| a.2.total_cmp(&b.2))
    };
    let worst = smallest(true).or_else(|| smallest(false));
    worst.map(|(_, name, margin)| ((*name).clone(), *margin))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_run_is_first() {
        let rank = |severity, margin, run| Rank {
            severity,
            margin,
            run,
        };
        let mut ranks = [
            rank(3, 0.1, 1),
            rank(2, -0.1, 9),
            rank(2, -0.1, 2),
            rank(2, f64::NEG_INFINITY, 7),
            rank(0, 1.0, 8),
        ];
        ranks.sort_by(Rank::compare);
        assert_eq!(ranks.map(|rank| rank.run), [8, 7, 2, 9, 1]);
    }
}
