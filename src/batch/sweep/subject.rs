//! What is swept: a scenario, which is run at each point, or a model, which is synthesized.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use nalgebra::DMatrix;
use serde::de::DeserializeOwned;
use serde::Serialize;
use serde_json::{Number, Value};
use synth::certify::{Report, Verdict};
use synth::feasibility::Decision;
use synth::model::{kind_of, parse, FileError, Kind, Model, Objective};
use synth::solve::{Backend, Clarabel, Observer, Structured};
use synth::synthesis::{self, Form, Outcome, Synthesized};

use super::outcome::{numbers_of, PointOutcome};
use crate::base::unit::unit_of_key;
use crate::batch::variation::grid::Grid;
use crate::run::design::{certified_angle_deg, Design};
use crate::run::simulate;
use crate::run::summary::{RunVerdict, Summary};
use crate::scenario::{Scenario, ScenarioFile};
use crate::sim::metrics::{MetricKind, METRICS};

/// What is swept. The file holds every default, so that what it leaves out can be varied too.
pub enum Subject {
    /// A scenario with its design, if it has one.
    Scenario {
        /// The file.
        file: Value,
        /// The design of its controller.
        design: Option<Box<Design>>,
    },
    /// A model.
    Model {
        /// The file.
        file: Value,
        /// The solver.
        solver: SolverChoice,
    },
}

/// A solver, with the form of the problems it is given.
#[derive(Debug, Clone)]
pub enum SolverChoice {
    /// Clarabel.
    Clarabel,
    /// The structured solver, which may start from the way to the solution of the file's own model. That is the
    /// same for every point, so that points do not depend on each other.
    Structured(Structured),
}

impl SolverChoice {
    /// The solver.
    pub fn backend(&self) -> Box<dyn Backend> {
        match self {
            SolverChoice::Clarabel => Box::new(Clarabel::default()),
            SolverChoice::Structured(solver) => Box::new(solver.clone()),
        }
    }

    /// The form of the decrease condition that the solver is fastest with.
    pub fn form(&self) -> Form {
        match self {
            SolverChoice::Clarabel => Form::Chordal,
            SolverChoice::Structured(_) => Form::VertexRelaxed,
        }
    }
}

/// Conditions that block a synthesis, as many as a row names.
const BLOCKING: usize = 3;

impl Subject {
    /// A scenario, which must be valid, with its design.
    pub fn scenario(file: &ScenarioFile, design: Option<Box<Design>>) -> Self {
        Subject::Scenario {
            file: value_of(file),
            design,
        }
    }

    /// A model.
    pub fn model(model: &Model, solver: SolverChoice) -> Self {
        Subject::Model {
            file: value_of(&model.file),
            solver,
        }
    }

    /// Whether a text is a scenario's.
    pub fn is_scenario(text: &str) -> bool {
        kind_of(text) == Some(Kind::Scenario)
    }

    /// The file with its defaults.
    pub fn file(&self) -> &Value {
        match self {
            Subject::Scenario { file, .. } | Subject::Model { file, .. } => file,
        }
    }

    /// Kind of the file.
    pub fn kind(&self) -> Kind {
        match self {
            Subject::Scenario { .. } => Kind::Scenario,
            Subject::Model { .. } => Kind::Model,
        }
    }

    /// SHA-256 of the design's file, for a scenario that has one.
    pub fn design_sha256(&self) -> Option<&str> {
        match self {
            Subject::Scenario { design, .. } => {
                design.as_ref().map(|design| design.sha256.as_str())
            }
            Subject::Model { .. } => None,
        }
    }

    /// The solver with the form of its problems, for a model.
    pub fn solver(&self) -> Option<String> {
        match self {
            Subject::Scenario { .. } => None,
            Subject::Model { solver, .. } => {
                let (backend, form) = (solver.backend(), solver.form());
                Some(format!("{}, {} form", backend.name(), form.name()))
            }
        }
    }

    /// Unit of a number that is varied or of a metric; empty where it has none.
    pub fn unit(&self, name: &str) -> &'static str {
        let body = self.file().pointer("/system/rigid_body").is_some();
        let metric = METRICS.iter().find(|entry| entry.key == name);
        match metric {
            Some(entry) if body || entry.kind != MetricKind::Effort => entry.unit,
            _ => unit_of_last_key(name),
        }
    }

    /// Solves the file's own model once, for the points to start from. A search takes too long for that.
    pub fn prepare(&mut self, stop: &Arc<AtomicBool>) {
        let Subject::Model { file, solver } = self else {
            return;
        };
        let SolverChoice::Structured(solver) = solver else {
            return;
        };
        let text = file.to_string();
        let Ok(model) = model_of(file) else {
            return;
        };
        if model.file.specs.objective == Objective::Gain {
            let first = Structured::warm();
            // Whatever comes of it: where nothing is remembered, points start cold.
            let _ = synthesis::synthesize(
                &model,
                &text,
                Form::VertexRelaxed,
                &first,
                Some(until(stop)),
            );
            *solver = first.frozen();
        }
    }

    /// Runs the point with these values, in the order of the axes. A synthesis ends early when `stop` is set;
    /// its outcome is of no use then.
    pub fn run(&self, grid: &Grid, values: Vec<f64>, stop: &Arc<AtomicBool>) -> PointOutcome {
        let found = match grid.apply(self.file(), &values) {
            Err(error) => Err(error.to_string()),
            Ok(file) => match self {
                Subject::Scenario { design, .. } => run_scenario(&values, &file, design.as_deref()),
                Subject::Model { solver, .. } => run_model(&values, &file, solver, stop),
            },
        };
        found.unwrap_or_else(|reason| PointOutcome::invalid(values, reason))
    }
}

