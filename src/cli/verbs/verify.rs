//! `steadfast verify FILE.json`

use std::path::{Path, PathBuf};

use synth::design::DesignFile;
use synth::feasibility::InfeasibilityFile;
use synth::model::{kind_of, Kind};
use synth::problem::ProblemDesignFile;

use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::show::design::DesignReport;
use crate::cli::show::infeasibility::{is_proved, RefutationReport};
use crate::cli::show::problem::ProblemReport;

/// Arguments of `verify`.
#[derive(clap::Args)]
pub struct VerifyArgs {
    /// Design file or infeasibility certificate
    file: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Proves a design, or that none exists, from a file alone. 0: proved; 2: not proved.
pub fn run(args: &VerifyArgs) -> Result<Answer, CliError> {
    let text = files::text(&args.file)?;
    match kind_of(&text) {
        Some(Kind::Infeasibility) => infeasibility(&args.file, &text),
        Some(Kind::ProblemDesign) => problem(&args.file, &text),
        _ => design(&args.file, &text),
    }
}

fn design(path: &Path, text: &str) -> Result<Answer, CliError> {
    let (design, model) = files::parse(path, text, DesignFile::from_json)?;
    let checked = design.verify(&model);
    let checked = checked.map_err(|problem| CliError::value(path, problem))?;
    let report = DesignReport::new(&design, &model, &checked);
    let lines = [vec![title(&design.name, path)], report.lines()].concat();
    Ok(Answer::new(Exit::from(checked.verdict), &report, &lines))
}

fn problem(path: &Path, text: &str) -> Result<Answer, CliError> {
    let (design, problem) = files::parse(path, text, ProblemDesignFile::from_json)?;
    let checked = design.verify(&problem);
    let checked = checked.map_err(|fault| CliError::value(path, fault))?;
    let report = ProblemReport::verified(&problem, &design, &checked);
    let lines = [vec![title(&design.name, path)], report.lines()].concat();
    Ok(Answer::new(Exit::from(checked.verdict), &report, &lines))
}

fn infeasibility(path: &Path, text: &str) -> Result<Answer, CliError> {
    let (file, model) = files::parse(path, text, InfeasibilityFile::from_json)?;
    let checked = file.verify(&model);
    let checked = checked.map_err(|problem| CliError::value(path, problem))?;
    let limits = match is_proved(&checked) {
        true => file.limits(&model, &checked),
        false => Ok(Vec::new()),
    };
    let limits = limits.map_err(|error| CliError::synthesis(path, error))?;
    let report = RefutationReport::new(&file, &checked, &limits);
    Ok(Answer::new(report.exit(), &report, &report.lines(path)))
}

fn title(name: &str, path: &Path) -> String {
    format!("design: {name} ({})", path.display())
}
