//! `steadfast schema KIND`

use std::process::ExitCode;

use clap::ValueEnum;
use schemars::schema_for;
use synth::design::DesignFile;
use synth::model::ModelFile;

use super::{print, CliError};
use crate::harness::scenario::ScenarioFile;
use crate::harness::tune::file::TuneFile;

/// Arguments of `schema`.
#[derive(clap::Args)]
pub struct SchemaArgs {
    /// Kind of file
    kind: KindArg,
}

/// Kinds of files.
#[derive(Clone, Copy, ValueEnum)]
enum KindArg {
    /// What an engineer writes
    Model,
    /// What synthesize writes
    Design,
    /// What simulate runs
    Scenario,
    /// What tune searches for
    Requirements,
}

/// Prints the JSON Schema (draft 2020-12) of a kind of file.
pub fn run(args: &SchemaArgs) -> Result<ExitCode, CliError> {
    let schema = match args.kind {
        KindArg::Model => schema_for!(ModelFile),
        KindArg::Design => schema_for!(DesignFile),
        KindArg::Scenario => schema_for!(ScenarioFile),
        KindArg::Requirements => schema_for!(TuneFile),
    };
    // A schema is a JSON value already.
    print(&serde_json::to_string_pretty(&schema).unwrap_or_default());
    Ok(ExitCode::SUCCESS)
}
