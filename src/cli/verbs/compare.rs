//! `steadfast compare SCENARIO.json...`

use std::path::{Path, PathBuf};

use crate::batch::comparison::{
    check_one_task, impose, name_apart, Candidate, ComparisonError, ComparisonJob, Entry,
};
use crate::cli::answer::{Answer, Exit};
use crate::cli::contents::{Contents, COMPARISON, COMPARISON_TABLE};
use crate::cli::design::{announce, read_design};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics::{of_scenario, warn};
use crate::cli::progress::{threads, PartsProgress};
use crate::cli::show::facts::written;
use crate::cli::target::Targets;
use crate::controllers::ControllerChoice;
use crate::report::html::PageKind;
use crate::report::pages::files::{
    write_comparison, COMPARISON_CSV, COMPARISON_FILE, COMPARISON_PAGE,
};
use crate::run::check_design;
use crate::run::design::Design;
use crate::run::summary::RunVerdict;
use crate::scenario::Scenario;

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
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// The files of a comparison.
const FILES: [(&str, Contents); 3] = [
    (COMPARISON_FILE, COMPARISON),
    (COMPARISON_CSV, COMPARISON_TABLE),
    (COMPARISON_PAGE, Contents::Page(PageKind::Comparison)),
];

/// Compares controllers. 0: each meets every requirement; 2: one does not.
pub fn run(args: &CompareArgs) -> Result<Answer, CliError> {
    let inputs = args.scenarios.iter().chain(&args.design);
    let inputs: Vec<&Path> = inputs.map(PathBuf::as_path).collect();
    let targets = Targets {
        inputs: &inputs,
        force: args.force,
    };
    targets.check_folder(args.output.as_deref(), &FILES)?;
    let candidates = candidates(args)?;
    let taken_from = args.take_system_from.as_ref();
    let taken_from = taken_from.map(|path| path.display().to_string());
    let job = ComparisonJob::new(&candidates, taken_from, !args.without_faults).map_err(failed)?;
    let threads = threads(None)?;
    let progress = PartsProgress::start(job.runs(), "runs");
    let done = || progress.done();
    let compared = job.compare(&threads, &progress.control(&done));
    let (comparison, curves) = compared.map_err(failed)?;
    let mut runs = comparison.runs.iter();
    let exit = Exit::of(runs.all(|row| row.verdict == RunVerdict::RequirementsMet));
    // It holds finite numbers, strings and lists only, so it can always be written.
    let json = serde_json::to_string(&comparison).unwrap_or_default();
    let mut answer = Answer::file(exit, json, comparison.to_text());
    if let Some(folder) = &args.output {
        write_comparison(folder, &comparison, &curves)
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

fn failed(error: ComparisonError) -> CliError {
    match error {
        ComparisonError::Interrupted(_) => CliError::Interrupted,
        error => CliError::Comparison(error.to_string()),
    }
}

/// The scenarios, checked, all with one task.
fn candidates(args: &CompareArgs) -> Result<Vec<Candidate>, CliError> {
    let entries = args.scenarios.iter().map(|path| read(path));
    let mut entries = entries.collect::<Result<Vec<_>, _>>()?;
    let design = args.design.as_deref().map(read_design).transpose()?;
    match &args.take_system_from {
        Some(path) => {
            let source = read(path)?;
            source.check_spacecraft().map_err(failed)?;
            let source = candidate(source, design.as_ref())?;
            impose(&source, &mut entries).map_err(failed)?;
        }
        None => check_one_task(&entries).map_err(failed)?,
    }
    let candidates = entries.into_iter();
    let candidates = candidates.map(|entry| candidate(entry, design.as_ref()));
    let mut candidates = candidates.collect::<Result<Vec<_>, _>>()?;
    if let Some(path) = &args.design {
        if !candidates.iter().any(Candidate::needs_design) {
            let reason = "no scenario uses this design: the controller of none is 'design'";
            return Err(CliError::unsuitable(path, reason));
        }
    }
    let mut announced: Vec<&str> = Vec::new();
    for design in candidates
        .iter()
        .filter_map(|candidate| candidate.design.as_ref())
    {
        if !announced.contains(&design.sha256.as_str()) {
            announced.push(&design.sha256);
            announce(design);
        }
    }
    for candidate in &candidates {
        // The types of a file hold numbers, texts and lists only, so they can always be written.
        let text = serde_json::to_string(&candidate.entry.file).unwrap_or_default();
        let warnings = of_scenario(&candidate.scenario, &text).into_iter();
        let named = warnings.map(|text| format!("{}: {text}", candidate.entry.path.display()));
        warn(&named.collect::<Vec<_>>());
    }
    name_apart(&mut candidates);
    Ok(candidates)
}

fn read(path: &Path) -> Result<Entry, CliError> {
    let text = files::text(path)?;
    let (file, sha256) = Scenario::read(&text).map_err(|error| CliError::file(path, error))?;
    // What is wrong with a file comes before how it differs from others.
    Scenario::from_file(&file, sha256.clone()).map_err(|error| CliError::value(path, error))?;
    Ok(Entry {
        path: path.to_path_buf(),
        file,
        sha256,
    })
}

/// The checked scenario with its design: the command line's, or the scenario's, whose path starts at
/// the scenario's folder.
fn candidate(entry: Entry, design: Option<&Design>) -> Result<Candidate, CliError> {
    let scenario = Scenario::from_file(&entry.file, entry.sha256.clone())
        .map_err(|error| CliError::value(&entry.path, error))?;
    let design = match (&scenario.controller, design) {
        (ControllerChoice::Design(_), Some(design)) => Some(design.clone()),
        (ControllerChoice::Design(Some(file)), None) => {
            let folder = entry.path.parent().unwrap_or(Path::new("."));
            Some(read_design(&folder.join(file))?)
        }
        _ => None,
    };
    check_design(&scenario, design.as_ref())
        .map_err(|error| CliError::unsuitable(&entry.path, error))?;
    Ok(Candidate {
        label: scenario.name.clone(),
        entry,
        scenario,
        design,
    })
}
