//! `steadfast campaign SCENARIO.json --runs N -o DIR`

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::Arc;

use crate::base::files::what_was_written;
use crate::batch::campaign::finish::finish;
use crate::batch::campaign::folder::{
    is_kept_run, is_part, CAMPAIGN_FILE, DESIGN_FILE, FAILED_FOLDER, PARTS_FOLDER, PROFILES_FILE,
    RUNS_FILE, SCENARIO_FILE,
};
use crate::batch::campaign::job::CampaignJob;
use crate::batch::campaign::plan::{Plan, MAX_RUNS};
use crate::batch::campaign::record::{Results, State};
use crate::batch::campaign::CampaignError;
use crate::batch::engine::{Control, Interrupted};
use crate::batch::store::chunks::Shard;
use crate::cli::answer::{note, Answer};
use crate::cli::arguments::{run_count, whole};
use crate::cli::contents::{Contents, CAMPAIGN, SUMMARY};
use crate::cli::design::{design_of, design_path};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics::{of_scenario, warn};
use crate::cli::progress::{interrupted, threads, PartsProgress};
use crate::cli::show::campaign::answer;
use crate::cli::target::Targets;
use crate::run::files::SUMMARY_FILE;
use crate::scenario::Scenario;

/// Most failed runs that are kept when the command line does not say.
pub(crate) const KEPT: u64 = 100;

/// Arguments of `campaign`.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct CampaignArgs {
    /// Scenario file; its `dispersions` state what is sampled for every run
    scenario: PathBuf,
    /// Number of runs
    #[arg(long, value_name = "N", value_parser = run_count)]
    runs: u64,
    /// Seed; that of the scenario when left out
    #[arg(long, value_parser = whole)]
    seed: Option<u64>,
    /// Threads; one for each processor when left out
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Make part i of n only, for `merge`
    #[arg(long, value_name = "i/n")]
    shard: Option<String>,
    /// Most failed runs that are kept with their trajectory
    #[arg(long, value_name = "K", default_value_t = KEPT, value_parser = whole)]
    keep: u64,
    /// Design file, for scenarios whose controller is a design
    #[arg(long)]
    design: Option<PathBuf>,
    /// Folder for the results; the same command goes on with what is there
    #[arg(short, long)]
    output: PathBuf,
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Makes the runs. 0: every run met every requirement; 2: some did not.
pub fn run(args: &CampaignArgs) -> Result<Answer, CliError> {
    check_runs(args.runs)?;
    let given = [Some(&args.scenario), args.design.as_ref()];
    let inputs: Vec<&Path> = given.into_iter().flatten().map(PathBuf::as_path).collect();
    check_folder(&args.output, &inputs, args.force)?;
    let shard = args.shard.as_deref().map(parse_shard).transpose()?;
    let (text, scenario) = files::load(&args.scenario, Scenario::from_json)?;
    let given = args.design.as_deref();
    let design = design_of(&scenario, &args.scenario, given)?;
    let design_text = match design_path(&scenario, &args.scenario, given) {
        Some(path) => Some(files::text(&path)?),
        None => None,
    };
    warn(&of_scenario(&scenario, &text));
    let failed = |error| CliError::campaign(&args.scenario, error);
    let plan = Plan::new(&text, design.as_ref(), args.seed, args.runs).map_err(failed)?;
    if plan.columns.drawn.is_empty() {
        note("note: the scenario has no dispersions; the runs differ in their noise only");
    }
    let threads = threads(args.jobs)?;
    let job = CampaignJob::new(&plan, shard, threads, &args.output).map_err(failed)?;
    let stop = interrupted();
    let open = job.prepare(&text, design_text.as_deref(), &stop);
    let results = open.and_then(|open| make(&job, open.state, args.keep as usize, stop));
    let results = results.map_err(|error| stopped(&args.scenario, &job, error))?;
    Ok(answer(&results, &job.folder.inputs, &args.output))
}

fn make(
    job: &CampaignJob,
    state: State,
    keep: usize,
    stop: Arc<AtomicBool>,
) -> Result<Results, CampaignError> {
    let all = job.runs();
    let done = match state {
        State::Running => job.runs_done(),
        State::Complete => all,
    };
    let progress = PartsProgress::resume(done as usize, all as usize, "runs");
    let control = Control {
        done: &|| progress.done(),
        stop,
    };
    if state == State::Running {
        job.run(&control)?;
    }
    finish(job, state, keep, &control.stop)
}

/// The files of a campaign beside its record.
const FILES: [(&str, Contents); 4] = [
    (RUNS_FILE, Contents::Parquet),
    (PROFILES_FILE, Contents::Parquet),
    (
        SCENARIO_FILE,
        Contents::Part("copy of the campaign's scenario"),
    ),
    (DESIGN_FILE, Contents::Part("copy of the campaign's design")),
];

/// Tries the folder of a campaign. Where one has begun, its record says whose the files are.
pub(crate) fn check_folder(folder: &Path, inputs: &[&Path], force: bool) -> Result<(), CliError> {
    let targets = Targets { inputs, force };
    let begun = CAMPAIGN.stands_in(&folder.join(CAMPAIGN_FILE));
    let files: &[(&str, Contents)] = if begun { &[] } else { &FILES };
    targets.check_folder(Some(folder), files)?;
    if !begun {
        targets.check_no_other(Some(folder), (SUMMARY_FILE, SUMMARY), "a run")?;
    }
    targets.check_parts(&folder.join(PARTS_FOLDER), |name| begun && is_part(name))?;
    // What else is in the folder of kept runs is left alone.
    targets.check_parts(&folder.join(FAILED_FOLDER), |name| {
        begun || !is_kept_run(name)
    })
}

/// Refuses numbers of runs that are no campaign.
pub(crate) fn check_runs(runs: u64) -> Result<(), CliError> {
    if (1..=MAX_RUNS).contains(&runs) {
        return Ok(());
    }
    Err(CliError::Argument {
        argument: "--runs",
        reason: format!("{runs} is not allowed; it must be from 1 to {MAX_RUNS}"),
    })
}

fn parse_shard(text: &str) -> Result<Shard, CliError> {
    let parts = text.split_once('/');
    let numbers = parts.and_then(|(index, count)| {
        let (index, count) = (index.trim().parse().ok()?, count.trim().parse().ok()?);
        Some(Shard { index, count })
    });
    let valid = numbers.filter(|shard| (1..=shard.count).contains(&shard.index));
    valid.ok_or_else(|| CliError::Argument {
        argument: "--shard",
        reason: format!("'{text}' is not of the form i/n with i from 1 to n"),
    })
}

/// What is wrong, and what is done.
fn stopped(scenario: &Path, job: &CampaignJob, error: CampaignError) -> CliError {
    let (done, all) = (job.runs_done(), job.runs());
    let kept = match done {
        0 => format!("; no run is done; {}", what_was_written()),
        _ => format!(
            "; {done} of {all} runs are done and kept in {}; the same command goes on with the rest",
            job.folder.path.display()
        ),
    };
    match error {
        CampaignError::Interrupted(Interrupted) => CliError::Campaign(format!("interrupted{kept}")),
        error if done == 0 => CliError::campaign(scenario, error),
        error => CliError::Campaign(format!("{}{kept}", CliError::campaign(scenario, error))),
    }
}
