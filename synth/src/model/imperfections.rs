//! What separates the spacecraft that flies from the ideal loop: the `imperfections` of a model file.
//!
//! Every number is a bound that the proof takes for granted; what is left out is 0, or perfect.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bounded::{As, NonNegative, Positive};
use super::file::{GainForm, ModelFile, PlantFile};
use super::ranges::{check_count, require};
use super::{Model, ModelError, Plant, RulesSystem, MAX_COLUMNS};
use crate::conditions::{FloorSupply, GainErrorSet, LoopImperfections, MeasurementError};
use crate::fuzzy::{MomentumExchange, TakagiSugeno, WheelMomentum};
use nalgebra::DVector;

/// The most consecutive transmissions that a model may let be lost.
const MOST_LOST: u32 = 100;

/// Bounds on what a loop that flies does otherwise than an ideal one.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Imperfections {
    /// How far the measured state may be from the true one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measurement: Option<MeasurementBounds>,
    /// Longest time from a sample until its message acts, not negative (s): sensor, computation, network, actuator and
    /// jitter together. It may exceed hbar_s.
    #[serde(default, skip_serializing_if = "is_zero", with = "As::<NonNegative>")]
    pub delay_s: f64,
    /// N: how many consecutive transmissions may be lost, at most 100. Every value is transmitted at its own sample and
    /// again at the N samples that follow.
    #[serde(default, skip_serializing_if = "no_loss")]
    pub lost_in_a_row: u32,
    /// Applied torque over commanded torque, after saturation: [lowest, highest] for all inputs or one pair for each;
    /// above 0. It may vary with time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effectiveness: Option<Effectiveness>,
    /// Bound on how much of one input's torque acts in another's place, not negative: |Delta_ij| for i != j.
    #[serde(default, skip_serializing_if = "is_zero", with = "As::<NonNegative>")]
    pub misalignment: f64,
    /// Bound on the angular momentum of the wheels in body axes [N m s]: on its norm, or on each component. It may vary
    /// with time in any way. With an `exact` plant only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wheel_momentum_nms: Option<MomentumBound>,
    /// Bounds on the motion of the reference attitude. With an `exact` plant only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<ReferenceMotion>,
    /// Step to which the actuators round the torque of each axis, not negative [N m]. With an `exact`
    /// plant only.
    #[serde(default, skip_serializing_if = "is_zero", with = "As::<NonNegative>")]
    pub torque_quantum_nm: f64,
}

/// How far the measured state may be from the true one: of a spacecraft `rate_rad_s` and `attitude_deg`, of any other
/// plant `state`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasurementBounds {
    /// Bound on the norm of the rate's error, not negative [rad/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<NonNegative>>")]
    pub rate_rad_s: Option<f64>,
    /// Bound on the angle between the measured and the true attitude, not negative (deg).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<NonNegative>>")]
    pub attitude_deg: Option<f64>,
    /// Bound on the error of each state, n entries, not negative, in the unit of the state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Vec<NonNegative>>>")]
    pub state: Option<Vec<f64>>,
}

/// [lowest, highest] for all inputs, or one pair for each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "it must be a pair [lowest, highest] of numbers, or one such pair for each input"
)]
pub enum Effectiveness {
    /// The same for all inputs.
    Common(#[serde(with = "As::<[Positive; 2]>")] [f64; 2]),
    /// One pair for each input.
    PerInput(#[serde(with = "As::<Vec<[Positive; 2]>>")] Vec<[f64; 2]>),
}

/// A bound on the norm of a vector, or on each of its components.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "it must be a number, or one number for each of the three axes; 0 or above"
)]
pub enum MomentumBound {
    /// On the norm [N m s].
    Norm(#[serde(with = "As::<NonNegative>")] f64),
    /// On each component [N m s].
    PerAxis(#[serde(with = "As::<[NonNegative; 3]>")] [f64; 3]),
}

/// Bounds on the motion of the reference attitude, in any direction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReferenceMotion {
    /// Bound on the norm of its rate, not negative [rad/s].
    #[serde(with = "As::<NonNegative>")]
    pub rate_rad_s: f64,
    /// Bound on the norm of its angular acceleration, not negative [rad/s^2].
    #[serde(default, with = "As::<NonNegative>")]
    pub acceleration_rad_s2: f64,
}

/// The absolute part eps_a of the trigger: a sample is sent when e'We >= nu w'Ww + eps_a.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "it must be \"auto\", or a number that is 0 or above"
)]
pub enum TriggerFloor {
    /// Found from the bounds on the measurement.
    Auto(Auto),
    /// In units of the Lyapunov function, which is 1 on the boundary of the certified set.
    Given(#[serde(with = "As::<NonNegative>")] f64),
}

/// The word `auto`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Auto {
    /// `auto`.
    Auto,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn no_loss(count: &u32) -> bool {
    *count == 0
}

/// Whether nothing departs from the ideal loop.
pub(super) fn is_none(imperfections: &Imperfections) -> bool {
    *imperfections == Imperfections::default()
}

/// Some states, and a bound on the norm of the measurement error in them.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBall {
    /// The states, from 0.
    pub states: Vec<usize>,
    /// The bound: a number in the file, times [`ErrorBall::factor`].
    pub bound: f64,
    /// What turns the file's number into the bound.
    pub factor: ErrorUnit,
}

