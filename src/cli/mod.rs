//! The command line: one file for each verb.

mod check;
mod error;
mod export;
mod files;
mod progress;
mod schema;
mod synthesize;
mod verify;

pub use error::CliError;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Exit status: the answer is no (infeasible, not proved, requirement missed).
pub const EXIT_NO: u8 = 2;
/// Exit status: the solver failed numerically.
pub const EXIT_SOLVER: u8 = 3;

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
    /// Prove a design file from its numbers alone
    Verify(verify::VerifyArgs),
    /// Read a model, design or scenario file and say whether it is valid
    Check(check::CheckArgs),
    /// Print the JSON Schema of a kind of file
    Schema(schema::SchemaArgs),
    /// Write the semidefinite program of a model or design for other solvers
    Export(export::ExportArgs),
}

/// Runs the command line and returns its exit status: 0 done; 1 bad usage or input; 2 the answer is
/// no; 3 the solver failed.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // Printing help or a usage error can only fail when the stream is closed.
            let _ = error.print();
            return ExitCode::from(u8::from(error.use_stderr()));
        }
    };
    let outcome = match &cli.verb {
        Verb::Synthesize(args) => synthesize::run(args),
        Verb::Verify(args) => verify::run(args),
        Verb::Check(args) => check::run(args),
        Verb::Schema(args) => schema::run(args),
        Verb::Export(args) => export::run(args),
    };
    outcome.unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::from(1)
    })
}

/// Prints to standard output; a closed pipe is not an error worth a panic.
fn print(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stdout(), "{text}");
}
