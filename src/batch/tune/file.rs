//! The requirements file of the parameter search.

use nalgebra::{Matrix3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::{
    check_matrix, check_positive, check_positive_definite, finite, parse, FileError, Kind,
    ModelError,
};

use crate::base::ranges::{each, not_negative, require};

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
    pub sampling_interval_s: Option<f64>,
    /// The search.
    #[serde(default)]
    pub search: SearchFile,
}

/// A spacecraft.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpacecraftFile {
    /// Inertia matrix, symmetric positive definite [kg m^2].
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// Largest torque of each axis, above 0 [N m].
    pub torque_limit_nm: [f64; 3],
    /// Longest time for which the actuators may be on, above 0; no limit when left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_on_s: Option<f64>,
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
    pub rate_rad_s: f64,
    /// From this time on, above 0, every component of the error quaternion's vector part stays within
    /// the tolerance and the attitude error within the accuracy (s).
    pub settle_s: f64,
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
    pub bound_nm: f64,
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
    /// Angle at the start, rad.
    pub angle_rad: f64,
    /// Tolerance of the components.
    pub component: f64,
    /// Length of every run, s.
    pub duration_s: f64,
    /// The search.
    pub search: SearchFile,
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
        let craft = &file.spacecraft;
        let rows: Vec<Vec<f64>> = craft.inertia_kg_m2.iter().map(|row| row.to_vec()).collect();
        let field = "spacecraft.inertia_kg_m2";
        check_positive_definite(field, &check_matrix(field, &rows, (Some(3), Some(3)))?)?;
        let inertia = Matrix3::from_fn(|row, column| craft.inertia_kg_m2[row][column]);
        check_spacecraft(craft)?;
        check_task(&file)?;
        let duration_s = check_search(&file)?;
        let moments = inertia.symmetric_eigenvalues();
        let accuracy = (0.5 * file.limits.accuracy_deg.to_radians()).sin();
        Ok(Requirements {
            inertia,
            moments_kg_m2: (moments.min(), moments.max()),
            angle_rad: file.manoeuvre.angle_deg.to_radians(),
            component: file.limits.settle_tolerance_component.unwrap_or(accuracy),
            duration_s,
            search: file.search.clone(),
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

    /// Smallest torque limit, N m.
    pub fn least_torque_nm(&self) -> f64 {
        Vector3::from(self.file.spacecraft.torque_limit_nm).min()
    }
}

fn check_spacecraft(craft: &SpacecraftFile) -> Result<(), ModelError> {
    let limits = &craft.torque_limit_nm;
    each("spacecraft.torque_limit_nm", limits, check_positive)?;
    match craft.longest_on_s {
        Some(longest) => check_positive("spacecraft.longest_on_s", longest),
        None => Ok(()),
    }
}

fn check_task(file: &TuneFile) -> Result<(), ModelError> {
    let limits = &file.limits;
    within(
        "manoeuvre.angle_deg",
        file.manoeuvre.angle_deg,
        (0.0, 170.0),
    )?;
    if let Some(axis) = &file.manoeuvre.axis {
        each("manoeuvre.axis", axis, finite)?;
        check_positive("manoeuvre.axis", Vector3::from(*axis).norm())?;
    }
    check_positive("limits.rate_rad_s", limits.rate_rad_s)?;
    check_positive("limits.settle_s", limits.settle_s)?;
    if let Some(component) = limits.settle_tolerance_component {
        within("limits.settle_tolerance_component", component, (0.0, 0.5))?;
    }
    let accuracy = limits.accuracy_deg;
    let ok = (1e-4..=10.0).contains(&accuracy);
    require(ok, "limits.accuracy_deg", accuracy, "from 0.0001 to 10")?;
    if let Some(interval) = file.sampling_interval_s {
        check_positive("sampling_interval_s", interval)?;
    }
    not_negative("disturbance.bound_nm", file.disturbance.bound_nm)?;
    check_positive(
        "disturbance.frequency_rad_s",
        file.disturbance.frequency_rad_s,
    )
}

fn check_search(file: &TuneFile) -> Result<f64, ModelError> {
    let search = &file.search;
    let counts = [
        ("search.candidates", search.candidates, 1, 100_000),
        ("search.training_axes", search.training_axes, 0, 100),
        ("search.validation_axes", search.validation_axes, 1, 1000),
    ];
    for (field, count, least, most) in counts {
        let ok = (least..=most).contains(&count);
        require(ok, field, count as f64, &format!("from {least} to {most}"))?;
    }
    let settle = file.limits.settle_s;
    let duration = search.duration_s.unwrap_or((4.0 * settle).max(700.0));
    let ok = duration > settle;
    require(ok, "search.duration_s", duration, "above limits.settle_s")?;
    Ok(duration)
}

fn within(field: &str, value: f64, (above, most): (f64, f64)) -> Result<(), ModelError> {
    let allowed = format!("above {above} and at most {most}");
    require(value > above && value <= most, field, value, &allowed)
}

/// A start of a run, at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Axis of the turn, of length 1.
    pub axis: Vector3<f64>,
    /// Whether the disturbance acts.
    pub disturbed: bool,
}
