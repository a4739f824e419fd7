//! The constants of the laws that scenarios name.

use runtime::yang2025::envelope::{Adhesion, EnvelopeParameters, Resilience};
use runtime::yang2025::fault::FaultEstimation;
use runtime::yang2025::performance::Performance;
use runtime::{lei2022, wu2018};

use super::constants::{flag, flags, number, numbers, of_matrix, Constant};
use crate::controllers::registry::ControllerChoice;
use crate::controllers::yang2025::YangChoice;

const WU: &str = include_str!("templates/wu2018.py");
const LEI: &str = include_str!("templates/lei2022.py");
const YANG: &str = include_str!("templates/yang2025.py");

/// The constants and the text of a controller; `None` where it has none.
pub fn of(controller: &ControllerChoice) -> Option<(Vec<Constant>, &'static str)> {
    match controller {
        ControllerChoice::Wu(parameters) => Some((wu(parameters), WU)),
        ControllerChoice::Lei(parameters) => Some((lei(parameters), LEI)),
        ControllerChoice::Yang(choice) => Some((yang(choice), YANG)),
        _ => None,
    }
}

fn wu(parameters: &wu2018::Parameters) -> Vec<Constant> {
    let (relative, absolute, every) = match parameters.trigger {
        wu2018::TriggerRule::Relative {
            relative,
            absolute_rad_s,
        } => (relative, absolute_rad_s, false),
        wu2018::TriggerRule::EverySample => (0.0, 0.0, true),
    };
    let hysteresis = match parameters.unwinding {
        wu2018::Unwinding::AsPublished => None,
        wu2018::Unwinding::ShortestRotation { hysteresis } => Some(hysteresis),
    };
    vec![
        number("LONGEST_INTERVAL_S", f64::INFINITY),
        numbers("TORQUE_LIMIT_NM", parameters.torque_limit.as_slice()),
        number("ERROR_GAIN_NM_S", parameters.gains.error_gain),
        number("ATTITUDE_WEIGHT_RAD_S", parameters.gains.attitude_weight),
        flag("EVERY_SAMPLE", every),
        number("TRIGGER_RELATIVE", relative),
        number("TRIGGER_ABSOLUTE_RAD_S", absolute),
        flag("SHORTEST_ROTATION", hysteresis.is_some()),
        number("SIGN_HYSTERESIS", hysteresis.unwrap_or(0.0)),
    ]
}

fn lei(parameters: &lei2022::Parameters) -> Vec<Constant> {
    let law = &parameters.law;
    let trigger = parameters.trigger.composite();
    let of = |value: fn(&lei2022::CompositeTrigger) -> f64| trigger.map_or(0.0, value);
    vec![
        number("LONGEST_INTERVAL_S", f64::INFINITY),
        numbers("TORQUE_LIMIT_NM", parameters.torque_limit.as_slice()),
        of_matrix("INERTIA_KG_M2", &law.inertia),
        numbers("WIDTH_INITIAL", law.performance.initial.as_slice()),
        numbers("WIDTH_TERMINAL", law.performance.terminal.as_slice()),
        number("MIDPOINT_S", law.performance.midpoint_s),
        number("TIME_SCALE_S", law.performance.time_scale_s),
        number("BARRIER_GAIN_J", law.barrier.gain_j),
        number("BARRIER_WIDTH", law.barrier.width),
        number("VIRTUAL_GAIN", law.virtual_law.gain),
        number("RATE_SCALE_RAD_S", law.virtual_law.rate_scale_rad_s),
        number("VIRTUAL_SLOPE", law.virtual_law.slope),
        number("RATE_GAIN_NM_S", law.rate_gain),
        number("DISTURBANCE_BOUND_NM", law.disturbance.bound_nm),
        number("SMOOTHING_RAD_S", law.disturbance.smoothing_rad_s),
        flag("EVERY_SAMPLE", trigger.is_none()),
        number("HELD_ERROR_INITIAL", of(|own| own.held_error_initial)),
        number("HELD_ERROR_TERMINAL", of(|own| own.held_error_terminal)),
        number("LONGEST_ON_S", of(|own| own.longest_on_s)),
        number("ENVELOPE_INITIAL_J", of(|own| own.envelope_initial_j)),
        number("ENVELOPE_TERMINAL_J", of(|own| own.envelope_terminal_j)),
        number("DECAY_RATE_PER_S", of(|own| own.decay_rate_per_s)),
        number("BUFFER_J", of(|own| own.buffer_j)),
        number("RELATIVE_BUFFER", of(|own| own.relative_buffer)),
        number("SIGN_HYSTERESIS", parameters.sign_hysteresis),
    ]
}

