//! The requirements file of the parameter search.

use std::ops::RangeInclusive;

use nalgebra::{Matrix3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::{check_inertia, check_positive, finite, parse, FileError, Kind, ModelError};

use crate::base::bounded::{plain, NonNegative, Positive};
use crate::base::ranges::{each, require};

/// The version this program reads.
pub const TUNE_SCHEMA_VERSION: u32 = 1;

/// What a spacecraft is and what it must do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TuneFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// A short name, used in the scenario.
    pub name: String,
    /// Where the numbers come from.
    #[serde(default)]
    pub source: String,
    /// The spacecraft.
    pub spacecraft: SpacecraftFile,
    /// The turn, from rest.
    pub manoeuvre: ManoeuvreFile,
    /// What must be achieved.
    pub limits: LimitsFile,
    /// The disturbance.
    pub disturbance: DisturbanceFile,
    /// How the trigger is evaluated: at this interval, above 0 (s); continuously, as in the paper, when
    /// left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sampling_interval_s: Option<Positive>,
    /// The search.
    #[serde(default)]
    pub search: SearchFile,
}

/// A spacecraft.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpacecraftFile {
    /// Inertia matrix of a rigid body about its centre of mass, in body axes [kg m^2]: symmetric positive definite,
    /// no principal moment above the sum of the other two. Entries off the diagonal are those of the matrix, J_12 =
    /// - integral of x y dm: products of inertia with their signs reversed.
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// Largest torque of each axis, above 0 [N m].
    pub torque_limit_nm: [Positive; 3],
    /// Longest time for which the actuators may be on, above 0; no limit when left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_on_s: Option<Positive>,
}

/// A turn from rest to rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ManoeuvreFile {
    /// Angle at the start, above 0 and at most 170 (deg).
    pub angle_deg: f64,
    /// Axis of the scenario that is written, of any length above 0; [1, 1, 1] when left out. The
    /// parameters are searched and validated for other axes too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<[f64; 3]>,
}

/// What must be achieved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LimitsFile {
    /// Largest norm of the body rate, above 0 [rad/s].
    pub rate_rad_s: Positive,
    /// From this time on, above 0, every component of the error quaternion's vector part stays within
    /// the tolerance and the attitude error within the accuracy (s).
    pub settle_s: Positive,
    /// The tolerance of the components, above 0 and below 0.5; that of the accuracy when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle_tolerance_component: Option<f64>,
    /// The accuracy, from 0.0001 to 10 (deg).
    pub accuracy_deg: f64,
}

/// A disturbance of which the largest norm is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisturbanceFile {
    /// Largest norm, 0 or above [N m].
    pub bound_nm: NonNegative,
    /// Angular frequency of its slower periodic part, above 0; 0.01 when left out [rad/s].
    #[serde(default = "slow")]
    pub frequency_rad_s: f64,
}

fn slow() -> f64 {
    0.01
}

/// The search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SearchFile {
    /// Seed of the axes.
    pub seed: u64,
    /// Most candidates, 1 to 100000.
    pub candidates: usize,
    /// Random axes that the search begins with, 0 to 100, in addition to the body's three.
    pub training_axes: usize,
    /// Random axes, 1 to 1000, on which the result is tried after the search.
    pub validation_axes: usize,
    /// Length of every run, above settle_s; the longer of 700 s and four times settle_s when left out (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
}

impl Default for SearchFile {
    fn default() -> Self {
        SearchFile {
            seed: 1,
            candidates: 200,
            training_axes: 4,
            validation_axes: 10,
            duration_s: None,
        }
    }
}

/// Checked requirements.
#[derive(Debug, Clone)]
pub struct Requirements {
    /// The file.
    pub file: TuneFile,
    /// Inertia, kg m^2.
    pub inertia: Matrix3<f64>,
    /// Smallest and largest principal moment of inertia, kg m^2.
    pub moments_kg_m2: (f64, f64),
    /// Largest torque of each axis, N m.
    pub torque_limit_nm: Vector3<f64>,
    /// Angle at the start, rad.
    pub angle_rad: f64,
    /// Tolerance of the components.
    pub component: f64,
    /// Length of every run, s.
    pub duration_s: f64,
}

