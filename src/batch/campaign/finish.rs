//! From what is done to the campaign's tables, its kept runs and its record.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use synth::model::make_readable;

use super::folder::{
    part_file, run_folder, run_folder_name, CAMPAIGN_FILE, FAILED_FOLDER, PARTS_FOLDER,
    PROFILES_FILE, RUNS_FILE, SCENARIO_FILE,
};
use super::parts::{inputs_text, Job};
use super::record::{
    CampaignFile, Inputs, ProfileGrid, RequirementCount, Results, State, CAMPAIGN_SCHEMA_VERSION,
};
use super::row::{Rank, Row};
use super::statistics::{count_missed, metric_quantiles, pass_rate_interval};
use super::table::{Columns, Content, TableReader, TableWriter};
use super::CampaignError;
use crate::base::files::{create_folder, write};
use crate::batch::watch::Watch;
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
pub(crate) struct Count {
    runs: u64,
    verdicts: BTreeMap<String, u64>,
    covered: Option<u64>,
    /// The worst failed runs, the worst first.
    worst: Vec<Rank>,
}

impl Count {
    fn add(&mut self, row: &Row, keep: usize) {
        self.runs += 1;
        let verdict = row.verdict.name().to_string();
        *self.verdicts.entry(verdict).or_default() += 1;
        if let Some(covers) = row.proof_covers {
            *self.covered.get_or_insert(0) += u64::from(covers);
        }
        if row.passed() {
            return;
        }
        let rank = row.rank();
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
pub fn finish(job: &Job, keep: usize, watch: &Watch) -> Result<Results, CampaignError> {
    let inputs = inputs_text(&job.inputs);
    let runs = job.folder.join(RUNS_FILE);
    let sources = job.own_parts()?.map(|part| Source {
        path: part_file(&job.folder, part),
        content: Content::Whole,
        inputs: inputs.clone(),
    });
    let sources: Vec<Source> = sources.collect();
    let columns = &job.plan.columns;
    let expected = (job.inputs.first_run, job.inputs.end_run);
    let count = concatenate(
        &sources,
        columns,
        (&runs, Content::Runs),
        &inputs,
        expected,
        keep,
    )?;
    let profiles = job.folder.join(PROFILES_FILE);
    let to = (profiles.as_path(), Content::Profiles);
    concatenate(&sources, columns, to, &inputs, expected, keep)?;
    let results = recount(job, &count, watch)?;
    remove_parts(&job.folder)?;
    Ok(results)
}

/// As [`finish`], from the tables of a job that is complete: another number of runs may be kept.
///
/// # Errors
/// A file that cannot be read or written; it was stopped.
pub fn finish_again(job: &Job, keep: usize, watch: &Watch) -> Result<Results, CampaignError> {
    let source = Source {
        path: job.folder.join(RUNS_FILE),
        content: Content::Runs,
        inputs: inputs_text(&job.inputs),
    };
    let expected = (job.inputs.first_run, job.inputs.end_run);
    let count = count_only(&source, &job.plan.columns, expected, keep)?;
    let results = recount(job, &count, watch)?;
    remove_parts(&job.folder)?;
    Ok(results)
}

fn recount(job: &Job, count: &Count, watch: &Watch) -> Result<Results, CampaignError> {
    keep_runs(job, &count.worst_runs(), watch)?;
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
    pub count: &'a Count,
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

/// One table from several, which must hold the runs `expected` without gap or overlap.
pub(crate) fn concatenate(
    sources: &[Source],
    columns: &Columns,
    (path, content): (&Path, Content),
    inputs: &str,
    (first, end): (u64, u64),
    keep: usize,
) -> Result<Count, CampaignError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let unwritten = |source| CampaignError::written(path, source);
    let file = tempfile::NamedTempFile::new_in(folder).map_err(unwritten)?;
    let to = file.reopen().map_err(unwritten)?;
    let mut table = TableWriter::new(path, to, columns, content, inputs)?;
    let mut count = Count::default();
    let mut next = first;
    for source in sources {
        each_row(source, columns, |row| {
            in_order(&source.path, row.run, &mut next)?;
            count.add(&row, keep);
            table.push(row)
        })?;
    }
    at_end(path, next, end)?;
    table.finish()?.sync_all().map_err(unwritten)?;
    make_readable(file.path()).map_err(unwritten)?;
    file.persist(path).map_err(|error| unwritten(error.error))?;
    Ok(count)
}

fn count_only(
    source: &Source,
    columns: &Columns,
    (first, end): (u64, u64),
    keep: usize,
) -> Result<Count, CampaignError> {
    let mut count = Count::default();
    let mut next = first;
    each_row(source, columns, |row| {
        in_order(&source.path, row.run, &mut next)?;
        count.add(&row, keep);
        Ok(())
    })?;
    at_end(&source.path, next, end)?;
    Ok(count)
}

fn each_row(
    source: &Source,
    columns: &Columns,
    mut take: impl FnMut(Row) -> Result<(), CampaignError>,
) -> Result<(), CampaignError> {
    let table = TableReader::open(&source.path, columns, source.content, &source.inputs)?;
    for rows in table {
        rows?.into_iter().try_for_each(&mut take)?;
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
fn keep_runs(job: &Job, runs: &[u64], watch: &Watch) -> Result<(), CampaignError> {
    let all = job.folder.join(FAILED_FOLDER);
    remove_others(&all, runs)?;
    job.pool.install(|| {
        runs.par_iter().try_for_each(|&run| {
            if watch.stopped() {
                return Err(CampaignError::Interrupted);
            }
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
