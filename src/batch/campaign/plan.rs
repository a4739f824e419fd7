//! The runs of a campaign: each a scenario of its own, from the campaign's seed and the run's index.

use serde_json::Value;
use synth::model::ModelError;

use super::dispersion::Sampler;
use super::record::{Inputs, ProfileGrid};
use super::row::RunRow;
use super::table::CampaignColumns;
use super::CampaignError;
use crate::base::bounded::from_value;
use crate::base::provenance::{sha256_of, GENERATOR};
use crate::batch::variation::samples::Samples;
use crate::plants::SystemFile;
use crate::run::design::Design;
use crate::run::outcome::{Recording, RunOutcome};
use crate::run::{check_design, simulate_recording};
use crate::scenario::{PlanFile, Scenario, ScenarioFile};

/// Most runs of a campaign.
pub const MAX_RUNS: u64 = 10_000_000;
/// Times of a profile.
const PROFILE_TIMES: u32 = 101;

/// The runs of a campaign.
#[derive(Debug, Clone)]
pub struct Plan<'a> {
    /// The scenario as it is without dispersions.
    pub nominal: Scenario,
    /// What determines every number of the whole campaign.
    pub inputs: Inputs,
    /// Columns of the tables.
    pub columns: CampaignColumns,
    design: Option<&'a Design>,
    template: ScenarioFile,
    /// The template as JSON, where numbers of it are drawn by name.
    value: Option<Value>,
    samplers: Vec<Sampler>,
    samples: Samples,
}

/// One run, ready to go.
#[derive(Debug, Clone)]
pub struct Resolved {
    /// Its index.
    pub run: u64,
    /// The scenario file with the drawn numbers.
    pub file: ScenarioFile,
    /// The same, checked. Its hash is empty.
    pub scenario: Scenario,
    /// What was drawn, in the order of the columns.
    pub drawn: Vec<Option<f64>>,
}

impl<'a> Plan<'a> {
    /// The runs of a scenario file's campaign. The seed is the file's own when none is given.
    ///
    /// # Errors
    /// A file that is not valid; a name that is no number of it; dispersions that need a design.
    pub fn new(
        text: &str,
        design: Option<&'a Design>,
        seed: Option<u64>,
        runs: u64,
    ) -> Result<Self, CampaignError> {
        let (file, sha256) = Scenario::read(text)?;
        let nominal = Scenario::from_file(&file, sha256)?;
        check_design(&nominal, design)?;
        let mut template = ScenarioFile {
            dispersions: None,
            ..file
        };
        pin_controller(&mut template);
        let dispersions = nominal.dispersions.as_ref();
        let sampling = dispersions.map_or(PlanFile::Independent, |all| all.sampling);
        let all = dispersions.map_or(&[][..], |all| &all.all);
        let value = serde_json::to_value(&template).unwrap_or_default();
        let samplers = all.iter().enumerate();
        let samplers = samplers
            .map(|(index, one)| Sampler::new(index, one, &value, &nominal, design))
            .collect::<Result<Vec<_>, _>>()?;
        let drawn = samplers.iter().flat_map(|one| one.columns.iter().cloned());
        let columns = CampaignColumns {
            drawn: drawn.collect(),
            profile: profile(&nominal),
        };
        check_distinct(&columns.drawn)?;
        let inputs = Inputs {
            generator: GENERATOR.to_string(),
            scenario: nominal.name.clone(),
            scenario_sha256: nominal.sha256.clone(),
            design_sha256: design.map(|design| design.sha256.clone()),
            seed: seed.unwrap_or(nominal.seed),
            runs,
            sampling,
            shard: None,
            first_run: 0,
            end_run: runs,
        };
        let numbers = samplers.iter().map(|one| one.numbers).sum();
        Ok(Plan {
            samples: Samples::new(sampling, inputs.seed, runs, numbers)?,
            nominal,
            inputs,
            columns,
            design,
            template,
            value: samplers.iter().any(Sampler::is_named).then_some(value),
            samplers,
        })
    }

