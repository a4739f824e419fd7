//! The final set of a proof for gains with a trigger on the command.

use super::command_trigger::{CommandTriggerSpecs, FinalSetSpecs};
use super::error::ModelError;
use super::file::{ModelFile, PlantFile};
use super::ranges::require;

fn choice(field: &str, reason: &str) -> ModelError {
    ModelError::choice(field, reason)
}

/// The model file with the box and the decay rate of the final set.
pub(super) fn derived(file: &ModelFile, last: &FinalSetSpecs) -> Result<ModelFile, ModelError> {
    let mut out = file.clone();
    let PlantFile::Exact(exact) = &mut out.plant else {
        let reason = "needs an 'exact' plant";
        return Err(choice("specs.command_trigger", reason));
    };
    exact.rate_rad_s = last.rate_rad_s;
    exact.q0_min = last.q0_min;
    out.specs.phi_per_s = last.phi_per_s;
    out.specs.must_contain.clear();
    out.specs.command_trigger = Some(CommandTriggerSpecs {
        within_limit: Some(last.within_limit),
        final_level: last.final_level,
        last: None,
    });
    Ok(out)
}

/// Checks `specs.command_trigger`.
pub(super) fn check_command_trigger(file: &ModelFile) -> Result<(), ModelError> {
    let Some(specs) = &file.specs.command_trigger else {
        return Ok(());
    };
    if !matches!(file.plant, PlantFile::Exact(_)) {
        return Err(choice("specs.command_trigger", "needs an 'exact' plant"));
    }
    let Some(last) = &specs.last else {
        return Ok(());
    };
    let growth = last.phi_per_s * file.specs.hbar_s;
    let field = "specs.command_trigger.final.phi_per_s";
    let allowed = "at most 100 / specs.hbar_s";
    require(growth <= 100.0, field, last.phi_per_s, allowed)
}
