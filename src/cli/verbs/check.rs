//! `steadfast check FILE`

use std::path::PathBuf;

use synth::model::{kind_of, Kind};

use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::show::check::CheckReport;
use crate::cli::show::contents::{of_gains, of_model, of_problem, of_requirements};
use crate::scenario::design_check;

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
    let path = &args.file;
    let mut design = None;
    // A model is the default: its errors name the missing fields.
    let kind = kind_of(&text).unwrap_or(Kind::Model);
    let summary = match kind {
        Kind::Design => {
            let (design, model) = files::design_of(path, &text)?;
            of_model(&design.name, &model)
        }
        Kind::Scenario => {
            let scenario = files::scenario_of(path, &text)?;
            design = design_check(&scenario);
            format!("{}, {} s", scenario.name, scenario.duration_s)
        }
        Kind::Requirements => of_requirements(&files::requirements_of(path, &text)?),
        Kind::Infeasibility => {
            let (file, model) = files::infeasibility_of(path, &text)?;
            of_model(&file.name, &model)
        }
        Kind::Problem => of_problem(&files::problem_of(path, &text)?),
        Kind::ProblemDesign => of_problem(&files::problem_design_of(path, &text)?.1),
        Kind::Gains => of_gains(&files::gains_of(path, &text)?),
        Kind::Model => {
            let model = files::model_of(path, &text)?;
            of_model(&model.file.name, &model)
        }
    };
    let report = CheckReport::new(kind, summary, design.as_ref());
    let lines = report.lines(&args.file);
    Ok(Answer::new(Exit::Yes, &report, &lines))
}
