//! Yang et al. 2025, (20) inside of (10) to (12), of a scenario file.

use runtime::error::ParameterError;
use runtime::yang2025::allocation::Allocation;
use runtime::yang2025::envelope::{Adhesion, EnvelopeParameters, Resilience};
use runtime::yang2025::fault::FaultEstimation;
use runtime::yang2025::performance::{Performance, PerformanceFunction};

use super::law_text::{list, number, rows, vector, LawText};
use super::source::{Constant, Sending, ATTITUDE, CLOSING, COMMON, STEP, VECTORS};
use crate::controllers::yang2025::YangChoice;

const FIELDS: &str = "    double command[@NAME@_INPUTS];
    double initial[3];
    double attitude[4];
    @name@_correction correction[3];
    double fault[3];
    double last_rate[3];
    double momentum[3];
    double start_s;
    double time_s;
    uint8_t has_time;";

const TYPES: &str = "/* The correction (11) of the envelope of an axis. */
typedef struct {
    double value;
    double slope;
    double drive;
} @name@_correction;

";

const FUNCTIONS: &str = "/* Sets the lumped fault (N m): what acts beyond what the nominal model explains. For a controller that does not estimate it;
 * 0 until it is set. A number that is not finite changes nothing. */
void @name@_set_fault(@name@_controller *self, const double fault_nm[3]);

";

const LAW: &str = include_str!("templates/yang2025.c");

/// Functions of the C library that it calls.
const LIBRARY: [&str; 9] = [
    "pow", "tanh", "sinh", "exp", "expm1", "log", "sin", "cos", "fabs",
];

/// What is its own of this controller's C text.
///
/// # Errors
/// Numbers that the flight code refuses.
pub fn text(choice: &YangChoice) -> Result<LawText, ParameterError> {
    let parameters = &choice.parameters;
    let (kind, time_constant, bandwidth) = match parameters.fault_estimation {
        FaultEstimation::External => (0, 1.0, 0.0),
        FaultEstimation::LowPass { time_constant_s } => (1, time_constant_s, 0.0),
        FaultEstimation::ExtendedState { bandwidth_rad_s } => (2, 1.0, bandwidth_rad_s),
    };
    let mut constants = of_law(choice)?;
    constants.extend([
        number("TIME_CONSTANT_S", "s", "of the low-pass", time_constant),
        number("BANDWIDTH_RAD_S", "rad/s", "of the observer", bandwidth),
    ]);
    let [first, ..] = &parameters.envelopes;
    constants.extend(of_performance(&parameters.envelopes)?);
    constants.extend(of_corrections(&parameters.envelopes));
    let flag = usize::from;
    let appointed = matches!(first.performance, Performance::AppointedTime { .. });
    Ok(LawText {
        fields: FIELDS,
        further: [TYPES, FUNCTIONS],
        constants,
        counts: vec![
            ("ESTIMATION", kind),
            ("APPOINTED", flag(appointed)),
            ("ONE_SIDED", flag(first.one_sided)),
            ("ADHESIVE", flag(first.adhesion.is_some())),
            ("RESILIENT", flag(first.resilience.is_some())),
        ],
        parts: vec![COMMON, ATTITUDE, VECTORS, LAW, STEP, CLOSING],
        sending: Sending::AtEverySample,
        library: LIBRARY.to_vec(),
        words: 48,
        given_fault: kind == 0,
        in_matlab: None,
    })
}

fn of_law(choice: &YangChoice) -> Result<Vec<Constant>, ParameterError> {
    let parameters = &choice.parameters;
    let gains = &parameters.gains;
    let actuators = Allocation::new(parameters.actuator_matrix, parameters.torque_limit)?;
    Ok(vec![
        vector(
            "LIMITS",
            "N m",
            "saturation of each actuator",
            &parameters.torque_limit,
        ),
        list(
            "INERTIA",
            "kg m^2",
            "nominal inertia",
            &rows(&parameters.inertia),
        ),
        list(
            "ACTUATORS",
            "1",
            "nominal actuator matrix",
            &rows(&parameters.actuator_matrix),
        ),
        list(
            "ALLOCATION",
            "1",
            "from a torque to the actuators",
            &rows(actuators.inverse()),
        ),
        vector(
            "AUTHORITY",
            "N m",
            "torque about each axis",
            &actuators.authority(),
        ),
        number("SURFACE_GAIN", "rad/s", "k1", gains.surface_gain),
        number("SURFACE_EXPONENT", "1", "p/q", gains.surface_exponent),
        number("LINEAR_GAIN", "N m s/rad", "k2", gains.linear_gain),
        number("POWER_GAIN", "N m (s/rad)^chi", "k3", gains.power_gain),
        number("POWER_EXPONENT", "1", "chi", gains.power_exponent),
        vector("DEAD_ZONE_RAD_S", "rad/s", "zeta", &gains.dead_zone_rad_s),
    ])
}

