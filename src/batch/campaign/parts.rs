//! The runs of a campaign in parts of fixed size: each part is a file, whole or absent.
//!
//! Which runs are in which part depends on the campaign only, so what was done before an interruption
//! counts, and shards are made of whole parts.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use synth::model::write_atomically;

use super::folder::{part_file, CAMPAIGN_FILE, DESIGN_FILE, PARTS_FOLDER, SCENARIO_FILE};
use super::plan::Plan;
use super::record::{CampaignFile, Inputs, Shard, State, CAMPAIGN_SCHEMA_VERSION};
use super::table::{Content, TableWriter};
use super::CampaignError;
use crate::base::files::create_folder;
use crate::base::provenance::GENERATOR;
use crate::batch::watch::Watch;
use crate::scenario::Scenario;
use crate::sim::integrator::Method;
use crate::sim::sampling::Instants;

/// Most runs of a part.
const LARGEST_PART: u64 = 1024;
/// Parts that a campaign should have, so that any number of processors is busy.
const PARTS: u64 = 256;
/// Integration steps after which a part should end, so that an interruption loses little.
const PART_STEPS: f64 = 2e7;
/// Most parts of a campaign: they are files of one folder.
const MOST_PARTS: u64 = 20_000;

/// The division of a campaign into parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    size: u64,
    runs: u64,
}

impl Parts {
    /// The parts of a campaign.
    pub fn new(runs: u64, scenario: &Scenario) -> Self {
        let affordable = (PART_STEPS / steps(scenario)).max(1.0) as u64;
        let wanted = runs.div_ceil(PARTS).clamp(1, LARGEST_PART);
        let size = wanted.min(affordable).max(runs.div_ceil(MOST_PARTS)).max(1);
        Parts { size, runs }
    }

    /// Their number.
    pub fn count(&self) -> u64 {
        self.runs.div_ceil(self.size)
    }

    /// The runs of a part.
    pub fn runs_of(&self, part: u64) -> std::ops::Range<u64> {
        let end = ((part + 1) * self.size).min(self.runs);
        part * self.size..end
    }

    /// The parts of a shard.
    ///
    /// # Errors
    /// More shards than parts.
    pub fn of_shard(&self, shard: Option<Shard>) -> Result<std::ops::Range<u64>, CampaignError> {
        let count = self.count();
        let Some(Shard {
            index,
            count: shards,
        }) = shard
        else {
            return Ok(0..count);
        };
        if shards > count {
            return Err(CampaignError::Shards(format!(
                "the campaign can be divided into at most {count} shards; {shards} are asked for"
            )));
        }
        let start =
            |index: u64| (u128::from(index) * u128::from(count) / u128::from(shards)) as u64;
        Ok(start(index - 1)..start(index))
    }
}

/// Integration steps of a run, about.
fn steps(scenario: &Scenario) -> f64 {
    let interval = match scenario.instants {
        Instants::Periodic { interval_s, .. } => interval_s,
        Instants::Aperiodic {
            shortest_s,
            longest_s,
        } => 0.5 * (shortest_s + longest_s),
        Instants::Continuous { .. } => f64::INFINITY,
    };
    let step = match scenario.method {
        Method::RungeKutta4 { step_s } => step_s.min(interval),
        Method::DormandPrince853 { .. } => interval,
    };
    (scenario.duration_s / step).max(1.0)
}

/// What is run, and into which folder.
pub struct Job<'a> {
    /// The runs.
    pub plan: &'a Plan<'a>,
    /// What determines every number.
    pub inputs: Inputs,
    /// The campaign's folder.
    pub folder: PathBuf,
    /// How the campaign is divided.
    pub parts: Parts,
    /// Threads.
    pub pool: rayon::ThreadPool,
}

impl<'a> Job<'a> {
    /// A job on `jobs` threads (0: one for each processor).
    ///
    /// # Errors
    /// A shard that the campaign does not have; threads that cannot be started.
    pub fn new(
        plan: &'a Plan<'a>,
        design_sha256: Option<String>,
        shard: Option<Shard>,
        jobs: usize,
        folder: &Path,
    ) -> Result<Self, CampaignError> {
        let parts = Parts::new(plan.runs, &plan.nominal);
        let own = parts.of_shard(shard)?;
        let inputs = Inputs {
            generator: GENERATOR.to_string(),
            scenario: plan.nominal.name.clone(),
            scenario_sha256: plan.nominal.sha256.clone(),
            design_sha256,
            seed: plan.seed,
            runs: plan.runs,
            sampling: plan.sampling,
            shard,
            first_run: parts.runs_of(own.start).start,
            end_run: parts.runs_of(own.end - 1).end,
        };
        Ok(Job {
            plan,
            inputs,
            folder: folder.to_path_buf(),
            parts,
            pool: rayon::ThreadPoolBuilder::new().num_threads(jobs).build()?,
        })
    }

    /// Checks the runs that are not done, and creates the folder or finds in it what is done of the same
    /// campaign.
    ///
    /// # Errors
    /// A folder that cannot be written or that holds another campaign; a run that cannot be made; it was
    /// stopped.
    pub fn prepare(
        &self,
        scenario: &str,
        design: Option<&str>,
        stop: &AtomicBool,
    ) -> Result<State, CampaignError> {
        if found(&self.folder, &self.inputs)? != Some(State::Complete) {
            self.check(stop)?;
        }
        let state = prepare(&self.folder, &self.inputs, scenario, design)?;
        if state == State::Running {
            create_folder(&self.folder.join(PARTS_FOLDER))?;
        }
        Ok(state)
    }

