//! `steadfast check FILE`

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;
use synth::model::{kind_of, Kind, Model};
use synth::problem::Problem;

use super::{files, print, CliError};
use crate::harness::scenario::Scenario;

/// Arguments of `check`.
#[derive(clap::Args)]
pub struct CheckArgs {
    /// Model, design, scenario, gains or problem file, or infeasibility certificate
    file: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Reads a file of any kind and says what it is. Nothing is proved here.
pub fn run(args: &CheckArgs) -> Result<ExitCode, CliError> {
    let text = files::text(&args.file)?;
    let (kind, summary) = match kind_of(&text) {
        Some(Kind::Design) => {
            let (design, model) = files::design_of(&args.file, &text)?;
            (
                Kind::Design,
                format!("{}, {}", design.name, describe(&model)),
            )
        }
        Some(Kind::Scenario) => (Kind::Scenario, scenario(args, &text)?),
        Some(Kind::Infeasibility) => {
            let (file, model) = files::infeasibility_of(&args.file, &text)?;
            (
                Kind::Infeasibility,
                format!("{}, {}", file.name, describe(&model)),
            )
        }
        Some(Kind::Problem) => {
            let problem = files::problem_of(&args.file, &text)?;
            (Kind::Problem, describe_problem(&problem))
        }
        Some(Kind::ProblemDesign) => {
            let (_, problem) = files::problem_design_of(&args.file, &text)?;
            (Kind::ProblemDesign, describe_problem(&problem))
        }
        Some(Kind::Gains) => {
            let gains = files::gains_of(&args.file, &text)?;
            let (inputs, states) = gains.gains[0].shape();
            let count = gains.gains.len();
            let summary = format!("{}, {count} gains, {inputs} x {states}", gains.file.name);
            (Kind::Gains, summary)
        }
        // A model is the default: its errors name the missing fields.
        Some(Kind::Model) | None => {
            let model = files::model_of(&args.file, &text)?;
            (
                Kind::Model,
                format!("{}, {}", model.file.name, describe(&model)),
            )
        }
    };
    if args.json {
        print(&json!({ "valid": true, "kind": kind.to_string(), "summary": summary }).to_string());
    } else {
        print(&format!(
            "{}: valid {kind} file: {summary}",
            args.file.display()
        ));
    }
    Ok(ExitCode::SUCCESS)
}

fn describe(model: &Model) -> String {
    let (states, inputs, disturbances, outputs) = model.plant.sizes();
    let vertices = model.task().system.vertices.len();
    format!(
        "{vertices} vertices, {states} states, {inputs} inputs, {disturbances} disturbances, {outputs} outputs"
    )
}

fn describe_problem(problem: &Problem) -> String {
    let plant = &problem.plant;
    format!(
        "{}, {}, {} vertices, {} states, {} inputs",
        problem.file.name,
        problem.task.name(),
        plant.vertices.len(),
        plant.states(),
        plant.inputs()
    )
}

fn scenario(args: &CheckArgs, text: &str) -> Result<String, CliError> {
    let scenario = Scenario::from_json(text);
    let scenario = scenario.map_err(|problem| CliError::file(&args.file, problem))?;
    Ok(format!("{}, {} s", scenario.name, scenario.duration_s))
}
