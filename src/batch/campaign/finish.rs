//! From what is done to the campaign's tables, its kept runs and its record.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use synth::model::make_readable;

use super::folder::{
    run_folder, run_folder_name, CAMPAIGN_FILE, FAILED_FOLDER, PARTS_FOLDER, PROFILES_FILE,
    RUNS_FILE, SCENARIO_FILE,
};
use super::job::{inputs_text, CampaignJob};
use super::record::{
    CampaignFile, Inputs, ProfileGrid, RequirementCount, Results, State, CAMPAIGN_SCHEMA_VERSION,
};
use super::row::Rank;
use super::statistics::{count_missed, metric_quantiles, pass_rate_interval};
use super::table::{
    run_indices, run_verdicts, CampaignColumns, Content, CountedRun, TableReader, TableWriter,
};
use super::CampaignError;
use crate::base::files::{create_folder, write};
use crate::run::files::{summary_text, SUMMARY_FILE, TRAJECTORY_FILE};
use crate::run::summary::RunVerdict;

/// A table, what of the rows it holds, and the inputs in its metadata.
pub(crate) struct Source {
    pub path: PathBuf,
    pub content: Content,
    pub inputs: String,
}

/// What is counted while the rows pass.
#[derive(Debug, Default)]
pub(crate) struct RunCount {
    runs: u64,
    verdicts: BTreeMap<String, u64>,
    covered: Option<u64>,
    /// The worst failed runs, the worst first.
    worst: Vec<Rank>,
}

impl RunCount {
    fn add(&mut self, run: &CountedRun, keep: usize) {
        self.runs += 1;
        let verdict = run.verdict.name().to_string();
        *self.verdicts.entry(verdict).or_default() += 1;
        if let Some(covers) = run.proof_covers {
            *self.covered.get_or_insert(0) += u64::from(covers);
        }
        if run.verdict == RunVerdict::RequirementsMet {
            return;
        }
        let rank = Rank::new(run.verdict, run.margin, run.run);
        let place = self.worst.partition_point(|other| *other < rank);
        if place < keep {
            self.worst.insert(place, rank);
            self.worst.truncate(keep);
        }
    }

    fn failures(&self) -> u64 {
        let met = self.verdicts.get(RunVerdict::RequirementsMet.name());
        self.runs - met.copied().unwrap_or(0)
    }

    /// The worst failed runs, the worst first.
    pub fn worst_runs(&self) -> Vec<u64> {
        self.worst.iter().map(|rank| rank.run).collect()
    }
}

/// Writes the tables, the kept runs and the record of a job whose parts are all there, and removes the
/// parts. `keep`: most failed runs that are kept with their trajectory.
///
/// # Errors
/// A file that cannot be written; it was stopped. What was done before stays.
pub fn finish(job: &CampaignJob, keep: usize, stop: &AtomicBool) -> Result<Results, CampaignError> {
    let sources = |_: &str, _| {
        let sources = job.part_files().map(|path| Source {
            path,
            content: Content::Whole,
            inputs: inputs_text(&job.inputs),
        });
        sources.collect()
    };
    write_tables(&job.folder, &job.plan.columns, &job.inputs, sources)?;
    finish_again(job, keep, stop)
}

/// As [`finish`], from the tables of a job that is complete: another number of runs may be kept.
///
/// # Errors
/// A file that cannot be read or written; it was stopped.
pub fn finish_again(
    job: &CampaignJob,
    keep: usize,
    stop: &AtomicBool,
) -> Result<Results, CampaignError> {
    let count = count(&job.folder, &job.plan.columns, &job.inputs, keep)?;
    let results = recount(job, &count, stop)?;
    remove_parts(&job.folder)?;
    Ok(results)
}

