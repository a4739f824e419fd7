//! `steadfast export FILE --format c99|basilisk|fmu`

use std::path::Path;

use synth::model::{kind_of, Kind};

use super::data::{usable, Exported};
use super::former::Former;
use crate::base::files::create_folder;
use crate::cli::answer::{Answer, Exit};
use crate::cli::contents::Contents;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::show::facts::written;
use crate::cli::target::Targets;
use crate::export::basilisk;
use crate::export::flight::inputs::SAMPLES;
use crate::export::flight::source::Precision;
use crate::export::flight::{of_design, of_scenario, unit_of_design, unit_of_scenario, NoSource};
use crate::run::design::Design;
use crate::scenario::Scenario;

/// What is said where a design is not proved.
const NOT_PROVED: &str = "NOT PROVED; the export says so";

/// What is said of single precision.
const IN_SINGLE: &str =
    "in single precision: what is proved is of the controller in doubles; the export says so";

/// Writes a folder with the controller of a design or of a scenario. 2: of a design that is not proved.
pub fn export(
    path: &Path,
    folder: Option<&Path>,
    (samples, precision): (Option<u32>, Precision),
    targets: &Targets,
) -> Result<Answer, CliError> {
    let Some(folder) = folder else {
        return Err(CliError::Argument {
            argument: "--output",
            reason: "is needed with --format c99, which is a folder".to_string(),
        });
    };
    let samples = samples.map_or(SAMPLES, |count| count as usize);
    let (package, not_proved) = made(
        path,
        "c99",
        |design| of_design(design, samples, precision),
        |scenario, text| of_scenario(scenario, text, samples, precision),
    )?;
    let former = Former::in_folder(folder);
    former.check(folder, &package, targets.force)?;
    let names = package.files.iter();
    let names = names.map(|file| (file.name.as_str(), Contents::FlightCode));
    targets.check_folder(Some(folder), &names.collect::<Vec<_>>())?;
    create_folder(folder)?;
    for file in &package.files {
        files::write(&folder.join(&file.name), &file.text)?;
    }
    let edited = former.remove_others(folder, &package)?;
    let answer = Answer::silent(Exit::of(not_proved.is_none())).remark(written(folder));
    let left = edited.join(", ");
    let answer = match edited.is_empty() {
        true => answer,
        false => answer.remark(format!("left as edited, of the former export: {left}")),
    };
    let answer = match precision {
        Precision::Double => answer,
        Precision::Single => answer.remark(IN_SINGLE),
    };
    Ok(match not_proved {
        None => answer,
        Some(reason) => answer.remark(format!("{}: {reason}", path.display())),
    })
}

/// The module for Basilisk of a design or of a scenario.
pub fn basilisk(path: &Path) -> Result<Exported, CliError> {
    let (text, not_proved) = made(path, "basilisk", basilisk::of_design, basilisk::of_scenario)?;
    Ok(Exported {
        bytes: text.into_bytes(),
        not_proved,
    })
}

/// The functional mock-up unit of a design or of a scenario.
pub fn unit(path: &Path) -> Result<Exported, CliError> {
    let (bytes, not_proved) = made(path, "fmu", unit_of_design, unit_of_scenario)?;
    Ok(Exported { bytes, not_proved })
}

/// What is made of a design or of a scenario, and what is to be said of a design that is not proved.
fn made<T>(
    path: &Path,
    format: &str,
    of_design: impl FnOnce(&Design) -> Result<T, NoSource>,
    of_scenario: impl FnOnce(&Scenario, &str) -> Result<T, NoSource>,
) -> Result<(T, Option<String>), CliError> {
    let text = files::text(path)?;
    match kind_of(&text) {
        Some(Kind::Scenario) => {
            let scenario = files::parse(path, &text, Scenario::from_json)?;
            Ok((usable(path, of_scenario(&scenario, &text))?, None))
        }
        Some(Kind::Design) | None => {
            let design = files::parse(path, &text, Design::from_json)?;
            let not_proved = (!design.proved()).then(|| NOT_PROVED.to_string());
            Ok((usable(path, of_design(&design))?, not_proved))
        }
        Some(other) => {
            let kind = other.with_article();
            let reason = format!("this is {kind} file; {format} is for design and scenario files");
            Err(CliError::unsuitable(path, reason))
        }
    }
}