/// How the number of a file bounds a measurement error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorUnit {
    /// It is the bound, in the unit of the states.
    State,
    /// An angle theta (deg): a rotation by it moves a unit quaternion by 2 sin(theta/4) <= theta/2 (rad).
    RotationDeg,
}

impl ErrorBall {
    /// The bound in the unit of the states.
    pub fn radius(&self) -> f64 {
        match self.factor {
            ErrorUnit::State => self.bound,
            ErrorUnit::RotationDeg => 0.5 * self.bound.to_radians(),
        }
    }
}

impl MeasurementBounds {
    /// The sets of states whose errors are bounded together; all states of the plant are in one of them.
    pub fn balls(&self) -> Vec<ErrorBall> {
        if let Some(state) = &self.state {
            let each = state.iter().enumerate();
            return each
                .map(|(index, &bound)| ErrorBall {
                    states: vec![index],
                    bound,
                    factor: ErrorUnit::State,
                })
                .collect();
        }
        let ball = |states: std::ops::Range<usize>, bound: Option<f64>, factor| ErrorBall {
            states: states.collect(),
            bound: bound.unwrap_or(0.0),
            factor,
        };
        vec![
            ball(0..3, self.rate_rad_s, ErrorUnit::State),
            ball(3..6, self.attitude_deg, ErrorUnit::RotationDeg),
        ]
    }

    /// Whether any error is above 0.
    pub fn is_some(&self) -> bool {
        self.balls().iter().any(|ball| ball.bound > 0.0)
    }
}

impl Effectiveness {
    /// Lowest and highest of one input, from 0.
    pub fn of(&self, input: usize) -> [f64; 2] {
        match self {
            Effectiveness::Common(pair) => *pair,
            Effectiveness::PerInput(pairs) => pairs.get(input).copied().unwrap_or([1.0; 2]),
        }
    }
}

impl Imperfections {
    /// The bounds on the measurement, where an error is allowed.
    pub fn measurement_error(&self) -> Option<&MeasurementBounds> {
        self.measurement.as_ref().filter(|bounds| bounds.is_some())
    }

    /// Whether a message may come late or not at all.
    pub fn is_networked(&self) -> bool {
        self.delay_s > 0.0 || self.lost_in_a_row > 0
    }

    /// h_m = (N + 1) hbar + d_max: the greatest age of the sample behind the torque in force (s).
    pub fn oldest_sample_s(&self, hbar_s: f64) -> f64 {
        f64::from(self.lost_in_a_row + 1) * hbar_s + self.delay_s
    }

    /// N hbar + d_max: the latest first arrival (s).
    pub fn first_arrival_s(&self, hbar_s: f64) -> f64 {
        f64::from(self.lost_in_a_row) * hbar_s + self.delay_s
    }

    /// Lowest and highest effectiveness of an input, from 0.
    pub fn effectiveness_of(&self, input: usize) -> [f64; 2] {
        let given = self.effectiveness.as_ref();
        given.map_or([1.0; 2], |effectiveness| effectiveness.of(input))
    }

    /// The entries (i, j) of the actuators' gain matrix that are uncertain, row after row.
    pub fn uncertain_gains(&self, inputs: usize) -> Vec<(usize, usize)> {
        let uncertain = |i: usize, j: usize| match i == j {
            true => {
                let [lowest, highest] = self.effectiveness_of(i);
                lowest < highest
            }
            false => self.misalignment > 0.0,
        };
        let all = (0..inputs).flat_map(|i| (0..inputs).map(move |j| (i, j)));
        all.filter(|&(i, j)| uncertain(i, j)).collect()
    }

    /// What the plant has of it: momentum beside the body's, and rounded torques.
    pub(super) fn momentum_exchange(&self) -> MomentumExchange {
        let reference = self.reference.unwrap_or_default();
        MomentumExchange {
            wheels: self.wheel_momentum_nms.map(|bound| match bound {
                MomentumBound::Norm(bound) => WheelMomentum::Norm(bound),
                MomentumBound::PerAxis(bounds) => WheelMomentum::PerAxis(bounds),
            }),
            reference_rate: reference.rate_rad_s,
            reference_acceleration: reference.acceleration_rad_s2,
            torque_quantum: self.torque_quantum_nm,
        }
    }

