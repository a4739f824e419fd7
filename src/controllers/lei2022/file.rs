//! Lei et al. 2022 in the scenario file, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::base::empty_file::EmptyFile;

/// Law (12) with the composite trigger (6) and (8) of Lei et al. 2022. Made for a fixed reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeiFile {
    /// The performance function (3) of each component of the error quaternion's vector part.
    pub performance: PerformanceFile,
    /// The barrier Lyapunov function (5).
    pub barrier: BarrierFile,
    /// The virtual law (10).
    pub virtual_law: VirtualLawFile,
    /// K2, above 0 [N m s/rad].
    pub rate_gain_nm_s_rad: f64,
    /// The disturbance term of (12).
    pub disturbance: DisturbanceTermFile,
    /// The trigger.
    pub trigger: LeiTriggerFile,
    /// Largest torque of each axis, above 0 [N m].
    pub torque_limit_nm: [f64; 3],
    /// Inertia that the law assumes, symmetric positive definite; that of the plant when left out
    /// [kg m^2].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia_kg_m2: Option<[[f64; 3]; 3]>,
    /// Half width of the hysteresis of the sign of the error quaternion's scalar part, in [0, 1); 0, as
    /// published, when left out.
    #[serde(default)]
    pub sign_hysteresis: f64,
}

/// Performance function (3): the width of the funnel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PerformanceFile {
    /// rho_0 of each component, above rho_infinity; the start must be inside.
    pub initial: [f64; 3],
    /// rho_infinity of each component, above 0.
    pub terminal: [f64; 3],
    /// T_s: when the funnel is half way, 0 or above (s).
    pub midpoint_s: f64,
    /// f_s: how fast it shrinks then, above 0 (s).
    pub time_scale_s: f64,
}

/// Barrier Lyapunov function (5).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BarrierFile {
    /// k1, above 0 (J).
    pub gain_j: f64,
    /// F1, above 0.
    pub width: f64,
}

/// Virtual law (10).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VirtualLawFile {
    /// k_m, above 0.
    pub gain: f64,
    /// M_omega, above 0 [rad/s].
    pub rate_scale_rad_s: f64,
    /// gamma, above 0.
    pub slope: f64,
}

/// The disturbance term D_m tanh(z2 / p) of (12).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisturbanceTermFile {
    /// D_m, the bound of the disturbance's norm, 0 or above [N m].
    pub bound_nm: f64,
    /// p, above 0 [rad/s].
    pub smoothing_rad_s: f64,
}

/// When the torque changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LeiTriggerFile {
    /// As published: on for short times only.
    Composite(CompositeTriggerFile),
    /// The same law always on, with a new torque at every sample. Write `{}` after it.
    EverySample(EmptyFile),
}

/// Turn-off (6) and turn-on (8) with the envelope S2 of V2, (70).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CompositeTriggerFile {
    /// s of (6), above 0 [N^2 m^2].
    pub held_error_initial_n2m2: f64,
    /// m of (6), above 0 [N^2 m^2].
    pub held_error_terminal_n2m2: f64,
    /// T_max: longest time on, above 0 (s).
    pub longest_on_s: f64,
    /// S2(0), above S2 at infinity (J).
    pub envelope_initial_j: f64,
    /// S2 at infinity, above 0 (J).
    pub envelope_terminal_j: f64,
    /// beta of (6) and (70), above 0 [1/s].
    pub decay_rate_per_s: f64,
    /// delta_m of (8), above 0 and below (1 - relative_buffer) envelope_terminal_j (J).
    pub buffer_j: f64,
    /// kappa: turn on at (1 - kappa) S2 - delta_m, in [0, 1); 0, as published, when left out. A trigger
    /// that is evaluated at samples needs it.
    #[serde(default)]
    pub relative_buffer: f64,
}
