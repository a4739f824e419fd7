//! `steadfast simulate SCENARIO.json`

use std::path::{Path, PathBuf};

use super::campaign::check_runs;
use crate::batch::campaign::folder::CAMPAIGN_FILE;
use crate::batch::campaign::plan::Plan;
use crate::cli::answer::{Answer, Exit};
use crate::cli::arguments::{run_count, whole};
use crate::cli::contents::{Contents, CAMPAIGN, SUMMARY};
use crate::cli::design::{design_of, design_path};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics::{of_scenario, warn};
use crate::cli::show::facts::written;
use crate::cli::show::run::lines;
use crate::cli::target::Targets;
use crate::report::html::PageKind;
use crate::report::pages::files::write_run;
use crate::run::design::Design;
use crate::run::files::{summary_text, REPORT_FILE, SUMMARY_FILE, TRAJECTORY_FILE};
use crate::run::outcome::RunOutcome;
use crate::run::simulate;
use crate::run::summary::RunVerdict;
use crate::scenario::{PlanFile, Scenario};

/// Arguments of `simulate`.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct SimulateArgs {
    /// Scenario file
    scenario: PathBuf,
    /// Design file, for scenarios whose controller is a design
    #[arg(long)]
    design: Option<PathBuf>,
    /// Make one run of the scenario's campaign, by its index from 0
    #[arg(long, value_name = "K", value_parser = whole)]
    run_index: Option<u64>,
    /// Seed of the campaign; that of the scenario when left out
    #[arg(long, requires = "run_index", value_parser = whole)]
    seed: Option<u64>,
    /// Number of runs of the campaign; needed with a Latin hypercube
    #[arg(long, value_name = "N", requires = "run_index", value_parser = run_count)]
    runs: Option<u64>,
    /// Folder for trajectory.csv, summary.json and report.html
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// The files of a run.
const FILES: [(&str, Contents); 3] = [
    (TRAJECTORY_FILE, Contents::Trajectory),
    (SUMMARY_FILE, SUMMARY),
    (REPORT_FILE, Contents::Page(PageKind::Run)),
];

/// Runs a scenario. 0: every requirement is met; 2: one is missed, the run diverged or a proved bound
/// was broken.
pub fn run(args: &SimulateArgs) -> Result<Answer, CliError> {
    let (text, scenario) = files::load(&args.scenario, Scenario::from_json)?;
    let path = design_path(&scenario, &args.scenario, args.design.as_deref());
    let inputs: Vec<&Path> = [Some(args.scenario.as_path()), path.as_deref()]
        .into_iter()
        .flatten()
        .collect();
    let targets = Targets {
        inputs: &inputs,
        force: args.force,
    };
    let folder = args.output.as_deref();
    targets.check_folder(folder, &FILES)?;
    targets.check_no_other(folder, (CAMPAIGN_FILE, CAMPAIGN), "a campaign")?;
    let design = design_of(&scenario, &args.scenario, args.design.as_deref())?;
    warn(&of_scenario(&scenario, &text));
    let outcome = match args.run_index {
        Some(run) => run_of_campaign(args, &text, &scenario, design.as_ref(), run)?,
        None => simulate(&scenario, design.as_ref(), args.output.is_some())
            .map_err(|error| CliError::unsuitable(&args.scenario, error))?,
    };
    let summary = &outcome.summary;
    let exit = Exit::of(summary.verdict == RunVerdict::RequirementsMet);
    let json = summary_text(summary).trim_end().to_string();
    let mut answer = Answer::file(exit, json, lines(summary).join("\n"));
    if let Some(folder) = &args.output {
        write_run(folder, &outcome)?;
        answer = answer.remark(written(&folder.join(REPORT_FILE)));
    }
    if summary.verdict == RunVerdict::ProofBroken {
        answer = answer.remark(summary.verdict.sentence());
    }
    Ok(answer)
}

/// The run that a campaign makes.
fn run_of_campaign(
    args: &SimulateArgs,
    text: &str,
    scenario: &Scenario,
    design: Option<&Design>,
    run: u64,
) -> Result<RunOutcome, CliError> {
    let sampling = scenario.dispersions.as_ref().map(|all| all.sampling);
    let wrong = |argument, reason: String| Err(CliError::Argument { argument, reason });
    let runs = match args.runs {
        Some(runs) => runs,
        None if sampling == Some(PlanFile::LatinHypercube) => {
            let reason = "is needed, because a Latin hypercube depends on it".to_string();
            return wrong("--runs", reason);
        }
        None => run.saturating_add(1),
    };
    check_runs(runs)?;
    if run >= runs {
        let reason = format!("{run} is not allowed; it must be from 0 to {}", runs - 1);
        return wrong("--run-index", reason);
    }
    let plan = Plan::new(text, design, args.seed, runs);
    let plan = plan.map_err(|error| CliError::campaign(&args.scenario, error))?;
    let outcome = plan.alone(run, args.output.is_some());
    let (_, outcome) = outcome.map_err(|error| CliError::campaign(&args.scenario, error))?;
    Ok(outcome)
}