fn of_performance(envelopes: &[EnvelopeParameters; 3]) -> Result<Vec<Constant>, ParameterError> {
    let mut appointed = [1.0; 3];
    let mut coefficients = vec![vec![0.0; 4]; 3];
    for (axis, envelope) in envelopes.iter().enumerate() {
        let function = PerformanceFunction::new(envelope.performance)?;
        if let Some(own) = function.coefficients() {
            coefficients[axis] = own.to_vec();
        }
        if let Performance::AppointedTime {
            appointed_time_s, ..
        } = envelope.performance
        {
            appointed[axis] = appointed_time_s;
        }
    }
    let [first, ..] = envelopes;
    let (initial, last, rate, offset) = match first.performance {
        Performance::AppointedTime {
            initial_level,
            final_level,
            rate_per_s,
            offset,
            ..
        } => (initial_level, final_level, rate_per_s, offset),
        Performance::Exponential {
            initial_level,
            final_level,
            rate_per_s,
        } => (initial_level, final_level, rate_per_s, 0.0),
    };
    Ok(vec![
        list("COEFFICIENTS", "1", "z1 to z4 of (8)", &coefficients),
        list(
            "APPOINTED_S",
            "s",
            "appointed time of each axis",
            &appointed[..],
        ),
        number("INITIAL_LEVEL", "1", "rho_0", initial),
        number("FINAL_LEVEL", "1", "rho_inf", last),
        number("RATE_PER_S", "1/s", "k", rate),
        number("OFFSET", "1", "b", offset),
        number("HALF_PI", "1", "pi / 2", std::f64::consts::FRAC_PI_2),
        number("SHAPE", "1", "a", first.shape),
    ])
}

fn of_corrections(envelopes: &[EnvelopeParameters; 3]) -> Vec<Constant> {
    let [first, ..] = envelopes;
    let adhesion = |of: fn(&Adhesion) -> f64| first.adhesion.as_ref().map_or(1.0, of);
    let resilience = |of: fn(&Resilience) -> f64| first.resilience.as_ref().map_or(1.0, of);
    let spans = envelopes.each_ref();
    let spans = spans.map(|own| {
        own.adhesion
            .as_ref()
            .map_or(1.0, |adhesion| adhesion.span_s)
    });
    vec![
        number("ADHESION_WIDTH", "1", "lambda", adhesion(|own| own.width)),
        number("ADHESION_EXPONENT", "1", "nu", adhesion(|own| own.exponent)),
        list(
            "ADHESION_SPAN_S",
            "s",
            "time after which the terms are zero",
            &spans[..],
        ),
        number(
            "FAULT_GAIN",
            "1/(N m s)",
            "delta_1",
            resilience(|own| own.fault_gain),
        ),
        number(
            "FAULT_RATE_GAIN",
            "1",
            "delta_2",
            resilience(|own| own.rate_gain),
        ),
        number(
            "CORRECTION_DECAY_PER_S",
            "1/s",
            "delta_3",
            resilience(|own| own.decay_per_s),
        ),
        number(
            "CORRECTION_DECAY_SIZE",
            "1",
            "delta_4",
            resilience(|own| own.decay_size),
        ),
        number(
            "AWAY_WIDTH",
            "1",
            "kappa_1",
            resilience(|own| own.away_width),
        ),
        number(
            "TOWARD_WIDTH",
            "1",
            "kappa_2",
            resilience(|own| own.toward_width),
        ),
    ]
}
