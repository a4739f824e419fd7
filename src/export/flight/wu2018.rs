//! Wu, Shen and Cao 2018, (6) and (8), of a scenario file.

use runtime::wu2018::{Parameters, TriggerRule, Unwinding};

use super::law_text::{number, vector, LawText};
use super::source::{Constant, Sending, ATTITUDE, CLOSING, COMMON, STEP};

const FIELDS: &str = "    double command[@NAME@_INPUTS];
    double sent[@NAME@_INPUTS];
    double time_s;
    uint8_t has_time;
    uint8_t has_sent;
    uint8_t has_side;
    uint8_t is_positive;";

const LAW: &str = include_str!("templates/wu2018.c");

/// What is its own of this controller's C text.
pub fn text(parameters: &Parameters) -> LawText {
    let gains = &parameters.gains;
    let (relative, absolute, every) = match parameters.trigger {
        TriggerRule::Relative {
            relative,
            absolute_rad_s,
        } => (relative, absolute_rad_s, 0),
        TriggerRule::EverySample => (0.0, 0.0, 1),
    };
    let (hysteresis, shortest) = match parameters.unwinding {
        Unwinding::AsPublished => (0.0, 0),
        Unwinding::ShortestRotation { hysteresis } => (hysteresis, 1),
    };
    let constants: Vec<Constant> = vec![
        vector(
            "LIMITS",
            "N m",
            "saturation of each axis",
            &parameters.torque_limit,
        ),
        number("ERROR_GAIN", "N m s/rad", "k", gains.error_gain),
        number("ATTITUDE_WEIGHT", "rad/s", "beta", gains.attitude_weight),
        number("RELATIVE", "1", "alpha", relative),
        number("ABSOLUTE_RAD_S", "rad/s", "gamma", absolute),
        number("HYSTERESIS", "1", "half width", hysteresis),
    ];
    LawText {
        fields: FIELDS,
        further: [""; 2],
        constants,
        counts: vec![("EVERY_SAMPLE", every), ("SHORTEST", shortest)],
        parts: vec![COMMON, ATTITUDE, LAW, STEP, CLOSING],
        sending: Sending::AtTriggers,
        library: Vec::new(),
        words: 16,
        given_fault: false,
        in_matlab: Some(include_str!("templates/reference_wu2018.m")),
    }
}