impl Requirements {
    /// Reads and checks the text of a requirements file.
    ///
    /// # Errors
    /// The first field that is missing, unknown, of the wrong type or out of its range.
    pub fn from_json(text: &str) -> Result<Self, FileError> {
        Ok(Self::new(parse(text, Kind::Requirements)?)?)
    }

    fn new(file: TuneFile) -> Result<Self, ModelError> {
        if file.schema_version != TUNE_SCHEMA_VERSION {
            return Err(ModelError::SchemaVersion {
                found: file.schema_version,
                expected: TUNE_SCHEMA_VERSION,
            });
        }
        let rows = &file.spacecraft.inertia_kg_m2;
        let inertia = check_inertia("spacecraft.inertia_kg_m2", rows)?;
        let moments = inertia.symmetric_eigenvalues();
        let limits = &file.limits;
        let (turn, settle_s) = (&file.manoeuvre, limits.settle_s.get());
        check_above("manoeuvre.angle_deg", turn.angle_deg, 170.0)?;
        if let Some(axis) = &turn.axis {
            each("manoeuvre.axis", axis, finite)?;
            if axis.iter().all(|entry| *entry == 0.0) {
                let reason = "every entry is 0; an axis needs a direction";
                return Err(ModelError::choice("manoeuvre.axis", reason));
            }
        }
        if let Some(component) = limits.settle_tolerance_component {
            check_above("limits.settle_tolerance_component", component, 0.5)?;
        }
        let accuracy = limits.accuracy_deg;
        let ok = (1e-4..=10.0).contains(&accuracy);
        require(ok, "limits.accuracy_deg", accuracy, "from 0.0001 to 10")?;
        let frequency = file.disturbance.frequency_rad_s;
        check_positive("disturbance.frequency_rad_s", frequency)?;
        let search = &file.search;
        check_count("search.candidates", search.candidates, 1..=100_000)?;
        check_count("search.training_axes", search.training_axes, 0..=100)?;
        check_count("search.validation_axes", search.validation_axes, 1..=1000)?;
        let duration_s = search.duration_s.unwrap_or((4.0 * settle_s).max(700.0));
        let allowed = "above limits.settle_s";
        require(
            duration_s > settle_s,
            "search.duration_s",
            duration_s,
            allowed,
        )?;
        if let Some(interval) = &file.sampling_interval_s {
            let (interval_s, allowed) = (interval.get(), "at most limits.settle_s");
            require(
                interval_s <= settle_s,
                "sampling_interval_s",
                interval_s,
                allowed,
            )?;
        }
        let component = (0.5 * accuracy.to_radians()).sin();
        Ok(Requirements {
            inertia,
            moments_kg_m2: (moments.min(), moments.max()),
            torque_limit_nm: plain(&file.spacecraft.torque_limit_nm).into(),
            angle_rad: turn.angle_deg.to_radians(),
            component: limits.settle_tolerance_component.unwrap_or(component),
            duration_s,
            file,
        })
    }

    /// The start of the scenario that is written.
    pub fn start(&self) -> Start {
        let axis = Vector3::from(self.file.manoeuvre.axis.unwrap_or([1.0; 3]));
        Start {
            axis: axis.try_normalize(0.0).unwrap_or(Vector3::z()),
            disturbed: true,
        }
    }
}

fn check_above(field: &str, value: f64, most: f64) -> Result<(), ModelError> {
    let allowed = format!("above 0 and at most {most}");
    require(value > 0.0 && value <= most, field, value, &allowed)
}

fn check_count(field: &str, count: usize, range: RangeInclusive<usize>) -> Result<(), ModelError> {
    let allowed = format!("from {} to {}", range.start(), range.end());
    require(range.contains(&count), field, count as f64, &allowed)
}

/// A start of a run, at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Axis of the turn, of length 1.
    pub axis: Vector3<f64>,
    /// Whether the disturbance acts.
    pub disturbed: bool,
}
