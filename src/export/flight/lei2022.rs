//! Lei et al. 2022, (12) with (6) and (8), of a scenario file.

use runtime::lei2022::{CompositeTrigger, Parameters};

use super::law_text::{list, number, rows, vector, LawText};
use super::source::{Constant, Sending, ATTITUDE, CLOSING, COMMON, STEP, VECTORS};

const FIELDS: &str = "    double command[@NAME@_INPUTS];
    double time_s;
    double start_s;
    double on_since_s;
    uint8_t has_time;
    uint8_t has_side;
    uint8_t is_positive;
    uint8_t is_on;";

const LAW: &str = include_str!("templates/lei2022.c");

/// Functions of the C library that it calls.
const LIBRARY: [&str; 4] = ["tanh", "cosh", "exp", "log1p"];

/// How much shorter than its limit an interval may be that counts as the longest, relative: the rounding of times.
const TIME_ROUNDING: f64 = 1e-9;

/// What is its own of this controller's C text.
pub fn text(parameters: &Parameters) -> LawText {
    let trigger = parameters.trigger.composite();
    let mut constants = of_law(parameters);
    constants.extend(of_trigger(trigger));
    let hysteresis = parameters.sign_hysteresis;
    constants.push(number("HYSTERESIS", "1", "half width", hysteresis));
    LawText {
        fields: FIELDS,
        further: [""; 2],
        constants,
        counts: vec![("EVERY_SAMPLE", usize::from(trigger.is_none()))],
        parts: vec![COMMON, ATTITUDE, VECTORS, LAW, STEP, CLOSING],
        sending: Sending::AtSwitches,
        library: LIBRARY.to_vec(),
        words: 16,
        given_fault: false,
        in_matlab: None,
    }
}

fn of_law(parameters: &Parameters) -> Vec<Constant> {
    let law = &parameters.law;
    let (funnel, rejection) = (&law.performance, &law.disturbance);
    vec![
        vector(
            "LIMITS",
            "N m",
            "saturation of each axis",
            &parameters.torque_limit,
        ),
        list("INERTIA", "kg m^2", "inertia", &rows(&law.inertia)),
        vector(
            "FUNNEL_INITIAL",
            "1",
            "half width at the start",
            &funnel.initial,
        ),
        vector(
            "FUNNEL_TERMINAL",
            "1",
            "half width in the end",
            &funnel.terminal,
        ),
        number("MIDPOINT_S", "s", "midpoint of (3)", funnel.midpoint_s),
        number(
            "TIME_SCALE_S",
            "s",
            "time scale of (3)",
            funnel.time_scale_s,
        ),
        number("SLOPE", "1", "slope of (10)", law.virtual_law.slope),
        number(
            "STRENGTH_RAD_S",
            "rad/s",
            "gain times rate scale of (10)",
            law.virtual_law.strength(),
        ),
        number("BARRIER_GAIN_J", "J", "gain of (5)", law.barrier.gain_j),
        number("BARRIER_WIDTH", "1", "width of (5)", law.barrier.width),
        number("LN_2", "1", "ln 2", std::f64::consts::LN_2),
        number(
            "RATE_GAIN",
            "N m s/rad",
            "gain on the error of the rate",
            law.rate_gain,
        ),
        number(
            "DISTURBANCE_NM",
            "N m",
            "bound of the disturbance",
            rejection.bound_nm,
        ),
        number(
            "SMOOTHING_RAD_S",
            "rad/s",
            "smoothing of its rejection",
            rejection.smoothing_rad_s,
        ),
    ]
}

fn of_trigger(trigger: Option<&CompositeTrigger>) -> Vec<Constant> {
    let value = |of: fn(&CompositeTrigger) -> f64| trigger.map_or(0.0, of);
    let longest = value(|own| own.longest_on_s * (1.0 - TIME_ROUNDING));
    vec![
        number(
            "HELD_ERROR_INITIAL",
            "(N m)^2",
            "of (6)",
            value(|own| own.held_error_initial),
        ),
        number(
            "HELD_ERROR_TERMINAL",
            "(N m)^2",
            "of (6)",
            value(|own| own.held_error_terminal),
        ),
        number(
            "LONGEST_ON_S",
            "s",
            "longest time on, less the rounding of times",
            longest,
        ),
        number(
            "ENVELOPE_INITIAL_J",
            "J",
            "of (8)",
            value(|own| own.envelope_initial_j),
        ),
        number(
            "ENVELOPE_TERMINAL_J",
            "J",
            "of (8)",
            value(|own| own.envelope_terminal_j),
        ),
        number(
            "DECAY_PER_S",
            "1/s",
            "of (6) and (8)",
            value(|own| own.decay_rate_per_s),
        ),
        number(
            "BUFFER_J",
            "J",
            "absolute buffer",
            value(|own| own.buffer_j),
        ),
        number(
            "RELATIVE_BUFFER",
            "1",
            "relative buffer",
            value(|own| own.relative_buffer),
        ),
    ]
}
