//! The scenario file, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::VerticesPlant;

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
    /// Length of the run, above 0 [s].
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

/// The kinds of systems.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SystemFile {
    /// A rigid spacecraft.
    RigidBody(Box<RigidBodyFile>),
    /// A Takagi-Sugeno model of any size.
    TakagiSugeno(Box<TakagiSugenoFile>),
}

/// A rigid spacecraft: the true one, which may differ from the model of the design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigidBodyFile {
    /// Inertia matrix, symmetric positive definite [kg m^2].
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// Attitude at the start.
    pub initial_attitude: AttitudeFile,
    /// Body rate at the start [rad/s].
    #[serde(default)]
    pub initial_rate_rad_s: [f64; 3],
    /// What the attitude should be; the zero attitude when left out.
    #[serde(default)]
    pub reference: ReferenceFile,
    /// Disturbance torque; none when left out.
    #[serde(default)]
    pub disturbance: TorqueFile,
    /// Errors of the sensors; none when left out.
    #[serde(default)]
    pub sensors: SensorsFile,
    /// Limits of the actuators; none but the controller's own when left out.
    #[serde(default)]
    pub actuators: ActuatorsFile,
    /// Faults of the actuators.
    #[serde(default)]
    pub faults: Vec<FaultFile>,
}

/// An attitude. A quaternion's norm may differ from 1 by 0.01; it is normalised.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AttitudeFile {
    /// [q0, q1, q2, q3], q0 the scalar.
    QuaternionScalarFirst([f64; 4]),
    /// [q1, q2, q3, q0], q0 the scalar.
    QuaternionScalarLast([f64; 4]),
    /// [yaw, pitch, roll]: about axis 3, then 2, then 1 [deg].
    #[serde(rename = "euler_321_deg")]
    Euler321Deg([f64; 3]),
    /// A turn about an axis.
    AxisAngle(AxisAngleFile),
}

/// A turn about an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AxisAngleFile {
    /// The axis, of any length above 0.
    pub axis: [f64; 3],
    /// The angle [deg].
    pub angle_deg: f64,
}

/// What the attitude should be in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceFile {
    /// A constant attitude.
    Constant(AttitudeFile),
    /// A turn at a constant rate.
    Slew(SlewFile),
    /// An oscillation.
    Sine(SineFile),
}

impl Default for ReferenceFile {
    fn default() -> Self {
        ReferenceFile::Constant(AttitudeFile::QuaternionScalarFirst([1.0, 0.0, 0.0, 0.0]))
    }
}

/// A turn at a constant rate about an axis fixed in the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SlewFile {
    /// Attitude before the slew.
    pub start: AttitudeFile,
    /// The axis, of any length above 0.
    pub axis: [f64; 3],
    /// The rate [rad/s].
    pub rate_rad_s: f64,
    /// Start of the slew, not negative [s].
    pub from_s: f64,
    /// End of the slew, after its start [s].
    pub until_s: f64,
}

/// An oscillation `amplitude sin(frequency t)` about an axis fixed in the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SineFile {
    /// Attitude in the middle.
    pub centre: AttitudeFile,
    /// The axis, of any length above 0.
    pub axis: [f64; 3],
    /// Amplitude [deg].
    pub amplitude_deg: f64,
    /// Angular frequency, above 0 [rad/s].
    pub frequency_rad_s: f64,
}

/// A disturbance torque: the sum of its parts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorqueFile {
    /// Constant part [N m].
    #[serde(default)]
    pub bias_nm: [f64; 3],
    /// Periodic parts.
    #[serde(default)]
    pub sines: Vec<TorqueSineFile>,
    /// Rows between which the torque changes linearly; constant before the first and after the last.
    #[serde(default)]
    pub table: Vec<TorqueRowFile>,
}

/// `sine_nm sin(frequency t) + cosine_nm cos(frequency t)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorqueSineFile {
    /// Angular frequency, above 0 [rad/s].
    pub frequency_rad_s: f64,
    /// Amplitude of the sine [N m].
    #[serde(default)]
    pub sine_nm: [f64; 3],
    /// Amplitude of the cosine [N m].
    #[serde(default)]
    pub cosine_nm: [f64; 3],
}

/// One row of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorqueRowFile {
    /// Time, later than in the row before [s].
    pub time_s: f64,
    /// Torque [N m].
    pub torque_nm: [f64; 3],
}

/// Errors of the sensors.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorsFile {
    /// Standard deviation of the attitude about each axis, not negative [deg].
    #[serde(default)]
    pub attitude_noise_deg: f64,
    /// Standard deviation of each rate, not negative [deg/s].
    #[serde(default)]
    pub rate_noise_deg_s: f64,
    /// Resolution of the attitude, not negative; 0 for none [deg].
    #[serde(default)]
    pub attitude_quantum_deg: f64,
    /// Resolution of each rate, not negative; 0 for none [deg/s].
    #[serde(default)]
    pub rate_quantum_deg_s: f64,
}