fn recount(
    job: &CampaignJob,
    count: &RunCount,
    stop: &AtomicBool,
) -> Result<Results, CampaignError> {
    keep_runs(job, &count.worst_runs(), stop)?;
    let requirements = job.plan.nominal.requirements.iter();
    let requirements = requirements.filter_map(|requirement| {
        let (side, limit) = match (requirement.at_most, requirement.at_least) {
            (Some(limit), _) => ("at most", limit),
            (None, Some(limit)) => ("at least", limit),
            (None, None) => return None,
        };
        let metric = requirement.metric.key();
        Some(RequirementCount {
            name: format!("{metric} {side}"),
            metric: metric.to_string(),
            limit,
            missed: 0,
        })
    });
    let profile = ProfileGrid {
        times_s: job.plan.columns.times_s.clone(),
        quantities: job.plan.columns.quantities.clone(),
    };
    let record = Record {
        count,
        kept: count.worst_runs(),
        requirements: requirements.collect(),
        profile,
    };
    conclude(&job.folder, &job.inputs, record)
}

/// What the record is made of beside the table of the runs.
pub(crate) struct Record<'a> {
    pub count: &'a RunCount,
    /// Failed runs whose trajectory is kept, the worst first.
    pub kept: Vec<u64>,
    pub requirements: Vec<RequirementCount>,
    pub profile: ProfileGrid,
}

/// Writes the record.
pub(crate) fn conclude(
    folder: &Path,
    inputs: &Inputs,
    record: Record,
) -> Result<Results, CampaignError> {
    let Record {
        count,
        kept,
        mut requirements,
        profile,
    } = record;
    let runs = folder.join(RUNS_FILE);
    count_missed(&runs, &mut requirements)?;
    let failures = count.failures();
    let passed = count.runs - failures;
    let mut verdicts: BTreeMap<String, u64> = RunVerdict::ALL
        .map(|verdict| (verdict.name().to_string(), 0))
        .into();
    verdicts.extend(count.verdicts.clone());
    let results = Results {
        runs: count.runs,
        failures,
        verdicts,
        covered_runs: count.covered,
        pass_rate: passed as f64 / count.runs as f64,
        pass_rate_interval: pass_rate_interval(passed, count.runs),
        requirements,
        metrics: metric_quantiles(&runs)?,
        profile,
        not_kept: failures - kept.len() as u64,
        kept,
    };
    let record = CampaignFile {
        schema_version: CAMPAIGN_SCHEMA_VERSION,
        state: State::Complete,
        inputs: inputs.clone(),
        results: Some(results.clone()),
    };
    write(&folder.join(CAMPAIGN_FILE), &record.to_json())?;
    Ok(results)
}

/// Writes both tables of a folder from the sources that there are for the table of a name and content.
pub(super) fn write_tables(
    folder: &Path,
    columns: &CampaignColumns,
    inputs: &Inputs,
    sources: impl Fn(&str, Content) -> Vec<Source>,
) -> Result<(), CampaignError> {
    let tables = [
        (RUNS_FILE, Content::Runs),
        (PROFILES_FILE, Content::Profiles),
    ];
    for (name, content) in tables {
        let to = folder.join(name);
        concatenate(&sources(name, content), columns, (&to, content), inputs)?;
    }
    Ok(())
}

/// One table from several, which must hold the runs of `inputs` without gap or overlap.
fn concatenate(
    sources: &[Source],
    columns: &CampaignColumns,
    (path, content): (&Path, Content),
    inputs: &Inputs,
) -> Result<(), CampaignError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let unwritten = |source| CampaignError::written(path, source);
    let file = tempfile::NamedTempFile::new_in(folder).map_err(unwritten)?;
    let to = file.reopen().map_err(unwritten)?;
    let mut table = TableWriter::new(path, to, columns, content, &inputs_text(inputs))?;
    let mut next = inputs.first_run;
    for source in sources {
        let take = |rows: &RecordBatch| table.write(rows);
        each_batch(source, columns, content, &mut next, take)?;
    }
    at_end(path, next, inputs.end_run)?;
    table.finish()?.sync_all().map_err(unwritten)?;
    make_readable(file.path()).map_err(unwritten)?;
    file.persist(path).map_err(|error| unwritten(error.error))?;
    Ok(())
}