fn yang(choice: &YangChoice) -> Vec<Constant> {
    let parameters = &choice.parameters;
    let gains = &parameters.gains;
    let (time_constant, bandwidth) = match parameters.fault_estimation {
        FaultEstimation::External => (0.0, 0.0),
        FaultEstimation::LowPass { time_constant_s } => (time_constant_s, 0.0),
        FaultEstimation::ExtendedState { bandwidth_rad_s } => (0.0, bandwidth_rad_s),
    };
    let mut out = vec![
        number("LONGEST_INTERVAL_S", f64::INFINITY),
        numbers("TORQUE_LIMIT_NM", parameters.torque_limit.as_slice()),
        of_matrix("NOMINAL_INERTIA_KG_M2", &parameters.inertia),
        of_matrix("ACTUATOR_MATRIX", &parameters.actuator_matrix),
        number("SURFACE_GAIN_RAD_S", gains.surface_gain),
        number("SURFACE_EXPONENT", gains.surface_exponent),
        number("LINEAR_GAIN", gains.linear_gain),
        number("POWER_GAIN", gains.power_gain),
        number("POWER_EXPONENT", gains.power_exponent),
        numbers("DEAD_ZONE_RAD_S", gains.dead_zone_rad_s.as_slice()),
        number("FAULT_TIME_CONSTANT_S", time_constant),
        number("FAULT_BANDWIDTH_RAD_S", bandwidth),
    ];
    out.extend(envelopes(&parameters.envelopes));
    out
}

/// The levels of an axis: the first, the last, the rate, and what only an appointed time has.
fn levels(envelope: &EnvelopeParameters) -> [f64; 5] {
    match envelope.performance {
        Performance::AppointedTime {
            initial_level,
            final_level,
            appointed_time_s,
            rate_per_s,
            offset,
        } => [
            initial_level,
            final_level,
            rate_per_s,
            appointed_time_s,
            offset,
        ],
        Performance::Exponential {
            initial_level,
            final_level,
            rate_per_s,
        } => [initial_level, final_level, rate_per_s, 1.0, 1.0],
    }
}

fn envelopes(envelopes: &[EnvelopeParameters; 3]) -> Vec<Constant> {
    let [first, ..] = envelopes;
    let each = |name, of: &dyn Fn(&EnvelopeParameters) -> f64| {
        numbers(name, &envelopes.each_ref().map(of))
    };
    let adhesion =
        |name, of: fn(&Adhesion) -> f64| each(name, &|own| own.adhesion.as_ref().map_or(1.0, of));
    let resilience = |name, of: fn(&Resilience) -> f64| {
        each(name, &|own| own.resilience.as_ref().map_or(1.0, of))
    };
    let appointed = matches!(first.performance, Performance::AppointedTime { .. });
    vec![
        each("SHAPE", &|own| own.shape),
        flags("ONE_SIDED", first.one_sided),
        flags("APPOINTED", appointed),
        each("LEVEL_INITIAL", &|own| levels(own)[0]),
        each("LEVEL_FINAL", &|own| levels(own)[1]),
        each("RATE_PER_S", &|own| levels(own)[2]),
        each("APPOINTED_TIME_S", &|own| levels(own)[3]),
        each("OFFSET", &|own| levels(own)[4]),
        flags("ADHESION", first.adhesion.is_some()),
        adhesion("ADHESION_WIDTH", |own| own.width),
        adhesion("ADHESION_EXPONENT", |own| own.exponent),
        adhesion("ADHESION_SPAN_S", |own| own.span_s),
        flags("RESILIENCE", first.resilience.is_some()),
        resilience("FAULT_GAIN", |own| own.fault_gain),
        resilience("RATE_GAIN", |own| own.rate_gain),
        resilience("DECAY_PER_S", |own| own.decay_per_s),
        resilience("DECAY_SIZE", |own| own.decay_size),
        resilience("AWAY_WIDTH", |own| own.away_width),
        resilience("TOWARD_WIDTH", |own| own.toward_width),
    ]
}
