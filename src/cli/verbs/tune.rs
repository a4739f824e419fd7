//! `steadfast tune REQUIREMENTS.json -o SCENARIO.json`

use std::path::PathBuf;

use synth::model::Kind;

use crate::batch::engine::Threads;
use crate::batch::tune::file::Requirements;
use crate::batch::tune::limits::check_possible;
use crate::batch::tune::{tune, Tuned};
use crate::cli::answer::{Answer, Exit};
use crate::cli::contents::Contents;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics::{of_requirements, warn};
use crate::cli::progress::{threads, PartsProgress};
use crate::cli::show::facts::written;
use crate::cli::show::tune::lines;
use crate::cli::target::Targets;

/// Arguments of `tune`.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct TuneArgs {
    /// Requirements file
    requirements: PathBuf,
    /// Scenario file to write
    #[arg(short, long)]
    output: PathBuf,
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
    /// Threads; one for each processor when left out
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Searches, validates and writes the scenario. 0: every requirement is met on every axis tried; 2: one
/// is missed.
pub fn run(args: &TuneArgs) -> Result<Answer, CliError> {
    let (text, requirements) = files::load(&args.requirements, Requirements::from_json)?;
    check_possible(&requirements)
        .map_err(|error| CliError::unsuitable(&args.requirements, error))?;
    let targets = Targets {
        inputs: &[&args.requirements],
        force: args.force,
    };
    let contents = Contents::Document(&[Kind::Scenario]);
    targets.check_file(Some(&args.output), contents)?;
    warn(&of_requirements(&requirements, &text));
    let tuned = tuned(&requirements, &threads(args.jobs)?)?;
    // A file's types hold numbers, texts and lists only, so they can always be written.
    let scenario = serde_json::to_string_pretty(&tuned.scenario).unwrap_or_default() + "\n";
    files::write(&args.output, &scenario)?;
    let mut lines = lines(&tuned.report);
    lines.push(written(&args.output));
    Ok(Answer::new(
        Exit::of(tuned.report.met()),
        &tuned.report,
        &lines,
    ))
}

fn tuned(requirements: &Requirements, threads: &Threads) -> Result<Tuned, CliError> {
    let progress = PartsProgress::start(requirements.file.search.candidates, "candidates at most");
    let done = || progress.done();
    let tuned = tune(requirements, threads, &progress.control(&done));
    tuned.map_err(|_| CliError::Interrupted)
}
