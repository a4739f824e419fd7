//! From what is done to the campaign's tables, its kept runs and its record.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use arrow_array::{BooleanArray, Float64Array, RecordBatch, StringArray, UInt64Array};
use synth::model::{is_temporary, make_readable, new_in};

use super::folder::{
    is_kept_run, is_part, run_folder, run_folder_name, CampaignFolder, FAILED_FOLDER, PARTS_FOLDER,
    PROFILES_FILE, RUNS_FILE, SCENARIO_FILE,
};
use super::job::CampaignJob;
use super::record::{CampaignFile, RequirementCount, Results, State};
use super::row::Rank;
use super::statistics::{count_missed, metric_quantiles, pass_rate_interval};
use super::table::{
    mistyped, rows, typed, unwritten, writer, Content, COVERS_COLUMN, MARGIN_COLUMN, RUN_COLUMN,
    VERDICT_COLUMN,
};
use super::CampaignError;
use crate::base::files::{create_folder, note_written, write, OutputError};
use crate::run::files::{summary_text, REPORT_FILE, SUMMARY_FILE, TRAJECTORY_FILE};
use crate::run::summary::RunVerdict;

/// Writes the tables of a job whose parts are all there (of one that is complete they are), the kept runs
/// and the record, and removes the parts. `keep`: most failed runs that are kept with their trajectory; of
/// a job that is complete it may be another number than before.
///
/// # Errors
/// A file that cannot be read or written; it was stopped. What was done before stays.
pub fn finish(
    job: &CampaignJob,
    state: State,
    keep: usize,
    stop: &AtomicBool,
) -> Result<Results, CampaignError> {
    if state == State::Running {
        let inputs = job.folder.inputs.to_json();
        job.folder.write_tables(|_, _| {
            let sources = job.part_files().map(|path| Source {
                path,
                content: Content::Whole,
                inputs: inputs.clone(),
            });
            sources.collect()
        })?;
    }
    let folder = &job.folder;
    let count = folder.count(keep)?;
    let kept = count.worst_runs();
    keep_runs(job, &kept, stop)?;
    let runs = folder.path.join(RUNS_FILE);
    let requirements = count_missed(&runs, &job.plan.nominal.requirements)?;
    let results = folder.conclude(count, kept, requirements)?;
    remove_parts(&folder.path)?;
    Ok(results)
}

/// What is counted while the rows pass.
#[derive(Debug, Default)]
pub(crate) struct RunCount {
    runs: u64,
    passed: u64,
    verdicts: BTreeMap<String, u64>,
    covered: Option<u64>,
    /// The worst failed runs, the worst first.
    worst: Vec<Rank>,
}

impl RunCount {
    /// Counts some rows of a table and remembers the `keep` worst failed runs.
    fn add(&mut self, rows: &RecordBatch, keep: usize) -> Result<(), CampaignError> {
        let verdicts = typed::<StringArray>(rows, VERDICT_COLUMN)?;
        let covers = typed::<BooleanArray>(rows, COVERS_COLUMN)?;
        let margins = typed::<Float64Array>(rows, MARGIN_COLUMN)?;
        let runs = typed::<UInt64Array>(rows, RUN_COLUMN)?.values();
        for (((&run, verdict), covers), margin) in
            runs.iter().zip(verdicts).zip(covers).zip(margins)
        {
            let verdict = verdict.and_then(RunVerdict::named).ok_or_else(mistyped)?;
            self.runs += 1;
            *self.verdicts.entry(verdict.name().to_string()).or_default() += 1;
            if let Some(covers) = covers {
                *self.covered.get_or_insert(0) += u64::from(covers);
            }
            if verdict == RunVerdict::RequirementsMet {
                self.passed += 1;
                continue;
            }
            let rank = Rank::new(verdict, margin, run);
            let place = self
                .worst
                .partition_point(|other| other.compare(&rank).is_lt());
            if place < keep {
                self.worst.insert(place, rank);
                self.worst.truncate(keep);
            }
        }
        Ok(())
    }

    /// The worst failed runs, the worst first.
    pub fn worst_runs(&self) -> Vec<u64> {
        self.worst.iter().map(|rank| rank.run).collect()
    }
}

/// A table, what of the rows it holds, and the inputs in its metadata.
pub(crate) struct Source {
    pub path: PathBuf,
    pub content: Content,
    pub inputs: String,
}

impl CampaignFolder {
    /// Writes both tables from the sources that there are for the table of a name and content.
    pub(super) fn write_tables(
        &self,
        sources: impl Fn(&str, Content) -> Vec<Source>,
    ) -> Result<(), CampaignError> {
        let tables = [
            (RUNS_FILE, Content::Runs),
            (PROFILES_FILE, Content::Profiles),
        ];
        for (name, content) in tables {
            self.concatenate(&self.path.join(name), content, &sources(name, content))?;
        }
        Ok(())
    }

    /// One table from several, which must hold the runs of the inputs without gap or overlap.
    fn concatenate(
        &self,
        path: &Path,
        content: Content,
        sources: &[Source],
    ) -> Result<(), CampaignError> {
        let failed = |source| OutputError::io(path, "cannot be written", source);
        let file = new_in(&self.path).map_err(failed)?;
        let to = file.reopen().map_err(failed)?;
        let mut table = writer(path, to, &self.columns, content, &self.inputs.to_json())?;
        self.each_batch(path, content, sources, |rows| {
            table.write(rows).map_err(|error| unwritten(path, error))
        })?;
        let to = table.into_inner().map_err(|error| unwritten(path, error))?;
        to.sync_all().map_err(failed)?;
        make_readable(file.path()).map_err(failed)?;
        file.persist(path).map_err(|error| failed(error.error))?;
        note_written(path);
        Ok(())
    }

