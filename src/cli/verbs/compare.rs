//! `steadfast compare SCENARIO.json...`

use std::path::{Path, PathBuf};

use crate::batch::comparison::{
    Candidate, Comparison, ComparisonError, ComparisonJob, Curves, RunError, Task,
};
use crate::cli::answer::{Answer, Exit};
use crate::cli::design::read_design;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::progress::{threads, PartsProgress};
use crate::cli::show::facts::written;
use crate::controllers::ControllerChoice;
use crate::report::pages::files::{write_comparison, COMPARISON_PAGE};
use crate::run::design::Design;
use crate::run::summary::RunVerdict;
use crate::scenario::{Scenario, ScenarioFile};

/// Arguments of `compare`.
#[derive(clap::Args)]
pub struct CompareArgs {
    /// Scenario files: the same spacecraft, start, disturbance, limits and requirements, one controller
    /// each
    #[arg(required = true, num_args = 2..)]
    scenarios: Vec<PathBuf>,
    /// Design file, for scenarios whose controller is a design
    #[arg(long)]
    design: Option<PathBuf>,
    /// Take spacecraft, start, disturbance, limits, duration, metrics and requirements of this scenario
    /// for all
    #[arg(long, value_name = "SCENARIO")]
    take_system_from: Option<PathBuf>,
    /// Leave the runs with the standard faults out
    #[arg(long)]
    without_faults: bool,
    /// Folder for comparison.json, comparison.csv and comparison.html
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// A scenario file as it was read.
struct Read {
    path: PathBuf,
    file: ScenarioFile,
    sha256: String,
}

impl Read {
    fn name(&self) -> String {
        self.path.display().to_string()
    }
}

/// Compares controllers. 0: each meets every requirement; 2: one does not.
pub fn run(args: &CompareArgs) -> Result<Answer, CliError> {
    files::check_folder(args.output.as_deref())?;
    let mut files = Vec::new();
    for path in &args.scenarios {
        files.push(read(path)?);
    }
    let command_line = match &args.design {
        Some(path) => Some(read_design(path)?),
        None => None,
    };
    match &args.take_system_from {
        Some(path) => impose(path, &mut files, command_line.as_ref())?,
        None => require_one_task(&files)?,
    }
    let mut candidates = Vec::new();
    for file in &files {
        candidates.push(candidate(file, command_line.as_ref())?);
    }
    if args.design.is_some() && !candidates.iter().any(Candidate::needs_design) {
        let path = args.design.as_deref().unwrap_or(Path::new(""));
        let reason = "no scenario uses this design: the controller of none is 'design'";
        return Err(CliError::unsuitable(path, reason));
    }
    name_apart(&mut candidates, &files);
    let taken_from = args.take_system_from.as_ref();
    let taken_from = taken_from.map(|path| path.display().to_string());
    let (comparison, curves) = run_all(args, &candidates, taken_from)?;
    finish(args, &comparison, &curves)
}

fn finish(
    args: &CompareArgs,
    comparison: &Comparison,
    curves: &[Curves],
) -> Result<Answer, CliError> {
    let mut runs = comparison.runs.iter();
    let exit = Exit::of(runs.all(|row| row.verdict == RunVerdict::RequirementsMet));
    // It holds finite numbers, strings and lists only, so it can always be written.
    let json = serde_json::to_string(comparison).unwrap_or_default();
    let mut answer = Answer::file(exit, json, comparison.to_text());
    if let Some(folder) = &args.output {
        write_comparison(folder, comparison, curves)
            .map_err(|error| CliError::unsuitable(folder, error))?;
        answer = answer.remark(written(&folder.join(COMPARISON_PAGE)));
    }
    for row in &comparison.runs {
        if row.verdict == RunVerdict::ProofBroken {
            answer = answer.remark(format!("{}: {}", row.label, row.verdict.sentence()));
        }
    }
    Ok(answer)
}

fn run_all(
    args: &CompareArgs,
    candidates: &[Candidate],
    taken_from: Option<String>,
) -> Result<(Comparison, Vec<Curves>), CliError> {
    let with_faults = !args.without_faults;
    let job = ComparisonJob::new(candidates, taken_from, with_faults).map_err(comparison)?;
    let threads = threads(None)?;
    let progress = PartsProgress::start(job.runs(), "runs");
    let done = || progress.done();
    let compared = job.compare(&threads, &progress.control(&done));
    compared.map_err(|error| match error {
        RunError::Interrupted(_) => CliError::Interrupted,
        error => CliError::Comparison(error.to_string()),
    })
}

fn read(path: &Path) -> Result<Read, CliError> {
    let text = files::text(path)?;
    let (file, sha256) = Scenario::read(&text).map_err(|error| CliError::file(path, error))?;
    Ok(Read {
        path: path.to_path_buf(),
        file,
        sha256,
    })
}

/// The task of one scenario, which may be any, in place of every scenario's own.
fn impose(path: &Path, files: &mut [Read], design: Option<&Design>) -> Result<(), CliError> {
    let source = read(path)?;
    let task = Task::of(&source.name(), &source.file).map_err(comparison)?;
    let limit = candidate(&source, design)?.torque_limit();
    for read in files {
        Task::of(&read.name(), &read.file).map_err(comparison)?;
        read.file = task.imposed_on(&read.file, &limit);
    }
    Ok(())
}

fn require_one_task(files: &[Read]) -> Result<(), CliError> {
    let mut tasks = Vec::new();
    for read in files {
        tasks.push(Task::of(&read.name(), &read.file).map_err(comparison)?);
    }
    let Some((first, others)) = tasks.split_first() else {
        return Ok(());
    };
    for (task, read) in others.iter().zip(&files[1..]) {
        if let Some(difference) = task.first_difference(first) {
            return Err(comparison(ComparisonError::Differs {
                file: read.name(),
                other_file: files[0].name(),
                difference,
            }));
        }
    }
    Ok(())
}

fn comparison(error: ComparisonError) -> CliError {
    CliError::Comparison(error.to_string())
}

/// The checked scenario with its design: the command line's, or the scenario's, whose path starts at
/// the scenario's folder.
fn candidate(read: &Read, design: Option<&Design>) -> Result<Candidate, CliError> {
    let scenario = Scenario::from_file(&read.file, read.sha256.clone())
        .map_err(|error| CliError::value(&read.path, error))?;
    let design = match (&scenario.controller, design) {
        (ControllerChoice::Design(_), Some(design)) => Some(design.clone()),
        (ControllerChoice::Design(Some(file)), None) => {
            let folder = read.path.parent().unwrap_or(Path::new("."));
            Some(read_design(&folder.join(file))?)
        }
        _ => None,
    };
    Ok(Candidate {
        label: scenario.name.clone(),
        file: read.file.clone(),
        scenario,
        design,
    })
}

/// Scenarios with the same name are told apart by their files.
fn name_apart(candidates: &mut [Candidate], files: &[Read]) {
    let names: Vec<String> = candidates.iter().map(|one| one.label.clone()).collect();
    for (candidate, read) in candidates.iter_mut().zip(files) {
        if names
            .iter()
            .filter(|name| **name == candidate.label)
            .count()
            > 1
        {
            candidate.label = format!("{} ({})", candidate.label, read.name());
        }
    }
}
