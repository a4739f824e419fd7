//! Reaction wheels: three of them, with friction, stiction and a momentum limit.
//!
//! With the momenta h of the wheels and their axes as the columns of A, a torque u on the body is asked of the motors as
//! -A^-1 u. A wheel follows `h' = motor - friction(h)`, and the body
//!
//! ```text
//! J omega' = -omega x (J omega + A h) - A h' + tau
//! ```
//!
//! so that friction and the momentum limit act on it like a disturbance -A h' - u.

use nalgebra::{Matrix3, SVector, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use super::RigidBody;
use crate::base::bounded::{plain, As, Finite, NonNegative, Positive};
use crate::base::ranges::require;
use crate::sim::integrator::Method;
use crate::sim::plant::Plant;
use crate::sim::rigid_body_state::{body_state, RigidBodyState};

/// Three reaction wheels.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WheelsFile {
    /// Spin axis of each wheel in body axes, of any length above 0, linearly independent; the body axes when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axes: Option<[[Finite; 3]; 3]>,
    /// Angular momentum of each wheel at the start [N m s].
    #[serde(default, with = "As::<[Finite; 3]>")]
    pub initial_momentum_nms: [f64; 3],
    /// Viscous friction: torque over momentum, not negative [1/s].
    #[serde(default, with = "As::<NonNegative>")]
    pub viscous_per_s: f64,
    /// Friction torque of a wheel that turns, whatever its speed, not negative [N m].
    #[serde(default, with = "As::<NonNegative>")]
    pub coulomb_nm: f64,
    /// Torque that a wheel which stands must overcome, not below coulomb_nm, which it is when left out [N m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiction_nm: Option<NonNegative>,
    /// Momentum up to which a wheel counts as standing: there the friction rises from 0 to the stiction; it falls to
    /// coulomb_nm at twice this. Above 0 [N m s].
    #[serde(default = "standstill", with = "As::<Positive>")]
    pub standstill_nms: f64,
    /// Momentum that no wheel can exceed, above 0; no limit when left out [N m s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub momentum_limit_nms: Option<Positive>,
}

fn standstill() -> f64 {
    1e-3
}

/// Longest step of the Runge-Kutta method times the steepest friction: beyond 2.78 it is unstable.
const STEEPEST: f64 = 2.0;

impl WheelsFile {
    /// The wheels.
    ///
    /// # Errors
    /// Axes without a direction or in a plane, a stiction below the Coulomb friction, a start beyond the limit.
    pub fn check(&self) -> Result<Wheels, ModelError> {
        let rows = self
            .axes
            .map(|axes| axes.map(|axis| Vector3::from(plain(&axis))));
        let mut axes = Matrix3::identity();
        for (index, axis) in rows.into_iter().flatten().enumerate() {
            let length = axis.norm();
            let field = format!("wheels.axes[{index}]");
            let allowed = "an axis of length above 0; this is its length";
            require(length > 0.0, &field, length, allowed)?;
            axes.set_column(index, &(axis / length));
        }
        let volume = axes.determinant();
        let allowed = "three axes that are not in a plane; this is the volume that they span";
        require(volume.abs() > 1e-3, "wheels.axes", volume, allowed)?;
        let stiction = self.stiction_nm.map_or(self.coulomb_nm, NonNegative::get);
        let allowed = "coulomb_nm or above";
        require(
            stiction >= self.coulomb_nm,
            "wheels.stiction_nm",
            stiction,
            allowed,
        )?;
        let limit = self.momentum_limit_nms.map_or(f64::INFINITY, Positive::get);
        for (index, &momentum) in self.initial_momentum_nms.iter().enumerate() {
            let field = format!("wheels.initial_momentum_nms[{index}]");
            require(
                momentum.abs() <= limit,
                &field,
                momentum,
                "within momentum_limit_nms",
            )?;
        }
        Ok(Wheels {
            axes,
            inverse: axes.try_inverse().unwrap_or(Matrix3::identity()),
            initial: Vector3::from(self.initial_momentum_nms),
            viscous: self.viscous_per_s,
            coulomb: self.coulomb_nm,
            stiction,
            standstill: self.standstill_nms,
            limit,
        })
    }
}

