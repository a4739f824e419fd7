//! A parameter set without units, and the scenario that it stands for.
//!
//! The rules here scale a set that is known to work (that of models/lei2022.json) to another
//! spacecraft: times with the settling time, torques with the limit and the disturbance, energies with
//! the inertia and the rates. What links two parameters is a rule; what is left is a number of the
//! [`Shape`], and of order 1.

use nalgebra::Vector3;
use serde::Serialize;

use super::file::{Requirements, Start};
use crate::base::bounded::{plain, InsideUnit, Tail};
use crate::controllers::lei2022::{
    BarrierFile, CompositeTriggerFile, DisturbanceTermFile, LeiFile, LeiTriggerFile,
    PerformanceFile, VirtualLawFile,
};
use crate::controllers::ControllerFile;
use crate::plants::rigid_body::{
    AttitudeFile, AxisAngleFile, ReferenceFile, RigidBodyFile, SensorsFile, TorqueFile,
    TorqueSineFile,
};
use crate::plants::SystemFile;
use crate::scenario::{
    MetricsFile, OutputFile, RandomFile, RequirementFile, SamplingFile, ScenarioFile,
    SCENARIO_SCHEMA_VERSION,
};
use crate::sim::actuator::ActuatorsFile;
use crate::sim::integrator::Method;
use crate::sim::metrics::Metric;
use crate::sim::sampling::Instants;

/// Room of the funnel around the start.
const START_ROOM: f64 = 1.0167;
/// Least room of rho_0 above rho_infinity.
const FUNNEL_ROOM: f64 = 1.5;
/// k_m, just above k_u = 1.5, so that Property 1 of the paper holds.
const GAIN: f64 = 1.505;
/// Peak rate over mean rate of a turn that settles in time.
const PEAK_OVER_MEAN: f64 = 2.1;
/// Where the matching rule is kept with equality.
const MATCHING: f64 = 0.97;
/// Least disturbance that m allows for, as a fraction of the torque limit.
const LEAST_DISTURBANCE: f64 = 0.01;
/// Frequency of the faster wave of the disturbance over that of the slower.
const FAST_WAVE: f64 = 4.0;
/// Integration step over the time unit (a sixtieth of the settling time), and its largest phase of the
/// disturbance, rad.
const STEP: f64 = 0.05;
/// Width of the interval in which an event is found, over the time unit.
const RESOLUTION: f64 = 1e-7;

/// A number of a shape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Number {
    /// What it is.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    #[serde(skip)]
    least: f64,
    #[serde(skip)]
    most: f64,
}

/// A parameter set without units.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Its numbers.
    pub numbers: [Number; COUNT],
}

/// How many numbers a shape has.
pub const COUNT: usize = 14;
const RATE: usize = 0;
const FLOOR: usize = 1;
const RATE_GAIN: usize = 2;
const DECAY: usize = 3;
const FALL: usize = 4;
const ENVELOPE: usize = 5;
const BUFFER: usize = 6;
const ON_TIME: usize = 7;
const SLOPE: usize = 8;
const WIDTH: usize = 9;
const HELD_START: usize = 10;
const HELD_END: usize = 11;
const SMOOTHING: usize = 12;
const BARRIER: usize = 13;

impl Default for Shape {
    /// The set of models/lei2022.json, with a funnel that is wide enough for small components too.
    fn default() -> Self {
        let number = |name, value, least, most| Number {
            name,
            value,
            least,
            most,
        };
        Shape {
            numbers: [
                number("virtual rate over the allowed one", 0.95, 0.3, 1.0),
                number("least rho_0 over the largest possible", 0.2, 0.02, 1.0),
                number("K_2 times the time unit over lambda_min", 1.37, 0.1, 10.0),
                number("decay of S2 within the settling time", 0.92, 0.3, 2.0),
                number("f_s over the settling time", 6.4 / 60.0, 0.02, 0.3),
                number("S2(0) over V2(0)", 1.13, 1.01, 4.0),
                number("delta_m over S2_inf", 0.3, 0.02, 0.9),
                number("T_max over the time unit", 1.0, 0.02, 5.0),
                number("decay of the error over that of the funnel", 1.64, 0.6, 5.0),
                number("rho_inf / gamma over the accuracy", 0.44, 0.1, 1.5),
                number("root of s over the torque limit", 0.82, 0.05, 2.0),
                number("root of m over the disturbance", 2.24, 0.3, 10.0),
                number("p over the tolerated rate error", 0.6, 0.05, 10.0),
                number("k_1 over rho_inf and the torque limit", 0.2, 0.001, 2.0),
            ],
        }
    }
}