    /// The scenario of a run.
    ///
    /// # Errors
    /// A drawn number that the scenario cannot have.
    pub fn resolve(&self, run: u64) -> Result<Resolved, CampaignError> {
        let failed = |reason: String| CampaignError::Run { run, reason };
        let sample = self.samples.sample(run);
        let mut drawn = Vec::with_capacity(self.columns.drawn.len());
        let mut file = match &self.value {
            None => self.template.clone(),
            Some(value) => {
                let mut value = value.clone();
                for (sampler, at) in self.parts(&sample.coordinates) {
                    let set = sampler.set(at, &mut value);
                    drawn.extend(set.map_err(|error| failed(error.to_string()))?.map(Some));
                }
                from_value(value).map_err(|error| failed(error.to_string()))?
            }
        };
        let invalid = |error: ModelError| failed(error.to_string());
        for (sampler, at) in self.parts(&sample.coordinates) {
            drawn.extend(sampler.apply(at, &mut file).map_err(invalid)?);
        }
        file.random.seed = sample.seed;
        file.name = format!("{}, run {run}", self.template.name);
        let scenario = Scenario::from_file(&file, String::new()).map_err(invalid)?;
        check_design(&scenario, self.design).map_err(|error| failed(error.to_string()))?;
        Ok(Resolved {
            run,
            file,
            scenario,
            drawn,
        })
    }

    /// Each sampler with its coordinates.
    fn parts<'b>(&'b self, sample: &'b [f64]) -> impl Iterator<Item = (&'b Sampler, &'b [f64])> {
        let mut rest = sample;
        self.samplers.iter().map(move |sampler| {
            let (own, others) = rest.split_at(sampler.numbers.min(rest.len()));
            rest = others;
            (sampler, own)
        })
    }

    /// Makes a run and keeps its row.
    ///
    /// # Errors
    /// A drawn number that the scenario cannot have.
    pub fn row(&self, run: u64) -> Result<RunRow, CampaignError> {
        let resolved = self.resolve(run)?;
        let recording = Recording {
            trajectory: false,
            profile_times_s: &self.columns.profile.times_s,
        };
        let outcome = self.simulate(&resolved.scenario, run, &recording)?;
        let Resolved {
            scenario, drawn, ..
        } = resolved;
        Ok(RunRow::new(run, &scenario, drawn, outcome))
    }

    /// Makes a run and keeps its trajectory, and its scenario as a text.
    ///
    /// # Errors
    /// A drawn number that the scenario cannot have.
    pub fn alone(&self, run: u64, trajectory: bool) -> Result<(String, RunOutcome), CampaignError> {
        let resolved = self.resolve(run)?;
        // The file's types hold numbers, texts and lists only, so it can always be written.
        let text = serde_json::to_string_pretty(&resolved.file).unwrap_or_default() + "\n";
        let mut scenario = resolved.scenario;
        scenario.sha256 = sha256_of(&text);
        let recording = Recording {
            trajectory,
            ..Recording::default()
        };
        let outcome = self.simulate(&scenario, run, &recording)?;
        Ok((text, outcome))
    }

    fn simulate(
        &self,
        scenario: &Scenario,
        run: u64,
        recording: &Recording,
    ) -> Result<RunOutcome, CampaignError> {
        let outcome = simulate_recording(scenario, self.design, recording);
        outcome.map_err(|error| CampaignError::Run {
            run,
            reason: error.to_string(),
        })
    }
}

/// What is recorded of every run along time.
fn profile(nominal: &Scenario) -> ProfileGrid {
    let last = f64::from(PROFILE_TIMES - 1);
    let times = (0..PROFILE_TIMES).map(|time| nominal.duration_s * (f64::from(time) / last));
    let quantities = nominal.system.profile_quantities().iter();
    ProfileGrid {
        times_s: times.collect(),
        quantities: quantities.map(|name| name.to_string()).collect(),
    }
}

/// A controller that knows the plant's inertia knows the nominal one, not the drawn one.
fn pin_controller(file: &mut ScenarioFile) {
    if let SystemFile::RigidBody(body) = &file.system {
        file.controller.assume_inertia(&body.inertia_kg_m2);
    }
}

/// Refuses a number that is drawn by name twice.
fn check_distinct(columns: &[String]) -> Result<(), ModelError> {
    let mut sorted: Vec<&String> = columns.iter().collect();
    sorted.sort();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        None => Ok(()),
        Some(pair) => Err(ModelError::Choice {
            field: "dispersions.values".to_string(),
            reason: format!("'{}' is drawn twice", pair[0]),
        }),
    }
}
