//! What a campaign draws anew for every run, as written in a scenario file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::base::empty_file::EmptyFile;

/// What a campaign draws anew for every run. A single run without an index leaves it aside.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DispersionsFile {
    /// How the drawn numbers are spread over the runs.
    #[serde(default)]
    pub sampling: PlanFile,
    /// Attitude of a spacecraft at the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_attitude: Option<AttitudeDispersionFile>,
    /// Added to each component of a spacecraft's rate at the start, each drawn by itself [rad/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_rate_rad_s: Option<DistributionFile>,
    /// Added to each component of the state of a plant that is no spacecraft at the start, each drawn by
    /// itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_state: Option<DistributionFile>,
    /// Start on the boundary of the certified set of the design, in the place of the three above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certified_boundary: Option<BoundaryFile>,
    /// Inertia of a spacecraft.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<InertiaDispersionFile>,
    /// Amplitude and phase of the disturbance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbance: Option<DisturbanceDispersionFile>,
    /// Faults of a spacecraft's actuators, in addition to those of the scenario.
    #[serde(default)]
    pub faults: Vec<FaultDispersionFile>,
    /// Any other number of the scenario by its name, such as `sampling.dropout_probability`.
    #[serde(default)]
    pub values: Vec<ValueDispersionFile>,
}

/// How the drawn numbers are spread over the runs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlanFile {
    /// Every number of every run by itself.
    #[default]
    Independent,
    /// Every number in N runs takes one value from each of N equally probable intervals.
    LatinHypercube,
    /// A Sobol sequence with the direction numbers of Joe and Kuo, shifted by the seed.
    Sobol,
}

/// The distribution of a number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DistributionFile {
    /// Normal.
    Normal(NormalFile),
    /// Uniform between two bounds.
    Uniform(UniformFile),
    /// One of these values, each as probable as any other.
    Choice(Vec<f64>),
}

/// A normal distribution, cut off where bounds are given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NormalFile {
    /// Mean before it is cut off.
    #[serde(default)]
    pub mean: f64,
    /// Standard deviation before it is cut off, not negative.
    pub standard_deviation: f64,
    /// No value is below this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
    /// No value is above this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
}

/// A uniform distribution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UniformFile {
    /// Lower bound.
    pub from: f64,
    /// Upper bound, not below the lower.
    pub to: f64,
}

/// Attitude at the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AttitudeDispersionFile {
    /// Any attitude, uniform over all rotations. Write `{}` after it.
    Uniform(EmptyFile),
    /// The scenario's attitude turned about an axis of uniformly random direction.
    AxisAngle(TurnFile),
}

/// A turn about a random axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TurnFile {
    /// The angle (deg).
    pub angle_deg: DistributionFile,
}

/// The boundary of the certified set x'Ux <= 1 of a design.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundaryFile {
    /// x'Ux of every start, above 0; 1, the edge of the certified set, when left out. The direction is
    /// uniform in the metric of U, so units play no part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<f64>,
}

/// Changes of the inertia matrix. The controller keeps what it knows of the nominal one.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InertiaDispersionFile {
    /// Change of each moment of inertia, drawn by itself (percent of it).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moments_percent: Option<DistributionFile>,
    /// Change of each product of inertia, drawn by itself (percent of it).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub products_percent: Option<DistributionFile>,
}

/// Changes of the disturbance.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisturbanceDispersionFile {
    /// Factor of the whole disturbance: bias, sines and table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<DistributionFile>,
    /// Phase added to each of the sines, drawn by itself (deg).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase_deg: Option<DistributionFile>,
}

/// A fault that may happen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultDispersionFile {
    /// Probability that it happens in a run, in [0, 1]; 1 when left out.
    #[serde(default = "certain")]
    pub probability: f64,
    /// Axis: 1, 2 or 3; any of them when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<u32>,
    /// Start (s).
    pub from_s: DistributionFile,
    /// Duration; to the end of the run when left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<DistributionFile>,
    /// Share of the commanded torque that acts.
    pub effectiveness: DistributionFile,
}

fn certain() -> f64 {
    1.0
}

/// A number of the scenario.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ValueDispersionFile {
    /// Its name, such as `system.rigid_body.sensors.attitude_noise_deg`; the end of the name will do
    /// when it is the end of one name only.
    pub name: String,
    /// What is drawn.
    pub distribution: DistributionFile,
    /// What is done with it.
    #[serde(default)]
    pub change: ChangeFile,
}

/// What is done with a drawn value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ChangeFile {
    /// It takes the place of the scenario's.
    #[default]
    Replace,
    /// It is added.
    Add,
    /// The scenario's is multiplied by it.
    Multiply,
}
