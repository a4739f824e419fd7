//! The design file of a design problem, and its check.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::checked::Problem;
use super::file::ProblemFile;
use crate::certify::{decide_all, judge_all, ExactReport, Report};
use crate::conditions::state_feedback::StateFeedback;
use crate::design::{rows, symmetric, SolverRun, DESIGN_SCHEMA_VERSION};
use crate::model::{
    check_matrix, check_positive, check_version, parse, FileError, Kind, ModelError,
};

/// A state feedback with its proof. Every number stands once: what is asked is in the model, what flies
/// in the controller, what only the proof needs in the certificate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProblemDesignFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// Name of the problem file.
    pub name: String,
    /// The problem file, whole.
    pub model: ProblemFile,
    /// What flies.
    pub controller: FeedbackFile,
    /// What proves it.
    pub certificate: ProofFile,
    /// The outcome of the check when the file was written. A reader does not trust it: `verify`
    /// checks again.
    pub verdict: Report,
    /// What made the file.
    pub provenance: ProblemProvenance,
}

/// u = F x, saturated where the problem says so. n states, m inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeedbackFile {
    /// F, m x n.
    pub gain: Vec<Vec<f64>>,
}

/// The unknowns of the proof. n states, m inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProofFile {
    /// P of the quadratic function x'Px, n x n, symmetric.
    pub lyapunov: Vec<Vec<f64>>,
    /// The guaranteed number, above 0: the overshoot c, the L2 gain gamma, or the scale beta of the
    /// reference set.
    pub guarantee: f64,
    /// Further gains that the proof needs, m x n each: `saturation_gain` H for `saturated_region`.
    #[serde(default)]
    pub auxiliary: BTreeMap<String, Vec<Vec<f64>>>,
}

/// What made a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProblemProvenance {
    /// Program and version.
    pub generator: String,
    /// SHA-256 of the problem file's bytes.
    pub model_sha256: String,
    /// Date and time (UTC, RFC 3339).
    pub date: String,
    /// The solver's runs, in order. Their statuses are the solver's opinion and prove nothing.
    pub solver_runs: Vec<SolverRun>,
}

impl ProblemDesignFile {
    /// Reads the text of a design file; shapes and ranges are checked, nothing is proved.
    pub fn from_json(text: &str) -> Result<(Self, Problem), FileError> {
        let file: ProblemDesignFile = parse(text, Kind::ProblemDesign)?;
        check_version(file.schema_version, DESIGN_SCHEMA_VERSION)?;
        let problem = Problem::new(file.model.clone()).map_err(|error| error.within("model"))?;
        file.feedback(&problem)?;
        Ok((file, problem))
    }

    /// The file's text: JSON whose numbers read back exactly.
    pub fn to_json(&self) -> String {
        // A design holds finite numbers and string keys only, so it can always be written.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The feedback and its proof as numbers.
    pub fn feedback(&self, problem: &Problem) -> Result<StateFeedback, ModelError> {
        let (n, m) = (problem.plant.states(), problem.plant.inputs());
        let flat = (Some(m), Some(n));
        let gain = check_matrix("controller.gain", &self.controller.gain, flat)?;
        check_given_gain(problem, &gain)?;
        let part = &self.certificate;
        let lyapunov = symmetric("certificate.lyapunov", &part.lyapunov, n)?;
        check_positive("certificate.guarantee", part.guarantee)?;
        let expected: Vec<&str> = problem.task.auxiliary_gains().to_vec();
        if !part.auxiliary.keys().eq(expected.iter()) {
            let found: Vec<&str> = part.auxiliary.keys().map(String::as_str).collect();
            let (found, expected) = (listed(&found), listed(&expected));
            return Err(ModelError::shape("certificate.auxiliary", found, expected));
        }
        let auxiliary = part.auxiliary.iter().map(|(name, rows)| {
            let field = format!("certificate.auxiliary.{name}");
            Ok((name.clone(), check_matrix(&field, rows, flat)?))
        });
        Ok(StateFeedback {
            gain,
            lyapunov,
            guarantee: part.guarantee,
            auxiliary: auxiliary.collect::<Result<_, ModelError>>()?,
        })
    }

    /// Proves the design from the file's numbers alone, or says what is not proved.
    pub fn verify(&self, problem: &Problem) -> Result<Report, ModelError> {
        Ok(verify(problem, &self.feedback(problem)?))
    }

    /// As [`ProblemDesignFile::verify`], in exact rational arithmetic.
    pub fn verify_exactly(&self, problem: &Problem) -> Result<ExactReport, ModelError> {
        let found = self.feedback(problem)?;
        Ok(decide_all(|check| {
            problem
                .task
                .for_each_condition(&problem.plant, &found, check);
        }))
    }
}

/// Checks every condition of a problem's proof.
pub fn verify(problem: &Problem, found: &StateFeedback) -> Report {
    judge_all(problem.task.assumptions(), |check| {
        problem
            .task
            .for_each_condition(&problem.plant, found, check);
    })
}

/// A feedback that the problem gives is the one that flies.
fn check_given_gain(problem: &Problem, gain: &DMatrix<f64>) -> Result<(), ModelError> {
    let Some(given) = &problem.plant.gain else {
        return Ok(());
    };
    let places = (0..gain.nrows()).flat_map(|r| (0..gain.ncols()).map(move |c| (r, c)));
    for (r, c) in places {
        if gain[(r, c)] != given[(r, c)] {
            let field = format!("controller.gain[{r}][{c}]");
            let allowed = format!("{}, as in model.gain", given[(r, c)]);
            return Err(ModelError::range(field, gain[(r, c)], allowed));
        }
    }
    Ok(())
}

fn listed(names: &[&str]) -> String {
    match names {
        [] => "no gains".to_string(),
        names => names.join(", "),
    }
}

impl ProofFile {
    /// Splits a feedback into what flies and what proves.
    pub fn split(found: &StateFeedback) -> (FeedbackFile, ProofFile) {
        let auxiliary = found.auxiliary.iter();
        let controller = FeedbackFile {
            gain: rows(&found.gain),
        };
        let proof = ProofFile {
            lyapunov: rows(&found.lyapunov),
            guarantee: found.guarantee,
            auxiliary: auxiliary
                .map(|(name, gain)| (name.clone(), rows(gain)))
                .collect(),
        };
        (controller, proof)
    }
}
