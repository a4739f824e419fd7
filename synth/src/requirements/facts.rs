//! A spacecraft as its engineer knows it, and what is required of it. What the proof needs beside is found, and is kept where
//! the file gives it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::bounded::{AngleDeg, As, BelowOne, Finite, Positive, ShortestInterval, UpToOne};
use crate::model::{
    check_version, parse, ExactPlant, FileError, GainForm, Imperfections, InertiaUncertaintyFile,
    Kind, Mismatch, Model, ModelError, ModelFile, Objective, OutputWeights, PlantFile, Specs,
    TriggerFloor, MODEL_SCHEMA_VERSION,
};

/// The trigger threshold where none is given.
const THRESHOLD: f64 = 0.2;

/// The same where the measurement has errors: its conditions take up to twice the threshold.
const THRESHOLD_WITH_ERRORS: f64 = 0.05;

/// The shortest and the longest sampling interval that is taken (s).
const INTERVALS_S: [f64; 2] = [1e-6, 1e4];

/// A box [rad/s] and a decay rate [1/s] with which the rest of a file is checked.
const USUAL_RATE: [f64; 3] = [0.1; 3];
const USUAL_SCALAR_PART: f64 = 0.5;
const USUAL_DECAY: f64 = 0.01;

/// A model file in which only the spacecraft, its sampling and the requirements are given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FactsFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// A short name, used in reports.
    pub name: String,
    /// Where the numbers come from.
    #[serde(default)]
    pub source: String,
    /// The spacecraft.
    pub plant: FactsPlant,
    /// Sampling, and what else of a model's `specs` is to be kept.
    pub specs: FactsSpecs,
    /// Bounds on what the loop that flies does otherwise than an ideal one.
    #[serde(default, skip_serializing_if = "crate::model::is_ideal")]
    pub imperfections: Imperfections,
    /// What is required; at least one.
    pub requirements: Requirements,
}

/// How the plant is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FactsPlant {
    /// The rigid spacecraft.
    Exact(FactsSpacecraft),
}

/// A rigid spacecraft; the box is found where it is left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FactsSpacecraft {
    /// Inertia matrix about the centre of mass, in body axes [kg m^2], as in a model file.
    #[serde(with = "As::<[[Finite; 3]; 3]>")]
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// How far the true inertia may be from it; known exactly when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia_uncertainty: Option<InertiaUncertaintyFile>,
    /// Torque limit of each axis, above 0 [N m].
    #[serde(with = "As::<[Positive; 3]>")]
    pub torque_limit_nm: [f64; 3],
    /// Bound on the norm of the disturbance torque, above 0 [N m].
    #[serde(with = "As::<Positive>")]
    pub disturbance_bound_nm: f64,
    /// The box: bound on the magnitude of each rate, above 0 [rad/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<[Positive; 3]>>")]
    pub rate_rad_s: Option<[f64; 3]>,
    /// The box: smallest scalar part q0 of the error quaternion, in (0, 1].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<UpToOne>>")]
    pub q0_min: Option<f64>,
    /// K of the form of the gyroscopic torque, as in a model file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<[[Finite; 3]; 3]>>")]
    pub gyroscopic_form_kg_m2: Option<[[f64; 3]; 3]>,
    /// Weights of rate and attitude, of which the design makes a weighted norm small; when left out the attitude alone where
    /// `pointing_deg` is required, and both alike elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_weights: Option<OutputWeights>,
}

/// Sampling, and numbers of the proof that are kept where they are given.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FactsSpecs {
    /// Samples per second, above 0; or `hbar_s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub sample_hz: Option<f64>,
    /// Longest sampling interval, above 0 (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub hbar_s: Option<f64>,
    /// Shortest sampling interval (s); that of `sample_hz` when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<ShortestInterval>>")]
    pub hmin_s: Option<f64>,
    /// Decay rate phi [1/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub phi_per_s: Option<f64>,
    /// Largest trigger threshold nu, in [0, 1).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<BelowOne>>")]
    pub nu: Option<f64>,
    /// Absolute part of the trigger, or "auto".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trigger_floor: Option<TriggerFloor>,
}

/// What is required, each proved or said to be out of reach.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Requirements {
    /// Largest pointing error from rest, and in the end from every certified start, in (0, 180) (deg).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<AngleDeg>>")]
    pub pointing_deg: Option<f64>,
    /// Largest rate about each axis at any time, above 0 [rad/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub rate_rad_s: Option<f64>,
    /// Every attitude at rest up to this angle must be a certified start, in (0, 180) (deg).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<AngleDeg>>")]
    pub certified_angle_deg: Option<f64>,
    /// Longest time from a certified start until the pointing error stays within `pointing_deg`, above 0 (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub settle_s: Option<f64>,
    /// Most messages per second, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub messages_per_s: Option<f64>,
}

/// Refuses sampling intervals that no spacecraft has, by the key of the file that gives them.
fn check_intervals(file: &FactsFile) -> Result<(), ModelError> {
    let [shortest, longest] = INTERVALS_S;
    let given = [
        ("specs.hbar_s", file.specs.hbar_s, [shortest, longest]),
        (
            "specs.sample_hz",
            file.specs.sample_hz,
            [1.0 / longest, 1.0 / shortest],
        ),
        (
            "requirements.messages_per_s",
            file.requirements.messages_per_s,
            [1.0 / longest, f64::MAX],
        ),
    ];
    for (field, value, [low, high]) in given {
        let Some(value) = value.filter(|value| !(low..=high).contains(value)) else {
            continue;
        };
        let allowed = match high == f64::MAX {
            true => format!("at least {low}"),
            false => format!("in [{low}, {high}]"),
        };
        return Err(ModelError::range(field, value, allowed));
    }
    Ok(())
}

