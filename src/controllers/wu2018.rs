//! The controller of Wu, Shen and Cao 2018.

use nalgebra::{Matrix3, Vector3};
use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;
use runtime::error::ParameterError;
use runtime::wu2018;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use super::law::{matrix, AttitudeLaw, LawFile, Surroundings};
use crate::base::bounded::{plain, BelowOne, InsideUnit, Positive};
use crate::plants::RigidBodySystem;
use crate::sim::controller::{Controller, Use};

/// Law (6) and trigger (8) of Wu, Shen and Cao 2018.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WuFile {
    /// The gains.
    pub gains: WuGainsFile,
    /// The trigger.
    pub trigger: WuTriggerFile,
    /// Largest torque of each axis, above 0 [N m].
    pub torque_limit_nm: [Positive; 3],
    /// With this key the law takes the shorter way round: half width of the hysteresis of the scalar
    /// part's sign, in [0, 1). As published when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortest_rotation_hysteresis: Option<BelowOne>,
}

/// Gains of the law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum WuGainsFile {
    /// By (39), from a settling time.
    SettlingTime {
        /// Settling time, above 0 (s).
        settling_time_s: Positive,
        /// Damping ratio, above 0.
        damping_ratio: Positive,
        /// Largest principal moment of inertia, above 0; that of the plant when left out [kg m^2].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        largest_inertia_kg_m2: Option<Positive>,
    },
    /// k and beta.
    Direct {
        /// k, above 0 [N m s/rad].
        error_gain_nm_s_rad: Positive,
        /// beta, above 0 [rad/s].
        attitude_weight_rad_s: Positive,
    },
}

/// When the filtered error is sent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum WuTriggerFile {
    /// The paper's (8).
    Relative {
        /// alpha, in (0, 1).
        relative: InsideUnit,
        /// gamma, above 0 [rad/s].
        absolute_rad_s: Positive,
    },
    /// At every sample: the time-triggered loop. Write `{}` after it.
    EverySample {},
}

impl LawFile for WuFile {
    type Law = wu2018::Parameters;

    fn check(&self, system: &RigidBodySystem) -> Result<wu2018::Parameters, ModelError> {
        Ok(wu2018::Parameters {
            gains: self.gains.check(system.body.inertia())?,
            trigger: match &self.trigger {
                WuTriggerFile::EverySample {} => wu2018::TriggerRule::EverySample,
                WuTriggerFile::Relative {
                    relative,
                    absolute_rad_s,
                } => wu2018::TriggerRule::Relative {
                    relative: relative.get(),
                    absolute_rad_s: absolute_rad_s.get(),
                },
            },
            torque_limit: plain(&self.torque_limit_nm).into(),
            unwinding: match self.shortest_rotation_hysteresis {
                None => wu2018::Unwinding::AsPublished,
                Some(half_width) => wu2018::Unwinding::ShortestRotation {
                    hysteresis: half_width.get(),
                },
            },
        })
    }

    fn assume_inertia(&mut self, inertia_kg_m2: &[[f64; 3]; 3]) {
        if let WuGainsFile::SettlingTime {
            largest_inertia_kg_m2: largest,
            ..
        } = &mut self.gains
        {
            let of_plant = matrix(inertia_kg_m2).symmetric_eigenvalues().max();
            // An inertia that is not positive definite is refused with the plant.
            *largest = largest.or(Positive::try_from(of_plant).ok());
        }
    }
}

impl WuGainsFile {
    fn check(&self, plant: &Matrix3<f64>) -> Result<wu2018::Gains, ModelError> {
        match *self {
            WuGainsFile::Direct {
                error_gain_nm_s_rad,
                attitude_weight_rad_s,
            } => Ok(wu2018::Gains {
                error_gain: error_gain_nm_s_rad.get(),
                attitude_weight: attitude_weight_rad_s.get(),
            }),
            WuGainsFile::SettlingTime {
                settling_time_s,
                damping_ratio,
                largest_inertia_kg_m2,
            } => {
                let given = largest_inertia_kg_m2.map(Positive::get);
                let inertia = given.unwrap_or_else(|| plant.symmetric_eigenvalues().max());
                let (damping, time_s) = (damping_ratio.get(), settling_time_s.get());
                let gains = wu2018::Gains::from_settling_time(inertia, damping, time_s);
                gains.map_err(|_| ModelError::OutOfRange {
                    field: "gains.settling_time".to_string(),
                    value: inertia,
                    allowed: "above 0".to_string(),
                })
            }
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

    fn build<U: Use<AttitudeMeasurement, 3>>(
        &self,
        _: &Surroundings,
        then: U,
    ) -> Result<U::Output, ParameterError> {
        Ok(then.with(wu2018::Controller::new(*self)?))
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
