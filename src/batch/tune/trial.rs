//! One run of a candidate, and how far it is from the requirements.

use std::sync::atomic::AtomicBool;
use std::sync::Arc;

use nalgebra::Vector3;

use super::file::{Requirements, Start};
use super::shape::{scenario, Shape};
use crate::batch::engine::{Interrupted, Job};
use crate::run::simulate;
use crate::run::summary::{RequirementOutcome, RunVerdict, Summary};
use crate::scenario::Scenario;
use crate::sim::metrics::Metric;

/// Each axis with the disturbance off and on.
pub(crate) fn starts(axes: &[Vector3<f64>]) -> Vec<Start> {
    let both = |axis: &Vector3<f64>| {
        let axis = *axis;
        [false, true].map(|disturbed| Start { axis, disturbed })
    };
    axes.iter().flat_map(both).collect()
}

/// One run.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Its start.
    pub start: Start,
    /// Its summary; `None` when the parameters are no valid controller.
    pub summary: Option<Summary>,
    /// How far the run is from meeting every requirement with a margin: 0 when it does.
    pub penalty: f64,
}

/// Fraction of a limit that the search asks for, where chance decides by how much it is met.
const AIM: f64 = 0.97;
/// Penalty of a requirement whose metric the run does not have, and the largest of one that it misses.
const ABSENT: f64 = 5.0;
/// Penalty of a run that diverged or could not be made.
const BROKEN: f64 = 100.0;

/// Metrics that the trigger and the start hold at their limits, whatever the parameters.
const AT_THE_LIMIT: [Metric; 2] = [Metric::FunnelRatio, Metric::ThresholdRatio];

impl Trial {
    /// Runs a candidate from a start.
    pub fn new(requirements: &Requirements, shape: &Shape, start: Start) -> Self {
        let file = scenario(requirements, shape, &start);
        // The hash is that of a text; a trial has none.
        let run = Scenario::from_file(&file, String::new()).ok();
        let outcome = run.and_then(|scenario| simulate(&scenario, None, false).ok());
        let summary = outcome.map(|outcome| outcome.summary);
        Trial {
            start,
            penalty: match &summary {
                Some(summary) if summary.verdict != RunVerdict::Diverged => {
                    let outcomes = summary.requirements.iter().zip(&file.requirements);
                    outcomes
                        .map(|(outcome, required)| excess(outcome, required.metric))
                        .sum()
                }
                _ => BROKEN,
            },
            summary,
        }
    }

    /// Whether every requirement is met.
    pub fn met(&self) -> bool {
        let verdict = self.summary.as_ref().map(|summary| summary.verdict);
        verdict == Some(RunVerdict::RequirementsMet)
    }

    /// Requirements that are missed.
    pub fn missed(&self) -> impl Iterator<Item = &RequirementOutcome> {
        let summary = self.summary.iter();
        let all = summary.flat_map(|summary| &summary.requirements);
        all.filter(|outcome| !outcome.met)
    }
}

/// By how much of its limit a metric misses it.
fn excess(outcome: &RequirementOutcome, metric: Metric) -> f64 {
    let aim = match AT_THE_LIMIT.contains(&metric) {
        true => 1.0,
        false => AIM,
    };
    let ratio = outcome.value.map(|value| value / (aim * outcome.limit));
    ratio.map_or(ABSENT, |ratio| (ratio - 1.0).clamp(0.0, ABSENT))
}

/// The runs of a candidate.
pub(super) struct TrialJob<'a> {
    pub requirements: &'a Requirements,
    pub shape: &'a Shape,
    pub starts: &'a [Start],
}

impl Job for TrialJob<'_> {
    type Record = Trial;
    type Error = Interrupted;

    fn run(&self, index: u64, _stop: &Arc<AtomicBool>) -> Result<Trial, Interrupted> {
        let start = self.starts[index as usize];
        Ok(Trial::new(self.requirements, self.shape, start))
    }
}
