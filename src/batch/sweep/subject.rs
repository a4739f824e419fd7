//! What is swept: a scenario, which is run at each point, or a model, which is synthesized.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use nalgebra::DMatrix;
use serde::de::DeserializeOwned;
use serde::Serialize;
use serde_json::{Number, Value};
use synth::certify::{Report, Verdict};
use synth::claim::Claim;
use synth::feasibility::Decision;
use synth::model::{kind_of, parse, FileError, Kind, Model, Objective};
use synth::solve::{Observer, Solver, Structured};
use synth::synthesis::{self, Outcome, Solvers, Synthesized};

use super::outcome::{numbers_of, PointOutcome, INVALID};
use crate::base::unit::unit_of_key;
use crate::batch::variation::grid::Grid;
use crate::run::design::{certified_angle_deg, Design};
use crate::run::simulate;
use crate::run::summary::{RunVerdict, Summary};
use crate::scenario::{Scenario, ScenarioFile};
use crate::sim::metrics::{MetricKind, METRICS};

/// What is swept.
pub struct Subject {
    /// The file, with every default, so that what it leaves out can be varied too.
    pub file: Value,
    work: Work,
}

/// What is done at each point.
enum Work {
    /// A scenario is run, with the design of its controller, if it has one.
    Run(Option<Box<Design>>),
    /// A model is synthesized with these solvers.
    Synthesis(Solvers),
}

/// Conditions that block a synthesis, as many as a row names.
const BLOCKING: usize = 3;

impl Subject {
    /// A scenario, which must be valid, with its design.
    pub fn scenario(file: &ScenarioFile, design: Option<Box<Design>>) -> Self {
        Subject {
            file: value_of(file),
            work: Work::Run(design),
        }
    }

    /// A model with the solvers that may be asked.
    pub fn model(model: &Model, solvers: Solvers) -> Self {
        Subject {
            file: value_of(&model.file),
            work: Work::Synthesis(solvers),
        }
    }

    /// Whether a text is a scenario's.
    pub fn is_scenario(text: &str) -> bool {
        kind_of(text) == Some(Kind::Scenario)
    }

    /// Kind of the file.
    pub fn kind(&self) -> Kind {
        match &self.work {
            Work::Run(_) => Kind::Scenario,
            Work::Synthesis(_) => Kind::Model,
        }
    }

    /// SHA-256 of the design's file, for a scenario that has one.
    pub fn design_sha256(&self) -> Option<&str> {
        match &self.work {
            Work::Run(design) => Some(&design.as_ref()?.sha256),
            Work::Synthesis(_) => None,
        }
    }

    /// The solvers with the forms of their problems, for a model.
    pub fn solver(&self) -> Option<String> {
        match &self.work {
            Work::Run(_) => None,
            Work::Synthesis(solvers) => Some(solvers.names()),
        }
    }

    /// Unit of a number that is varied or of a metric; empty where it has none.
    pub fn unit(&self, name: &str) -> &'static str {
        let body = self.file.pointer("/system/rigid_body").is_some();
        let metric = METRICS.iter().find(|entry| entry.key == name);
        match metric {
            Some(entry) if body || entry.kind != MetricKind::Effort => entry.unit,
            _ => unit_of_last_key(name),
        }
    }

    /// Solves the file's own model once, for the points to start from: the structured solver can, and as
    /// that start is the same for every point, points do not depend on each other. A search takes too long
    /// for that.
    pub fn prepare(&mut self, stop: &Arc<AtomicBool>) {
        let Work::Synthesis(solvers) = &mut self.work else {
            return;
        };
        let (backend, form) = solvers.first();
        if backend.solver() != Some(Solver::Structured) {
            return;
        }
        let model = model_of(&self.file).ok();
        if let Some(model) = model.filter(is_one_design) {
            let (text, warm) = (self.file.to_string(), Structured::warm());
            let own = Solvers::only(warm.clone(), form);
            // Whatever comes of it: where nothing is remembered, points start cold.
            let _ = synthesis::synthesize(&model, &text, &own, Some(until(stop)));
            solvers.begin_with(warm.frozen(), form);
        }
    }

    /// Runs the point with these values, in the order of the axes. A synthesis ends early when `stop` is set;
    /// its outcome is of no use then.
    pub fn run(&self, grid: &Grid, values: &[f64], stop: &Arc<AtomicBool>) -> PointOutcome {
        let file = grid.apply(&self.file, values);
        let found = file.map_err(|error| error.to_string());
        let found = found.and_then(|file| match &self.work {
            Work::Run(design) => run_scenario(&file, design.as_deref()),
            Work::Synthesis(solvers) => run_model(&file, solvers, stop),
        });
        found.unwrap_or_else(|reason| PointOutcome::without_numbers(INVALID, reason))
    }
}

/// Whether a model is neither searched nor asks for a region.
fn is_one_design(model: &Model) -> bool {
    matches!(
        model.file.specs.objective,
        Objective::Gain | Objective::Pointing | Objective::Gamma
    )
}

/// The unit that the last key of a name ends with.
fn unit_of_last_key(name: &str) -> &'static str {
    let key = name.rsplit('.').next().unwrap_or(name);
    unit_of_key(key.split('[').next().unwrap_or(key))
}

/// The files' types hold numbers, texts and lists only, so they can always be written.
pub(super) fn value_of<T: Serialize>(file: &T) -> Value {
    serde_json::to_value(file).unwrap_or_default()
}

