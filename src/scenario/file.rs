//! The scenario file, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::dispersions::DispersionsFile;
use super::link::LinkFile;
use super::network::NetworkFile;
use crate::base::bounded::{As, BelowOne, HalfTurn, InsideUnit, Positive, Tail};
use crate::controllers::ControllerFile;
use crate::plants::SystemFile;
use crate::sim::integrator::Method;
use crate::sim::metrics::{Limit, Metric};
use crate::sim::sampling::Instants;

/// The version this program reads.
pub const SCENARIO_SCHEMA_VERSION: u32 = 1;

/// A plant, a controller and what is required of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// A short name, used in reports.
    pub name: String,
    /// Where the numbers come from.
    #[serde(default)]
    pub source: String,
    /// Length of the run, above 0 (s).
    #[serde(with = "As::<Positive>")]
    pub duration_s: f64,
    /// The generator of every random number of the run.
    #[serde(default)]
    pub random: RandomFile,
    /// The plant with its initial state, disturbance, sensors and actuators.
    pub system: SystemFile,
    /// When the sensor is sampled.
    pub sampling: SamplingFile,
    /// The controller.
    pub controller: ControllerFile,
    /// The link from the controller's torque command to the actuators of a spacecraft; without it the
    /// command acts as it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<LinkFile>,
    /// The network that carries the controller's messages, in the place of a link; without it they arrive at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<NetworkFile>,
    /// How the plant is integrated between events.
    #[serde(default)]
    pub integrator: Method,
    /// How the error of the run is summed up.
    #[serde(default)]
    pub metrics: MetricsFile,
    /// What the run must achieve.
    #[serde(default)]
    pub requirements: Vec<RequirementFile>,
    /// What is written of the trajectory.
    #[serde(default)]
    pub output: OutputFile,
    /// What a campaign draws anew for every run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dispersions: Option<DispersionsFile>,
}

/// The generator of random numbers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomFile {
    /// Its name.
    pub generator: Generator,
    /// Its seed.
    pub seed: u64,
}

impl Default for RandomFile {
    fn default() -> Self {
        Self {
            generator: Generator::Chacha8,
            seed: 0,
        }
    }
}

/// The generators there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Generator {
    /// ChaCha with 8 rounds.
    Chacha8,
}

/// When the sensor is sampled, the first time at the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SamplingFile {
    /// The instants.
    pub instants: Instants,
    /// Probability that a sample is lost, in [0, 1).
    #[serde(default, with = "As::<BelowOne>")]
    pub dropout_probability: f64,
}

/// How the error of the run is summed up.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MetricsFile {
    /// A spacecraft has settled when its attitude error stays below this, above 0; 1 when left out
    /// (deg).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle_tolerance_deg: Option<HalfTurn>,
    /// Another plant has settled when the norm of its state stays below this, above 0; 0.01 when left
    /// out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle_tolerance_state: Option<Positive>,
    /// A spacecraft has settled when no component of the vector part of its error quaternion is above
    /// this in magnitude, above 0 and below 1. In the place of settle_tolerance_deg.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle_tolerance_component: Option<InsideUnit>,
    /// The root mean square is taken over the last so many seconds, above 0; a fifth of the run when
    /// left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tail_s: Option<Tail>,
}

/// A requirement: one metric, one limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RequirementFile {
    /// The metric.
    pub metric: Metric,
    /// The metric must not be above this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
    /// The metric must not be below this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
}

impl RequirementFile {
    /// Its limit, which a checked scenario's has.
    pub fn limit(&self) -> Option<Limit> {
        let most = self.at_most.map(Limit::AtMost);
        most.or(self.at_least.map(Limit::AtLeast))
    }
}

/// What is written of the trajectory.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Longest time between two rows of the trajectory, above 0; a 4000th of the run when left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval_s: Option<Positive>,
}
