//! The verbs, one file each.

pub mod analyse;
pub mod campaign;
pub mod check;
pub mod compare;
pub mod export;
pub mod feasibility;
mod held_command;
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

use super::answer::{complain, Answer, Exit};
use super::progress::watch_for_interruption;

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
    Synthesize(synthesize::SynthesizeArgs),
    /// Decide whether any design exists for a model file, with a proof
    Feasibility(feasibility::FeasibilityArgs),
    /// Find the smallest gain bound that can be proved for given gains
    Analyse(analyse::AnalyseArgs),
    /// Prove a design file or an infeasibility certificate from its numbers alone
    Verify(verify::VerifyArgs),
    /// Simulate a scenario: a controller on the nonlinear plant
    Simulate(simulate::SimulateArgs),
    /// Run several controllers on the same task and tabulate them
    Compare(compare::CompareArgs),
    /// Run variants of a scenario, or synthesize variants of a model, over a grid
    Sweep(sweep::SweepArgs),
    /// Make many runs of a scenario, with numbers sampled for each
    Campaign(campaign::CampaignArgs),
    /// Merge the shards of a campaign
    Merge(merge::MergeArgs),
    /// Search controller parameters for a spacecraft and write a scenario with them
    Tune(tune::TuneArgs),
    /// Rebuild the report page of a run from its files
    Report(report::ReportArgs),
    /// Check whether a file of any kind is valid
    Check(check::CheckArgs),
    /// Print the JSON Schema of a kind of file
    Schema(schema::SchemaArgs),
    /// Write a design, a trajectory or a semidefinite program for other programs
    Export(export::ExportArgs),
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
    watch_for_interruption();
    let (answer, json) = match &cli.verb {
        Verb::Synthesize(args) => (synthesize::run(args), args.json),
        Verb::Feasibility(args) => (feasibility::run(args), args.json),
        Verb::Analyse(args) => (analyse::run(args), args.json),
        Verb::Verify(args) => (verify::run(args), args.json),
        Verb::Simulate(args) => (simulate::run(args), args.json),
        Verb::Compare(args) => (compare::run(args), args.json),
        Verb::Sweep(args) => (sweep::run(args), args.json),
        Verb::Campaign(args) => (campaign::run(args), args.json),
        Verb::Merge(args) => (merge::run(args), args.json),
        Verb::Tune(args) => (tune::run(args), args.json),
        Verb::Report(args) => (report::run(args), false),
        Verb::Check(args) => (check::run(args), args.json),
        Verb::Schema(args) => (schema::run(args), false),
        Verb::Export(args) => (export::run(args), false),
        Verb::Solve(args) => (solve::run(args), args.json),
    };
    match answer {
        Ok(answer) => answer.print(json),
        Err(error) => {
            complain(&error.to_string());
            error.exit().into()
        }
    }
}

/// Prints help, or what is wrong with the arguments in one line.
fn usage(error: &clap::Error) -> ExitCode {
    let help = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    if help || !error.use_stderr() {
        if error.use_stderr() {
            // Nothing is left to say so where this fails.
            let _ = error.print();
            return Exit::Usage.into();
        }
        let text = error.render().to_string();
        return Answer::text(Exit::Yes, text.trim_end().to_string()).print(false);
    }
    complain(&one_line(&error.to_string()));
    Exit::Usage.into()
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
