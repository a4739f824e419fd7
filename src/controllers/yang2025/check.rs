//! Checks of the controller of Yang et al. 2025.

use nalgebra::{Matrix3, Vector3};
use runtime::error::{Element, ParameterError};
use runtime::yang2025::envelope::{Adhesion, EnvelopeParameters, Resilience};
use runtime::yang2025::fault::FaultEstimation;
use runtime::yang2025::law::Gains;
use runtime::yang2025::performance::Performance;
use runtime::yang2025::{Controller, Parameters};
use synth::model::ModelError;

use super::file::{
    AdhesionFile, FaultEstimationFile, ResilienceFile, YangEnvelopeFile, YangFile, YangGainsFile,
    YangPerformanceFile,
};
use crate::base::plant_model::relocated;
use crate::controllers::law::{matrix, LawFile};
use crate::plants::rigid_body::inertia::inertia;
use crate::plants::RigidBodySystem;

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

    fn check(&self, system: &RigidBodySystem) -> Result<YangChoice, ModelError> {
        checked(self, system.body.inertia())
    }

    fn assume_inertia(&mut self, inertia_kg_m2: &[[f64; 3]; 3]) {
        self.nominal_inertia_kg_m2.get_or_insert(*inertia_kg_m2);
    }
}

/// Checks the parameters; the plant's inertia stands in for a nominal one that is left out.
fn checked(file: &YangFile, plant_inertia: &Matrix3<f64>) -> Result<YangChoice, ModelError> {
    let parameters = Parameters {
        inertia: match &file.nominal_inertia_kg_m2 {
            None => *plant_inertia,
            Some(rows) => {
                inertia(rows).map_err(|error| relocated(error, "inertia", "nominal_inertia"))?
            }
        },
        actuator_matrix: file
            .actuator_matrix
            .as_ref()
            .map_or(Matrix3::identity(), matrix),
        torque_limit: Vector3::from(file.torque_limit_nm),
        envelopes: envelopes(&file.envelope)?,
        gains: gains(&file.gains),
        fault_estimation: match &file.fault_estimation {
            FaultEstimationFile::Perfect(_) => FaultEstimation::External,
            FaultEstimationFile::LowPass(filter) => FaultEstimation::LowPass {
                time_constant_s: filter.time_constant_s,
            },
            FaultEstimationFile::Observer(observer) => FaultEstimation::ExtendedState {
                bandwidth_rad_s: observer.bandwidth_rad_s,
            },
        },
    };
    Controller::new(parameters).map_err(|error| located(&error))?;
    Ok(YangChoice {
        parameters,
        told_fault: matches!(file.fault_estimation, FaultEstimationFile::Perfect(_)),
    })
}

fn envelopes(file: &YangEnvelopeFile) -> Result<[EnvelopeParameters; 3], ModelError> {
    let appointed = match &file.performance {
        YangPerformanceFile::AppointedTime(function) => Some(function.appointed_time_s),
        YangPerformanceFile::Exponential(_) => None,
    };
    let spans = match &file.adhesion {
        None => None,
        Some(adhesion) => {
            let spans = adhesion.span_s.or(appointed);
            Some(spans.ok_or_else(|| ModelError::WrongShape {
                field: "envelope.adhesion.span_s".to_string(),
                found: "no value".to_string(),
                expected: "3 times, because an exponential has no appointed time".to_string(),
            })?)
        }
    };
    Ok(std::array::from_fn(|axis| EnvelopeParameters {
        performance: performance(&file.performance, axis),
        shape: file.shape,
        one_sided: file.one_sided,
        adhesion: file
            .adhesion
            .as_ref()
            .zip(spans)
            .map(|(adhesion, spans)| adhesive(adhesion, spans[axis])),
        resilience: file.resilience.as_ref().map(resilience),
    }))
}

fn performance(file: &YangPerformanceFile, axis: usize) -> Performance {
    match file {
        YangPerformanceFile::AppointedTime(function) => Performance::AppointedTime {
            initial_level: function.initial_level,
            final_level: function.final_level,
            appointed_time_s: function.appointed_time_s[axis],
            rate_per_s: function.rate_per_s,
            offset: function.offset,
        },
        YangPerformanceFile::Exponential(function) => Performance::Exponential {
            initial_level: function.initial_level,
            final_level: function.final_level,
            rate_per_s: function.rate_per_s,
        },
    }
}