/// The unit that the last key of a name ends with.
fn unit_of_last_key(name: &str) -> &'static str {
    let key = name.rsplit('.').next().unwrap_or(name);
    unit_of_key(key.split('[').next().unwrap_or(key))
}

/// The files' types hold numbers, texts and lists only, so they can always be written.
fn value_of<T: Serialize>(file: &T) -> Value {
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

fn run_scenario(
    values: &[f64],
    file: &Value,
    design: Option<&Design>,
) -> Result<PointOutcome, String> {
    let scenario = scenario_of(file).map_err(|error| error.to_string())?;
    let outcome = simulate(&scenario, design, false).map_err(|error| error.to_string())?;
    let summary = outcome.summary;
    Ok(PointOutcome {
        values: values.to_vec(),
        verdict: summary.verdict.name().to_string(),
        reason: why_not(&summary),
        metrics: numbers_of(&value_of(&summary)),
        worst_condition: None,
    })
}

fn why_not(summary: &Summary) -> Option<String> {
    let missed = summary.requirements.iter().filter(|outcome| !outcome.met);
    let missed = missed.map(|outcome| {
        let value = outcome.value.map_or("none".to_string(), |v| v.to_string());
        format!("{} {}: {value}", outcome.name, outcome.limit)
    });
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
    values: &[f64],
    file: &Value,
    solver: &SolverChoice,
    stop: &Arc<AtomicBool>,
) -> Result<PointOutcome, String> {
    let text = file.to_string();
    let model = model_of(file).map_err(|error| error.to_string())?;
    let backend = solver.backend();
    let observer = Some(until(stop));
    let outcome = synthesis::synthesize(&model, &text, solver.form(), backend.as_ref(), observer);
    let values = values.to_vec();
    Ok(match outcome.map_err(|error| error.to_string())? {
        Outcome::Solved(design) => designed(values, &design),
        Outcome::Infeasible(decision) => undesigned(values, "infeasible", &decision),
        Outcome::Undecided(decision) => undesigned(values, "undecided", &decision),
        Outcome::SolverFailed(decision) => undesigned(values, "solver_failed", &decision),
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
fn model_metrics(values: &[(&str, Option<f64>)]) -> Vec<(String, Option<Number>)> {
    let of = |name: &str| {
        let found = values.iter().find(|(own, _)| *own == name);
        found.and_then(|(_, value)| value.and_then(Number::from_f64))
    };
    MODEL_METRICS
        .map(|name| (name.to_string(), of(name)))
        .to_vec()
}

fn designed(values: Vec<f64>, design: &Synthesized) -> PointOutcome {
    let (part, report) = (&design.file.certificate, &design.report);
    let proved = report.verdict == Verdict::Proved;
    let worst = report.worst();
    PointOutcome {
        values,
        verdict: if proved { "proved" } else { "not_proved" }.to_string(),
        reason: (!proved).then(|| not_proved(report)),
        metrics: model_metrics(&[
            ("gamma", Some(part.gamma)),
            ("guaranteed_gain", Some(part.guaranteed_gain)),
            ("xi", Some(part.xi)),
            (
                "certified_angle_deg",
                certified_angle_deg(part.certified_vector_part),
            ),
            ("worst_margin", worst.map(|condition| condition.margin)),
            ("gain_norm", gain_norm(&design.file.controller.gains)),
        ]),
        worst_condition: worst.map(|condition| condition.name.clone()),
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
        Some(worst) => format!("not proved: {}, margin {:.3e}", worst.name, worst.margin),
        None => "not proved".to_string(),
    }
}

fn undesigned(values: Vec<f64>, verdict: &str, decision: &Decision) -> PointOutcome {
    let blocking = decision.blocking.iter().take(BLOCKING);
    let names: Vec<&str> = blocking.map(|one| one.name.as_str()).collect();
    let reason = match names.as_slice() {
        [] => "no condition is known to block".to_string(),
        names => format!("blocked by {}", names.join(", ")),
    };
    PointOutcome {
        values,
        verdict: verdict.to_string(),
        reason: Some(reason),
        metrics: model_metrics(&[("slack", decision.slack)]),
        worst_condition: None,
    }
}
