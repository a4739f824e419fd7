//! The controller and the part of a design file that only the proof needs.

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::imperfections::{present, FinalBoundsFile, FirstTorqueFile, MeasurementFile};
use super::matrices::{positive_list, rows, symmetric};
use crate::certify::theorem1::{Certificate, MismatchSlack, RuleGains};
use crate::model::bounded::{As, NonNegative};
use crate::model::{check_matrix, check_positive, Mismatch, Model, ModelError, Plant};

/// u = sat(F w), w the state sent last, sent anew when e' W e >= nu w' W w + eps_a. n states, m inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControllerFile {
    /// The gains F_j, each m x n; one for a constant gain.
    pub gains: Vec<Vec<Vec<f64>>>,
    /// The trigger weight Upsilon, n x n, symmetric.
    pub trigger_weight: Vec<Vec<f64>>,
    /// eps_a: the absolute part of the trigger, in the unit of e' Upsilon e; 0 when left out.
    #[serde(default, skip_serializing_if = "is_zero", with = "As::<NonNegative>")]
    pub trigger_floor: f64,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// The unknowns of Theorem 1. n states, m inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CertificateFile {
    /// U: x'Ux <= 1 is the certified set. n x n, symmetric.
    pub lyapunov: Vec<Vec<f64>>,
    /// Y: weight of the integral term. n x n, symmetric.
    pub integral_weight: Vec<Vec<f64>>,
    /// Q: multiplier of the plant's equation (for a spacecraft, of the equation multiplied by the
    /// inertia). n x n.
    pub multiplier: Vec<Vec<f64>>,
    /// L1. n x n.
    pub free_state: Vec<Vec<f64>>,
    /// L2. n x n.
    pub free_sample: Vec<Vec<f64>>,
    /// N_j: anti-windup gains, each m x n.
    pub anti_windup: Vec<Vec<Vec<f64>>>,
    /// Diagonal of M. m entries.
    pub sector_weight: Vec<f64>,
    /// Slack of the mismatch bound, for r = 1 and r = 2; only with scheduled gains and kappa > 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mismatch: Vec<MismatchFile>,
    /// xi: V' <= -phi V + xi |tau|^2.
    pub xi: f64,
    /// gamma: the paper's bound on sup|y| / sup|tau| from rest, not below xi.
    pub gamma: f64,
    /// The sharper bound sqrt(g xi) with C'C <= g phi U.
    pub guaranteed_gain: f64,
    /// Radius s: every attitude at rest with |q| <= s is in the certified set. Spacecraft only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certified_vector_part: Option<f64>,
    /// Bounds from rest and in the end. Spacecraft only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub final_bounds: Option<FinalBoundsFile>,
    /// For a measurement that is not exact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measurement: Option<MeasurementFile>,
    /// T: one number for each uncertain entry of the actuators' gain matrix, row after row.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gain_error_weight: Vec<f64>,
    /// For messages that may come late or be lost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_torque: Option<FirstTorqueFile>,
}

/// P_j and R with P_j >= +-(N_j - R), N_j the form of gain j on (B'Q'v, M p, x(t_k)); the rows of M p are
/// left out where all anti-windup gains are equal. Each m + n (or 2 m + n) square, symmetric.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MismatchFile {
    /// P_j of every gain.
    pub bounds: Vec<Vec<Vec<f64>>>,
    /// R.
    pub common: Vec<Vec<f64>>,
}

impl CertificateFile {
    /// Splits a certificate into what flies and what proves.
    pub fn split(certificate: &Certificate) -> (ControllerFile, CertificateFile) {
        let controller = ControllerFile {
            gains: certificate.gains().map(rows).collect(),
            trigger_weight: rows(&certificate.trigger_weight),
            trigger_floor: certificate.trigger_floor,
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
            final_bounds: certificate.final_bounds.as_ref().map(FinalBoundsFile::of),
            measurement: certificate.measurement.as_ref().map(MeasurementFile::of),
            gain_error_weight: certificate.gain_error_weight.iter().copied().collect(),
            first_torque: certificate.first_torque.as_ref().map(FirstTorqueFile::of),
        };
        (controller, proof)
    }