impl Shape {
    /// The shape with one number multiplied; `None` when that is out of its range.
    pub fn scaled(&self, index: usize, factor: f64) -> Option<Self> {
        let mut shape = self.clone();
        let number = shape.numbers.get_mut(index)?;
        number.value *= factor;
        let allowed = number.least..=number.most;
        allowed.contains(&number.value).then_some(shape)
    }

    fn of(&self, index: usize) -> f64 {
        self.numbers[index].value
    }
}

/// The controller of a shape for one start: rho_0 from the error quaternion, the levels of S2 from the
/// matching rule k_m M rho_inf >= sqrt(2 ((1 - kappa) S2_inf - delta_m) / lambda_min).
pub fn controller(requirements: &Requirements, shape: &Shape, start: &Start) -> LeiFile {
    let (limits, craft) = (&requirements.file.limits, &requirements.file.spacecraft);
    let settle = limits.settle_s.get();
    let unit = settle / 60.0;
    let (least, torque) = (
        requirements.moments_kg_m2.0,
        requirements.torque_limit_nm.min(),
    );
    let disturbance = requirements.file.disturbance.bound_nm.get();
    let vector = start.axis * (0.5 * requirements.angle_rad).sin();
    let fall = shape.of(FALL) * settle;
    let mean = requirements.angle_rad / settle;
    let rate = shape.of(RATE) * limits.rate_rad_s.get().min(PEAK_OVER_MEAN * mean);
    let strength = rate / (START_ROOM * vector.norm());
    let slope = shape.of(SLOPE) * 4.0 / (fall * strength);
    let accuracy = limits
        .accuracy_deg
        .to_radians()
        .min(2.0 * requirements.component);
    let terminal = shape.of(WIDTH) * slope * accuracy;
    let floor = (shape.of(FLOOR) * vector.norm()).max(FUNNEL_ROOM * terminal);
    let initial = vector.map(|component| START_ROOM * component.abs().max(floor));
    // The rate error that the trigger tolerates in the end.
    let tolerated = MATCHING * strength * terminal;
    let relative_buffer = relative_buffer(requirements);
    let room = (1.0 - relative_buffer) * (1.0 - shape.of(BUFFER));
    let envelope_end = 0.5 * least * tolerated * tolerated / room;
    let direction = vector.normalize() * (strength * initial.norm());
    let energy = 0.5 * direction.dot(&(requirements.inertia * direction));
    let envelope_start =
        (shape.of(ENVELOPE) * energy / (1.0 - relative_buffer)).max(2.0 * envelope_end);
    let on_time = shape.of(ON_TIME) * unit;
    let held = shape.of(HELD_END) * disturbance.max(LEAST_DISTURBANCE * torque);
    let rate_scale = strength / GAIN;
    LeiFile {
        performance: PerformanceFile {
            initial: initial.into(),
            terminal: [terminal; 3],
            midpoint_s: settle * 50.0 / 60.0,
            time_scale_s: fall,
        },
        barrier: BarrierFile {
            gain_j: shape.of(BARRIER) * torque * terminal,
            width: 1.0,
        },
        virtual_law: VirtualLawFile {
            gain: GAIN,
            rate_scale_rad_s: rate_scale,
            slope,
        },
        rate_gain_nm_s_rad: shape.of(RATE_GAIN) * least / unit,
        disturbance: DisturbanceTermFile {
            bound_nm: 1.06 * disturbance,
            smoothing_rad_s: shape.of(SMOOTHING) * (2.0 * envelope_end / least).sqrt(),
        },
        trigger: LeiTriggerFile::Composite(CompositeTriggerFile {
            held_error_initial_n2m2: (shape.of(HELD_START) * torque).powi(2),
            held_error_terminal_n2m2: held * held,
            longest_on_s: craft
                .longest_on_s
                .map_or(on_time, |longest| on_time.min(longest.get())),
            envelope_initial_j: envelope_start,
            envelope_terminal_j: envelope_end,
            decay_rate_per_s: (envelope_start / envelope_end).ln() / (shape.of(DECAY) * settle),
            buffer_j: shape.of(BUFFER) * (1.0 - relative_buffer) * envelope_end,
            relative_buffer,
        }),
        torque_limit_nm: plain(&craft.torque_limit_nm),
        inertia_kg_m2: None,
        sign_hysteresis: 0.0,
    }
}

