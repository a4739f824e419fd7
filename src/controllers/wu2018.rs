//! The controller of Wu, Shen and Cao 2018.

use nalgebra::{Matrix3, Vector3};
use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;
use runtime::error::ParameterError;
use runtime::wu2018;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::{check_positive, ModelError};

use super::law::{matrix, AnyAttitudeController, AttitudeLaw, LawFile, Surroundings};
use crate::base::empty_file::EmptyFile;
use crate::base::ranges::{each, require};
use crate::plants::RigidBodySystem;
use crate::sim::controller::Controller;

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

/// alpha and gamma of (8).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelativeTriggerFile {
    /// alpha, in (0, 1).
    pub relative: f64,
    /// gamma, above 0 [rad/s].
    pub absolute_rad_s: f64,
}

impl LawFile for WuFile {
    type Law = wu2018::Parameters;

    fn check(&self, system: &RigidBodySystem) -> Result<wu2018::Parameters, ModelError> {
        checked(self, largest_inertia(system.body.inertia()))
    }

    fn assume_inertia(&mut self, inertia_kg_m2: &[[f64; 3]; 3]) {
        if let WuGainsFile::SettlingTime(settling) = &mut self.gains {
            let largest = largest_inertia(&matrix(inertia_kg_m2));
            settling.largest_inertia_kg_m2.get_or_insert(largest);
        }
    }
}

fn largest_inertia(inertia: &Matrix3<f64>) -> f64 {
    inertia.symmetric_eigenvalues().max()
}

fn checked(file: &WuFile, plant_inertia: f64) -> Result<wu2018::Parameters, ModelError> {
    each("torque_limit_nm", &file.torque_limit_nm, check_positive)?;
    let trigger = match &file.trigger {
        WuTriggerFile::EverySample(_) => wu2018::TriggerRule::EverySample,
        WuTriggerFile::Relative(rule) => {
            let ok = rule.relative > 0.0 && rule.relative < 1.0;
            require(ok, "trigger.relative.relative", rule.relative, "in (0, 1)")?;
            check_positive("trigger.relative.absolute_rad_s", rule.absolute_rad_s)?;
            wu2018::TriggerRule::Relative {
                relative: rule.relative,
                absolute_rad_s: rule.absolute_rad_s,
            }
        }
    };
    let unwinding = match file.shortest_rotation_hysteresis {
        None => wu2018::Unwinding::AsPublished,
        Some(hysteresis) => {
            let ok = (0.0..1.0).contains(&hysteresis);
            require(ok, "shortest_rotation_hysteresis", hysteresis, "in [0, 1)")?;
            wu2018::Unwinding::ShortestRotation { hysteresis }
        }
    };
    Ok(wu2018::Parameters {
        gains: wu_gains(&file.gains, plant_inertia)?,
        trigger,
        torque_limit: Vector3::from(file.torque_limit_nm),
        unwinding,
    })
}

fn wu_gains(file: &WuGainsFile, plant_inertia: f64) -> Result<wu2018::Gains, ModelError> {
    match file {
        WuGainsFile::Direct(direct) => {
            check_positive(
                "gains.direct.error_gain_nm_s_rad",
                direct.error_gain_nm_s_rad,
            )?;
            check_positive(
                "gains.direct.attitude_weight_rad_s",
                direct.attitude_weight_rad_s,
            )?;
            Ok(wu2018::Gains {
                error_gain: direct.error_gain_nm_s_rad,
                attitude_weight: direct.attitude_weight_rad_s,
            })
        }
        WuGainsFile::SettlingTime(settling) => {
            let field = "gains.settling_time";
            let inertia = settling.largest_inertia_kg_m2.unwrap_or(plant_inertia);
            check_positive(
                &format!("{field}.settling_time_s"),
                settling.settling_time_s,
            )?;
            check_positive(&format!("{field}.damping_ratio"), settling.damping_ratio)?;
            check_positive(&format!("{field}.largest_inertia_kg_m2"), inertia)?;
            let gains = wu2018::Gains::from_settling_time(
                inertia,
                settling.damping_ratio,
                settling.settling_time_s,
            );
            gains.map_err(|_| ModelError::OutOfRange {
                field: field.to_string(),
                value: inertia,
                allowed: "above 0".to_string(),
            })
        }
    }
}

impl AttitudeLaw for wu2018::Parameters {
    fn name(&self) -> String {
        let law = match self.trigger {
            wu2018::TriggerRule::Relative { .. } => "law (6) and trigger (8)",
            wu2018::TriggerRule::EverySample => "law (6) at every sample",
        };
        format!("Wu, Shen and Cao 2018, {law}")
    }

    fn torque_limit(&self) -> Vector3<f64> {
        self.torque_limit
    }

    fn build(&self, _: &Surroundings) -> Result<AnyAttitudeController, ParameterError> {
        Ok(Box::new(wu2018::Controller::new(*self)?))
    }

    fn sends_every_sample(&self) -> bool {
        self.trigger == wu2018::TriggerRule::EverySample
    }
}

impl Controller<AttitudeMeasurement, 3> for wu2018::Controller {
    #[inline]
    fn step(&mut self, time_s: f64, measurement: &AttitudeMeasurement) -> Command<3> {
        self.step(time_s, measurement)
    }

    fn would_send(&self, time_s: f64, measurement: &AttitudeMeasurement) -> bool {
        let mut trial = *self;
        trial.step(time_s, measurement).sent
    }
}
