//! The rigid spacecraft and its surroundings, as written in a scenario file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::InertiaUncertaintyFile;

use super::wheels::WheelsFile;
use crate::base::bounded::{As, Finite, NonNegative, Positive, Unit};
use crate::sim::actuator::ActuatorsFile;
use crate::sim::measurement_error::ErrorKind;

/// A rigid spacecraft: the true one, which may differ from the model of the design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigidBodyFile {
    /// Inertia matrix of a rigid body about its centre of mass, in body axes [kg m^2]: symmetric positive definite,
    /// no principal moment above the sum of the other two. Entries off the diagonal are those of the matrix, J_12 =
    /// - integral of x y dm: products of inertia with their signs reversed.
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// The inertia is drawn from this set about `inertia_kg_m2` with the scenario's seed, every entry
    /// uniform and independent of the others; it is `inertia_kg_m2` itself when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia_drawn_within: Option<InertiaUncertaintyFile>,
    /// Attitude at the start.
    pub initial_attitude: AttitudeFile,
    /// Body rate at the start [rad/s].
    #[serde(default, with = "As::<[Finite; 3]>")]
    pub initial_rate_rad_s: [f64; 3],
    /// What the attitude should be; the zero attitude when left out.
    #[serde(default)]
    pub reference: ReferenceFile,
    /// Disturbance torque; none when left out.
    #[serde(default)]
    pub disturbance: TorqueFile,
    /// Errors of the sensors; none when left out.
    #[serde(default)]
    pub sensors: SensorsFile,
    /// Limits of the actuators; none but the controller's own when left out.
    #[serde(default)]
    pub actuators: ActuatorsFile,
    /// Faults of the actuators.
    #[serde(default)]
    pub faults: Vec<FaultFile>,
    /// Reaction wheels that give the torque; without them it acts from outside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wheels: Option<WheelsFile>,
}

/// An attitude: the rotation that turns the axes of the reference frame into those of the body. A quaternion is
/// Hamilton's, cos(angle / 2) and the axis times sin(angle / 2); its key says where the scalar part stands. The error
/// quaternion is conj(desired) * actual. A norm may differ from 1 by 0.01; it is normalised.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AttitudeFile {
    /// [q0, q1, q2, q3], q0 the scalar.
    QuaternionScalarFirst(#[serde(with = "As::<[Finite; 4]>")] [f64; 4]),
    /// [q1, q2, q3, q0], q0 the scalar.
    QuaternionScalarLast(#[serde(with = "As::<[Finite; 4]>")] [f64; 4]),
    /// [yaw, pitch, roll]: about axis 3, then 2, then 1 (deg).
    #[serde(rename = "euler_321_deg")]
    Euler321Deg(#[serde(with = "As::<[Finite; 3]>")] [f64; 3]),
    /// A turn about an axis.
    AxisAngle(AxisAngleFile),
}

/// A turn about an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AxisAngleFile {
    /// The axis, of any length above 0.
    #[serde(with = "As::<[Finite; 3]>")]
    pub axis: [f64; 3],
    /// The angle (deg).
    #[serde(with = "As::<Finite>")]
    pub angle_deg: f64,
}

/// What the attitude should be in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ReferenceFile {
    /// A constant attitude.
    Constant(AttitudeFile),
    /// A turn at a constant rate about an axis fixed in the body.
    Slew {
        /// Attitude before the slew.
        start: AttitudeFile,
        /// The axis, of any length above 0.
        axis: [Finite; 3],
        /// The rate [rad/s].
        rate_rad_s: Finite,
        /// Start of the slew, not negative (s).
        from_s: NonNegative,
        /// End of the slew, after its start (s).
        until_s: Finite,
    },
    /// An oscillation `amplitude sin(frequency t)` about an axis fixed in the body.
    Sine {
        /// Attitude in the middle.
        centre: AttitudeFile,
        /// The axis, of any length above 0.
        axis: [Finite; 3],
        /// Amplitude (deg).
        amplitude_deg: Finite,
        /// Angular frequency, above 0 [rad/s].
        frequency_rad_s: Positive,
    },
}

impl Default for ReferenceFile {
    fn default() -> Self {
        ReferenceFile::Constant(AttitudeFile::QuaternionScalarFirst([1.0, 0.0, 0.0, 0.0]))
    }
}

