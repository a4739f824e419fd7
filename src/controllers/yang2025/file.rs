//! Yang et al. 2025 in the scenario file.

use nalgebra::Matrix3;
use runtime::error::ParameterError;
use runtime::yang2025::envelope::{Adhesion, EnvelopeParameters, Resilience};
use runtime::yang2025::fault::FaultEstimation;
use runtime::yang2025::law::Gains;
use runtime::yang2025::performance::Performance;
use runtime::yang2025::{Controller, Parameters};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::{check_inertia, ModelError};

use crate::base::bounded::{
    plain, AnyFinite, AnyNonNegative, AnyPositive, AtLeastOne, InsideUnit, OneToTwo,
};
use crate::controllers::law::{matrix, LawFile};
use crate::plants::RigidBodySystem;

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
    pub actuator_matrix: Option<[[AnyFinite; 3]; 3]>,
    /// Largest torque of each actuator, above 0 [N m].
    pub torque_limit_nm: [AnyPositive; 3],
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
    pub shape: AnyPositive,
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
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum YangPerformanceFile {
    /// (8): reaches its final level at the appointed time.
    AppointedTime {
        /// rho_0, above `final_level`.
        initial_level: AnyPositive,
        /// rho_inf, above 0.
        final_level: AnyPositive,
        /// t_f of each component, above 0 (s).
        appointed_time_s: [f64; 3],
        /// k, above 0 [1/s].
        rate_per_s: AnyPositive,
        /// b, in [0.001, 50].
        offset: f64,
    },
    /// The usual exponential: (initial - final) exp(-rate t) + final.
    Exponential {
        /// Level at the start, above `final_level`.
        initial_level: AnyPositive,
        /// Level it tends to, above 0.
        final_level: AnyPositive,
        /// Rate, above 0 [1/s].
        rate_per_s: AnyPositive,
    },
}

/// Parameters of (12).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdhesionFile {
    /// lambda, 1 or above.
    pub width: AtLeastOne,
    /// nu, above 0.
    pub exponent: AnyPositive,
    /// Time after which the terms are zero, above 0; the appointed times when left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span_s: Option<[AnyPositive; 3]>,
}

/// Parameters of (11).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ResilienceFile {
    /// delta_1, above 0 [1/(N m s)].
    pub fault_gain_per_nm_s: AnyPositive,
    /// delta_2, 0 or above.
    pub rate_gain: AnyNonNegative,
    /// delta_3, above 0 [1/s].
    pub decay_per_s: AnyPositive,
    /// delta_4, above 0.
    pub decay_size: AnyPositive,
    /// kappa_1, 0 or above: how far the bound on the side away from the fault moves outwards.
    pub away_width: AnyNonNegative,
    /// kappa_2, 0 or above: how far the bound on the side the fault pushes to moves outwards.
    pub toward_width: AnyNonNegative,
}

/// Gains of the law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct YangGainsFile {
    /// k1, above 0 [rad/s].
    pub surface_gain_rad_s: AnyPositive,
    /// p/q, in (1, 2).
    pub surface_exponent: OneToTwo,
    /// k2, above 0 [N m s/rad].
    pub linear_gain_nm_s_rad: AnyPositive,
    /// k3, above 0 [N m (s/rad)^chi].
    pub power_gain: AnyPositive,
    /// chi, in (0, 1).
    pub power_exponent: InsideUnit,
    /// zeta of each axis, 0 or above [rad/s].
    pub dead_zone_rad_s: [AnyNonNegative; 3],
}

/// Where the estimate of the lumped fault comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FaultEstimationFile {
    /// The simulation tells the controller the true one. Write `{}` after it.
    Perfect {},
    /// A low-pass of the torque that explains the measured change of the rate.
    LowPass {
        /// Time constant, above 0 (s).
        time_constant_s: AnyPositive,
    },
    /// An extended state observer.
    Observer {
        /// Bandwidth, above 0 [rad/s].
        bandwidth_rad_s: AnyPositive,
    },
}

/// The checked controller.
#[derive(Debug, Clone, Copy)]
pub struct YangChoice {
    /// Parameters that the flight code accepts.
    pub parameters: Parameters<3>,
    /// Whether the simulation gives it the true fault.
    pub told_fault: bool,
}

impl LawFile for YangFile {
    type Law = YangChoice;

