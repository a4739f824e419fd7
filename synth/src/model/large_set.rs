//! The larger set of a design with two certificates.

use super::error::ModelError;
use super::file::{ModelFile, OuterSpecs, PlantFile};
use super::objective::Objective;
use super::ranges::{check_count, check_matrix, require, MAX_BOUNDS};

pub(super) fn choice(reason: &str) -> ModelError {
    ModelError::choice("specs.outer", reason)
}

/// The model file with the specifications of the large set in the place of its own.
pub(super) fn derived(file: &ModelFile, outer: &OuterSpecs) -> Result<ModelFile, ModelError> {
    let mut out = file.clone();
    let PlantFile::Exact(exact) = &mut out.plant else {
        return Err(choice("needs an 'exact' plant"));
    };
    if exact.inertia_uncertainty.is_some() {
        let reason = "needs an inertia that is known: no 'inertia_uncertainty'";
        return Err(choice(reason));
    }
    exact.rate_rad_s = outer.rate_rad_s;
    exact.q0_min = outer.q0_min;
    out.specs.phi_per_s = outer.phi_per_s;
    out.specs.xi_max = outer.xi_max;
    out.specs.must_contain.clone_from(&outer.must_contain);
    out.specs.objective = Objective::Gamma;
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
    let growth = outer.phi_per_s * file.specs.hbar_s;
    let (field, allowed) = ("specs.outer.phi_per_s", "at most 100 / specs.hbar_s");
    require(growth <= 100.0, field, outer.phi_per_s, allowed)?;
    let (field, count) = ("specs.outer.must_contain", outer.must_contain.len());
    check_count(field, "states", count, MAX_BOUNDS)?;
    if count == 0 {
        let expected = format!("1 to {MAX_BOUNDS} states");
        return Err(ModelError::shape(field, "0 states", expected));
    }
    for (index, state) in outer.must_contain.iter().enumerate() {
        let field = format!("specs.outer.must_contain[{index}]");
        check_matrix(&field, std::slice::from_ref(state), (Some(1), Some(6)))?;
    }
    derived(file, outer).map(|_| ())
}
