//! `steadfast schema KIND`

use clap::ValueEnum;
use schemars::schema_for;
use synth::design::DesignFile;
use synth::feasibility::InfeasibilityFile;
use synth::held_command::HeldCommandDesignFile;
use synth::model::{GainsFile, ModelFile};
use synth::problem::{ProblemDesignFile, ProblemFile};
use synth::requirements::FactsFile;

use crate::batch::tune::file::TuneFile;
use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::scenario::ScenarioFile;

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
    /// What an engineer knows and requires; the rest of a model is found
    Facts,
    /// What synthesize writes
    Design,
    /// What simulate runs
    Scenario,
    /// What feasibility writes when no design exists
    Infeasibility,
    /// A design problem for a state feedback
    Problem,
    /// What synthesize writes for a problem
    ProblemDesign,
    /// What analyse writes for gains with a trigger on the command
    HeldCommandDesign,
    /// What analyse judges
    Gains,
    /// What tune searches for
    Requirements,
}

/// Prints the JSON Schema (draft 2020-12) of a kind of file.
pub fn run(args: &SchemaArgs) -> Result<Answer, CliError> {
    let schema = match args.kind {
        KindArg::Model => schema_for!(ModelFile),
        KindArg::Facts => schema_for!(FactsFile),
        KindArg::Design => schema_for!(DesignFile),
        KindArg::Gains => schema_for!(GainsFile),
        KindArg::Scenario => schema_for!(ScenarioFile),
        KindArg::Infeasibility => schema_for!(InfeasibilityFile),
        KindArg::Problem => schema_for!(ProblemFile),
        KindArg::ProblemDesign => schema_for!(ProblemDesignFile),
        KindArg::HeldCommandDesign => schema_for!(HeldCommandDesignFile),
        KindArg::Requirements => schema_for!(TuneFile),
    };
    // A schema is a JSON value already.
    let text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    Ok(Answer::text(Exit::Yes, text))
}
