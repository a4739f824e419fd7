//! The exact sector form of the rigid spacecraft on a box.
//!
//! With x = [omega; q] and q0 = sqrt(1 - |q|^2), the plant
//!
//! ```text
//! J omega' = -omega^x J omega + sat(u) + tau,    q' = 1/2 (q0 I + q^x) omega
//! ```
//!
//! is x' = A(omega, q0) x + B (sat(u) + tau), because q^x omega = -omega^x q. A is affine in the
//! four scheduling variables (omega_1, omega_2, omega_3, q0), so on a box of them the plant is the
//! convex combination of the 16 corner systems: nothing is approximated.
//!
//! As omega^x omega = 0, the gyroscopic torque is -(omega^x J - K omega^x) omega for every 3 x 3 matrix K: the plant has
//! as many exact models, with the same box and the same number of vertices, and the conditions differ.
//!
//! Wheels and a moving reference add h^x omega with a bounded h ([`MomentumExchange`]): A is affine in (omega, q0, h)
//! jointly, so that the corners of the sets of both are the vertices.
//!
//! An inertia that is only known to lie in a box is kept on the left-hand side: `diag(J, I) x' =
//! [-omega^x J, 0; 1/2 q0 I, -1/2 omega^x] x + [I; 0] (sat(u) + tau)` is affine in each of J and (omega, q0)
//! while the other is fixed, so the corners of both boxes together are the vertices.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3, Vector4, Vector6};

use super::momentum::InertiaExtremes;
use super::{BoxCondition, InertiaUncertainty, MomentumExchange, TakagiSugeno};

/// Number of scheduling variables: omega_1, omega_2, omega_3, q0.
pub const SCHEDULING_VARIABLES: usize = 4;
/// Number of vertex systems (rules).
pub const SPACECRAFT_VERTICES: usize = 1 << SCHEDULING_VARIABLES;

/// A rigid spacecraft and the box on which its T-S model is stated.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactSpacecraft {
    /// Inertia J [kg m^2], symmetric positive definite.
    pub inertia: Matrix3<f64>,
    /// How far the true inertia may be from it.
    pub inertia_uncertainty: InertiaUncertainty,
    /// Torque limit of each axis [N m].
    pub torque_limit: Vector3<f64>,
    /// Bound on the Euclidean norm of the disturbance torque [N m].
    pub disturbance_bound: f64,
    /// Bound on |omega_i| [rad/s].
    pub rate_bound: Vector3<f64>,
    /// Smallest scalar part q0 of the box, in (0, 1].
    pub scalar_part_min: f64,
    /// K of the gyroscopic torque's form [kg m^2]; not chosen yet when `None`, and 0 where a number is needed.
    pub gyroscopic_form: Option<Matrix3<f64>>,
    /// The output is y = diag(these) x.
    pub output_weights: [f64; 6],
    /// Wheels, a moving reference, rounded torques.
    pub exchange: MomentumExchange,
    /// The vertices are those at omega = 0 alone: see [`ExactSpacecraft::at_rest`].
    pub at_rest: bool,
}

/// The skew matrix v^x with v^x w = v x w.
pub(crate) fn skew(v: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0)
}

impl ExactSpacecraft {
    /// The scheduling variables (omega [rad/s], q0) at a vertex. Bit k of the vertex index set
    /// means that variable k is at its upper bound.
    pub fn corner(&self, vertex: usize) -> Vector4<f64> {
        let bound = &self.rate_bound;
        let low = Vector4::new(-bound[0], -bound[1], -bound[2], self.scalar_part_min);
        let high = Vector4::new(bound[0], bound[1], bound[2], 1.0);
        Vector4::from_fn(|k, _| {
            if vertex >> k & 1 == 1 {
                high[k]
            } else {
                low[k]
            }
        })
    }

    /// A(omega, q0), 6 x 6, for rates in rad/s, the nominal inertia and no further momentum.
    pub fn state_matrix(&self, scheduling: &Vector4<f64>) -> DMatrix<f64> {
        self.state_matrix_for(&self.inertia, scheduling, &Vector3::zeros())
    }

    /// diag(J0, I)^-1 [-omega^x J + K omega^x + h^x, 0; 1/2 q0 I, -1/2 omega^x] for the nominal J0 and any J and h.
    fn state_matrix_for(
        &self,
        inertia: &Matrix3<f64>,
        scheduling: &Vector4<f64>,
        momentum: &Vector3<f64>,
    ) -> DMatrix<f64> {
        let spin = skew(&scheduling.fixed_rows::<3>(0).into_owned());
        let form = self.gyroscopic_form.unwrap_or_else(Matrix3::zeros);
        let gyroscopic = form * spin - spin * inertia + skew(momentum);
        let mut a = DMatrix::zeros(6, 6);
        a.view_mut((0, 0), (3, 3))
            .copy_from(&(self.inverse_inertia() * gyroscopic));
        a.view_mut((3, 0), (3, 3))
            .copy_from(&(Matrix3::identity() * (0.5 * scheduling[3])));
        a.view_mut((3, 3), (3, 3)).copy_from(&(-0.5 * spin));
        a
    }

    /// Membership of each vertex at (omega [rad/s], q0): the product of the four interval weights.
    /// They are non-negative and sum to one on the box.
    pub fn memberships(&self, scheduling: &Vector4<f64>) -> [f64; SPACECRAFT_VERTICES] {
        let (low, high) = (self.corner(0), self.corner(SPACECRAFT_VERTICES - 1));
        let upper = Vector4::from_fn(|k, _| {
            let width = high[k] - low[k];
            // A box of zero width has one value; either end describes it.
            if width > 0.0 {
                (scheduling[k] - low[k]) / width
            } else {
                1.0
            }
        });
        std::array::from_fn(|vertex| {
            (0..SCHEDULING_VARIABLES)
                .map(|k| {
                    if vertex >> k & 1 == 1 {
                        upper[k]
                    } else {
                        1.0 - upper[k]
                    }
                })
                .product()
        })
    }