    /// Whether the actuators' gain is other than 1.
    pub fn changes_gain(&self) -> bool {
        self.effectiveness.is_some() || self.misalignment > 0.0
    }
}

fn refuse(key: &str, reason: &str) -> Result<(), ModelError> {
    Err(ModelError::choice(
        format!("imperfections.{key}"),
        reason.to_string(),
    ))
}

/// Checks what the ranges of single numbers leave open.
pub(super) fn check_imperfections(file: &ModelFile, plant: &Plant) -> Result<(), ModelError> {
    let imperfections = &file.imperfections;
    check_forms(file, plant)?;
    if let Some(measurement) = &imperfections.measurement {
        check_measurement(measurement, file, plant)?;
    }
    let lost = imperfections.lost_in_a_row;
    let allowed = "in 0 to 100";
    let field = "imperfections.lost_in_a_row";
    require(lost <= MOST_LOST, field, f64::from(lost), allowed)?;
    let oldest = imperfections.oldest_sample_s(file.specs.hbar_s);
    let ok = file.specs.phi_per_s * oldest <= 100.0;
    let allowed = "such that (lost_in_a_row + 1) hbar_s + delay_s is at most 100 / phi_per_s";
    require(ok, "imperfections.delay_s", imperfections.delay_s, allowed)?;
    let inputs = plant.sizes().1;
    check_effectiveness(imperfections, inputs)?;
    check_floor(file)
}

/// What only some plants and gains have.
fn check_forms(file: &ModelFile, plant: &Plant) -> Result<(), ModelError> {
    let imperfections = &file.imperfections;
    let exact = matches!(plant, Plant::Spacecraft(_));
    if imperfections.wheel_momentum_nms.is_some() && !exact {
        return refuse("wheel_momentum_nms", "needs an 'exact' plant");
    }
    if imperfections.reference.is_some() && !exact {
        return refuse("reference", "needs an 'exact' plant");
    }
    if imperfections.torque_quantum_nm > 0.0 && !exact {
        return refuse("torque_quantum_nm", "needs an 'exact' plant");
    }
    let constant = file.gains == GainForm::Constant;
    match constant || is_none(imperfections) {
        true => Ok(()),
        false => Err(ModelError::choice(
            "imperfections",
            "are proved for constant gains only; leave them out, or use \"constant\"",
        )),
    }
}

fn check_measurement(
    bounds: &MeasurementBounds,
    file: &ModelFile,
    plant: &Plant,
) -> Result<(), ModelError> {
    let spacecraft = match &file.plant {
        PlantFile::Exact(_) => true,
        PlantFile::Rules(rules) => matches!(rules.system, RulesSystem::Spacecraft(_)),
        PlantFile::Vertices(_) => false,
    };
    match (spacecraft, &bounds.state) {
        (true, Some(_)) => {
            return refuse(
                "measurement.state",
                "a spacecraft has rate_rad_s and attitude_deg in its place",
            );
        }
        (false, None) => {
            return refuse(
                "measurement.state",
                "is missing: it bounds the error of each state",
            );
        }
        _ => {}
    }
    if let Some(state) = &bounds.state {
        if bounds.rate_rad_s.is_some() || bounds.attitude_deg.is_some() {
            return refuse(
                "measurement",
                "rate_rad_s and attitude_deg are for spacecraft only",
            );
        }
        let (found, expected) = (state.len(), plant.sizes().0);
        if found != expected {
            let [found, expected] = [found, expected].map(|count| format!("{count} entries"));
            let field = "imperfections.measurement.state";
            return Err(ModelError::shape(field, found, expected));
        }
    }
    let disturbed = plant.takagi_sugeno().disturbance_bound > 0.0;
    if bounds.is_some() && !disturbed {
        return refuse(
            "measurement",
            "needs a disturbance bound above 0: the error is weighed against the disturbance",
        );
    }
    check_attitude_error(bounds, file)
}

/// The sign of the measured quaternion follows from its scalar part, which must not vanish.
fn check_attitude_error(bounds: &MeasurementBounds, file: &ModelFile) -> Result<(), ModelError> {
    let PlantFile::Exact(exact) = &file.plant else {
        return Ok(());
    };
    let angle = bounds.attitude_deg.unwrap_or(0.0);
    let ok = 0.5 * angle.to_radians() < exact.q0_min;
    let allowed =
        "such that half of it (rad) stays below q0_min, so that the sign of the scalar part is known";
    require(ok, "imperfections.measurement.attitude_deg", angle, allowed)
}

