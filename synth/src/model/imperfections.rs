//! What separates the spacecraft that flies from the ideal loop: the `imperfections` of a model file.
//!
//! Every number is a bound that the proof takes for granted; what is left out is 0, or perfect.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bounded::{As, NonNegative, Positive};
use crate::fuzzy::{MomentumExchange, WheelMomentum};

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
pub(crate) fn is_none(imperfections: &Imperfections) -> bool {
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
