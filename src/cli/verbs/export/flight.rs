//! `steadfast export FILE --format c99 -o DIR`

use std::path::Path;

use synth::model::{kind_of, Kind};

use super::data::{usable, Exported};
use crate::base::files::create_folder;
use crate::cli::answer::{Answer, Exit};
use crate::cli::contents::Contents;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::show::facts::written;
use crate::cli::target::Targets;
use crate::export::basilisk;
use crate::export::flight::inputs::SAMPLES;
use crate::export::flight::{of_design, of_scenario, unit_of_design, unit_of_scenario};
use crate::run::design::Design;
use crate::scenario::Scenario;

/// What is said where a design is not proved.
const NOT_PROVED: &str = "NOT PROVED; the export says so";

/// Writes a folder with the controller of a design or of a scenario. 2: of a design that is not proved.
pub fn export(
    path: &Path,
    folder: Option<&Path>,
    samples: Option<u32>,
    targets: &Targets,
) -> Result<Answer, CliError> {
    let Some(folder) = folder else {
        return Err(CliError::Argument {
            argument: "--output",
            reason: "is needed with --format c99, which is a folder".to_string(),
        });
    };
    let samples = samples.map_or(SAMPLES, |count| count as usize);
    let text = files::text(path)?;
    let (package, is_design) = match Flown::read(path, &text, "c99")? {
        Flown::Scenario(scenario) => (usable(path, of_scenario(&scenario, &text, samples))?, false),
        Flown::Design(design) => (usable(path, of_design(&design, samples))?, true),
    };
    let names = package.files.iter();
    let names = names.map(|file| (file.name.as_str(), Contents::FlightCode));
    targets.check_folder(Some(folder), &names.collect::<Vec<_>>())?;
    create_folder(folder)?;
    for file in &package.files {
        files::write(&folder.join(&file.name), &file.text)?;
    }
    let fails = is_design && !package.proved;
    let answer = Answer::silent(Exit::of(!fails)).remark(written(folder));
    Ok(match fails {
        false => answer,
        true => answer.remark(format!("{}: {NOT_PROVED}", path.display())),
    })
}

/// What has a controller.
enum Flown {
    Scenario(Box<Scenario>),
    Design(Box<Design>),
}

impl Flown {
    fn read(path: &Path, text: &str, format: &str) -> Result<Self, CliError> {
        match kind_of(text) {
            Some(Kind::Scenario) => {
                let scenario = files::parse(path, text, Scenario::from_json)?;
                Ok(Flown::Scenario(Box::new(scenario)))
            }
            Some(Kind::Design) | None => {
                let design = files::parse(path, text, Design::from_json)?;
                Ok(Flown::Design(Box::new(design)))
            }
            Some(other) => {
                let kind = other.with_article();
                let reason =
                    format!("this is {kind} file; {format} is for design and scenario files");
                Err(CliError::unsuitable(path, reason))
            }
        }
    }
}

/// The module for Basilisk of a design or of a scenario.
pub fn basilisk(path: &Path) -> Result<Exported, CliError> {
    let text = files::text(path)?;
    let (written, fails) = match Flown::read(path, &text, "basilisk")? {
        Flown::Scenario(scenario) => (
            usable(path, basilisk::of_scenario(&scenario, &text))?,
            false,
        ),
        Flown::Design(design) => (
            usable(path, basilisk::of_design(&design))?,
            !design.proved(),
        ),
    };
    Ok(Exported {
        bytes: written.into_bytes(),
        not_proved: fails.then(|| NOT_PROVED.to_string()),
    })
}

/// The functional mock-up unit of a design or of a scenario.
pub fn unit(path: &Path) -> Result<Exported, CliError> {
    let text = files::text(path)?;
    let (bytes, fails) = match Flown::read(path, &text, "fmu")? {
        Flown::Scenario(scenario) => (usable(path, unit_of_scenario(&scenario, &text))?, false),
        Flown::Design(design) => (usable(path, unit_of_design(&design))?, !design.proved()),
    };
    Ok(Exported {
        bytes,
        not_proved: fails.then(|| NOT_PROVED.to_string()),
    })
}
