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

/// Largest excess of a squared norm for which one Newton step restores it to rounding: the error is
/// 3/8 of its square.
const NEWTON_RANGE: f64 = 1e-8;

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
    /// By the memberships of the design's model at the plant's state.
    Model,
}

/// A Takagi-Sugeno plant x' = sum_i zeta_i(t) A_i x + B u + B_w tau of at most `N` states, `M` inputs
/// and `N` disturbances. A smaller plant is padded with zeros, which changes none of its numbers.
#[derive(Clone, Debug)]
pub struct TakagiSugenoPlant<const N: usize, const M: usize> {
    vertices: Vec<SMatrix<f64, N, N>>,
    input: SMatrix<f64, N, M>,
    disturbance: SMatrix<f64, N, N>,
    mixing: Mixing,
    rules: Option<synth::fuzzy::RuleModel>,
}

impl<const N: usize, const M: usize> TakagiSugenoPlant<N, M> {
    /// The padded plant of a checked vertex system, which must not be larger than `N` and `M`. `rules`:
    /// the memberships for [`Mixing::Model`], one for each vertex.
    pub fn new(
        system: &synth::fuzzy::VertexSystem,
        mixing: Mixing,
        rules: Option<synth::fuzzy::RuleModel>,
    ) -> Self {
        let vertices = system.state_matrices.iter();
        Self {
            vertices: vertices.map(super::padding::matrix).collect(),
            input: super::padding::matrix(&system.input_matrix),
            disturbance: super::padding::matrix(&system.disturbance_matrix),
            mixing,
            rules,
        }
    }

    fn blend(&self, weights: &[f64], state: &SVector<f64, N>) -> SVector<f64, N> {
        let parts = self.vertices.iter().zip(weights);
        parts.fold(SVector::zeros(), |sum, (vertex, &weight)| {
            sum + vertex * state * weight
        })
    }

    fn drift(&self, time_s: f64, state: &SVector<f64, N>) -> SVector<f64, N> {
        match &self.mixing {
            Mixing::Constant(weights) => self.blend(weights, state),
            Mixing::Model => match &self.rules {
                Some(rules) => self.blend(&rules.memberships(state.as_slice()), state),
                None => SVector::zeros(),
            },
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

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn a_cycle_visits_each_vertex_and_comes_back() {
        let vertex = |rate: f64| nalgebra::DMatrix::from_element(1, 1, rate);
        let system = synth::fuzzy::VertexSystem {
            state_matrices: vec![vertex(1.0), vertex(2.0), vertex(4.0)],
            input_matrix: vertex(1.0),
            disturbance_matrix: vertex(1.0),
            output_matrix: vertex(1.0),
            input_limit: nalgebra::DVector::from_element(1, 1.0),
            disturbance_bound: 0.0,
            box_rows: nalgebra::DMatrix::zeros(0, 1),
            box_bounds: nalgebra::DVector::zeros(0),
        };
        let plant = TakagiSugenoPlant::<2, 1>::new(&system, Mixing::Cycle { dwell_s: 10.0 }, None);
        let one = SVector::from([1.0, 0.0]);
        let cases = [
            (0.0, 1.0),
            (5.0, 1.5),
            (10.0, 2.0),
            (20.0, 4.0),
            (25.0, 2.5),
            (30.0, 1.0),
        ];
        for (time, slope) in cases {
            assert!(
                (plant.drift(time, &one).x - slope).abs() < 1e-12,
                "at {time} s"
            );
        }
    }
}
