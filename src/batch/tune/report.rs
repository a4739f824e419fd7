//! What a search found.

use serde::{Serialize, Serializer};
use serde_json::json;

use super::file::Requirements;
use super::limits::least_time_s;
use super::search::Search;
use super::shape::{Number, COUNT};
use super::trial::Trial;
use crate::base::provenance::GENERATOR;
use crate::controllers::lei2022::LeiFile;
use crate::controllers::ControllerFile;
use crate::run::summary::RequirementOutcome;
use crate::scenario::ScenarioFile;
use crate::sim::metrics::{by_key, Metric, MetricValue};

/// The answer of a search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TuneReport {
    /// Name of the requirements.
    pub name: String,
    /// Program and version.
    pub generator: String,
    /// Seed of the axes.
    pub seed: u64,
    /// Candidates tried.
    pub candidates: usize,
    /// Whether every run of the training set meets the requirements with a margin.
    pub training_met: bool,
    /// Axes, unseen by the search, on which the result was tried.
    pub axes: usize,
    /// Those on which every requirement is met, with the disturbance and without.
    pub axes_met: usize,
    /// Length of every run, s.
    pub duration_s: f64,
    /// The shortest time in which any controller could make the turn, s.
    pub least_time_s: f64,
    /// The parameters, for the start of the scenario that is written. From another start only rho_0
    /// and S2(0), and with it beta, differ.
    pub parameters: Option<LeiFile>,
    /// The numbers of the shape, by name.
    pub shape: [Number; COUNT],
    /// Every run.
    pub runs: Vec<RunReport>,
}

/// One validation run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunReport {
    /// Axis of the turn.
    pub axis: [f64; 3],
    /// Whether the disturbance acts.
    pub disturbed: bool,
    /// Whether every requirement is met.
    pub met: bool,
    /// The requirements that are missed.
    #[serde(serialize_with = "without_met")]
    pub missed: Vec<RequirementOutcome>,
    /// The [`REPORTED`] metrics, each under its key; null where the run could not be made.
    #[serde(flatten, serialize_with = "by_key")]
    pub metrics: Vec<MetricValue>,
}

/// Metrics of a validation run.
pub const REPORTED: [Metric; 5] = [
    Metric::SettleSeconds,
    Metric::TailErrorDeg,
    Metric::MaxRate,
    Metric::TurnOns,
    Metric::Impulse,
];

/// Writes the name, value and limit of requirements, all of which are missed.
fn without_met<S: Serializer>(
    missed: &[RequirementOutcome],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let parts = missed.iter();
    let parts =
        parts.map(|one| json!({ "name": one.name, "value": one.value, "limit": one.limit }));
    serializer.collect_seq(parts)
}

impl TuneReport {
    /// The report of a search whose result was tried on `axes` unseen axes.
    pub fn new(
        requirements: &Requirements,
        search: &Search,
        scenario: &ScenarioFile,
        axes: usize,
        trials: Vec<Trial>,
    ) -> Self {
        let per_axis = trials.chunks(trials.len() / axes.max(1));
        let met = per_axis.filter(|trials| trials.iter().all(Trial::met));
        TuneReport {
            name: requirements.file.name.clone(),
            generator: GENERATOR.to_string(),
            seed: requirements.file.search.seed,
            candidates: search.candidates,
            training_met: search.penalty == 0.0,
            axes,
            axes_met: met.count(),
            duration_s: requirements.duration_s,
            least_time_s: least_time_s(requirements),
            parameters: match &scenario.controller {
                ControllerFile::Lei2022(file) => Some((**file).clone()),
                _ => None,
            },
            shape: search.shape.numbers,
            runs: trials.iter().map(run_report).collect(),
        }
    }

    /// Whether every axis met every requirement.
    pub fn met(&self) -> bool {
        self.axes_met == self.axes
    }
}

fn run_report(trial: &Trial) -> RunReport {
    let summary = trial.summary.as_ref();
    RunReport {
        axis: trial.start.axis.into(),
        disturbed: trial.start.disturbed,
        met: trial.met(),
        missed: trial.missed().cloned().collect(),
        metrics: REPORTED
            .map(|metric| (metric, summary.and_then(|summary| summary.metric(metric))))
            .into(),
    }
}