    /// The numbers, with those of the controller.
    pub(super) fn read(
        &self,
        controller: &ControllerFile,
        model: &Model,
    ) -> Result<Certificate, ModelError> {
        let (n, m, _, _) = model.plant.sizes();
        let (square, gain) = ((Some(n), Some(n)), (Some(m), Some(n)));
        let weights = &self.sector_weight;
        check_matrix(
            "certificate.sector_weight",
            std::slice::from_ref(weights),
            (Some(1), Some(m)),
        )?;
        check_positive("certificate.xi", self.xi)?;
        check_positive("certificate.gamma", self.gamma)?;
        check_positive("certificate.guaranteed_gain", self.guaranteed_gain)?;
        if let Some(radius) = self.certified_vector_part {
            check_radius(model, radius)?;
        }
        let symmetric = |field: &str, rows| symmetric(field, rows, n);
        let gains = each("controller.gains", &controller.gains, gain)?;
        let anti_windups = each("certificate.anti_windup", &self.anti_windup, gain)?;
        let mut rules = paired(gains, anti_windups)?;
        let first = rules.remove(0);
        let mut certificate = Certificate {
            gain: first.gain,
            further: rules,
            mismatch: Vec::new(),
            trigger_weight: symmetric("controller.trigger_weight", &controller.trigger_weight)?,
            trigger_floor: controller.trigger_floor,
            trigger_multiple: 1.0,
            lyapunov: symmetric("certificate.lyapunov", &self.lyapunov)?,
            integral_weight: symmetric("certificate.integral_weight", &self.integral_weight)?,
            multiplier: check_matrix("certificate.multiplier", &self.multiplier, square)?,
            free_state: check_matrix("certificate.free_state", &self.free_state, square)?,
            free_sample: check_matrix("certificate.free_sample", &self.free_sample, square)?,
            anti_windup: first.anti_windup,
            sector_weight: DVector::from_column_slice(weights),
            disturbance_weight: self.xi,
            gain_bound: self.gamma,
            guaranteed_gain: self.guaranteed_gain,
            certified_vector_part: self.certified_vector_part,
            final_bounds: None,
            measurement: None,
            gain_error_weight: DVector::zeros(0),
            first_torque: None,
        };
        self.read_imperfections(model, &mut certificate)?;
        certificate.mismatch = mismatch_slack(model, &certificate, &self.mismatch)?;
        Ok(certificate)
    }
}

impl CertificateFile {
    /// Reads what imperfections need: each number where the model's need it, and nowhere else.
    fn read_imperfections(
        &self,
        model: &Model,
        certificate: &mut Certificate,
    ) -> Result<(), ModelError> {
        let imperfections = &model.file.imperfections;
        let (n, m, d, _) = model.plant.sizes();
        let needed = imperfections.measurement_error().is_some();
        present("measurement", self.measurement.is_some(), needed)?;
        let needed = imperfections.is_networked();
        present("first_torque", self.first_torque.is_some(), needed)?;
        let measurement = self.measurement.as_ref();
        certificate.measurement = measurement.map(|file| file.read(n)).transpose()?;
        let first = self.first_torque.as_ref();
        certificate.first_torque = first.map(|file| file.read((n, d))).transpose()?;
        let count = imperfections.uncertain_gains(m).len();
        let field = "certificate.gain_error_weight";
        certificate.gain_error_weight = positive_list(field, &self.gain_error_weight, count)?;
        let bounds = self.final_bounds.as_ref();
        certificate.final_bounds = bounds.map(|bounds| bounds.read(model)).transpose()?;
        Ok(())
    }
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
    let found = format!("{found} matrices");
    ModelError::shape(field, found, format!("{expected} matrices"))
}

/// Largest number of gains in a file.
const MAX_GAINS: usize = 64;

/// Each gain with its anti-windup gain, at least one.
fn paired(
    gains: Vec<DMatrix<f64>>,
    anti_windups: Vec<DMatrix<f64>>,
) -> Result<Vec<RuleGains>, ModelError> {
    if gains.is_empty() || gains.len() > MAX_GAINS {
        let expected = format!("1 to {MAX_GAINS}");
        return Err(wrong_count("controller.gains", gains.len(), &expected));
    }
    if gains.len() != anti_windups.len() {
        let expected = gains.len().to_string();
        let found = anti_windups.len();
        return Err(wrong_count("certificate.anti_windup", found, &expected));
    }
    let pairs = gains.into_iter().zip(anti_windups);
    Ok(pairs
        .map(|(gain, anti_windup)| RuleGains { gain, anti_windup })
        .collect())
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
        let (found, expected) = (sides.len(), format!("{needed} entries"));
        let found = format!("{found} entries");
        return Err(ModelError::shape("certificate.mismatch", found, expected));
    }
    let side = certificate.mismatch_side();
    let symmetric = |field: &str, rows: &[Vec<f64>]| symmetric(field, rows, side);
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
    let field = "certificate.certified_vector_part";
    Err(ModelError::range(field, radius, allowed))
}
