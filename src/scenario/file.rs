//! The scenario file, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::dispersions_file::DispersionsFile;
use super::link_file::LinkFile;
use crate::controllers::ControllerFile;
use crate::plants::SystemFile;
use crate::sim::metrics::{Limit, Metric};

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
    /// How the plant is integrated between events.
    #[serde(default)]
    pub integrator: IntegratorFile,
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
    pub instants: InstantsFile,
    /// Probability that a sample is lost, in [0, 1).
    #[serde(default)]
    pub dropout_probability: f64,
}

/// Sampling instants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InstantsFile {
    /// At multiples of an interval.
    Periodic(PeriodicFile),
    /// At random intervals.
    Aperiodic(AperiodicFile),
    /// The trigger is watched continuously and its events are found as roots. Needs exact sensors and
    /// the fixed-step integrator.
    Continuous(ContinuousFile),
}

/// Periodic sampling with jitter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PeriodicFile {
    /// Interval, above 0 (s).
    pub interval_s: f64,
    /// Largest shift of an instant either way, below half of the interval (s).
    #[serde(default)]
    pub jitter_s: f64,
}

/// Aperiodic sampling: intervals uniform between two bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AperiodicFile {
    /// Shortest interval, above 0 (s).
    pub shortest_s: f64,
    /// Longest interval, not below the shortest (s).
    pub longest_s: f64,
}

/// A trigger watched continuously.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ContinuousFile {
    /// Width of the interval of time in which an event is known to lie, at least 1e-9 (s).
    pub resolution_s: f64,
}

/// The integrators.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum IntegratorFile {
    /// The classical Runge-Kutta method of order 4.
    RungeKutta4(StepFile),
    /// Dormand and Prince's adaptive method of order 8.
    DormandPrince853(ToleranceFile),
}

impl Default for IntegratorFile {
    fn default() -> Self {
        IntegratorFile::RungeKutta4(StepFile { step_s: 0.03125 })
    }
}

/// The longest step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StepFile {
    /// Longest step, above 0 (s); 1/32 s when the integrator is left out.
    pub step_s: f64,
}

/// The allowed error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ToleranceFile {
    /// Allowed error of a step relative to the state, in [1e-14, 0.001].
    pub tolerance: f64,
}

/// How the error of the run is summed up.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MetricsFile {
    /// A spacecraft has settled when its attitude error stays below this, above 0; 1 when left out
    /// (deg).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle_tolerance_deg: Option<f64>,
    /// Another plant has settled when the norm of its state stays below this, above 0; 0.01 when left
    /// out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle_tolerance_state: Option<f64>,
    /// A spacecraft has settled when no component of the vector part of its error quaternion is above
    /// this in magnitude, above 0 and below 1. In the place of settle_tolerance_deg.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle_tolerance_component: Option<f64>,
    /// The root mean square is taken over the last so many seconds, above 0; a fifth of the run when
    /// left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tail_s: Option<f64>,
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
    pub interval_s: Option<f64>,
}
