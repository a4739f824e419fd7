//! The verbs, one file each.

pub mod analyse;
pub mod campaign;
pub mod check;
pub mod compare;
pub mod export;
pub mod feasibility;
pub mod merge;
pub mod report;
pub mod schema;
pub mod simulate;
pub mod solve;
pub mod sweep;
pub mod synthesize;
pub mod tune;
pub mod verify;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

use super::answer::complain;

#[derive(Parser)]
#[command(
    name = "steadfast",
    version,
    about = "Synthesizes event-triggered attitude controllers with a proof, and runs them"
)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Design a controller for a model file and prove it
    Synthesize(synthesize::args::SynthesizeArgs),
    /// Say whether any design exists for a model file, with a proof
    Feasibility(feasibility::FeasibilityArgs),
    /// Find the smallest gain bound that can be proved for given gains
    Analyse(analyse::AnalyseArgs),
    /// Prove a design file or an infeasibility certificate from its numbers alone
    Verify(verify::VerifyArgs),
    /// Run a scenario: a controller on the real plant
    Simulate(simulate::SimulateArgs),
    /// Run several controllers on the same task and put them side by side
    Compare(compare::CompareArgs),
    /// Run variants of a scenario, or synthesize variants of a model, over a grid
    Sweep(sweep::SweepArgs),
    /// Make many runs of a scenario with numbers drawn anew for each
    Campaign(campaign::CampaignArgs),
    /// Make one campaign of its shards
    Merge(merge::MergeArgs),
    /// Search controller parameters for a spacecraft and write a scenario with them
    Tune(tune::TuneArgs),
    /// Build the report page of a run again from its files
    Report(report::ReportArgs),
    /// Read a file of any kind and say whether it is valid
    Check(check::CheckArgs),
    /// Print the JSON Schema of a kind of file
    Schema(schema::SchemaArgs),
    /// Write a design, a trajectory or a semidefinite program for other programs
    Export(export::args::ExportArgs),
    /// Solve a semidefinite program given as SDPA sparse text
    Solve(solve::SolveArgs),
}

/// Runs the command line and returns its exit status: 0 done; 1 bad usage or input; 2 the answer is
/// no; 3 the solver failed.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
    };
    let outcome = match &cli.verb {
        Verb::Synthesize(args) => synthesize::run(args),
        Verb::Feasibility(args) => feasibility::run(args),
        Verb::Analyse(args) => analyse::run(args),
        Verb::Verify(args) => verify::run(args),
        Verb::Simulate(args) => simulate::run(args),
        Verb::Compare(args) => compare::run(args),
        Verb::Sweep(args) => sweep::run(args),
        Verb::Campaign(args) => campaign::run(args),
        Verb::Merge(args) => merge::run(args),
        Verb::Tune(args) => tune::run(args),
        Verb::Report(args) => report::run(args),
        Verb::Check(args) => check::run(args),
        Verb::Schema(args) => schema::run(args),
        Verb::Export(args) => export::run(args),
        Verb::Solve(args) => solve::run(args),
    };
    outcome.unwrap_or_else(|error| {
        complain(&error.to_string());
        ExitCode::from(error.exit_status())
    })
}

/// Prints help, or what is wrong with the arguments in one line.
pub(crate) fn usage(error: &clap::Error) -> ExitCode {
    let help = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    if help || !error.use_stderr() {
        // Printing help can only fail when the stream is closed.
        let _ = error.print();
        return ExitCode::from(u8::from(error.use_stderr()));
    }
    complain(&one_line(&error.to_string()));
    ExitCode::from(1)
}

/// The parser's lines as one sentence.
fn one_line(text: &str) -> String {
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let said = lines.filter(|line| !line.starts_with("For more information"));
    let joined = said.fold(String::new(), |mut sentence, line| {
        let between = match sentence.chars().last() {
            None => "",
            Some(':') => " ",
            Some(_) => "; ",
        };
        sentence.push_str(between);
        sentence.push_str(line);
        sentence
    });
    joined.trim_start_matches("error: ").to_string()
}