/// Three reaction wheels, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheels {
    axes: Matrix3<f64>,
    inverse: Matrix3<f64>,
    /// Momentum of each at the start, N m s.
    pub initial: Vector3<f64>,
    viscous: f64,
    coulomb: f64,
    stiction: f64,
    standstill: f64,
    limit: f64,
}

impl Wheels {
    /// Refuses steps of an integrator with which a wheel that stands would oscillate.
    ///
    /// # Errors
    /// The standstill momentum with the smallest one allowed.
    pub fn check_step(&self, method: &Method) -> Result<(), ModelError> {
        let Method::RungeKutta4 { step_s } = *method else {
            return Ok(());
        };
        let steepest = self.stiction / self.standstill + self.viscous;
        let allowed = format!(
            "such that (stiction_nm / standstill_nms + viscous_per_s) integrator.runge_kutta4.step_s is at most {STEEPEST}"
        );
        let field = "system.rigid_body.wheels.standstill_nms";
        require(
            steepest * step_s <= STEEPEST,
            field,
            self.standstill,
            &allowed,
        )
    }

    /// The friction of a wheel with this momentum (N m s), N m.
    fn friction(&self, momentum: f64) -> f64 {
        let turning = momentum.abs() / self.standstill;
        let level = if turning <= 1.0 {
            self.stiction * turning
        } else {
            let running = (turning - 1.0).min(1.0);
            self.stiction + (self.coulomb - self.stiction) * running
        };
        self.viscous * momentum + level.copysign(momentum)
    }

    /// Derivatives of the momenta (N m) while the torque `input` (N m) on the body is asked for.
    fn slopes(&self, momenta: &Vector3<f64>, input: &Vector3<f64>) -> Vector3<f64> {
        let motors = -(self.inverse * input);
        Vector3::from_fn(|wheel, _| {
            let momentum = momenta[wheel];
            let slope = motors[wheel] - self.friction(momentum);
            let beyond = momentum.abs() >= self.limit && slope * momentum > 0.0;
            if beyond {
                0.0
            } else {
                slope
            }
        })
    }

    /// The wheels' angular momentum in body axes, N m s, of a state that ends with the momenta of the wheels.
    pub fn momentum(&self, state: &WheeledState) -> Vector3<f64> {
        self.axes * momenta(state)
    }

    /// What friction and the momentum limit add to the torque on the body, N m.
    pub fn further_torque(&self, state: &WheeledState, input: &Vector3<f64>) -> Vector3<f64> {
        -(self.axes * self.slopes(&momenta(state), input)) - input
    }
}

/// State of a body with wheels: that of the body, then the momentum of each wheel (N m s).
pub type WheeledState = SVector<f64, 10>;

fn momenta(state: &WheeledState) -> Vector3<f64> {
    state.fixed_rows::<3>(7).into_owned()
}

/// State of a body with wheels.
pub fn wheeled_state(body: &RigidBodyState, momenta: &Vector3<f64>) -> WheeledState {
    WheeledState::from_fn(|row, _| if row < 7 { body[row] } else { momenta[row - 7] })
}

/// A rigid spacecraft that is turned by reaction wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheeledBody {
    /// The spacecraft with its wheels at rest.
    pub body: RigidBody,
    /// Its wheels.
    pub wheels: Wheels,
}

impl Plant<10, 3, 3> for WheeledBody {
    fn derivative(
        &self,
        time_s: f64,
        state: &WheeledState,
        input: &Vector3<f64>,
        disturbance: &Vector3<f64>,
    ) -> WheeledState {
        let body = body_state(state);
        let slopes = self.wheels.slopes(&momenta(state), input);
        let torque = -(self.wheels.axes * slopes);
        let rate = body.fixed_rows::<3>(0).into_owned();
        let gyroscopic = rate.cross(&self.wheels.momentum(state));
        let slope = self
            .body
            .derivative(time_s, &body, &torque, &(disturbance - gyroscopic));
        wheeled_state(&slope, &slopes)
    }

