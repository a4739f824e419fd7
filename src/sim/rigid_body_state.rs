//! The state of the rigid body.

use nalgebra::{SVector, Vector3};
use runtime::attitude::Quaternion;

/// State of the rigid body: body rate (rad/s), then the attitude quaternion, scalar part first.
pub type RigidBodyState = SVector<f64, 7>;

/// State of a body at an attitude and a body rate (rad/s).
pub fn rigid_body_state(attitude: &Quaternion, rate: &Vector3<f64>) -> RigidBodyState {
    let [q0, q1, q2, q3] = attitude.to_scalar_first();
    RigidBodyState::from([rate.x, rate.y, rate.z, q0, q1, q2, q3])
}

/// The rigid body's part of a state that begins with it.
#[inline(always)]
pub fn body_state<const N: usize>(state: &SVector<f64, N>) -> RigidBodyState {
    const { assert!(N >= 7, "a rigid body has seven states") };
    RigidBodyState::from_fn(|row, _| state[row])
}

/// Attitude of a rigid-body state.
#[inline]
pub fn attitude(state: &RigidBodyState) -> Quaternion {
    Quaternion::new(state[3], Vector3::new(state[4], state[5], state[6]))
}

/// Body rate of a rigid-body state, rad/s.
#[inline]
pub fn body_rate(state: &RigidBodyState) -> Vector3<f64> {
    Vector3::new(state[0], state[1], state[2])
}
