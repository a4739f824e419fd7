//! The rigid spacecraft.

pub mod check;
pub mod file;
pub mod gauge;
pub mod wheels;

use nalgebra::{Matrix3, Vector3};

use crate::sim::plant::Plant;
use crate::sim::rigid_body_state::RigidBodyState;

pub use check::RigidBodySystem;
pub use file::*;

/// Largest excess of a squared norm for which one Newton step restores it to rounding: the error is
/// 3/8 of its square.
const NEWTON_RANGE: f64 = 1e-8;

/// The rigid spacecraft, Xu and Huang 2020, (1) to (3): `J omega' = -omega x J omega + u + tau`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    inertia: Matrix3<f64>,
    inverse: Matrix3<f64>,
}

impl RigidBody {
    /// Body with the given inertia (kg m^2), symmetric positive definite; `None` when it cannot be
    /// inverted.
    pub fn new(inertia: Matrix3<f64>) -> Option<Self> {
        let inverse = inertia.try_inverse()?;
        Some(Self { inertia, inverse })
    }

    /// Inertia, kg m^2.
    pub fn inertia(&self) -> &Matrix3<f64> {
        &self.inertia
    }
}

impl Plant<7, 3, 3> for RigidBody {
    /// Written out in components: this is the innermost loop of every run.
    #[inline(always)]
    fn derivative(
        &self,
        _time_s: f64,
        state: &RigidBodyState,
        input: &Vector3<f64>,
        disturbance: &Vector3<f64>,
    ) -> RigidBodyState {
        let [[w1, w2, w3, q0, q1, q2, q3]] = state.data.0;
        let [h1, h2, h3] = product(&self.inertia, [w1, w2, w3]);
        let torque = [
            input.x + disturbance.x - (w2 * h3 - w3 * h2),
            input.y + disturbance.y - (w3 * h1 - w1 * h3),
            input.z + disturbance.z - (w1 * h2 - w2 * h1),
        ];
        let [a1, a2, a3] = product(&self.inverse, torque);
        RigidBodyState::from([
            a1,
            a2,
            a3,
            -0.5 * (q1 * w1 + q2 * w2 + q3 * w3),
            0.5 * (q0 * w1 + (q2 * w3 - q3 * w2)),
            0.5 * (q0 * w2 + (q3 * w1 - q1 * w3)),
            0.5 * (q0 * w3 + (q1 * w2 - q2 * w1)),
        ])
    }

    /// Restores the unit norm of the quaternion.
    #[inline(always)]
    fn project(&self, state: &mut RigidBodyState) {
        let square = (state[3] * state[3] + state[4] * state[4])
            + (state[5] * state[5] + state[6] * state[6]);
        // One step of Newton's method for 1 / sqrt, exact to rounding this close to 1.
        let excess = square - 1.0;
        let scale = if excess.abs() < NEWTON_RANGE {
            1.0 - 0.5 * excess
        } else {
            1.0 / square.sqrt()
        };
        for component in 3..7 {
            state[component] *= scale;
        }
    }
}

#[inline(always)]
fn product(matrix: &Matrix3<f64>, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [c1, c2, c3] = &matrix.data.0;
    std::array::from_fn(|row| c1[row] * x + c2[row] * y + c3[row] * z)
}

#[cfg(test)]
mod tests {
    use runtime::attitude::Quaternion;

    use super::*;
    use crate::sim::rigid_body_state::rigid_body_state;

    #[test]
    fn the_written_out_equations_are_those_of_the_attitude_algebra() {
        let inertia = Matrix3::new(350.0, 3.0, 4.0, 3.0, 270.0, 10.0, 4.0, 10.0, 190.0);
        let body = RigidBody::new(inertia).unwrap();
        let attitude = Quaternion::from_euler_321(0.4, -0.3, 1.2);
        let rate = Vector3::new(0.3, -0.5, 0.7);
        let (input, disturbance) = (Vector3::new(1.0, 2.0, -3.0), Vector3::new(0.1, 0.0, 0.2));
        let state = rigid_body_state(&attitude, &rate);
        let slope = body.derivative(0.0, &state, &input, &disturbance);
        let acceleration =
            inertia.try_inverse().unwrap() * (input + disturbance - rate.cross(&(inertia * rate)));
        let turn = attitude.derivative(&rate);
        let expected = rigid_body_state(&turn, &acceleration);
        assert!((slope - expected).amax() < 1e-15);
    }
}