/// Counts the runs in the table of a folder, which must be those of `inputs`.
pub(super) fn count(
    folder: &Path,
    columns: &CampaignColumns,
    inputs: &Inputs,
    keep: usize,
) -> Result<RunCount, CampaignError> {
    let source = Source {
        path: folder.join(RUNS_FILE),
        content: Content::Runs,
        inputs: inputs_text(inputs),
    };
    let mut count = RunCount::default();
    let mut next = inputs.first_run;
    each_batch(&source, columns, Content::Runs, &mut next, |rows| {
        let runs = run_verdicts(rows)?;
        runs.iter().for_each(|run| count.add(run, keep));
        Ok(())
    })?;
    at_end(&source.path, next, inputs.end_run)?;
    Ok(count)
}

/// Reads the columns of a content from a source, whose first run must be `next`.
fn each_batch(
    source: &Source,
    columns: &CampaignColumns,
    content: Content,
    next: &mut u64,
    mut take: impl FnMut(&RecordBatch) -> Result<(), CampaignError>,
) -> Result<(), CampaignError> {
    let contents = (source.content, content);
    for rows in TableReader::open(&source.path, columns, contents, &source.inputs)? {
        let rows = rows?;
        for &run in run_indices(&rows)? {
            in_order(&source.path, run, next)?;
        }
        take(&rows)?;
    }
    Ok(())
}

fn in_order(path: &Path, run: u64, next: &mut u64) -> Result<(), CampaignError> {
    if run != *next {
        return Err(CampaignError::Unsuitable {
            path: path.to_path_buf(),
            reason: format!("holds run {run} where run {next} is expected"),
        });
    }
    *next += 1;
    Ok(())
}

fn at_end(path: &Path, next: u64, end: u64) -> Result<(), CampaignError> {
    if next == end {
        return Ok(());
    }
    Err(CampaignError::Unsuitable {
        path: path.to_path_buf(),
        reason: format!(
            "ends before run {next}; the campaign has runs up to {}",
            end - 1
        ),
    })
}

/// Makes the failed runs again, this time with their trajectory; other folders of kept runs go away.
fn keep_runs(job: &CampaignJob, runs: &[u64], stop: &AtomicBool) -> Result<(), CampaignError> {
    remove_others(&job.folder.join(FAILED_FOLDER), runs)?;
    job.threads.each(runs.to_vec(), stop, |run| {
        let folder = run_folder(&job.folder, run);
        // The summary is written last.
        if folder.join(SUMMARY_FILE).exists() {
            return Ok(());
        }
        let (scenario, outcome) = job.plan.alone(run, true)?;
        create_folder(&folder)?;
        let trajectory = outcome.trajectory.unwrap_or_default();
        write(&folder.join(SCENARIO_FILE), &scenario)?;
        write(&folder.join(TRAJECTORY_FILE), &trajectory.to_csv())?;
        write(&folder.join(SUMMARY_FILE), &summary_text(&outcome.summary))?;
        Ok(())
    })
}

/// Removes the folders of runs that are not to be kept.
pub(crate) fn remove_others(all: &Path, runs: &[u64]) -> Result<(), CampaignError> {
    let Ok(entries) = fs::read_dir(all) else {
        return Ok(());
    };
    let names: Vec<String> = runs.iter().map(|&run| run_folder_name(run)).collect();
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with("run-") && !names.contains(&name) {
            let path = entry.path();
            fs::remove_dir_all(&path)
                .map_err(|source| CampaignError::io(&path, "cannot be removed", source))?;
        }
    }
    // Only when nothing is left.
    if runs.is_empty() {
        let _ = fs::remove_dir(all);
    }
    Ok(())
}

fn remove_parts(folder: &Path) -> Result<(), CampaignError> {
    let path = folder.join(PARTS_FOLDER);
    match fs::remove_dir_all(&path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(CampaignError::io(&path, "cannot be removed", error))
        }
        _ => Ok(()),
    }
}