    /// The flight code checks what relates several numbers; the plant's inertia stands in for a nominal one
    /// that is left out.
    fn check(&self, system: &RigidBodySystem) -> Result<YangChoice, ModelError> {
        let gains = &self.gains;
        let parameters = Parameters {
            inertia: match &self.nominal_inertia_kg_m2 {
                None => *system.body.inertia(),
                Some(rows) => check_inertia("nominal_inertia_kg_m2", rows)?,
            },
            actuator_matrix: match &self.actuator_matrix {
                None => Matrix3::identity(),
                Some(rows) => matrix(&rows.map(|row| plain(&row))),
            },
            torque_limit: plain(&self.torque_limit_nm).into(),
            envelopes: self.envelope.parameters()?,
            gains: Gains {
                surface_gain: gains.surface_gain_rad_s.get(),
                surface_exponent: gains.surface_exponent.get(),
                linear_gain: gains.linear_gain_nm_s_rad.get(),
                power_gain: gains.power_gain.get(),
                power_exponent: gains.power_exponent.get(),
                dead_zone_rad_s: plain(&gains.dead_zone_rad_s).into(),
            },
            fault_estimation: match &self.fault_estimation {
                FaultEstimationFile::Perfect {} => FaultEstimation::External,
                FaultEstimationFile::LowPass { time_constant_s } => FaultEstimation::LowPass {
                    time_constant_s: time_constant_s.get(),
                },
                FaultEstimationFile::Observer { bandwidth_rad_s } => {
                    FaultEstimation::ExtendedState {
                        bandwidth_rad_s: bandwidth_rad_s.get(),
                    }
                }
            },
        };
        Controller::new(parameters).map_err(located)?;
        Ok(YangChoice {
            parameters,
            told_fault: matches!(self.fault_estimation, FaultEstimationFile::Perfect {}),
        })
    }

    fn assume_inertia(&mut self, inertia_kg_m2: &[[f64; 3]; 3]) {
        self.nominal_inertia_kg_m2.get_or_insert(*inertia_kg_m2);
    }
}

impl YangEnvelopeFile {
    /// The envelope of each component.
    fn parameters(&self) -> Result<[EnvelopeParameters; 3], ModelError> {
        let appointed = match &self.performance {
            YangPerformanceFile::AppointedTime {
                appointed_time_s, ..
            } => Some(*appointed_time_s),
            YangPerformanceFile::Exponential { .. } => None,
        };
        let given = self.adhesion.as_ref().and_then(|adhesion| adhesion.span_s);
        let spans = given.map(|spans| plain(&spans)).or(appointed);
        if self.adhesion.is_some() && spans.is_none() {
            let expected = "3 times, because an exponential has no appointed time";
            return Err(ModelError::shape(
                "envelope.adhesion.span_s",
                "no value",
                expected,
            ));
        }
        let adhesion = self.adhesion.as_ref().zip(spans);
        let resilience = self.resilience.as_ref();
        Ok(std::array::from_fn(|axis| EnvelopeParameters {
            performance: self.performance.of_axis(axis),
            shape: self.shape.get(),
            one_sided: self.one_sided,
            adhesion: adhesion.map(|(file, spans)| Adhesion {
                width: file.width.get(),
                exponent: file.exponent.get(),
                span_s: spans[axis],
            }),
            resilience: resilience.map(|file| Resilience {
                fault_gain: file.fault_gain_per_nm_s.get(),
                rate_gain: file.rate_gain.get(),
                decay_per_s: file.decay_per_s.get(),
                decay_size: file.decay_size.get(),
                away_width: file.away_width.get(),
                toward_width: file.toward_width.get(),
            }),
        }))
    }
}

impl YangPerformanceFile {
    fn of_axis(&self, axis: usize) -> Performance {
        match *self {
            YangPerformanceFile::AppointedTime {
                initial_level,
                final_level,
                appointed_time_s,
                rate_per_s,
                offset,
            } => Performance::AppointedTime {
                initial_level: initial_level.get(),
                final_level: final_level.get(),
                appointed_time_s: appointed_time_s[axis],
                rate_per_s: rate_per_s.get(),
                offset,
            },
            YangPerformanceFile::Exponential {
                initial_level,
                final_level,
                rate_per_s,
            } => Performance::Exponential {
                initial_level: initial_level.get(),
                final_level: final_level.get(),
                rate_per_s: rate_per_s.get(),
            },
        }
    }
}

/// The flight code's refusal in terms of the file: the ranges of single numbers are checked when they are
/// read, so that it is about the performance function or the actuator matrix.
fn located(error: ParameterError) -> ModelError {
    match error {
        ParameterError::OutOfRange {
            field,
            value,
            allowed,
        } => {
            let function = match field.name {
                "initial_level" => "envelope.performance: ",
                _ => "envelope.performance.appointed_time.",
            };
            ModelError::OutOfRange {
                field: format!("{function}{}", field.name),
                value,
                allowed: format!("in {allowed}"),
            }
        }
        ParameterError::RankDeficient { determinant, .. } => ModelError::OutOfRange {
            field: "actuator_matrix".to_string(),
            value: determinant,
            allowed: "a matrix that reaches every axis; this is its relative determinant"
                .to_string(),
        },
        other => {
            let expected = "parameters that the flight code accepts";
            ModelError::shape("yang2025", other.to_string(), expected)
        }
    }
}