    /// The parts of this job.
    pub fn own_parts(&self) -> Result<std::ops::Range<u64>, CampaignError> {
        self.parts.of_shard(self.inputs.shard)
    }

    /// Runs of this job that are done.
    pub fn runs_done(&self) -> Result<u64, CampaignError> {
        let own = self.own_parts()?;
        let done = own.filter(|&part| part_file(&self.folder, part).exists());
        let runs = done.map(|part| {
            let runs = self.parts.runs_of(part);
            runs.end - runs.start
        });
        Ok(runs.sum())
    }

    /// Makes every run that is not done.
    ///
    /// # Errors
    /// It was stopped; a file that cannot be written. What was done before stays.
    pub fn run(&self, watch: &Watch) -> Result<(), CampaignError> {
        self.each_missing(&watch.stop, |part| self.run_part(part, watch))
    }

    /// Draws every run that is not done, without making it.
    fn check(&self, stop: &AtomicBool) -> Result<(), CampaignError> {
        self.each_missing(stop, |part| {
            let mut runs = self.parts.runs_of(part);
            runs.try_for_each(|run| self.plan.resolve(run).map(drop))
        })
    }

    /// Does something with every part that is not done, on all threads.
    fn each_missing(
        &self,
        stop: &AtomicBool,
        one: impl Fn(u64) -> Result<(), CampaignError> + Sync,
    ) -> Result<(), CampaignError> {
        let own = self.own_parts()?;
        let missing = own.filter(|&part| !part_file(&self.folder, part).exists());
        let missing: Vec<u64> = missing.collect();
        let parts = || missing.par_iter().with_max_len(1);
        self.pool.install(|| {
            parts().try_for_each(|&part| match stop.load(Ordering::Relaxed) {
                true => Err(CampaignError::Interrupted),
                false => one(part),
            })
        })
    }

    fn run_part(&self, part: u64, watch: &Watch) -> Result<(), CampaignError> {
        let path = part_file(&self.folder, part);
        let inputs = inputs_text(&self.inputs);
        let columns = &self.plan.columns;
        let mut table = TableWriter::new(&path, Vec::new(), columns, Content::Whole, &inputs)?;
        for run in self.parts.runs_of(part) {
            table.push(self.plan.row(run)?)?;
            (watch.done)();
        }
        let bytes = table.finish()?;
        write_atomically(&path, &bytes).map_err(|problem| CampaignError::file(&path, problem))
    }
}

/// The inputs as they are in the tables' metadata.
pub(crate) fn inputs_text(inputs: &Inputs) -> String {
    // They hold numbers and texts only, so they can always be written.
    serde_json::to_string(inputs).unwrap_or_default()
}

/// How far a campaign is in a folder; `None` when there is nothing of it.
///
/// # Errors
/// A folder that holds another campaign.
fn found(folder: &Path, inputs: &Inputs) -> Result<Option<State>, CampaignError> {
    if !folder.join(CAMPAIGN_FILE).exists() {
        return Ok(None);
    }
    let known = CampaignFile::read(folder)?;
    match difference(&known.inputs, inputs) {
        None => Ok(Some(known.state)),
        Some(difference) => Err(CampaignError::Unsuitable {
            path: folder.to_path_buf(),
            reason: format!("holds another campaign: {difference}; choose another folder"),
        }),
    }
}

/// Creates a campaign's folder with its record, or says how far the same campaign is in it.
///
/// # Errors
/// A folder that cannot be written or that holds another campaign.
pub(crate) fn prepare(
    folder: &Path,
    inputs: &Inputs,
    scenario: &str,
    design: Option<&str>,
) -> Result<State, CampaignError> {
    create_folder(folder)?;
    if let Some(state) = found(folder, inputs)? {
        return Ok(state);
    }
    let write = |name: &str, text: &str| crate::base::files::write(&folder.join(name), text);
    write(SCENARIO_FILE, scenario)?;
    if let Some(design) = design {
        write(DESIGN_FILE, design)?;
    }
    let record = CampaignFile {
        schema_version: CAMPAIGN_SCHEMA_VERSION,
        state: State::Running,
        inputs: inputs.clone(),
        results: None,
    };
    write(CAMPAIGN_FILE, &record.to_json())?;
    Ok(State::Running)
}

/// Names of the inputs, those that explain a difference best first.
const NAMES: [&str; 10] = [
    "scenario_sha256",
    "design_sha256",
    "seed",
    "runs",
    "shard",
    "sampling",
    "generator",
    "scenario",
    "first_run",
    "end_run",
];

/// The first input that differs, as text.
pub(crate) fn difference(known: &Inputs, asked: &Inputs) -> Option<String> {
    if known == asked {
        return None;
    }
    let value = |inputs: &Inputs| serde_json::to_value(inputs).unwrap_or_default();
    let (known, asked) = (value(known), value(asked));
    let name = NAMES.iter().find(|name| known[**name] != asked[**name])?;
    Some(format!(
        "its {name} is {}, not {}",
        known[*name], asked[*name]
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_whole_parts_without_gap_or_overlap() {
        for (runs, size, count) in [(10, 1, 3), (1000, 4, 7), (100_000, 391, 256), (5, 5, 1)] {
            let parts = Parts { size, runs };
            let mut next = 0;
            for index in 1..=count {
                let shard = Shard { index, count };
                for part in parts.of_shard(Some(shard)).expect("a shard") {
                    let own = parts.runs_of(part);
                    assert_eq!(own.start, next);
                    assert!(own.end > own.start);
                    next = own.end;
                }
            }
            assert_eq!(next, runs);
        }
    }
}