    /// The nonlinear right-hand side x' at x = [omega [rad/s]; q] for a torque [N m] that already
    /// includes the disturbance.
    pub fn right_hand_side(&self, state: &Vector6<f64>, torque: &Vector3<f64>) -> Vector6<f64> {
        let rate = state.fixed_rows::<3>(0).into_owned();
        let vector_part = state.fixed_rows::<3>(3).into_owned();
        let scalar_part = (1.0 - vector_part.norm_squared()).max(0.0).sqrt();
        let acceleration = self.inverse_inertia() * (torque - rate.cross(&(self.inertia * rate)));
        let kinematics = 0.5 * (scalar_part * rate + vector_part.cross(&rate));
        let mut out = Vector6::zeros();
        out.fixed_rows_mut::<3>(0).copy_from(&acceleration);
        out.fixed_rows_mut::<3>(3).copy_from(&kinematics);
        out
    }

    /// The same spacecraft with exactly the nominal inertia.
    pub fn nominal(&self) -> Self {
        ExactSpacecraft {
            inertia_uncertainty: InertiaUncertainty::default(),
            ..self.clone()
        }
    }

    /// The (omega, q0) of the vertices: the corners of the box, or the two of them at omega = 0.
    pub(crate) fn corners(&self) -> Vec<Vector4<f64>> {
        let all = (0..SPACECRAFT_VERTICES).map(|vertex| self.corner(vertex));
        match self.at_rest {
            false => all.collect(),
            true => [self.scalar_part_min, 1.0]
                .map(|scalar_part| Vector4::new(0.0, 0.0, 0.0, scalar_part))
                .to_vec(),
        }
    }

    /// The T-S model: for each vertex of the inertia's set and each corner of the set of momenta 16 vertices (the box runs
    /// fastest), output y = W x. With an uncertain inertia the equation of motion is multiplied by the nominal inertia's
    /// inverse only.
    pub fn takagi_sugeno(&self) -> TakagiSugeno {
        let mut input = DMatrix::zeros(6, 3);
        input
            .view_mut((0, 0), (3, 3))
            .copy_from(&self.inverse_inertia());
        let inertias = self.inertia_uncertainty.vertices(&self.inertia);
        let extremes = InertiaExtremes::of(&inertias);
        let momenta = self.exchange.corners(&extremes);
        let certain = inertias.len() == 1;
        let corners = self.corners();
        let mut vertices = Vec::with_capacity(inertias.len() * momenta.len() * corners.len());
        let mut descriptors = Vec::new();
        for (inertia, momentum) in pairs(&inertias, &momenta) {
            for corner in &corners {
                vertices.push(self.state_matrix_for(inertia, corner, momentum));
                if !certain {
                    descriptors.push(self.descriptor_for(inertia));
                }
            }
        }
        TakagiSugeno {
            vertices,
            descriptors,
            disturbance: input.clone(),
            input,
            output: DMatrix::from_diagonal(&DVector::from_column_slice(&self.output_weights)),
            input_limit: DVector::from_column_slice(self.torque_limit.as_slice()),
            disturbance_bound: self.disturbance_bound + self.exchange.further_torque(&extremes),
            region: self.region(),
        }
    }

    /// |omega_i| <= bound on each axis, and |q| <= sqrt(1 - q0min^2).
    fn region(&self) -> Vec<BoxCondition> {
        let identity = DMatrix::<f64>::identity(6, 6);
        let rates = (0..3).map(|axis| BoxCondition {
            name: format!("rate axis {}", axis + 1),
            rows: identity.rows(axis, 1).into_owned(),
            bound_squared: self.rate_bound[axis] * self.rate_bound[axis],
        });
        let attitude = BoxCondition {
            name: "attitude".to_string(),
            rows: identity.rows(3, 3).into_owned(),
            bound_squared: 1.0 - self.scalar_part_min * self.scalar_part_min,
        };
        rates.chain([attitude]).collect()
    }

    /// diag(J0^-1 J, I) for the nominal J0 and any J.
    fn descriptor_for(&self, inertia: &Matrix3<f64>) -> DMatrix<f64> {
        let mut out = DMatrix::identity(6, 6);
        out.view_mut((0, 0), (3, 3))
            .copy_from(&(self.inverse_inertia() * inertia));
        out
    }

    /// The same spacecraft with the vertices at omega = 0 alone. Conditions that are affine in omega and hold at both ends
    /// of the box hold there, where K plays no part: a proof that no design exists for these vertices covers every K.
    pub fn at_rest(&self) -> Self {
        ExactSpacecraft {
            at_rest: true,
            ..self.clone()
        }
    }

    fn inverse_inertia(&self) -> Matrix3<f64> {
        // The inertia was checked to be positive definite when the model was read.
        self.inertia.try_inverse().unwrap_or_else(Matrix3::zeros)
    }
}

/// Every element of one list with every element of another, which runs fastest.
pub(crate) fn pairs<'a, A, B>(
    first: &'a [A],
    second: &'a [B],
) -> impl Iterator<Item = (&'a A, &'a B)> {
    first
        .iter()
        .flat_map(move |a| second.iter().map(move |b| (a, b)))
}
