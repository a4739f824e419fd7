//! `steadfast tune REQUIREMENTS.json -o SCENARIO.json`

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;
use synth::model::read_text;

use crate::batch::engine::Threads;
use crate::batch::tune::file::Requirements;
use crate::batch::tune::limits::check_possible;
use crate::batch::tune::report::{RunReport, TuneReport};
use crate::batch::tune::{tune, Tuned};
use crate::cli::answer::{print, EXIT_NO};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::progress::{threads, PartsProgress};

/// Arguments of `tune`.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct TuneArgs {
    /// Requirements file
    requirements: PathBuf,
    /// Scenario file to write
    #[arg(short, long)]
    output: PathBuf,
    /// Threads; one for each processor when left out
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Searches, validates and writes the scenario. 0: every requirement is met on every axis tried; 2: one
/// is missed.
pub fn run(args: &TuneArgs) -> Result<ExitCode, CliError> {
    let failed = |error| CliError::file(&args.requirements, error);
    let text = read_text(&args.requirements).map_err(failed)?;
    let requirements = Requirements::from_json(&text).map_err(failed)?;
    check_possible(&requirements)
        .map_err(|error| CliError::unsuitable(&args.requirements, error))?;
    files::check_output(&args.output, &args.requirements)?;
    let tuned = tuned(&requirements, &threads(args.jobs)?)?;
    // A file's types hold numbers, texts and lists only, so they can always be written.
    let scenario = serde_json::to_string_pretty(&tuned.scenario).unwrap_or_default() + "\n";
    files::write(&args.output, &scenario)?;
    match args.json {
        true => print(&json!(tuned.report).to_string()),
        false => {
            print(&describe(&tuned.report));
            print(&format!("written: {}", args.output.display()));
        }
    }
    Ok(match tuned.report.met() {
        true => ExitCode::SUCCESS,
        false => ExitCode::from(EXIT_NO),
    })
}

fn tuned(requirements: &Requirements, threads: &Threads) -> Result<Tuned, CliError> {
    let progress = PartsProgress::start(requirements.search.candidates, "candidates at most");
    let done = || progress.done();
    let tuned = tune(requirements, threads, &progress.control(&done));
    tuned.map_err(|_| CliError::Interrupted)
}

fn describe(report: &TuneReport) -> String {
    let training = match report.training_met {
        true => "every training run meets the requirements with a margin",
        false => "some training run does not meet the requirements with a margin",
    };
    let mut lines = vec![
        format!("requirements: {}", report.name),
        format!(
            "shortest turn that any controller could make: {:.3} s",
            report.least_time_s
        ),
        format!("candidates tried: {}; {training}", report.candidates),
        format!(
            "validation: {} of {} random axes meet every requirement over {} s, with and without the disturbance",
            report.axes_met, report.axes, report.duration_s
        ),
    ];
    for run in report.runs.iter().filter(|run| !run.met) {
        lines.push(missed(run));
    }
    lines.join("\n")
}

fn missed(run: &RunReport) -> String {
    let [x, y, z] = run.axis;
    let disturbance = if run.disturbed { "with" } else { "without" };
    let what: Vec<String> = run
        .missed
        .iter()
        .map(|one| {
            let value = one
                .value
                .map_or("none".to_string(), |value| format!("{value:.5}"));
            format!("{} {}: {value}", one.name, one.limit)
        })
        .collect();
    let what = match what.as_slice() {
        [] => "the run diverged or could not be made".to_string(),
        list => list.join("; "),
    };
    format!("  missed about [{x:.3}, {y:.3}, {z:.3}] {disturbance} disturbance: {what}")
}