fn adhesive(file: &AdhesionFile, span_s: f64) -> Adhesion {
    Adhesion {
        width: file.width,
        exponent: file.exponent,
        span_s,
    }
}

fn resilience(file: &ResilienceFile) -> Resilience {
    Resilience {
        fault_gain: file.fault_gain_per_nm_s,
        rate_gain: file.rate_gain,
        decay_per_s: file.decay_per_s,
        decay_size: file.decay_size,
        away_width: file.away_width,
        toward_width: file.toward_width,
    }
}

fn gains(file: &YangGainsFile) -> Gains {
    Gains {
        surface_gain: file.surface_gain_rad_s,
        surface_exponent: file.surface_exponent,
        linear_gain: file.linear_gain_nm_s_rad,
        power_gain: file.power_gain,
        power_exponent: file.power_exponent,
        dead_zone_rad_s: Vector3::from(file.dead_zone_rad_s),
    }
}

/// Where the flight code's parameters are in the file.
const PLACES: [(&str, &str); 27] = [
    ("inertia", "nominal_inertia_kg_m2"),
    ("actuator_matrix", "actuator_matrix"),
    ("torque_limit", "torque_limit_nm"),
    ("initial_level", "envelope.performance: initial_level"),
    ("final_level", "envelope.performance: final_level"),
    ("rate_per_s", "envelope.performance: rate_per_s"),
    (
        "appointed_time_s",
        "envelope.performance.appointed_time.appointed_time_s",
    ),
    ("offset", "envelope.performance.appointed_time.offset"),
    (
        "rate_per_s * appointed_time_s",
        "envelope.performance.appointed_time: rate_per_s * appointed_time_s",
    ),
    ("shape", "envelope.shape"),
    ("width", "envelope.adhesion.width"),
    ("exponent", "envelope.adhesion.exponent"),
    ("span_s", "envelope.adhesion.span_s"),
    ("fault_gain", "envelope.resilience.fault_gain_per_nm_s"),
    ("rate_gain", "envelope.resilience.rate_gain"),
    ("decay_per_s", "envelope.resilience.decay_per_s"),
    ("decay_size", "envelope.resilience.decay_size"),
    ("away_width", "envelope.resilience.away_width"),
    ("toward_width", "envelope.resilience.toward_width"),
    ("surface_gain", "gains.surface_gain_rad_s"),
    ("surface_exponent", "gains.surface_exponent"),
    ("linear_gain", "gains.linear_gain_nm_s_rad"),
    ("power_gain", "gains.power_gain"),
    ("power_exponent", "gains.power_exponent"),
    ("dead_zone_rad_s", "gains.dead_zone_rad_s"),
    (
        "time_constant_s",
        "fault_estimation.low_pass.time_constant_s",
    ),
    (
        "bandwidth_rad_s",
        "fault_estimation.observer.bandwidth_rad_s",
    ),
];

/// The flight code's refusal in terms of the file.
fn located(error: &ParameterError) -> ModelError {
    let place = |field: &runtime::error::Field| {
        let known = PLACES.iter().find(|(name, _)| *name == field.name);
        let place = known.map_or(field.name, |(_, place)| place);
        match field.element {
            Element::Component(index) => format!("{place}[{index}]"),
            Element::Entry { row, column } | Element::RuleEntry { row, column, .. } => {
                format!("{place}[{row}][{column}]")
            }
            Element::Scalar => place.to_string(),
        }
    };
    let out_of_range = |field: String, value: f64, allowed: String| ModelError::OutOfRange {
        field,
        value,
        allowed,
    };
    match error {
        ParameterError::NotFinite { field, value } => {
            out_of_range(place(field), *value, "a finite number".to_string())
        }
        ParameterError::OutOfRange {
            field,
            value,
            allowed,
        } => out_of_range(place(field), *value, format!("in {allowed}")),
        ParameterError::NotPositiveDefinite { field, pivot } => ModelError::NotPositiveDefinite {
            field: place(field),
            smallest: *pivot,
        },
        ParameterError::RankDeficient { determinant, .. } => out_of_range(
            "actuator_matrix".to_string(),
            *determinant,
            "a matrix that reaches every axis; this is its relative determinant".to_string(),
        ),
        other => ModelError::WrongShape {
            field: "yang2025".to_string(),
            found: other.to_string(),
            expected: "parameters that the flight code accepts".to_string(),
        },
    }
}
