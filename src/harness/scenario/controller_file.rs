//! The controller part of the scenario file, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::lei_file::LeiFile;

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
    /// Lei et al. 2022.
    Lei2022(Box<LeiFile>),
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
    /// Settling time, above 0 (s).
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
    /// Longest sampling interval of the design, above 0 (s).
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
