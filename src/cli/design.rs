//! The design that a scenario runs with.

use std::path::{Path, PathBuf};
use synth::claim::Claim;

use super::answer::note;
use super::error::CliError;
use super::files;
use crate::controllers::ControllerChoice;
use crate::run::check_design;
use crate::run::design::Design;
use crate::run::outcome::SimulateError;
use crate::scenario::Scenario;

/// The command line's design, or the scenario's, whose path starts at the scenario's folder; its
/// verdict goes to standard error.
pub(crate) fn design_of(
    scenario: &Scenario,
    scenario_path: &Path,
    given: Option<&Path>,
) -> Result<Option<Design>, CliError> {
    let Some(path) = design_path(scenario, scenario_path, given) else {
        return Ok(None);
    };
    let needs_one = matches!(scenario.controller, ControllerChoice::Design(_));
    if given.is_some() && !needs_one {
        let error = SimulateError::UnusedDesign;
        return Err(CliError::unsuitable(scenario_path, error));
    }
    let design = read_design(&path)?;
    check_design(scenario, Some(&design)).map_err(|error| {
        let reason = format!("with the design {}: {error}", path.display());
        CliError::unsuitable(scenario_path, reason)
    })?;
    announce(&design);
    Ok(Some(design))
}

/// Path of the command line's design, or of the scenario's.
pub(crate) fn design_path(
    scenario: &Scenario,
    scenario_path: &Path,
    given: Option<&Path>,
) -> Option<PathBuf> {
    match (given, &scenario.controller) {
        (Some(path), _) => Some(path.to_path_buf()),
        (None, ControllerChoice::Design(Some(file))) => {
            Some(scenario_path.parent().unwrap_or(Path::new(".")).join(file))
        }
        (None, _) => None,
    }
}

pub(crate) fn read_design(path: &Path) -> Result<Design, CliError> {
    let text = files::text(path)?;
    Design::from_json(&text).map_err(|error| CliError::file(path, error))
}

/// Says on standard error whether the design is proved, before it is used.
pub(crate) fn announce(design: &Design) {
    let verdict = match design.proved() {
        true => "PROVED",
        false => "NOT PROVED",
    };
    let worst = design.report.worst().map_or(String::new(), |worst| {
        let margin = Claim::AtLeast(worst.margin);
        format!(", smallest margin {margin:.4} ({})", worst.name)
    });
    note(&format!("design '{}': {verdict}{worst}", design.file.name));
}
