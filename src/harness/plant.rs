//! Plants: what a controller is tried on.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use runtime::attitude::Quaternion;

/// A plant of `N` states, `M` inputs and `D` disturbances.
pub trait Plant<const N: usize, const M: usize, const D: usize> {
    /// Time derivative of the state at `time_s` seconds.
    fn derivative(
        &self,
        time_s: f64,
        state: &SVector<f64, N>,
        input: &SVector<f64, M>,
        disturbance: &SVector<f64, D>,
    ) -> SVector<f64, N>;

    /// Puts a state back on the plant's state space after an integration step.
    fn project(&self, state: &mut SVector<f64, N>);
}

/// State of the rigid body: body rate (rad/s), then the attitude quaternion, scalar part first.
pub type RigidBodyState = SVector<f64, 7>;

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

/// State of a body at an attitude and a body rate (rad/s).
pub fn rigid_body_state(attitude: &Quaternion, rate: &Vector3<f64>) -> RigidBodyState {
    let [q0, q1, q2, q3] = attitude.to_scalar_first();
    RigidBodyState::from([rate.x, rate.y, rate.z, q0, q1, q2, q3])
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

impl Plant<7, 3, 3> for RigidBody {
    #[inline(always)]
    fn derivative(
        &self,
        _time_s: f64,
        state: &RigidBodyState,
        input: &Vector3<f64>,
        disturbance: &Vector3<f64>,
    ) -> RigidBodyState {
        let rate = body_rate(state);
        let torque = input + disturbance - rate.cross(&(self.inertia * rate));
        let acceleration = self.inverse * torque;
        let turn = attitude(state).derivative(&rate);
        RigidBodyState::from([
            acceleration.x,
            acceleration.y,
            acceleration.z,
            turn.scalar,
            turn.vector.x,
            turn.vector.y,
            turn.vector.z,
        ])
    }

    /// Restores the unit norm of the quaternion.
    #[inline(always)]
    fn project(&self, state: &mut RigidBodyState) {
        let square = (state[3] * state[3] + state[4] * state[4])
            + (state[5] * state[5] + state[6] * state[6]);
        let scale = 1.0 / square.sqrt();
        for component in 3..7 {
            state[component] *= scale;
        }
    }
}

/// How the vertex systems of a Takagi-Sugeno plant are weighted in time.
#[derive(Clone, Debug, PartialEq)]
pub enum Mixing {
    /// Constant weights, not negative, with sum 1.
    Constant(Vec<f64>),
    /// From each vertex to the next and from the last back to the first, linearly, `dwell_s` seconds
    /// each.
    Cycle {
        /// Time from one vertex to the next, s.
        dwell_s: f64,
    },
}

/// A Takagi-Sugeno plant x' = sum_i zeta_i(t) A_i x + B u + B_w tau of at most `N` states, `M` inputs
/// and `N` disturbances. A smaller plant is padded with zeros, which changes none of its numbers.
#[derive(Clone, Debug)]
pub struct TakagiSugenoPlant<const N: usize, const M: usize> {
    vertices: Vec<SMatrix<f64, N, N>>,
    input: SMatrix<f64, N, M>,
    disturbance: SMatrix<f64, N, N>,
    mixing: Mixing,
}

impl<const N: usize, const M: usize> TakagiSugenoPlant<N, M> {
    /// The padded plant of a checked vertex system, which must not be larger than `N` and `M`.
    pub fn new(system: &synth::fuzzy::VertexSystem, mixing: Mixing) -> Self {
        let vertices = system.state_matrices.iter();
        Self {
            vertices: vertices.map(super::padding::matrix).collect(),
            input: super::padding::matrix(&system.input_matrix),
            disturbance: super::padding::matrix(&system.disturbance_matrix),
            mixing,
        }
    }

    fn drift(&self, time_s: f64, state: &SVector<f64, N>) -> SVector<f64, N> {
        match &self.mixing {
            Mixing::Constant(weights) => {
                let parts = self.vertices.iter().zip(weights);
                parts.fold(SVector::zeros(), |sum, (vertex, &weight)| {
                    sum + vertex * state * weight
                })
            }
            Mixing::Cycle { dwell_s } => {
                let place = time_s / dwell_s;
                let fraction = place - place.floor();
                let count = self.vertices.len();
                let from = (place.floor() % count as f64) as usize % count;
                let to = (from + 1) % count;
                (self.vertices[from] * (1.0 - fraction) + self.vertices[to] * fraction) * state
            }
        }
    }
}

impl<const N: usize, const M: usize> Plant<N, M, N> for TakagiSugenoPlant<N, M> {
    fn derivative(
        &self,
        time_s: f64,
        state: &SVector<f64, N>,
        input: &SVector<f64, M>,
        disturbance: &SVector<f64, N>,
    ) -> SVector<f64, N> {
        self.drift(time_s, state) + self.input * input + self.disturbance * disturbance
    }

    fn project(&self, _state: &mut SVector<f64, N>) {}
}
