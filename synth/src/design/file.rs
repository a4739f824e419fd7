//! The design file, as written, and its check.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::certificate::{CertificateFile, ControllerFile};
use super::hand_over::SetHandOverFile;
use crate::certify::controller_rounding::{as_disturbance, holds_with_rounding, UNIT_ROUNDOFF};
use crate::certify::exact::Exact;
use crate::certify::interval::Interval;
use crate::certify::matrix::Matrix;
use crate::certify::reach::fall_time;
use crate::certify::scalar::Scalar;
use crate::certify::theorem1::{
    for_each_hand_over_condition, longest_without_torque, oldest_sample, reached_from_rest,
    Certificate, HandOver,
};
use crate::certify::{check, check_exactly, decide_all, judge_all, ExactReport, Report, Verdict};
use crate::model::{
    check_positive, check_version, parse, FileError, Kind, Model, ModelError, ModelFile, Objective,
};

/// The version this program reads and writes.
pub const DESIGN_SCHEMA_VERSION: u32 = 1;

/// A controller with its certificate. Every number stands once: what the model says (limits,
/// sampling, thresholds, memberships of the box) is in the model, what flies in the controller, what
/// only the proof needs in the certificate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// Name of the model.
    pub name: String,
    /// The model the design was made for, whole.
    pub model: ModelFile,
    /// What flies.
    pub controller: ControllerFile,
    /// What proves it.
    pub certificate: CertificateFile,
    /// What proves the same controller on the larger set of the model's `specs.outer`; only in designs
    /// with two certificates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outer: Option<OuterFile>,
    /// The outcome of the check when the file was written. A reader does not trust it: `verify`
    /// checks again.
    pub verdict: Report,
    /// What made the file.
    pub provenance: Provenance,
}

/// What made a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Program and version.
    pub generator: String,
    /// SHA-256 of the model file's bytes.
    pub model_sha256: String,
    /// SHA-256 of the gains file's bytes, where the gains were given and not designed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gains_sha256: Option<String>,
    /// Date and time (UTC, RFC 3339).
    pub date: String,
    /// Form of the decrease condition: reduced or full.
    pub form: String,
    /// Units of the scaled problem that was solved.
    pub problem: ProblemUnits,
    /// What ties the two certificates together, where there are two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coupling: Option<Coupling>,
    /// The search that chose the model's numbers, where there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<SearchRecord>,
    /// The solver's runs, in order. Their statuses are the solver's opinion and prove nothing.
    pub solver_runs: Vec<SolverRun>,
}

/// What fixes the units of a scaled problem; enough to state the very problem again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProblemUnits {
    /// The unit of each state, as a fraction of the smallest extent of the model's region along it.
    pub state_fraction: f64,
    /// The weight rho of the containment condition, in scaled units.
    pub containment_weight: f64,
    /// The unit of each state itself, where a solver's point suggested it; powers of two.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub state_units: Vec<f64>,
}

impl ProblemUnits {
    /// Units from the model's region.
    pub const fn of_fraction(state_fraction: f64, containment_weight: f64) -> Self {
        ProblemUnits {
            state_fraction,
            containment_weight,
            state_units: Vec::new(),
        }
    }
}

/// One run of a solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SolverRun {
    /// What was sought.
    pub goal: String,
    /// Number of vertices whose decrease condition was given to the solver.
    pub vertices: usize,
    /// Solver and version.
    pub solver: String,
    /// Its own status.
    pub status: String,
    /// Objective reached.
    pub objective: f64,
    /// Iterations.
    pub iterations: u32,
    /// Wall time (s).
    pub seconds: f64,
    /// Unit of each state in the program, a power of two; empty where no program was solved, or where two certificates
    /// have units of their own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub state_units: Vec<f64>,
    /// Margin of the strict inequalities at the solver's point, in scaled units: asked for or, where it was sought, reached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
}

