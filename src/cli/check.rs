//! `steadfast check FILE`

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;
use synth::model::{kind_of, read_text, Kind, Model};

use super::{files, print, CliError};
use crate::harness::scenario::Scenario;

/// Arguments of `check`.
#[derive(clap::Args)]
pub struct CheckArgs {
    /// Model, design, scenario or gains file
    file: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Reads a file of any kind and says what it is. Nothing is proved here.
pub fn run(args: &CheckArgs) -> Result<ExitCode, CliError> {
    let text = read_text(&args.file).map_err(|problem| CliError::file(&args.file, problem))?;
    let (kind, summary) = match kind_of(&text) {
        Some(Kind::Design) => {
            let (design, model) = files::design(&args.file)?;
            (
                Kind::Design,
                format!("{}, {}", design.name, describe(&model)),
            )
        }
        Some(Kind::Scenario) => (Kind::Scenario, scenario(args, &text)?),
        Some(Kind::Gains) => {
            let (_, gains) = files::gains(&args.file)?;
            let (inputs, states) = gains.gains[0].shape();
            let count = gains.gains.len();
            let summary = format!("{}, {count} gains, {inputs} x {states}", gains.file.name);
            (Kind::Gains, summary)
        }
        // A model is the default: its errors name the missing fields.
        Some(Kind::Model) | None => {
            let (_, model) = files::model(&args.file)?;
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

fn scenario(args: &CheckArgs, text: &str) -> Result<String, CliError> {
    let scenario = Scenario::from_json(text);
    let scenario = scenario.map_err(|problem| CliError::file(&args.file, problem))?;
    Ok(format!("{}, {} s", scenario.name, scenario.duration_s))
}
