//! Lei et al. 2022 in the scenario file.

use nalgebra::Vector3;
use runtime::lei2022::{
    Barrier, CompositeTrigger, ControlLaw, DisturbanceCompensation, Parameters,
    PerformanceFunction, TriggerRule, VirtualLaw,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::{check_inertia, ModelError};

use crate::base::bounded::{As, BelowOne, NonNegative, Positive};
use crate::base::ranges::require;
use crate::controllers::law::LawFile;
use crate::plants::RigidBodySystem;
use crate::sim::rigid_body_state::rigid_body_state;

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
    #[serde(with = "As::<Positive>")]
    pub rate_gain_nm_s_rad: f64,
    /// The disturbance term of (12).
    pub disturbance: DisturbanceTermFile,
    /// The trigger.
    pub trigger: LeiTriggerFile,
    /// Largest torque of each axis, above 0 [N m].
    #[serde(with = "As::<[Positive; 3]>")]
    pub torque_limit_nm: [f64; 3],
    /// Inertia that the law assumes, symmetric positive definite; that of the plant when left out
    /// [kg m^2].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia_kg_m2: Option<[[f64; 3]; 3]>,
    /// Half width of the hysteresis of the sign of the error quaternion's scalar part, in [0, 1); 0, as
    /// published, when left out.
    #[serde(default, with = "As::<BelowOne>")]
    pub sign_hysteresis: f64,
}

/// Performance function (3): the width of the funnel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PerformanceFile {
    /// rho_0 of each component, above rho_infinity; the start must be inside.
    #[serde(with = "As::<[Positive; 3]>")]
    pub initial: [f64; 3],
    /// rho_infinity of each component, above 0.
    #[serde(with = "As::<[Positive; 3]>")]
    pub terminal: [f64; 3],
    /// T_s: when the funnel is half way, 0 or above (s).
    #[serde(with = "As::<NonNegative>")]
    pub midpoint_s: f64,
    /// f_s: how fast it shrinks then, above 0 (s).
    #[serde(with = "As::<Positive>")]
    pub time_scale_s: f64,
}

/// Barrier Lyapunov function (5).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BarrierFile {
    /// k1, above 0 (J).
    #[serde(with = "As::<Positive>")]
    pub gain_j: f64,
    /// F1, above 0.
    #[serde(with = "As::<Positive>")]
    pub width: f64,
}

/// Virtual law (10).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VirtualLawFile {
    /// k_m, above 0.
    #[serde(with = "As::<Positive>")]
    pub gain: f64,
    /// M_omega, above 0 [rad/s].
    #[serde(with = "As::<Positive>")]
    pub rate_scale_rad_s: f64,
    /// gamma, above 0.
    #[serde(with = "As::<Positive>")]
    pub slope: f64,
}

/// The disturbance term D_m tanh(z2 / p) of (12).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisturbanceTermFile {
    /// D_m, the bound of the disturbance's norm, 0 or above [N m].
    #[serde(with = "As::<NonNegative>")]
    pub bound_nm: f64,
    /// p, above 0 [rad/s].
    #[serde(with = "As::<Positive>")]
    pub smoothing_rad_s: f64,
}

/// When the torque changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LeiTriggerFile {
    /// As published: on for short times only.
    Composite(CompositeTriggerFile),
    /// The same law always on, with a new torque at every sample. Write `{}` after it.
    EverySample {},
}

/// Turn-off (6) and turn-on (8) with the envelope S2 of V2, (70).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CompositeTriggerFile {
    /// s of (6), above 0 [N^2 m^2].
    #[serde(with = "As::<Positive>")]
    pub held_error_initial_n2m2: f64,
    /// m of (6), above 0 [N^2 m^2].
    #[serde(with = "As::<Positive>")]
    pub held_error_terminal_n2m2: f64,
    /// T_max: longest time on, above 0 (s).
    #[serde(with = "As::<Positive>")]
    pub longest_on_s: f64,
    /// S2(0), above S2 at infinity (J).
    #[serde(with = "As::<Positive>")]
    pub envelope_initial_j: f64,
    /// S2 at infinity, above 0 (J).
    #[serde(with = "As::<Positive>")]
    pub envelope_terminal_j: f64,
    /// beta of (6) and (70), above 0 [1/s].
    #[serde(with = "As::<Positive>")]
    pub decay_rate_per_s: f64,
    /// delta_m of (8), above 0 and below (1 - relative_buffer) envelope_terminal_j (J).
    #[serde(with = "As::<Positive>")]
    pub buffer_j: f64,
    /// kappa: turn on at (1 - kappa) S2 - delta_m, in [0, 1); 0, as published, when left out. A trigger
    /// that is evaluated at samples needs it.
    #[serde(default, with = "As::<BelowOne>")]
    pub relative_buffer: f64,
}