/// The type of a file from its value.
fn typed<T: DeserializeOwned + Serialize>(file: &Value, kind: Kind) -> Result<T, FileError> {
    // Of a value that does not fit, the text's reader names the field.
    T::deserialize(file).or_else(|_| parse(&file.to_string(), kind))
}

fn scenario_of(file: &Value) -> Result<Scenario, FileError> {
    let file = typed(file, Kind::Scenario)?;
    // The hash is that of a text; a point has none.
    Ok(Scenario::from_file(&file, String::new())?)
}

fn model_of(file: &Value) -> Result<Model, FileError> {
    Ok(Model::new(typed(file, Kind::Model)?)?)
}

fn run_scenario(file: &Value, design: Option<&Design>) -> Result<PointOutcome, String> {
    let scenario = scenario_of(file).map_err(|error| error.to_string())?;
    let outcome = simulate(&scenario, design, false).map_err(|error| error.to_string())?;
    let summary = outcome.summary;
    let certificate = summary.certificate.as_ref();
    let reasons = certificate.map(|outcome| outcome.not_covered.join("; "));
    Ok(PointOutcome {
        proof_covers: certificate.map(|outcome| outcome.covers_run),
        not_covered: reasons.filter(|reasons| !reasons.is_empty()),
        verdict: summary.verdict.name().to_string(),
        reason: why_not(&summary),
        metrics: numbers_of(&value_of(&summary)),
        ..PointOutcome::default()
    })
}

fn why_not(summary: &Summary) -> Option<String> {
    let missed = summary.requirements.iter().filter(|outcome| !outcome.met);
    let missed = missed.map(|outcome| outcome.as_text());
    match summary.verdict {
        RunVerdict::RequirementsMet => None,
        RunVerdict::RequirementsMissed => Some(missed.collect::<Vec<_>>().join("; ")),
        other => Some(other.sentence().to_string()),
    }
}

fn until(stop: &Arc<AtomicBool>) -> Observer {
    let stop = Arc::clone(stop);
    Arc::new(move |_| !stop.load(Ordering::Relaxed))
}

fn run_model(
    file: &Value,
    solvers: &Solvers,
    stop: &Arc<AtomicBool>,
) -> Result<PointOutcome, String> {
    let text = file.to_string();
    let model = model_of(file).map_err(|error| error.to_string())?;
    let outcome = synthesis::synthesize(&model, &text, solvers, Some(until(stop)));
    Ok(match outcome.map_err(|error| error.to_string())? {
        Outcome::Solved(design) => designed(&design),
        Outcome::Infeasible(decision) => undesigned("infeasible", &decision),
        Outcome::Undecided(decision) => undesigned("undecided", &decision),
        Outcome::SolverFailed(decision) => undesigned("solver_failed", &decision),
    })
}

/// Metrics of a model, whatever its points come to.
const MODEL_METRICS: [&str; 7] = [
    "gamma",
    "guaranteed_gain",
    "xi",
    "certified_angle_deg",
    "worst_margin",
    "gain_norm",
    "slack",
];

/// The metrics of a model with the values that a point has.
fn model_metrics(values: [Option<f64>; 7]) -> Vec<(String, Option<Number>)> {
    let metrics = MODEL_METRICS.into_iter().zip(values);
    metrics
        .map(|(name, value)| (name.to_string(), value.and_then(Number::from_f64)))
        .collect()
}

fn designed(design: &Synthesized) -> PointOutcome {
    let (part, report) = (&design.file.certificate, &design.report);
    let proved = report.verdict == Verdict::Proved;
    let worst = report.worst();
    // What is not proved claims nothing.
    let claimed = |value: Option<f64>| value.filter(|_| proved);
    PointOutcome {
        verdict: if proved { "proved" } else { "not_proved" }.to_string(),
        reason: (!proved).then(|| not_proved(report)),
        metrics: model_metrics([
            claimed(Some(part.gamma)),
            claimed(Some(part.guaranteed_gain)),
            claimed(Some(part.xi)),
            claimed(certified_angle_deg(part.certified_vector_part)),
            worst.map(|condition| condition.margin),
            gain_norm(&design.file.controller.gains),
            None,
        ]),
        worst_condition: worst.map(|condition| condition.name.clone()),
        ..PointOutcome::default()
    }
}

/// Largest singular value of any of the gains.
fn gain_norm(gains: &[Vec<Vec<f64>>]) -> Option<f64> {
    let norms = gains.iter().map(|rows| {
        let columns = rows.first().map_or(0, Vec::len);
        let entries = rows.iter().flatten().copied();
        let matrix = DMatrix::from_row_iterator(rows.len(), columns, entries);
        matrix.singular_values().max()
    });
    norms.reduce(f64::max)
}

fn not_proved(report: &Report) -> String {
    match report.worst() {
        Some(worst) => {
            let margin = Claim::AtLeast(worst.margin);
            format!("not proved: {}, margin {margin:.4}", worst.name)
        }
        None => "not proved".to_string(),
    }
}

fn undesigned(verdict: &str, decision: &Decision) -> PointOutcome {
    let blocking = decision.blocking.iter().take(BLOCKING);
    let names: Vec<&str> = blocking.map(|one| one.name.as_str()).collect();
    let reason = match names.as_slice() {
        [] => "no condition is known to block".to_string(),
        names => format!("blocked by {}", names.join(", ")),
    };
    PointOutcome {
        metrics: model_metrics([None, None, None, None, None, None, decision.slack]),
        ..PointOutcome::without_numbers(verdict, reason)
    }
}