    fn project(&self, state: &mut WheeledState) {
        let mut body = body_state(state);
        self.body.project(&mut body);
        *state = wheeled_state(&body, &momenta(state));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::integrator::runge_kutta_step;
    use crate::sim::rigid_body_state::{attitude, body_rate, rigid_body_state};
    use runtime::attitude::Quaternion;

    fn inertia() -> Matrix3<f64> {
        Matrix3::new(350.0, 3.0, 4.0, 3.0, 270.0, 10.0, 4.0, 10.0, 190.0)
    }

    fn file() -> WheelsFile {
        WheelsFile {
            standstill_nms: 1e-3,
            ..WheelsFile::default()
        }
    }

    fn flown(wheels: Wheels, torque: Vector3<f64>, seconds: u32) -> WheeledState {
        let body = RigidBody::new(inertia()).unwrap();
        let plant = WheeledBody { body, wheels };
        let start = rigid_body_state(
            &Quaternion::from_euler_321(0.2, 0.1, -0.4),
            &Vector3::new(0.01, -0.02, 0.03),
        );
        let mut state = wheeled_state(&start, &wheels.initial);
        let none = [Vector3::zeros(); 3];
        for step in 0..seconds * 32 {
            let time = f64::from(step) / 32.0;
            state = runge_kutta_step(&plant, time, &state, 1.0 / 32.0, &torque, &none);
        }
        state
    }

    #[test]
    fn the_total_angular_momentum_is_conserved_in_inertial_axes() {
        let tilted = [[1.0, 0.2, 0.0], [0.0, 2.0, 0.3], [-0.4, 0.0, 1.0]];
        let wheels = WheelsFile {
            axes: Some(tilted.map(|axis| axis.map(|part| Finite::try_from(part).unwrap()))),
            initial_momentum_nms: [5.0, -3.0, 8.0],
            viscous_per_s: 1e-3,
            coulomb_nm: 2e-3,
            stiction_nm: Some(NonNegative::try_from(5e-3).unwrap()),
            ..file()
        };
        let wheels = wheels.check().unwrap();
        let total = |state: &WheeledState| {
            let body = body_state(state);
            let own = inertia() * body_rate(&body) + wheels.momentum(state);
            attitude(&body).direction_cosine_matrix().transpose() * own
        };
        let torque = Vector3::new(0.3, -0.2, 0.1);
        let (start, end) = (flown(wheels, torque, 0), flown(wheels, torque, 60));
        assert!((wheels.momentum(&end) - wheels.momentum(&start)).norm() > 5.0);
        assert!((total(&end) - total(&start)).norm() < 1e-7);
    }

    #[test]
    fn wheels_without_friction_give_the_torque_that_is_asked_for() {
        let wheels = file().check().unwrap();
        let state = wheeled_state(&RigidBodyState::zeros(), &Vector3::new(1.0, 2.0, 3.0));
        let torque = Vector3::new(0.1, 0.2, -0.3);
        assert!(wheels.further_torque(&state, &torque).amax() < 1e-16);
    }

    #[test]
    fn a_wheel_that_stands_swallows_a_torque_below_its_stiction() {
        let stiff = WheelsFile {
            coulomb_nm: 2e-3,
            stiction_nm: Some(NonNegative::try_from(5e-3).unwrap()),
            ..file()
        };
        let wheels = stiff.check().unwrap();
        let held = flown(wheels, Vector3::new(4e-3, 0.0, 0.0), 20);
        let torque = Vector3::new(4e-3, 0.0, 0.0);
        assert!((wheels.further_torque(&held, &torque) + torque).amax() < 1e-6);
        // A larger one breaks it loose, and then only the Coulomb friction is missing.
        let torque = Vector3::new(6e-3, 0.0, 0.0);
        let turning = flown(wheels, torque, 20);
        let missing = wheels.further_torque(&turning, &torque);
        assert!(
            (missing + Vector3::new(2e-3, 0.0, 0.0)).amax() < 1e-6,
            "{missing}"
        );
    }

    #[test]
    fn a_wheel_at_its_limit_gives_no_further_torque() {
        let limited = WheelsFile {
            momentum_limit_nms: Some(Positive::try_from(1.0).unwrap()),
            ..file()
        };
        let wheels = limited.check().unwrap();
        let torque = Vector3::new(-0.1, 0.0, 0.0);
        let full = flown(wheels, torque, 20);
        assert!((full[7] - 1.0).abs() < 0.1 / 32.0 + 1e-12);
        assert_eq!(wheels.further_torque(&full, &torque), -torque);
        // The other way round it works.
        assert!(wheels.further_torque(&full, &-torque).amax() < 1e-15);
    }
}