/// How a search chose the numbers of the design's model. The proof is about the model as it stands in the
/// design and does not need this.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SearchRecord {
    /// What was sought: region or gain.
    pub objective: String,
    /// Semidefinite programs solved on the way.
    pub evaluations: u32,
    /// What was varied, and the values chosen.
    pub varied: Vec<VariedFile>,
    /// P of the last containment condition Qh'P + P'Qh - P'Uh P >= s^2 D D', n x n.
    pub linearisation: Vec<Vec<f64>>,
}

/// A number that a search chose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VariedFile {
    /// Its field in the model.
    pub field: String,
    /// The lowest value allowed.
    pub lowest: f64,
    /// The highest value allowed.
    pub highest: f64,
    /// The value chosen.
    pub value: f64,
}

/// What proves the controller on the larger set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OuterFile {
    /// Above 0: the outer functional uses this multiple of `controller.trigger_weight`. The trigger
    /// itself does not depend on a factor of its weight.
    pub trigger_multiple: f64,
    /// The unknowns of Theorem 1 on the outer box, for the model's `specs.outer`.
    pub certificate: CertificateFile,
    /// How every certified start of this set comes under the first certificate; left out where that is not proved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hand_over: Option<SetHandOverFile>,
}

/// How the unknowns that two certificates share were scaled against each other; enough, with the units,
/// to state the very problem again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Coupling {
    /// Size of the inner set over that of the outer: the inverse multipliers are in the ratio of its
    /// square.
    pub inner_scale: f64,
    /// Multiple of the trigger weight in the outer functional.
    pub trigger_multiple: f64,
}

/// The large-set certificate with the model it belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct LargeSetCertificate {
    /// The model on the box of the large set.
    pub model: Model,
    /// The numbers, those of the controller included.
    pub certificate: Certificate,
    /// How its states come under the certificate of the small set, where that is claimed.
    pub hand_over: Option<HandOver>,
}

impl LargeSetCertificate {
    /// Time by which every certified start has come under the certificate of the small set, at a sample (s); `None` where
    /// that is not claimed.
    pub fn hand_over_time(&self) -> Option<f64> {
        let level = self.hand_over.as_ref()?.level;
        let reached = reached_from_rest(&self.model, &self.certificate);
        let fall = fall_time(self.model.file.specs.phi_per_s, reached, level)?;
        let before = longest_without_torque(&self.model, &self.certificate);
        Some(before + fall + oldest_sample(&self.model))
    }
}

/// Prefix of the names of the large-set conditions.
const OUTER: &str = "outer ";

impl DesignFile {
    /// Reads the text of a design file; shapes and ranges are checked, nothing is proved.
    pub fn from_json(text: &str) -> Result<(Self, Model), FileError> {
        let file: DesignFile = parse(text, Kind::Design)?;
        check_version(file.schema_version, DESIGN_SCHEMA_VERSION)?;
        let model = Model::new(file.model.clone()).map_err(|error| error.within("model"))?;
        file.certificate(&model)?;
        let outer = file.large_set_certificate(&model)?;
        if outer.is_none() && model.file.specs.objective == Objective::Both {
            let reason = "is missing; the model's objective \"both\" needs a second certificate";
            return Err(ModelError::choice("outer", reason).into());
        }
        Ok((file, model))
    }

