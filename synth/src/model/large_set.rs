//! The larger set of a design with two certificates.

use super::error::ModelError;
use super::file::{ModelFile, Objective, OuterSpecs, PlantFile};
use super::ranges::{check_count, check_matrix, check_positive, finite, require, MAX_BOUNDS};

pub(super) fn choice(reason: &str) -> ModelError {
    ModelError::Choice {
        field: "specs.outer".to_string(),
        reason: reason.to_string(),
    }
}

/// The model file with the specifications of the large set in the place of its own.
pub(super) fn derived(file: &ModelFile, outer: &OuterSpecs) -> Result<ModelFile, ModelError> {
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

/// Checks the specifications of the large set (`specs.outer`) under their own names.
pub(super) fn check_large_set(file: &ModelFile) -> Result<(), ModelError> {
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
