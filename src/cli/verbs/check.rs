//! `steadfast check FILE`

use std::path::PathBuf;

use synth::design::DesignFile;
use synth::feasibility::InfeasibilityFile;
use synth::held_command::HeldCommandDesignFile;
use synth::model::{kind_of, GainsFile, Kind, Model};
use synth::problem::{Problem, ProblemDesignFile};

use crate::batch::tune::file::Requirements;
use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics;
use crate::cli::show::check::{of_gains, of_model, of_problem, of_requirements, CheckReport};
use crate::scenario::{design_check, Scenario};

/// Arguments of `check`.
#[derive(clap::Args)]
pub struct CheckArgs {
    /// Model, design, scenario, gains, problem or requirements file, or infeasibility certificate
    file: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Reads a file of any kind and says what it is, and for a controller whose paper has conditions on its
/// parameters, which of them hold. Nothing is proved here. A condition that fails is no error: the file
/// is valid, and the status is 0.
pub fn run(args: &CheckArgs) -> Result<Answer, CliError> {
    let text = files::text(&args.file)?;
    let (mut conditions, mut warnings) = (None, Vec::new());
    // A model is the default: its errors name the missing fields.
    let kind = kind_of(&text).unwrap_or(Kind::Model);
    let summary = match kind {
        Kind::Model => Model::from_json(&text).map(|model| {
            warnings = physics::of_model(&model, &text);
            of_model(&model.file.name, &model)
        }),
        Kind::Design => {
            DesignFile::from_json(&text).map(|(file, model)| of_model(&file.name, &model))
        }
        Kind::Infeasibility => {
            InfeasibilityFile::from_json(&text).map(|(file, model)| of_model(&file.name, &model))
        }
        Kind::Scenario => Scenario::from_json(&text).map(|scenario| {
            conditions = design_check(&scenario);
            warnings = physics::of_scenario(&scenario, &text);
            format!("{}, {} s", scenario.name, scenario.duration_s)
        }),
        Kind::Requirements => Requirements::from_json(&text).map(|own| {
            warnings = physics::of_requirements(&own, &text);
            of_requirements(&own)
        }),
        Kind::Problem => Problem::from_json(&text).map(|problem| of_problem(&problem)),
        Kind::ProblemDesign => {
            ProblemDesignFile::from_json(&text).map(|(_, problem)| of_problem(&problem))
        }
        Kind::HeldCommandDesign => HeldCommandDesignFile::from_json(&text)
            .map(|(file, proof)| of_model(&file.name, &proof.model)),
        Kind::Gains => GainsFile::from_json(&text).map(|gains| of_gains(&gains)),
    };
    let summary = summary.map_err(|problem| CliError::file(&args.file, problem))?;
    let report = CheckReport::new(kind, summary, warnings, conditions.as_ref());
    let lines = report.lines(&args.file);
    Ok(Answer::new(Exit::Yes, &report, &lines))
}