/// Limits of the actuators.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ActuatorsFile {
    /// Largest torque of each axis, above 0; no limit but the controller's when left out [N m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_limit_nm: Option<[f64; 3]>,
    /// Commands below this magnitude give no torque, not negative [N m].
    #[serde(default)]
    pub dead_band_nm: [f64; 3],
    /// Time from command to torque, not negative [s].
    #[serde(default)]
    pub delay_s: f64,
}

/// A fault of one axis in a window of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultFile {
    /// Axis: 1, 2 or 3.
    pub axis: u32,
    /// Start of the window, not negative [s].
    pub from_s: f64,
    /// End of the window, after its start [s].
    pub until_s: f64,
    /// Share of the commanded torque that acts, in [0, 1]; 1 when left out.
    #[serde(default = "one")]
    pub effectiveness: f64,
    /// Torque that acts on top [N m].
    #[serde(default)]
    pub additive_nm: f64,
}

fn one() -> f64 {
    1.0
}

/// A Takagi-Sugeno model as the plant: x' = A(t) x + B u + B_w tau.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TakagiSugenoFile {
    /// Its vertex systems, as in a model file. At most 24 states and 12 inputs.
    pub vertices: VerticesPlant,
    /// How they are weighted in time.
    pub mixing: MixingFile,
    /// State at the start, n entries.
    pub initial_state: Vec<f64>,
    /// Disturbance; none when left out.
    #[serde(default)]
    pub disturbance: SignalFile,
    /// Standard deviation of the measurement of each state, not negative.
    #[serde(default)]
    pub state_noise: f64,
    /// Time from command to input, not negative [s].
    #[serde(default)]
    pub input_delay_s: f64,
}

/// Weights of the vertex systems in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MixingFile {
    /// Constant weights, one for each vertex, not negative, with sum 1.
    Constant(Vec<f64>),
    /// From each vertex to the next and back to the first.
    Cycle(CycleFile),
}

/// A cycle through the vertices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CycleFile {
    /// Time from one vertex to the next, above 0 [s].
    pub dwell_s: f64,
}

/// A disturbance of any size: the sum of its parts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SignalFile {
    /// Constant part; zero when left out.
    #[serde(default)]
    pub bias: Vec<f64>,
    /// Periodic parts.
    #[serde(default)]
    pub sines: Vec<SignalSineFile>,
}

/// `sine sin(frequency t) + cosine cos(frequency t)`; a part left out is zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SignalSineFile {
    /// Angular frequency, above 0 [rad/s].
    pub frequency_rad_s: f64,
    /// Amplitude of the sine.
    #[serde(default)]
    pub sine: Vec<f64>,
    /// Amplitude of the cosine.
    #[serde(default)]
    pub cosine: Vec<f64>,
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
    /// Interval, above 0 [s].
    pub interval_s: f64,
    /// Largest shift of an instant either way, below half of the interval [s].
    #[serde(default)]
    pub jitter_s: f64,
}

/// Aperiodic sampling: intervals uniform between two bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AperiodicFile {
    /// Shortest interval, above 0 [s].
    pub shortest_s: f64,
    /// Longest interval, not below the shortest [s].
    pub longest_s: f64,
}

/// A trigger watched continuously.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ContinuousFile {
    /// Width of the interval of time in which an event is known to lie, at least 1e-9 [s].
    pub resolution_s: f64,
}

/// The controllers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ControllerFile {
    /// The controller of a design file, which `simulate --design` names.
    Design(DesignReferenceFile),
    /// Wu, Shen and Cao 2018.
    Wu2018(WuFile),
    /// Xu and Huang 2020 with given gains: nothing is proved.
    Xu2020(Box<XuFile>),
}

/// Which design file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignReferenceFile {
    /// Path of the design file, from the scenario file's folder; the command line's takes precedence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
}

/// Law (6) and trigger (8) of Wu, Shen and Cao 2018.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WuFile {
    /// The gains.
    pub gains: WuGainsFile,
    /// The trigger.
    pub trigger: WuTriggerFile,
    /// Largest torque of each axis, above 0 [N m].
    pub torque_limit_nm: [f64; 3],
    /// With this key the law takes the shorter way round: half width of the hysteresis of the scalar
    /// part's sign, in [0, 1). As published when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortest_rotation_hysteresis: Option<f64>,
}

/// Gains of the law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WuGainsFile {
    /// By (39), from a settling time.
    SettlingTime(SettlingTimeFile),
    /// k and beta.
    Direct(DirectGainsFile),
}

/// Data of (39).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SettlingTimeFile {
    /// Settling time, above 0 [s].
    pub settling_time_s: f64,
    /// Damping ratio, above 0.
    pub damping_ratio: f64,
    /// Largest principal moment of inertia, above 0; that of the plant when left out [kg m^2].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_inertia_kg_m2: Option<f64>,
}