    /// The file's text: JSON whose numbers read back exactly.
    pub fn to_json(&self) -> String {
        // A design holds finite numbers and string keys only, so it can always be written.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The numbers of the certificate.
    pub fn certificate(&self, model: &Model) -> Result<Certificate, ModelError> {
        self.certificate.read(&self.controller, model)
    }

    /// The numbers of the outer certificate, where there is one.
    ///
    /// # Errors
    /// Shapes and ranges; a model without `specs.outer`.
    pub fn large_set_certificate(
        &self,
        model: &Model,
    ) -> Result<Option<LargeSetCertificate>, ModelError> {
        let Some(outer) = &self.outer else {
            return Ok(None);
        };
        let model = model.large_set().map_err(|error| error.within("model"))?;
        check_positive("outer.trigger_multiple", outer.trigger_multiple)?;
        let read = outer.certificate.read(&self.controller, &model);
        let mut certificate = read.map_err(|error| error.within("outer"))?;
        certificate.trigger_multiple = outer.trigger_multiple;
        let rows = certificate.gain_count() * certificate.gain.nrows();
        let hand_over = outer.hand_over.as_ref();
        let hand_over = hand_over.map(|own| own.read(rows)).transpose()?;
        Ok(Some(LargeSetCertificate {
            model,
            certificate,
            hand_over,
        }))
    }

    /// Proves the design from the file's numbers alone, or says what is not proved: both certificates, where there
    /// are two.
    pub fn verify(&self, model: &Model) -> Result<Report, ModelError> {
        let certificate = self.certificate(model)?;
        let outer = self.large_set_certificate(model)?;
        Ok(prove(model, &certificate, outer.as_ref()))
    }

    /// As [`DesignFile::verify`], in exact rational arithmetic.
    pub fn verify_exactly(&self, model: &Model) -> Result<ExactReport, ModelError> {
        let certificate = self.certificate(model)?;
        let outer = self.large_set_certificate(model)?;
        let report = check_exactly(model, &certificate);
        let Some(outer) = outer else {
            return Ok(report);
        };
        let report = report.and(decide_all(|emit| {
            handed_over::<Exact>(&outer, (model, &certificate), emit);
        }));
        let mut further = check_exactly(&outer.model, &outer.certificate);
        for name in &mut further.failed {
            name.insert_str(0, OUTER);
        }
        Ok(report.and(further))
    }
}

/// Proves what a design file's numbers were read as, or says what is not proved.
pub fn prove(
    model: &Model,
    certificate: &Certificate,
    outer: Option<&LargeSetCertificate>,
) -> Report {
    let mut report = check(model, certificate);
    if let Some(large) = outer {
        let handed_over = judge_all(Vec::new(), |emit| {
            handed_over::<Interval>(large, (model, certificate), emit);
        });
        let outer = check(&large.model, &large.certificate);
        for verdict in [outer.verdict, handed_over.verdict] {
            if verdict == Verdict::NotProved {
                report.verdict = Verdict::NotProved;
            }
        }
        let named = outer.conditions.into_iter().map(|mut condition| {
            condition.name.insert_str(0, OUTER);
            condition
        });
        report.conditions.extend(named);
        report.conditions.extend(handed_over.conditions);
        for assumption in outer.not_covered {
            if !report.not_covered.contains(&assumption) {
                report.not_covered.push(assumption);
            }
        }
    }
    report
        .not_covered
        .push(arithmetic_assumed(model, certificate, outer));
    report
}

/// How the controller may compute: in doubles where every level holds with what rounding adds.
fn arithmetic_assumed(
    model: &Model,
    certificate: &Certificate,
    outer: Option<&LargeSetCertificate>,
) -> String {
    let large = outer.map(|own| (&own.model, &own.certificate, own.hand_over.as_ref()));
    let counted = as_disturbance(model, certificate, UNIT_ROUNDOFF);
    match counted.filter(|_| holds_with_rounding((model, certificate), large, UNIT_ROUNDOFF)) {
        Some(more) => format!(
            "commands and decisions computed in IEEE doubles, sums in any order, fused or not; in the gain this counts as a \
             disturbance within {:e}{}",
            10f64.powf(more.log10().ceil()),
            match model.plant.inertia() {
                Some(_) => " N m",
                None => "",
            }
        ),
        None => "commands and decisions computed without rounding".to_string(),
    }
}

/// The conditions of a hand-over that is claimed.
fn handed_over<S: Scalar>(
    outer: &LargeSetCertificate,
    small: (&Model, &Certificate),
    emit: &mut dyn FnMut(String, Matrix<S>),
) {
    if let Some(hand_over) = &outer.hand_over {
        let large = (&outer.model, &outer.certificate);
        for_each_hand_over_condition(large, small, hand_over, emit);
    }
}