    /// Counts the runs in the table of the runs, which must be those of the inputs. `keep`: most failed
    /// runs that are wanted.
    pub(super) fn count(&self, keep: usize) -> Result<RunCount, CampaignError> {
        let path = self.path.join(RUNS_FILE);
        let source = Source {
            path: path.clone(),
            content: Content::Runs,
            inputs: self.inputs.to_json(),
        };
        let mut count = RunCount::default();
        self.each_batch(&path, Content::Runs, &[source], |rows| {
            count.add(rows, keep)
        })?;
        Ok(count)
    }

    /// Reads the columns of a content from sources, which must hold the runs of the inputs in their order.
    fn each_batch(
        &self,
        path: &Path,
        content: Content,
        sources: &[Source],
        mut take: impl FnMut(&RecordBatch) -> Result<(), CampaignError>,
    ) -> Result<(), CampaignError> {
        let mut next = self.inputs.first_run;
        for source in sources {
            let contents = (source.content, content);
            for batch in rows(&source.path, &self.columns, contents, &source.inputs)? {
                let batch = batch?;
                for &run in typed::<UInt64Array>(&batch, RUN_COLUMN)?.values() {
                    if run != next {
                        let reason = format!("holds run {run} where run {next} is expected");
                        return Err(CampaignError::unsuitable(&source.path, reason));
                    }
                    next += 1;
                }
                take(&batch)?;
            }
        }
        match self.inputs.end_run {
            end if end == next => Ok(()),
            end => {
                let last = end - 1;
                let reason = format!("ends before run {next}; the campaign has runs up to {last}");
                Err(CampaignError::unsuitable(path, reason))
            }
        }
    }

    /// Writes the record, with the failed runs whose trajectory is kept, the worst first.
    pub(super) fn conclude(
        &self,
        count: RunCount,
        kept: Vec<u64>,
        requirements: Vec<RequirementCount>,
    ) -> Result<Results, CampaignError> {
        let RunCount { runs, passed, .. } = count;
        let none = RunVerdict::ALL.map(|verdict| (verdict.name().to_string(), 0));
        let results = Results {
            runs,
            failures: runs - passed,
            verdicts: none.into_iter().chain(count.verdicts).collect(),
            covered_runs: count.covered,
            pass_rate: passed as f64 / runs as f64,
            pass_rate_interval: pass_rate_interval(passed, runs),
            requirements,
            metrics: metric_quantiles(&self.path.join(RUNS_FILE))?,
            profile: self.columns.profile.clone(),
            not_kept: runs - passed - kept.len() as u64,
            kept,
        };
        CampaignFile::write(&self.path, &self.inputs, Some(&results))?;
        Ok(results)
    }
}

/// Makes the failed runs again, this time with their trajectory; other folders of kept runs go away.
fn keep_runs(job: &CampaignJob, runs: &[u64], stop: &AtomicBool) -> Result<(), CampaignError> {
    remove_others(&job.folder.path.join(FAILED_FOLDER), runs)?;
    job.threads.each(runs.to_vec(), stop, |run| {
        let folder = run_folder(&job.folder.path, run);
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

/// The files of a run that is kept, its page included.
const KEPT_FILES: [&str; 4] = [SCENARIO_FILE, TRAJECTORY_FILE, SUMMARY_FILE, REPORT_FILE];

/// Removes the folders of runs that are not to be kept, without what is not the campaign's.
pub(crate) fn remove_others(all: &Path, runs: &[u64]) -> Result<(), CampaignError> {
    let names: Vec<String> = runs.iter().map(|&run| run_folder_name(run)).collect();
    for (name, path) in own_entries(all) {
        if is_kept_run(&name) && !names.contains(&name) {
            remove_files(&path, |name| {
                is_temporary(name) || KEPT_FILES.contains(&name)
            })?;
        }
    }
    // Only when nothing is left.
    if runs.is_empty() {
        let _ = fs::remove_dir(all);
    }
    Ok(())
}

fn remove_parts(folder: &Path) -> Result<(), CampaignError> {
    remove_files(&folder.join(PARTS_FOLDER), is_part)
}

/// Removes the files of a folder that have such names, and the folder where it is empty then. A link is not
/// followed.
fn remove_files(folder: &Path, is_own: impl Fn(&str) -> bool) -> Result<(), CampaignError> {
    for (name, path) in own_entries(folder) {
        let is_file = fs::symlink_metadata(&path).is_ok_and(|about| about.is_file());
        if is_file && is_own(&name) {
            fs::remove_file(&path)
                .map_err(|source| OutputError::io(&path, "cannot be removed", source))?;
        }
    }
    // Only when nothing is left.
    let _ = fs::remove_dir(folder);
    Ok(())
}

/// What is in a folder, by name; nothing where it is a link or there is none.
fn own_entries(folder: &Path) -> Vec<(String, PathBuf)> {
    let is_folder = fs::symlink_metadata(folder).is_ok_and(|about| about.is_dir());
    let entries = is_folder.then(|| fs::read_dir(folder).ok()).flatten();
    let entries = entries.into_iter().flatten().flatten();
    let named = entries.map(|entry| {
        (
            entry.file_name().to_string_lossy().into_owned(),
            entry.path(),
        )
    });
    named.collect()
}
