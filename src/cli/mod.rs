//! The command line: one file for each verb.

mod answer;
mod design;
mod error;
mod files;
mod progress;
mod show;
mod solver;
mod verbs;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

use answer::complain;

pub use error::CliError;

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
    Synthesize(verbs::synthesize::args::SynthesizeArgs),
    /// Say whether any design exists for a model file, with a proof
    Feasibility(verbs::feasibility::FeasibilityArgs),
    /// Find the smallest gain bound that can be proved for given gains
    Analyse(verbs::analyse::AnalyseArgs),
    /// Prove a design file or an infeasibility certificate from its numbers alone
    Verify(verbs::verify::VerifyArgs),
    /// Run a scenario: a controller on the real plant
    Simulate(verbs::simulate::SimulateArgs),
    /// Run several controllers on the same task and put them side by side
    Compare(verbs::compare::CompareArgs),
    /// Run variants of a scenario, or synthesize variants of a model, over a grid
    Sweep(verbs::sweep::SweepArgs),
    /// Make many runs of a scenario with numbers drawn anew for each
    Campaign(verbs::campaign::CampaignArgs),
    /// Make one campaign of its shards
    Merge(verbs::merge::MergeArgs),
    /// Search controller parameters for a spacecraft and write a scenario with them
    Tune(verbs::tune::TuneArgs),
    /// Build the report page of a run again from its files
    Report(verbs::report::ReportArgs),
    /// Read a file of any kind and say whether it is valid
    Check(verbs::check::CheckArgs),
    /// Print the JSON Schema of a kind of file
    Schema(verbs::schema::SchemaArgs),
    /// Write a design, a trajectory or a semidefinite program for other programs
    Export(verbs::export::args::ExportArgs),
    /// Solve a semidefinite program given as SDPA sparse text
    Solve(verbs::solve::SolveArgs),
}

/// Runs the command line and returns its exit status: 0 done; 1 bad usage or input; 2 the answer is
/// no; 3 the solver failed.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
    };
    let outcome = match &cli.verb {
        Verb::Synthesize(args) => verbs::synthesize::run(args),
        Verb::Feasibility(args) => verbs::feasibility::run(args),
        Verb::Analyse(args) => verbs::analyse::run(args),
        Verb::Verify(args) => verbs::verify::run(args),
        Verb::Simulate(args) => verbs::simulate::run(args),
        Verb::Compare(args) => verbs::compare::run(args),
        Verb::Sweep(args) => verbs::sweep::run(args),
        Verb::Campaign(args) => verbs::campaign::run(args),
        Verb::Merge(args) => verbs::merge::run(args),
        Verb::Tune(args) => verbs::tune::run(args),
        Verb::Report(args) => verbs::report::run(args),
        Verb::Check(args) => verbs::check::run(args),
        Verb::Schema(args) => verbs::schema::run(args),
        Verb::Export(args) => verbs::export::run(args),
        Verb::Solve(args) => verbs::solve::run(args),
    };
    outcome.unwrap_or_else(|error| {
        complain(&error.to_string());
        ExitCode::from(error.exit_status())
    })
}

/// Prints help, or what is wrong with the arguments in one line.
fn usage(error: &clap::Error) -> ExitCode {
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