/// kappa: a trigger evaluated at samples needs one.
fn relative_buffer(requirements: &Requirements) -> f64 {
    match requirements.file.sampling_interval_s {
        Some(_) => 0.2,
        None => 0.0,
    }
}

/// The scenario of a shape from one start, with the requirements on the run.
pub fn scenario(requirements: &Requirements, shape: &Shape, start: &Start) -> ScenarioFile {
    let (file, limits) = (&requirements.file, &requirements.file.limits);
    let (settle_s, unit) = (limits.settle_s.get(), limits.settle_s.get() / 60.0);
    let instants = match file.sampling_interval_s {
        Some(interval) => Instants::Periodic {
            interval_s: interval.get(),
            jitter_s: 0.0,
        },
        None => Instants::Continuous {
            resolution_s: (RESOLUTION * unit).max(1e-9),
        },
    };
    ScenarioFile {
        schema_version: SCENARIO_SCHEMA_VERSION,
        name: file.name.clone(),
        source: source(file),
        duration_s: requirements.duration_s,
        random: RandomFile::default(),
        system: system(requirements, start),
        sampling: SamplingFile {
            instants,
            dropout_probability: 0.0,
        },
        controller: ControllerFile::Lei2022(Box::new(controller(requirements, shape, start))),
        link: None,
        network: None,
        integrator: Method::RungeKutta4 {
            step_s: STEP * unit.min((FAST_WAVE * file.disturbance.frequency_rad_s).recip()),
        },
        // In their ranges as the requirements are checked.
        metrics: MetricsFile {
            settle_tolerance_deg: None,
            settle_tolerance_component: InsideUnit::try_from(requirements.component).ok(),
            settle_tolerance_state: None,
            tail_s: Tail::try_from(requirements.duration_s - settle_s).ok(),
        },
        requirements: vec![
            at_most(Metric::SettleSeconds, settle_s),
            at_most(Metric::TailErrorDeg, limits.accuracy_deg),
            at_most(Metric::MaxRate, limits.rate_rad_s.get()),
            at_most(Metric::FunnelRatio, 1.0),
            at_most(Metric::ThresholdRatio, 1.0),
        ],
        output: OutputFile::default(),
        dispersions: None,
    }
}

fn source(file: &super::file::TuneFile) -> String {
    let from = "parameters found by steadfast tune for the controller of Lei et al. 2022";
    match file.source.as_str() {
        "" => from.to_string(),
        source => format!("{source}; {from}"),
    }
}

fn at_most(metric: Metric, limit: f64) -> RequirementFile {
    RequirementFile {
        metric,
        at_most: Some(limit),
        at_least: None,
    }
}

fn system(requirements: &Requirements, start: &Start) -> SystemFile {
    let disturbance = match start.disturbed {
        true => torque(requirements),
        false => TorqueFile::default(),
    };
    SystemFile::RigidBody(Box::new(RigidBodyFile {
        inertia_kg_m2: requirements.file.spacecraft.inertia_kg_m2,
        inertia_drawn_within: None,
        initial_attitude: AttitudeFile::AxisAngle(AxisAngleFile {
            axis: start.axis.into(),
            angle_deg: requirements.file.manoeuvre.angle_deg,
        }),
        initial_rate_rad_s: [0.0; 3],
        reference: ReferenceFile::default(),
        disturbance,
        sensors: SensorsFile::default(),
        actuators: ActuatorsFile::default(),
        faults: Vec::new(),
        wheels: None,
    }))
}

/// A bias and two waves about different axes, whose norms add up to the bound.
fn torque(requirements: &Requirements) -> TorqueFile {
    let file = &requirements.file.disturbance;
    let part = |fraction: f64, direction: [f64; 3]| -> [f64; 3] {
        (Vector3::from(direction).normalize() * (fraction * file.bound_nm.get())).into()
    };
    let wave = |times: f64, sine_nm: [f64; 3], cosine_nm: [f64; 3]| TorqueSineFile {
        frequency_rad_s: times * file.frequency_rad_s,
        sine_nm,
        cosine_nm,
    };
    TorqueFile {
        bias_nm: part(0.4, [-1.0, 1.0, 1.0]),
        sines: vec![
            wave(1.0, part(0.3, [1.0, -0.5, 1.0]), [0.0; 3]),
            wave(FAST_WAVE, [0.0; 3], part(0.3, [0.5, 1.0, -1.0])),
        ],
        table: Vec::new(),
        worst_nm: 0.0,
    }
}
