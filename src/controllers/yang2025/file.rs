//! The controller of Yang et al. 2025, as written in a scenario file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::base::empty_file::EmptyFile;

/// Law (20) inside of the envelope (10)-(12) of Yang et al. 2025.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct YangFile {
    /// Nominal inertia J0; that of the plant when left out [kg m^2].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nominal_inertia_kg_m2: Option<[[f64; 3]; 3]>,
    /// Nominal actuator matrix D0: torque about each body axis (rows) per unit torque of each actuator
    /// (columns); the identity when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actuator_matrix: Option<[[f64; 3]; 3]>,
    /// Largest torque of each actuator, above 0 [N m].
    pub torque_limit_nm: [f64; 3],
    /// The envelope of each component of the error quaternion's vector part.
    pub envelope: YangEnvelopeFile,
    /// Gains of the law.
    pub gains: YangGainsFile,
    /// Where the estimate of the lumped fault comes from.
    pub fault_estimation: FaultEstimationFile,
}

/// The envelope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct YangEnvelopeFile {
    /// The performance function rho(t).
    pub performance: YangPerformanceFile,
    /// a in (10), above 0.
    pub shape: f64,
    /// True for (10), wide on the side of the initial error and narrow on the other; false for bounds
    /// of -a rho and a rho.
    #[serde(default = "yes")]
    pub one_sided: bool,
    /// The adhesive terms (12): the envelope starts around the initial error. None when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adhesion: Option<AdhesionFile>,
    /// The resilient correction (11): the envelope widens under faults beyond the torque limit. None
    /// when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resilience: Option<ResilienceFile>,
}

fn yes() -> bool {
    true
}

/// A performance function.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum YangPerformanceFile {
    /// (8): reaches its final level at the appointed time.
    AppointedTime(AppointedTimeFile),
    /// The usual exponential.
    Exponential(ExponentialFile),
}

/// Parameters of (8).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AppointedTimeFile {
    /// rho_0, above `final_level`.
    pub initial_level: f64,
    /// rho_inf, above 0.
    pub final_level: f64,
    /// t_f of each component, above 0 (s).
    pub appointed_time_s: [f64; 3],
    /// k, above 0 [1/s].
    pub rate_per_s: f64,
    /// b, in [0.001, 50].
    pub offset: f64,
}

/// (initial - final) exp(-rate t) + final.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExponentialFile {
    /// Level at the start, above `final_level`.
    pub initial_level: f64,
    /// Level it tends to, above 0.
    pub final_level: f64,
    /// Rate, above 0 [1/s].
    pub rate_per_s: f64,
}

/// Parameters of (12).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdhesionFile {
    /// lambda, 1 or above.
    pub width: f64,
    /// nu, above 0.
    pub exponent: f64,
    /// Time after which the terms are zero, above 0; the appointed times when left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span_s: Option<[f64; 3]>,
}

/// Parameters of (11).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ResilienceFile {
    /// delta_1, above 0 [1/(N m s)].
    pub fault_gain_per_nm_s: f64,
    /// delta_2, 0 or above.
    pub rate_gain: f64,
    /// delta_3, above 0 [1/s].
    pub decay_per_s: f64,
    /// delta_4, above 0.
    pub decay_size: f64,
    /// kappa_1, 0 or above: how far the bound on the side away from the fault moves outwards.
    pub away_width: f64,
    /// kappa_2, 0 or above: how far the bound on the side the fault pushes to moves outwards.
    pub toward_width: f64,
}

/// Gains of the law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct YangGainsFile {
    /// k1, above 0 [rad/s].
    pub surface_gain_rad_s: f64,
    /// p/q, in (1, 2).
    pub surface_exponent: f64,
    /// k2, above 0 [N m s/rad].
    pub linear_gain_nm_s_rad: f64,
    /// k3, above 0 [N m (s/rad)^chi].
    pub power_gain: f64,
    /// chi, in (0, 1).
    pub power_exponent: f64,
    /// zeta of each axis, 0 or above [rad/s].
    pub dead_zone_rad_s: [f64; 3],
}

/// Where the estimate of the lumped fault comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FaultEstimationFile {
    /// The simulation tells the controller the true one. Write `{}` after it.
    Perfect(EmptyFile),
    /// A low-pass of the torque that explains the measured change of the rate.
    LowPass(LowPassFile),
    /// An extended state observer.
    Observer(ObserverFile),
}

/// A low-pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LowPassFile {
    /// Time constant, above 0 (s).
    pub time_constant_s: f64,
}

/// An extended state observer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObserverFile {
    /// Bandwidth, above 0 [rad/s].
    pub bandwidth_rad_s: f64,
}