/// k and beta.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectGainsFile {
    /// k, above 0 [N m s/rad].
    pub error_gain_nm_s_rad: f64,
    /// beta, above 0 [rad/s].
    pub attitude_weight_rad_s: f64,
}

/// When the filtered error is sent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WuTriggerFile {
    /// The paper's (8).
    Relative(RelativeTriggerFile),
    /// At every sample: the time-triggered loop. Write `{}` after it.
    EverySample(EmptyFile),
}

/// Nothing.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EmptyFile {}

/// alpha and gamma of (8).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelativeTriggerFile {
    /// alpha, in (0, 1).
    pub relative: f64,
    /// gamma, above 0 [rad/s].
    pub absolute_rad_s: f64,
}

/// Law (12) and trigger (10) of Xu and Huang 2020 with given gains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct XuFile {
    /// The fuzzy rules, 1 to 8, with Gaussian memberships about their centres.
    pub rules: Vec<RuleFile>,
    /// Standard deviation of the membership functions in each state, above 0 [rad/s, then 1].
    pub widths: [f64; 6],
    /// The trigger weight Upsilon, 6 x 6, symmetric positive definite.
    pub trigger_weight: [[f64; 6]; 6],
    /// The threshold nu.
    pub threshold: ThresholdFile,
    /// Largest torque of each axis, above 0 [N m].
    pub torque_limit_nm: [f64; 3],
    /// Longest sampling interval of the design, above 0 [s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_interval_s: Option<f64>,
    /// What the paper claims for these gains. It is compared with the run; it is not proved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published_claim: Option<ClaimFile>,
}

/// A fuzzy rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RuleFile {
    /// State [body rate (rad/s), vector part of the error quaternion] that the rule is about.
    pub centre: [f64; 6],
    /// Gain F_j, 3 x 6.
    pub gain: [[f64; 6]; 3],
}

/// The threshold of the trigger, in [0, 1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ThresholdFile {
    /// It never changes.
    Fixed(FixedThresholdFile),
    /// The published update between two bounds.
    Clamped(ClampedThresholdFile),
    /// The published update, bounded from below only.
    UnclampedAsPublished(UnclampedThresholdFile),
}

/// A constant threshold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FixedThresholdFile {
    /// nu.
    pub nu: f64,
}

/// The published update between two bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClampedThresholdFile {
    /// Smallest and first threshold.
    pub nu_min: f64,
    /// Largest threshold, not below the smallest.
    pub nu_max: f64,
    /// mu_1, mu_2, mu_3, each not negative.
    pub mu: [f64; 3],
}

/// The published update, bounded from below only.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UnclampedThresholdFile {
    /// Smallest and first threshold.
    pub nu_min: f64,
    /// mu_1, mu_2, mu_3, each not negative.
    pub mu: [f64; 3],
}

/// A claim of a paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClaimFile {
    /// gamma, above 0.
    pub gain_bound: f64,
    /// phi, above 0 [1/s].
    pub decay_rate_per_s: f64,
    /// kappa: the largest membership mismatch that the conditions assume, above 0.
    pub membership_mismatch: f64,
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
    /// Longest step, above 0 [s]; 1/32 s when the integrator is left out.
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
    /// [deg].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle_tolerance_deg: Option<f64>,
    /// Another plant has settled when the norm of its state stays below this, above 0; 0.01 when left
    /// out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle_tolerance_state: Option<f64>,
    /// The root mean square is taken over the last so many seconds, above 0; a fifth of the run when
    /// left out [s].
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

/// What can be required. A metric that a run does not have (such as the settling time of a run that
/// does not settle) misses its requirement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Messages sent.
    Triggers,
    /// Changes of the torque that acts.
    Updates,
    /// Bits sent.
    Bits,
    /// Bytes sent.
    Bytes,
    /// Time from which on the error stays within the tolerance [s].
    SettleSeconds,
    /// Attitude error at the end [deg].
    FinalErrorDeg,
    /// Root mean square of the attitude error over the tail [deg].
    RmsErrorDeg,
    /// Norm of the state at the end.
    FinalStateNorm,
    /// Root mean square of the norm of the state over the tail.
    RmsStateNorm,
    /// Largest norm of the body rate [rad/s].
    MaxRate,
    /// Largest torque of any axis [N m].
    MaxTorque,
    /// Integral of the magnitudes of all axes' torques [N m s].
    Impulse,
    /// Steps at which a claim of the controller's certificate was broken.
    Violations,
    /// Shortest time between two messages [s].
    ShortestIntervalS,
    /// Mean time between two messages [s].
    MeanIntervalS,
    /// Largest x'Ux over its bound, for a design.
    LyapunovRatio,
}

/// What is written of the trajectory.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Longest time between two rows of the trajectory, above 0; a 4000th of the run when left out [s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval_s: Option<f64>,
}
