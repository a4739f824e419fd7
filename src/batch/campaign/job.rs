//! The work of a campaign: its runs in chunks, each of which is a table in the folder `parts` until the
//! campaign is complete.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::Arc;

use super::folder::{CampaignFolder, OpenFolder, PARTS_FOLDER};
use super::plan::Plan;
use super::record::{Inputs, State};
use super::row::RunRow;
use super::table::part_table;
use super::CampaignError;
use crate::base::files::{create_folder, write};
use crate::batch::engine::{Control, Job, Threads};
use crate::batch::store::chunks::{Chunks, Shard};
use crate::batch::store::Store;
use crate::scenario::Scenario;
use crate::sim::integrator::Method;
use crate::sim::sampling::Instants;

/// Most runs of a chunk.
const LARGEST_CHUNK: u64 = 1024;
/// Chunks that a campaign should have, so that any number of processors is busy.
const CHUNKS: u64 = 256;
/// Integration steps after which a chunk should end, so that an interruption loses little.
const CHUNK_STEPS: f64 = 2e7;
/// Most chunks of a campaign: they are files of one folder.
const MOST_CHUNKS: u64 = 20_000;

/// The chunks of a campaign.
fn chunks(runs: u64, scenario: &Scenario) -> Chunks {
    let affordable = (CHUNK_STEPS / steps(scenario)).max(1.0) as u64;
    let wanted = runs.div_ceil(CHUNKS).clamp(1, LARGEST_CHUNK);
    let size = wanted.min(affordable).max(runs.div_ceil(MOST_CHUNKS));
    Chunks::new(runs, size.max(1))
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

/// The runs of a campaign, or of a shard of it.
pub struct CampaignJob<'a> {
    /// The runs.
    pub plan: &'a Plan<'a>,
    /// Where they are kept.
    pub folder: CampaignFolder,
    /// Threads.
    pub threads: Threads,
    chunks: Chunks,
    /// Numbers of the chunks of this shard.
    own: Range<u64>,
}

impl<'a> CampaignJob<'a> {
    /// The campaign of a plan, or a shard of it.
    ///
    /// # Errors
    /// A shard that the campaign does not have.
    pub fn new(
        plan: &'a Plan<'a>,
        shard: Option<Shard>,
        threads: Threads,
        folder: &Path,
    ) -> Result<Self, CampaignError> {
        let chunks = chunks(plan.inputs.runs, &plan.nominal);
        let own = chunks.of_shard(shard)?;
        let inputs = Inputs {
            shard,
            first_run: chunks.runs_of(own.start).start,
            end_run: chunks.runs_of(own.end - 1).end,
            ..plan.inputs.clone()
        };
        let folder = CampaignFolder {
            path: folder.to_path_buf(),
            columns: plan.columns.clone(),
            inputs,
        };
        Ok(CampaignJob {
            plan,
            folder,
            threads,
            chunks,
            own,
        })
    }

    /// Checks the runs that are not done, and creates the folder or finds in it what is done of the same
    /// campaign.
    ///
    /// # Errors
    /// A folder that cannot be written, that is in use or that holds another campaign; a run that cannot
    /// be made; it was stopped.
    pub fn prepare(
        &self,
        scenario: &str,
        design: Option<&str>,
        stop: &AtomicBool,
    ) -> Result<OpenFolder, CampaignError> {
        if self.folder.found()? != Some(State::Complete) {
            self.threads.each(self.missing(), stop, |mut runs| {
                runs.try_for_each(|run| self.plan.resolve(run).map(drop))
            })?;
        }
        let open = self.folder.open(scenario, design)?;
        if open.state == State::Running {
            create_folder(&self.folder.path.join(PARTS_FOLDER))?;
        }
        Ok(open)
    }

    /// Files of all chunks, in the order of their runs.
    pub(super) fn part_files(&self) -> impl Iterator<Item = PathBuf> + '_ {
        let own = self.own.clone();
        own.map(|chunk| self.folder.part(chunk))
    }

    /// Number of its runs.
    pub fn runs(&self) -> u64 {
        self.folder.inputs.end_run - self.folder.inputs.first_run
    }

    /// Number of its runs that are done while it is running.
    pub fn runs_done(&self) -> u64 {
        let missing = self.missing().into_iter();
        self.runs() - missing.map(|runs| runs.end - runs.start).sum::<u64>()
    }

    /// Makes every run that is not done.
    ///
    /// # Errors
    /// It was stopped; a file that cannot be written. What was done before stays.
    pub fn run(&self, control: &Control) -> Result<(), CampaignError> {
        self.threads.execute(self, self, control)
    }
}

impl Job for CampaignJob<'_> {
    type Record = RunRow;
    type Error = CampaignError;

    fn run(&self, index: u64, _stop: &Arc<AtomicBool>) -> Result<RunRow, CampaignError> {
        self.plan.row(index)
    }
}

impl Store<RunRow> for CampaignJob<'_> {
    type Error = CampaignError;

    fn missing(&self) -> Vec<Range<u64>> {
        let missing = self.own.clone().zip(self.part_files());
        let missing = missing.filter(|(_, file)| !file.exists());
        missing
            .map(|(chunk, _)| self.chunks.runs_of(chunk))
            .collect()
    }

    fn keep(&self, chunk: Range<u64>, rows: Vec<RunRow>) -> Result<(), CampaignError> {
        let CampaignFolder {
            columns, inputs, ..
        } = &self.folder;
        let path = self.folder.part(self.chunks.holding(chunk.start));
        let bytes = part_table(&path, columns, &inputs.to_json(), &rows)?;
        Ok(write(&path, &bytes)?)
    }
}
