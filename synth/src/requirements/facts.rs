//! A spacecraft as its engineer knows it, and what is required of it. What the proof needs beside is found, and is kept where
//! the file gives it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::bounded::{AngleDeg, As, BelowOne, Finite, Positive, ShortestInterval, UpToOne};
use crate::model::{
    check_inertia, check_line, check_version, parse, FileError, Imperfections,
    InertiaUncertaintyFile, Kind, ModelError, TriggerFloor, MODEL_SCHEMA_VERSION,
};

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
    /// Largest pointing error from rest, and in the end, in (0, 180) (deg); where a design has two sets, in the end from the
    /// small one.
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
    /// Most messages per second, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub messages_per_s: Option<f64>,
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
        check_line("name", &file.name)?;
        let FactsPlant::Exact(craft) = &file.plant;
        check_inertia("plant.exact.inertia_kg_m2", &craft.inertia_kg_m2)?;
        let (rate, interval) = (file.specs.sample_hz, file.specs.hbar_s);
        if rate.is_some() == interval.is_some() {
            let reason = "exactly one of sample_hz and hbar_s must be given";
            return Err(ModelError::choice("specs.sample_hz", reason));
        }
        if file.requirements == Requirements::default() {
            let reason = "at least one requirement must be given";
            return Err(ModelError::choice("requirements", reason));
        }
        Ok(Facts { file })
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
        let craft = self.craft();
        let weakest = craft.torque_limit_nm.into_iter().fold(f64::MAX, f64::min);
        weakest / craft.disturbance_bound_nm
    }
}
