//! The design file, as written, and its check.

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::certificate::{CertificateFile, MismatchFile};
use super::large_set::{both, Coupling, LargeSetCertificate, OuterFile};
use super::search::SearchRecord;
use crate::certify::theorem1::{Certificate, MismatchSlack, RuleGains};
use crate::certify::{check, Report};
use crate::model::{
    check_matrix, check_positive, check_symmetric, parse, FileError, Kind, Mismatch, Model,
    ModelError, ModelFile, Objective, Plant,
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

/// u = sat(F x(t_k)), sent when e' W e >= nu x(t_k)' W x(t_k). n states, m inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControllerFile {
    /// The gains F_j, each m x n; one for a constant gain.
    pub gains: Vec<Vec<Vec<f64>>>,
    /// The trigger weight Upsilon, n x n, symmetric.
    pub trigger_weight: Vec<Vec<f64>>,
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProblemUnits {
    /// The unit of the state, as a fraction of the smallest extent of the model's region.
    pub state_fraction: f64,
    /// The weight rho of the containment condition, in scaled units.
    pub containment_weight: f64,
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
}

impl DesignFile {
    /// Reads the text of a design file; shapes and ranges are checked, nothing is proved.
    pub fn from_json(text: &str) -> Result<(Self, Model), FileError> {
        let file: DesignFile = parse(text, Kind::Design)?;
        if file.schema_version != DESIGN_SCHEMA_VERSION {
            return Err(ModelError::SchemaVersion {
                found: file.schema_version,
                expected: DESIGN_SCHEMA_VERSION,
            }
            .into());
        }
        let model = Model::new(file.model.clone()).map_err(|error| error.within("model"))?;
        file.certificate(&model)?;
        let outer = file.large_set_certificate(&model)?;
        if outer.is_none() && model.file.specs.objective == Objective::Both {
            return Err(ModelError::Choice {
                field: "outer".to_string(),
                reason: "is missing; the model's objective \"both\" needs a second certificate"
                    .to_string(),
            }
            .into());
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
        let (n, m, _, _) = model.plant.sizes();
        let (square, gain) = ((Some(n), Some(n)), (Some(m), Some(n)));
        let part = &self.certificate;
        let weights = &part.sector_weight;
        check_matrix(
            "certificate.sector_weight",
            std::slice::from_ref(weights),
            (Some(1), Some(m)),
        )?;
        check_positive("certificate.xi", part.xi)?;
        check_positive("certificate.gamma", part.gamma)?;
        check_positive("certificate.guaranteed_gain", part.guaranteed_gain)?;
        if let Some(radius) = part.certified_vector_part {
            check_radius(model, radius)?;
        }
        let symmetric = |field: &str, rows| -> Result<DMatrix<f64>, ModelError> {
            let matrix = check_matrix(field, rows, square)?;
            check_symmetric(field, &matrix)?;
            Ok(matrix)
        };
        let gains = each("controller.gains", &self.controller.gains, gain)?;
        let anti_windups = each("certificate.anti_windup", &part.anti_windup, gain)?;
        let [(gain, anti_windup), further @ ..] = &paired(gains, anti_windups)?[..] else {
            return Err(wrong_count("controller.gains", 0, "1 or more"));
        };
        let further = further.iter().map(|(gain, anti_windup)| RuleGains {
            gain: gain.clone(),
            anti_windup: anti_windup.clone(),
        });
        let mut certificate = Certificate {
            gain: gain.clone(),
            further: further.collect(),
            mismatch: Vec::new(),
            trigger_weight: symmetric(
                "controller.trigger_weight",
                &self.controller.trigger_weight,
            )?,
            trigger_multiple: 1.0,
            lyapunov: symmetric("certificate.lyapunov", &part.lyapunov)?,
            integral_weight: symmetric("certificate.integral_weight", &part.integral_weight)?,
            multiplier: check_matrix("certificate.multiplier", &part.multiplier, square)?,
            free_state: check_matrix("certificate.free_state", &part.free_state, square)?,
            free_sample: check_matrix("certificate.free_sample", &part.free_sample, square)?,
            anti_windup: anti_windup.clone(),
            sector_weight: DVector::from_column_slice(weights),
            disturbance_weight: part.xi,
            gain_bound: part.gamma,
            guaranteed_gain: part.guaranteed_gain,
            certified_vector_part: part.certified_vector_part,
        };
        certificate.mismatch = mismatch_slack(model, &certificate, &part.mismatch)?;
        Ok(certificate)
    }

    /// Proves the design from the file's numbers alone, or says what is not proved.
    pub fn verify(&self, model: &Model) -> Result<Report, ModelError> {
        let report = check(model, &self.certificate(model)?);
        Ok(match self.large_set_certificate(model)? {
            None => report,
            Some(outer) => both(report, &check(&outer.model, &outer.certificate)),
        })
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
        let mut as_plain = self.clone();
        as_plain.certificate.clone_from(&outer.certificate);
        let read = as_plain.certificate(&model);
        let mut certificate = read.map_err(|error| error.within("outer"))?;
        certificate.trigger_multiple = outer.trigger_multiple;
        Ok(Some(LargeSetCertificate { model, certificate }))
    }
}

impl CertificateFile {
    /// Splits a certificate into what flies and what proves.
    pub fn split(certificate: &Certificate) -> (ControllerFile, CertificateFile) {
        let controller = ControllerFile {
            gains: certificate.gains().map(rows).collect(),
            trigger_weight: rows(&certificate.trigger_weight),
        };
        let proof = CertificateFile {
            lyapunov: rows(&certificate.lyapunov),
            integral_weight: rows(&certificate.integral_weight),
            multiplier: rows(&certificate.multiplier),
            free_state: rows(&certificate.free_state),
            free_sample: rows(&certificate.free_sample),
            anti_windup: certificate.anti_windups().map(rows).collect(),
            sector_weight: certificate.sector_weight.iter().copied().collect(),
            mismatch: certificate
                .mismatch
                .iter()
                .map(|side| MismatchFile {
                    bounds: side.bounds.iter().map(rows).collect(),
                    common: rows(&side.common),
                })
                .collect(),
            xi: certificate.disturbance_weight,
            gamma: certificate.gain_bound,
            guaranteed_gain: certificate.guaranteed_gain,
            certified_vector_part: certificate.certified_vector_part,
        };
        (controller, proof)
    }
}

/// A matrix as a file holds it: a list of rows.
pub(crate) fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let row = |r: usize| matrix.row(r).iter().copied().collect();
    (0..matrix.nrows()).map(row).collect()
}

/// The matrix that rows of equal length hold.
pub(crate) fn matrix(rows: &[Vec<f64>]) -> DMatrix<f64> {
    let columns = rows.first().map_or(0, Vec::len);
    DMatrix::from_fn(rows.len(), columns, |r, c| {
        rows[r].get(c).copied().unwrap_or(f64::NAN)
    })
}

/// A list of matrices of one size.
fn each(
    field: &str,
    matrices: &[Vec<Vec<f64>>],
    size: (Option<usize>, Option<usize>),
) -> Result<Vec<DMatrix<f64>>, ModelError> {
    let numbered = matrices.iter().enumerate();
    numbered
        .map(|(index, rows)| check_matrix(&format!("{field}[{index}]"), rows, size))
        .collect()
}

fn wrong_count(field: &str, found: usize, expected: &str) -> ModelError {
    ModelError::WrongShape {
        field: field.to_string(),
        found: format!("{found} matrices"),
        expected: format!("{expected} matrices"),
    }
}

/// Largest number of gains in a file.
const MAX_GAINS: usize = 64;

/// A gain and its anti-windup gain.
type GainPair = (DMatrix<f64>, DMatrix<f64>);

/// Each gain with its anti-windup gain.
fn paired(
    gains: Vec<DMatrix<f64>>,
    anti_windups: Vec<DMatrix<f64>>,
) -> Result<Vec<GainPair>, ModelError> {
    if gains.is_empty() || gains.len() > MAX_GAINS {
        let expected = format!("1 to {MAX_GAINS}");
        return Err(wrong_count("controller.gains", gains.len(), &expected));
    }
    if gains.len() != anti_windups.len() {
        let expected = gains.len().to_string();
        let found = anti_windups.len();
        return Err(wrong_count("certificate.anti_windup", found, &expected));
    }
    Ok(gains.into_iter().zip(anti_windups).collect())
}

/// The slack of the mismatch bound: two of it where kappa > 0 is assumed, none elsewhere.
fn mismatch_slack(
    model: &Model,
    certificate: &Certificate,
    sides: &[MismatchFile],
) -> Result<Vec<MismatchSlack>, ModelError> {
    let positive = matches!(model.file.mismatch, Mismatch::Kappa(kappa) if kappa > 0.0);
    let needed = match certificate.is_matched(model) && positive {
        true => 2,
        false => 0,
    };
    if sides.len() != needed {
        return Err(ModelError::WrongShape {
            field: "certificate.mismatch".to_string(),
            found: format!("{} entries", sides.len()),
            expected: format!("{needed} entries"),
        });
    }
    let side = certificate.mismatch_side();
    let symmetric = |field: &str, rows: &[Vec<f64>]| -> Result<DMatrix<f64>, ModelError> {
        let matrix = check_matrix(field, rows, (Some(side), Some(side)))?;
        check_symmetric(field, &matrix)?;
        Ok(matrix)
    };
    let mut out = Vec::with_capacity(needed);
    for (index, file) in sides.iter().enumerate() {
        let field = format!("certificate.mismatch[{index}]");
        let count = certificate.gain_count();
        if file.bounds.len() != count {
            let field = format!("{field}.bounds");
            return Err(wrong_count(&field, file.bounds.len(), &count.to_string()));
        }
        let bounds = file.bounds.iter().enumerate();
        let bounds = bounds.map(|(k, rows)| symmetric(&format!("{field}.bounds[{k}]"), rows));
        out.push(MismatchSlack {
            bounds: bounds.collect::<Result<_, _>>()?,
            common: symmetric(&format!("{field}.common"), &file.common)?,
        });
    }
    Ok(out)
}

/// The radius of certified attitudes: for spacecraft only, where it is checked, and in [0, 1].
fn check_radius(model: &Model, radius: f64) -> Result<(), ModelError> {
    let allowed = match model.plant {
        Plant::Spacecraft(_) => "in [0, 1]",
        Plant::Vertices(_) | Plant::Rules(_) => "left out: the plant is not an exact spacecraft",
    };
    let spacecraft = matches!(model.plant, Plant::Spacecraft(_));
    if spacecraft && (0.0..=1.0).contains(&radius) {
        return Ok(());
    }
    Err(ModelError::OutOfRange {
        field: "certificate.certified_vector_part".to_string(),
        value: radius,
        allowed: allowed.to_string(),
    })
}