impl LawFile for LeiFile {
    type Law = Parameters;

    /// Checks what relates several numbers, and that the start is inside of the funnel.
    fn check(&self, system: &RigidBodySystem) -> Result<Parameters, ModelError> {
        let performance = self.performance.check()?;
        let law = ControlLaw {
            inertia: match &self.inertia_kg_m2 {
                Some(rows) => check_inertia("inertia_kg_m2", rows)?,
                None => *system.body.inertia(),
            },
            performance,
            barrier: Barrier {
                gain_j: self.barrier.gain_j,
                width: self.barrier.width,
            },
            virtual_law: VirtualLaw {
                gain: self.virtual_law.gain,
                rate_scale_rad_s: self.virtual_law.rate_scale_rad_s,
                slope: self.virtual_law.slope,
            },
            rate_gain: self.rate_gain_nm_s_rad,
            disturbance: DisturbanceCompensation {
                bound_nm: self.disturbance.bound_nm,
                smoothing_rad_s: self.disturbance.smoothing_rad_s,
            },
        };
        let trigger = match &self.trigger {
            LeiTriggerFile::Composite(rule) => {
                let rule = rule.check();
                TriggerRule::Composite(rule.map_err(|error| error.within("trigger.composite"))?)
            }
            LeiTriggerFile::EverySample {} => TriggerRule::EverySample,
        };
        start_inside(&law.performance, system)?;
        Ok(Parameters {
            law,
            trigger,
            torque_limit: Vector3::from(self.torque_limit_nm),
            sign_hysteresis: self.sign_hysteresis,
        })
    }

    fn assume_inertia(&mut self, inertia_kg_m2: &[[f64; 3]; 3]) {
        self.inertia_kg_m2.get_or_insert(*inertia_kg_m2);
    }
}

/// Refuses a value that is not below a bound that is itself a field of the file.
fn below(field: &str, value: f64, (name, limit): (&str, f64)) -> Result<(), ModelError> {
    let allowed = format!("above 0 and below {name} = {limit}");
    require(value < limit, field, value, &allowed)
}

impl PerformanceFile {
    fn check(&self) -> Result<PerformanceFunction, ModelError> {
        for (axis, (&terminal, &initial)) in self.terminal.iter().zip(&self.initial).enumerate() {
            let field = format!("performance.terminal[{axis}]");
            below(&field, terminal, (&format!("initial[{axis}]"), initial))?;
        }
        Ok(PerformanceFunction {
            initial: Vector3::from(self.initial),
            terminal: Vector3::from(self.terminal),
            midpoint_s: self.midpoint_s,
            time_scale_s: self.time_scale_s,
        })
    }
}

impl CompositeTriggerFile {
    fn check(&self) -> Result<CompositeTrigger, ModelError> {
        let (initial, terminal) = (self.envelope_initial_j, self.envelope_terminal_j);
        let bound = ("envelope_initial_j", initial);
        below("envelope_terminal_j", terminal, bound)?;
        let bound = match self.relative_buffer > 0.0 {
            true => "(1 - relative_buffer) envelope_terminal_j",
            false => "envelope_terminal_j",
        };
        let room = (bound, (1.0 - self.relative_buffer) * terminal);
        below("buffer_j", self.buffer_j, room)?;
        Ok(CompositeTrigger {
            held_error_initial: self.held_error_initial_n2m2,
            held_error_terminal: self.held_error_terminal_n2m2,
            longest_on_s: self.longest_on_s,
            envelope_initial_j: initial,
            envelope_terminal_j: terminal,
            decay_rate_per_s: self.decay_rate_per_s,
            buffer_j: self.buffer_j,
            relative_buffer: self.relative_buffer,
        })
    }
}

/// The funnel (4) must hold the error at the start.
fn start_inside(
    performance: &PerformanceFunction,
    system: &RigidBodySystem,
) -> Result<(), ModelError> {
    let state = rigid_body_state(&system.attitude, &system.rate_rad_s);
    let error = system.reference.error(0.0, &state).error.vector;
    let width = performance.value(0.0);
    for axis in 0..3 {
        let (rho, component) = (width[axis], error[axis].abs());
        let allowed = format!(
            "large enough to hold the start: rho is {rho:.6} at 0 s, and component {} of the error \
             quaternion's vector part is {component:.6}",
            axis + 1
        );
        let field = format!("performance.initial[{axis}]");
        let initial = performance.initial[axis];
        require(component < rho, &field, initial, &allowed)?;
    }
    Ok(())
}