/// Checked facts.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// The file, unchanged.
    pub file: FactsFile,
}

impl Facts {
    /// Reads and checks the text of a file.
    ///
    /// # Errors
    /// No such file, or a value out of its range.
    pub fn from_json(text: &str) -> Result<Self, FileError> {
        Ok(Facts::new(parse(text, Kind::Facts)?)?)
    }

    /// Checks every value.
    ///
    /// # Errors
    /// A value out of its range.
    pub fn new(file: FactsFile) -> Result<Self, ModelError> {
        check_version(file.schema_version, MODEL_SCHEMA_VERSION)?;
        let (rate, interval) = (file.specs.sample_hz, file.specs.hbar_s);
        if rate.is_some() == interval.is_some() {
            let reason = "exactly one of sample_hz and hbar_s must be given";
            return Err(ModelError::choice("specs.sample_hz", reason));
        }
        if file.requirements == Requirements::default() {
            let reason = "at least one requirement must be given";
            return Err(ModelError::choice("requirements", reason));
        }
        if file.requirements.settle_s.is_some() && file.requirements.pointing_deg.is_none() {
            let reason = "needs pointing_deg: the time counts until the error stays within it";
            return Err(ModelError::choice("requirements.settle_s", reason));
        }
        check_intervals(&file)?;
        let facts = Facts { file };
        // What else a model checks does not depend on what is found.
        let craft = facts.craft();
        let rate = craft.rate_rad_s.unwrap_or(USUAL_RATE);
        let scalar_part = craft.q0_min.unwrap_or(USUAL_SCALAR_PART);
        Model::new(facts.model(rate, scalar_part, USUAL_DECAY))?;
        Ok(facts)
    }

    /// The spacecraft.
    pub fn craft(&self) -> &FactsSpacecraft {
        let FactsPlant::Exact(craft) = &self.file.plant;
        craft
    }

    /// The longest sampling interval (s): that of the file, or longer where fewer messages are required than samples
    /// are possible.
    pub fn longest_interval(&self) -> f64 {
        let specs = &self.file.specs;
        let own = specs
            .hbar_s
            .or(specs.sample_hz.map(|rate| 1.0 / rate))
            .unwrap_or(f64::NAN);
        match self.file.requirements.messages_per_s {
            Some(most) => own.max(1.0 / most),
            None => own,
        }
    }

    /// The smallest torque limit over the bound on the disturbance.
    pub fn authority(&self) -> f64 {
        self.weakest_torque() / self.craft().disturbance_bound_nm
    }

    /// The smallest torque limit (N m).
    pub fn weakest_torque(&self) -> f64 {
        let limits = self.craft().torque_limit_nm;
        limits.into_iter().fold(f64::MAX, f64::min)
    }

    /// Whether no design can be proved, whatever its gains: held along the weakest axis, the disturbance takes the momentum
    /// about it beyond every bound. A proof covers the plant at the centre of the box, J w' = sat(u) + tau and q' = w / 2,
    /// in which that momentum cannot decrease.
    pub fn is_overwhelmed(&self) -> bool {
        self.weakest_torque() <= self.craft().disturbance_bound_nm
    }

    /// A model in SI units with a box and a decay rate; the objective is the smallest gain.
    pub(super) fn model(&self, rate_rad_s: [f64; 3], q0_min: f64, phi_per_s: f64) -> ModelFile {
        let (file, craft) = (&self.file, self.craft());
        let specs = &file.specs;
        let interval = self.longest_interval();
        let pointing = file.requirements.pointing_deg;
        let pointing = pointing.map(|_| OutputWeights::ATTITUDE);
        ModelFile {
            schema_version: MODEL_SCHEMA_VERSION,
            name: file.name.clone(),
            source: file.source.clone(),
            plant: PlantFile::Exact(ExactPlant {
                inertia_kg_m2: craft.inertia_kg_m2,
                inertia_uncertainty: craft.inertia_uncertainty,
                torque_limit_nm: craft.torque_limit_nm,
                disturbance_bound_nm: craft.disturbance_bound_nm,
                rate_rad_s,
                q0_min,
                gyroscopic_form_kg_m2: craft.gyroscopic_form_kg_m2,
                output_weights: craft.output_weights.or(pointing),
            }),
            specs: Specs {
                phi_per_s,
                hbar_s: interval,
                hmin_s: specs.hmin_s.or(specs.sample_hz.map(|_| interval)),
                nu: specs.nu.unwrap_or(match file.imperfections.measurement {
                    None => THRESHOLD,
                    Some(_) => THRESHOLD_WITH_ERRORS,
                }),
                trigger_floor: specs.trigger_floor,
                nu_min: None,
                threshold_update: None,
                eps: [1.0; 3],
                xi_max: f64::INFINITY,
                objective: Objective::Gain,
                gamma: None,
                gamma_max: None,
                must_contain: Vec::new(),
                outer: None,
                command_trigger: None,
                search: None,
                margin: 1e-6,
            },
            imperfections: file.imperfections.clone(),
            gains: GainForm::Constant,
            mismatch: Mismatch::None,
        }
    }
}
