//! The runs of a campaign: each a scenario of its own, from the campaign's seed and the run's index.

use serde_json::Value;
use synth::model::{FileError, ModelError};

use super::dispersion::{Boundary, Context, Sampler};
use super::row::RunRow;
use super::table::CampaignColumns;
use super::CampaignError;
use crate::base::bounded::from_value;
use crate::base::provenance::sha256_of;
use crate::batch::variation::parameter::Parameter;
use crate::batch::variation::samples::Samples;
use crate::plants::{System, SystemFile};
use crate::run::design::Design;
use crate::run::outcome::{Outcome, Recording};
use crate::run::{check_design, simulate_recording};
use crate::scenario::{ChangeFile, Dispersion, PlanFile, Scenario, ScenarioFile};
use crate::sim::reference::Reference;

/// Most runs of a campaign.
pub const MAX_RUNS: u64 = 10_000_000;
/// Times of a profile.
const PROFILE_TIMES: u32 = 101;

/// The runs of a campaign.
#[derive(Debug, Clone)]
pub struct Plan<'a> {
    /// The scenario as it is without dispersions.
    pub nominal: Scenario,
    /// Seed.
    pub seed: u64,
    /// Runs.
    pub runs: u64,
    /// How the drawn numbers are spread.
    pub sampling: PlanFile,
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
    ) -> Result<Self, PlanError> {
        let (file, sha256) = Scenario::read(text)?;
        let nominal = Scenario::from_file(&file, sha256)?;
        check_design(&nominal, design).map_err(CampaignError::from)?;
        let mut template = ScenarioFile {
            dispersions: None,
            ..file
        };
        pin_controller(&mut template);
        let dispersions = nominal.dispersions.as_ref();
        let sampling = dispersions.map_or(PlanFile::Independent, |all| all.sampling);
        let all = dispersions.map_or(&[][..], |all| &all.all);
        let value = serde_json::to_value(&template).unwrap_or_default();
        let samplers = all
            .iter()
            .enumerate()
            .map(|(index, one)| sampler(index, one, &value, &nominal, design))
            .collect::<Result<Vec<_>, _>>()?;
        let mut all = samplers.iter();
        let named = all.any(|one| matches!(one.context, Context::Number(..)));
        let seed = seed.unwrap_or(nominal.seed);
        let numbers = samplers.iter().map(Sampler::numbers).sum();
        let last = f64::from(PROFILE_TIMES - 1);
        let times = (0..PROFILE_TIMES).map(|time| nominal.duration_s * (f64::from(time) / last));
        let columns = CampaignColumns {
            drawn: samplers.iter().flat_map(Sampler::columns).collect(),
            quantities: nominal
                .system
                .profile_quantities()
                .iter()
                .map(|name| name.to_string())
                .collect(),
            times_s: times.collect(),
        };
        check_distinct(&columns.drawn)?;
        Ok(Plan {
            samples: Samples::new(sampling, seed, runs, numbers).map_err(CampaignError::from)?,
            nominal,
            seed,
            runs,
            sampling,
            columns,
            design,
            template,
            value: named.then_some(value),
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
                    let set = sampler.set(at, &mut value, &mut drawn);
                    set.map_err(|error| failed(error.to_string()))?;
                }
                from_value(value).map_err(|error| failed(error.to_string()))?
            }
        };
        let invalid = |error: ModelError| failed(error.to_string());
        for (sampler, at) in self.parts(&sample.coordinates) {
            sampler.apply(at, &mut file, &mut drawn).map_err(invalid)?;
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
            let (own, others) = rest.split_at(sampler.numbers().min(rest.len()));
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
            profile_times_s: &self.columns.times_s,
        };
        let outcome = self.simulate(&resolved.scenario, run, &recording)?;
        let seed = resolved.scenario.seed;
        Ok(RunRow::new(
            run,
            seed,
            &outcome.summary,
            resolved.drawn,
            outcome.profile,
        ))
    }

    /// Makes a run and keeps its trajectory, and its scenario as a text.
    ///
    /// # Errors
    /// A drawn number that the scenario cannot have.
    pub fn alone(&self, run: u64, trajectory: bool) -> Result<(String, Outcome), CampaignError> {
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
    ) -> Result<Outcome, CampaignError> {
        let outcome = simulate_recording(scenario, self.design, recording);
        outcome.map_err(|error| CampaignError::Run {
            run,
            reason: error.to_string(),
        })
    }
}

/// Why a file has no plan.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The file is not valid.
    #[error(transparent)]
    File(#[from] FileError),
    /// It does not go with its design.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
}

impl From<ModelError> for PlanError {
    fn from(error: ModelError) -> Self {
        PlanError::File(error.into())
    }
}

/// A controller that knows the plant's inertia knows the nominal one, not the drawn one.
fn pin_controller(file: &mut ScenarioFile) {
    if let SystemFile::RigidBody(body) = &file.system {
        file.controller.assume_inertia(&body.inertia_kg_m2);
    }
}

fn sampler(
    index: usize,
    dispersion: &Dispersion,
    file: &Value,
    nominal: &Scenario,
    design: Option<&Design>,
) -> Result<Sampler, PlanError> {
    let wrong =
        |field: String, reason: String| PlanError::from(ModelError::Choice { field, reason });
    let context = match dispersion {
        Dispersion::Number { name, change, .. } => {
            let field = format!("dispersions.values[{index}].name");
            let parameter = Parameter::find(file, name)
                .map_err(|error| wrong(field.clone(), error.to_string()))?;
            let base = match (parameter.value(file), change) {
                (Some(base), _) => base,
                (None, ChangeFile::Replace) => 0.0,
                (None, ChangeFile::Add | ChangeFile::Multiply) => {
                    let reason = format!("'{name}' stands for several different numbers");
                    return Err(wrong(field, reason));
                }
            };
            Context::Number(parameter, base)
        }
        Dispersion::Boundary { level } => {
            let field = || "dispersions.certified_boundary".to_string();
            let Some(design) = design else {
                let reason = "the set is that of a design, and the controller has none";
                return Err(wrong(field(), reason.to_string()));
            };
            let desired = match &nominal.system {
                System::TakagiSugeno(_) => None,
                System::RigidBody(body) => match body.reference {
                    Reference::Fixed(desired) => Some(desired),
                    _ => {
                        let reason = "the reference must be constant; it moves";
                        return Err(wrong(field(), reason.to_string()));
                    }
                },
            };
            let lower = design.certificate.lyapunov.clone().cholesky();
            let map = lower.and_then(|factor| factor.l().transpose().try_inverse());
            let Some(map) = map else {
                let reason = "the design's matrix U is not positive definite";
                return Err(wrong(field(), reason.to_string()));
            };
            Context::Boundary(Boundary {
                map: map * level.sqrt(),
                desired,
            })
        }
        _ => Context::Nothing,
    };
    Ok(Sampler {
        dispersion: dispersion.clone(),
        context,
    })
}

/// Refuses a number that is drawn by name twice.
fn check_distinct(columns: &[String]) -> Result<(), PlanError> {
    let mut sorted: Vec<&String> = columns.iter().collect();
    sorted.sort();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        None => Ok(()),
        Some(pair) => Err(ModelError::Choice {
            field: "dispersions.values".to_string(),
            reason: format!("'{}' is drawn twice", pair[0]),
        }
        .into()),
    }
}
