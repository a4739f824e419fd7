//! `steadfast check FILE`

use std::path::PathBuf;

use synth::model::{kind_of, Kind};

use crate::cli::answer::{Answer, Exit};
use crate::cli::document::Document;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics;
use crate::cli::show::check::{
    of_facts, of_gains, of_model, of_problem, of_requirements, CheckReport,
};
use crate::scenario::design_check;

/// Arguments of `check`.
#[derive(clap::Args)]
pub struct CheckArgs {
    /// Model, design, scenario, gains, problem or requirements file, infeasibility certificate, or a run's
    /// summary.json
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
    let document = files::parse(&args.file, &text, |text| Document::read(kind, text))?;
    let summary = match &document {
        Document::Model(model) => {
            warnings = physics::of_model(model, &text);
            of_model(&model.file.name, model)
        }
        Document::Facts(facts) => {
            warnings = physics::of_facts(facts, &text);
            of_facts(facts)
        }
        Document::Design(file, model) => of_model(&file.name, model),
        Document::Infeasibility(file, model) => of_model(&file.name, model),
        Document::Scenario(scenario) => {
            conditions = design_check(scenario);
            warnings = physics::of_scenario(scenario, &text);
            format!("{}, {} s", scenario.name, scenario.duration_s)
        }
        Document::Requirements(own) => {
            warnings = physics::of_requirements(own, &text);
            of_requirements(own)
        }
        Document::Problem(problem) | Document::ProblemDesign(problem) => of_problem(problem),
        Document::HeldCommandDesign(file, model) => of_model(&file.name, model),
        Document::Gains(gains) => of_gains(gains),
        Document::Summary(summary) => {
            format!("{}, {}", summary.scenario, summary.verdict.sentence())
        }
    };
    if !args.json {
        physics::warn(&warnings);
    }
    let report = CheckReport::new(kind, summary, warnings, conditions.as_ref());
    let lines = report.lines(&args.file);
    Ok(Answer::new(Exit::Yes, &report, &lines))
}