fn check_effectiveness(imperfections: &Imperfections, inputs: usize) -> Result<(), ModelError> {
    let field = "imperfections.effectiveness";
    if let Some(Effectiveness::PerInput(pairs)) = &imperfections.effectiveness {
        check_count(field, "pairs", pairs.len(), MAX_COLUMNS)?;
        if pairs.len() != inputs {
            let [found, expected] = [pairs.len(), inputs].map(|count| format!("{count} pairs"));
            return Err(ModelError::shape(field, found, expected));
        }
    }
    for input in 0..inputs {
        let [lowest, highest] = imperfections.effectiveness_of(input);
        let allowed = "at most the highest effectiveness";
        require(lowest <= highest, field, lowest, allowed)?;
    }
    match imperfections.misalignment > 0.0 && inputs < 2 {
        true => refuse("misalignment", "needs two inputs or more"),
        false => Ok(()),
    }
}

/// A floor of the trigger is found from the measurement.
fn check_floor(file: &ModelFile) -> Result<(), ModelError> {
    let auto = matches!(file.specs.trigger_floor, Some(TriggerFloor::Auto(_)));
    match auto && file.imperfections.measurement_error().is_none() {
        true => Err(ModelError::choice(
            "specs.trigger_floor",
            "\"auto\" is found from imperfections.measurement, which is missing",
        )),
        false => Ok(()),
    }
}

/// The floor's part of the supply where it is found by the program, relative to the rest.
pub const FLOOR_SHARE: f64 = 0.3;

/// The part of an input's limit that is kept for measurement errors as long as the gain is not known.
const FIRST_RESERVE: f64 = 0.01;

/// The smallest error that the conditions are stated for, relative to the extent of the region along its state: they divide
/// by it.
const SMALLEST_ERROR: f64 = 1e-7;

/// The imperfections of a model as its conditions see them, for its plant in SI units.
pub(super) fn loop_imperfections(file: &ModelFile, system: &TakagiSugeno) -> LoopImperfections {
    let imperfections = &file.imperfections;
    let taubar_squared = system.disturbance_bound.powi(2);
    let floor = match file.specs.trigger_floor {
        None => FloorSupply::default(),
        Some(TriggerFloor::Auto(_)) => FloorSupply {
            share: FLOOR_SHARE,
            constant: 0.0,
        },
        Some(TriggerFloor::Given(floor)) => FloorSupply {
            share: 0.0,
            constant: floor / taubar_squared,
        },
    };
    let networked = imperfections.is_networked();
    let measurement = imperfections.measurement_error();
    LoopImperfections {
        oldest_sample: networked.then(|| imperfections.oldest_sample_s(file.specs.hbar_s)),
        gain_error: imperfections
            .changes_gain()
            .then(|| gain_error(imperfections, system.inputs())),
        measurement: measurement.map(|bounds| measurement_error(bounds, system)),
        floor,
    }
}

fn gain_error(imperfections: &Imperfections, inputs: usize) -> GainErrorSet {
    let ends = |input: usize| imperfections.effectiveness_of(input);
    let entries = imperfections.uncertain_gains(inputs).into_iter();
    GainErrorSet {
        centre: DVector::from_fn(inputs, |input, _| {
            let [lowest, highest] = ends(input);
            0.5 * (lowest + highest)
        }),
        entries: entries
            .map(|(i, j)| {
                let [lowest, highest] = ends(i);
                let width = match i == j {
                    true => 0.5 * (highest - lowest),
                    false => imperfections.misalignment,
                };
                ((i, j), width)
            })
            .collect(),
    }
}

fn measurement_error(bounds: &MeasurementBounds, system: &TakagiSugeno) -> MeasurementError {
    let states = system.states();
    let (mut sizes, mut balls) = (DVector::zeros(states), vec![0; states]);
    for (index, ball) in bounds.balls().iter().enumerate() {
        let extents = ball.states.iter().filter_map(|&state| system.extent(state));
        let extent = extents.reduce(f64::min).unwrap_or(1.0);
        let radius = ball.radius().max(SMALLEST_ERROR * extent);
        for &state in &ball.states {
            sizes[state] = radius / system.disturbance_bound;
            balls[state] = index;
        }
    }
    MeasurementError {
        sizes,
        balls,
        point: None,
        reserve: &system.input_limit * FIRST_RESERVE,
    }
}

impl Model {
    /// Whether no design exists for this model when none exists for an ideal loop: every imperfection may also be absent.
    /// Actuators whose effectiveness is never 1 are none that could be ideal.
    pub fn is_refuted_by_ideal_loop(&self) -> bool {
        let imperfections = &self.file.imperfections;
        (0..self.plant.sizes().1).all(|input| {
            let [lowest, highest] = imperfections.effectiveness_of(input);
            lowest <= 1.0 && 1.0 <= highest
        })
    }
}
