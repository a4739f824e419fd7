//! The larger set of a design with two certificates.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::file::{ModelFile, Objective, PlantFile};
use super::validate::{check_count, check_matrix, finite, require, MAX_BOUNDS};
use super::{check_positive, Model, ModelError};

/// What the outer certificate of `--objective both` is for: the same controller on a larger box. The
/// rest (limits, sampling, threshold, multiplier weights) is that of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OuterSpecs {
    /// Decay rate phi of the outer functional, above 0 [1/s].
    pub phi_per_s: f64,
    /// The outer box: bound on the magnitude of each rate, above 0 [rad/s].
    pub rate_rad_s: [f64; 3],
    /// The outer box: smallest scalar part q0 of the error quaternion, in (0, 1].
    pub q0_min: f64,
    /// Largest disturbance weight xi of the outer certificate, above 0.
    pub xi_max: f64,
    /// States x0 that the outer set must contain, each of 6 entries; at least one.
    pub must_contain: Vec<Vec<f64>>,
    /// Size of the inner set over that of the outer one, in (0, 1]; searched when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inner_scale: Option<f64>,
    /// Weight rho of the containment condition in scaled units, above 0; searched when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub containment_weight: Option<f64>,
}

impl Model {
    /// The model of the outer certificate: the same plant on the outer box, with the outer decay rate,
    /// weight bound and start states.
    ///
    /// # Errors
    /// No `specs.outer`, or a plant that is not `exact`.
    pub fn outer(&self) -> Result<Model, ModelError> {
        let Some(outer) = &self.file.specs.outer else {
            let reason =
                "is missing: a design with two certificates needs the outer one's decay rate, \
                          box, xi_max and must_contain there";
            return Err(choice(reason));
        };
        Model::new(derived(&self.file, outer)?)
    }
}

fn choice(reason: &str) -> ModelError {
    ModelError::Choice {
        field: "specs.outer".to_string(),
        reason: reason.to_string(),
    }
}

/// The model file with the outer specifications in the place of its own.
fn derived(file: &ModelFile, outer: &OuterSpecs) -> Result<ModelFile, ModelError> {
    let mut out = file.clone();
    let PlantFile::Exact(exact) = &mut out.plant else {
        return Err(choice("needs an 'exact' plant"));
    };
    if exact.inertia_uncertainty.is_some() {
        return Err(choice(
            "needs an inertia that is known: no 'inertia_uncertainty'",
        ));
    }
    exact.rate_rad_s = outer.rate_rad_s;
    exact.q0_min = outer.q0_min;
    out.specs.phi_per_s = outer.phi_per_s;
    out.specs.xi_max = outer.xi_max;
    out.specs.must_contain.clone_from(&outer.must_contain);
    out.specs.objective = Objective::Gain;
    out.specs.outer = None;
    Ok(out)
}

/// Checks the outer specifications of a model file under their own names.
pub(super) fn check_outer(file: &ModelFile) -> Result<(), ModelError> {
    let Some(outer) = &file.specs.outer else {
        return match file.specs.objective {
            Objective::Both => Err(choice("is missing; the objective \"both\" needs it")),
            _ => Ok(()),
        };
    };
    if file.gains != Default::default() {
        return Err(choice("needs a constant gain"));
    }
    check_positive("specs.outer.phi_per_s", outer.phi_per_s)?;
    let allowed = "at most 100 / specs.hbar_s";
    let growth = outer.phi_per_s * file.specs.hbar_s;
    require(
        growth <= 100.0,
        "specs.outer.phi_per_s",
        outer.phi_per_s,
        allowed,
    )?;
    for (axis, &rate) in outer.rate_rad_s.iter().enumerate() {
        check_positive(&format!("specs.outer.rate_rad_s[{axis}]"), rate)?;
    }
    let q0 = outer.q0_min;
    require(q0 > 0.0 && q0 <= 1.0, "specs.outer.q0_min", q0, "in (0, 1]")?;
    check_positive("specs.outer.xi_max", outer.xi_max)?;
    if let Some(scale) = outer.inner_scale {
        let allowed = "above 0 and at most 1";
        require(
            scale > 0.0 && scale <= 1.0,
            "specs.outer.inner_scale",
            scale,
            allowed,
        )?;
        finite("specs.outer.inner_scale", scale)?;
    }
    if let Some(weight) = outer.containment_weight {
        check_positive("specs.outer.containment_weight", weight)?;
    }
    check_count(
        "specs.outer.must_contain",
        "states",
        outer.must_contain.len(),
        MAX_BOUNDS,
    )?;
    if outer.must_contain.is_empty() {
        return Err(ModelError::WrongShape {
            field: "specs.outer.must_contain".to_string(),
            found: "0 states".to_string(),
            expected: format!("1 to {MAX_BOUNDS} states"),
        });
    }
    for (index, state) in outer.must_contain.iter().enumerate() {
        let field = format!("specs.outer.must_contain[{index}]");
        check_matrix(&field, std::slice::from_ref(state), (Some(1), Some(6)))?;
    }
    derived(file, outer).map(|_| ())
}