/// A disturbance torque: the sum of its parts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorqueFile {
    /// Constant part [N m].
    #[serde(default, with = "As::<[Finite; 3]>")]
    pub bias_nm: [f64; 3],
    /// Periodic parts.
    #[serde(default)]
    pub sines: Vec<TorqueSineFile>,
    /// Rows between which the torque changes linearly; constant before the first and after the last.
    #[serde(default)]
    pub table: Vec<TorqueRowFile>,
    /// Norm of a torque along B'Ux of the design, where x'Ux grows fastest, chosen anew at every sample and every arrival;
    /// not negative [N m].
    #[serde(default, with = "As::<NonNegative>")]
    pub worst_nm: f64,
}

/// `sine_nm sin(frequency t) + cosine_nm cos(frequency t)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorqueSineFile {
    /// Angular frequency, above 0 [rad/s].
    #[serde(with = "As::<Positive>")]
    pub frequency_rad_s: f64,
    /// Amplitude of the sine [N m].
    #[serde(default, with = "As::<[Finite; 3]>")]
    pub sine_nm: [f64; 3],
    /// Amplitude of the cosine [N m].
    #[serde(default, with = "As::<[Finite; 3]>")]
    pub cosine_nm: [f64; 3],
}

/// One row of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorqueRowFile {
    /// Time, later than in the row before (s).
    #[serde(with = "As::<Finite>")]
    pub time_s: f64,
    /// Torque [N m].
    #[serde(with = "As::<[Finite; 3]>")]
    pub torque_nm: [f64; 3],
}

/// Errors of the sensors.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorsFile {
    /// Standard deviation of the attitude about each axis, not negative (deg).
    #[serde(default, with = "As::<NonNegative>")]
    pub attitude_noise_deg: f64,
    /// Standard deviation of each rate, not negative [deg/s].
    #[serde(default, with = "As::<NonNegative>")]
    pub rate_noise_deg_s: f64,
    /// Resolution of the attitude, not negative; 0 for none (deg).
    #[serde(default, with = "As::<NonNegative>")]
    pub attitude_quantum_deg: f64,
    /// Resolution of each rate, not negative; 0 for none [deg/s].
    #[serde(default, with = "As::<NonNegative>")]
    pub rate_quantum_deg_s: f64,
    /// Errors within bounds; none when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bounded_error: Option<BoundedErrorFile>,
}

/// Errors of the sensors within bounds, as a model's `imperfections.measurement` states them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundedErrorFile {
    /// Bound on the norm of the rate's error, not negative [rad/s].
    #[serde(default, with = "As::<NonNegative>")]
    pub rate_rad_s: f64,
    /// Bound on the angle between the measured and the true attitude, not negative (deg).
    #[serde(default, with = "As::<NonNegative>")]
    pub attitude_deg: f64,
    /// How the errors are chosen.
    pub kind: ErrorKind,
}

/// A fault of one axis in a window of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultFile {
    /// Axis: 1, 2 or 3.
    #[schemars(range(min = 1, max = 3))]
    pub axis: u32,
    /// Start of the window, not negative (s).
    #[serde(with = "As::<NonNegative>")]
    pub from_s: f64,
    /// End of the window, after its start (s).
    #[serde(with = "As::<Finite>")]
    pub until_s: f64,
    /// Fraction of the commanded torque that acts, in [0, 1]; 1 when left out.
    #[serde(default = "one", with = "As::<Unit>")]
    pub effectiveness: f64,
    /// Torque about the axis that acts on top, whatever is commanded [N m].
    #[serde(default, with = "As::<Finite>")]
    pub additive_nm: f64,
    /// The same, changing in time: added to `additive_nm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub additive_wave: Option<FaultWaveFile>,
}

/// amplitude sin(frequency t + phase) exp(-decay t), with t the time of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultWaveFile {
    /// Amplitude at time zero [N m].
    pub amplitude_nm: Finite,
    /// Angular frequency, not negative [rad/s].
    pub frequency_rad_s: NonNegative,
    /// Phase (deg).
    #[serde(default)]
    pub phase_deg: Finite,
    /// Decay, not negative [1/s].
    #[serde(default)]
    pub decay_per_s: NonNegative,
}

fn one() -> f64 {
    1.0
}
