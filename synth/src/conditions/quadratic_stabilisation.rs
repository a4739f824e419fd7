//! Quadratic stabilisation with a decay rate: one quadratic function and one state feedback for every
//! plant in the hull.
//!
//! J. Bernussou, P. L. D. Peres, J. C. Geromel, "A linear programming oriented procedure for quadratic
//! stabilization of uncertain systems", Systems & Control Letters 13 (1989) 65-72; S. Boyd, L. El Ghaoui,
//! E. Feron, V. Balakrishnan, "Linear Matrix Inequalities in System and Control Theory", SIAM 1994,
//! section 7.2.

use nalgebra::{DMatrix, DVector};

use super::state_feedback::{
    DesignProblem, Inequality, Proof, StateFeedback, Transformed, VertexPlant,
};
use super::units::{power_of_two, Sizes, Units};
use crate::riccati::{positive, symmetric};
use sdp::lmi::Affine;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// `|x(t)| <= c e^(-alpha t) |x(0)|` for every A(t) in the hull, with the smallest c that the method
/// gives.
#[derive(Debug, Clone, PartialEq)]
pub struct QuadraticStabilisation {
    /// alpha [1/s], 0 or above.
    pub decay_rate: f64,
    /// d of the norm |x| with |x|^2 = sum_k d_k x_k^2, n numbers above 0: 1 in the file's units.
    pub norm: DVector<f64>,
    /// The unit of kappa = c^2: 1 in the file's units.
    pub kappa_unit: f64,
}

impl QuadraticStabilisation {
    /// With the Euclidean norm of n states.
    pub fn new(decay_rate: f64, states: usize) -> Self {
        QuadraticStabilisation {
            decay_rate,
            norm: DVector::from_element(states, 1.0),
            kappa_unit: 1.0,
        }
    }
}

/// Relative allowance in the claimed c and in P > I, so that the check can prove them.
const CLAIM_ALLOWANCE: f64 = 1e-5;

/// Part of its diagonal that a decay condition keeps where the feedback is completed.
const FINSLER_ROOM: f64 = 1e-10;

impl DesignProblem for QuadraticStabilisation {
    const NAME: &'static str = "quadratic_stabilisation";
    const OBJECTIVE: &'static str = "c^2";
    const GUARANTEE: &'static str = "overshoot c: |x(t)| <= c e^(-alpha t) |x(0)|";

    /// The smallest state unit is 1: `Q >= I` in the file's units.
    fn units(&self, plant: &VertexPlant, sizes: &Sizes) -> Units {
        let sizes = sizes.clone().times(1.0 / sizes.state.min());
        let units = Units::of(plant, &sizes);
        let spread = (units.state.max() / units.state.min()).powi(2);
        let objective = power_of_two(sizes.objective.unwrap_or(spread));
        Units { objective, ..units }
    }

    fn decay_rate(&self) -> f64 {
        self.decay_rate
    }

    fn in_units(&self, units: &Units) -> Self {
        let squares = units.state.component_mul(&units.state);
        QuadraticStabilisation {
            decay_rate: self.decay_rate * units.time,
            norm: self.norm.component_mul(&squares),
            kappa_unit: self.kappa_unit * units.objective,
        }
    }

    /// With N = diag(d)^-1 of the norm: `N <= Q <= kappa N` and `A_i Q + Q A_i' + B Y + Y'B' + 2 alpha Q < 0`;
    /// kappa = c^2 is minimised.
    fn conditions(&self, plant: &VertexPlant, transformed: &Transformed) -> Vec<Inequality> {
        let q = &transformed.inverse;
        let smallest = Affine::constant(&DMatrix::from_diagonal(&self.norm.map(|d| 1.0 / d)));
        // As kappa I >= N^(-1/2) Q N^(-1/2), in units of kappa.
        let root = DMatrix::from_diagonal(&self.norm.map(|d| (d / self.kappa_unit).sqrt()));
        let n = plant.states();
        let kappa = transformed.objective.times_matrix(&DMatrix::identity(n, n));
        let mut out = vec![
            Inequality::strict("inverse above identity", q - &smallest),
            Inequality::weak("inverse bounded", &kappa - &q.congruence(&root)),
        ];
        for (index, a) in plant.vertices.iter().enumerate() {
            let decay = transformed.decay(a, &plant.input, &transformed.gain, self.decay_rate);
            let decay = match &transformed.unreached {
                Some(basis) if basis.ncols() == 0 => continue,
                Some(basis) => decay.congruence(basis),
                None => decay,
            };
            out.push(Inequality::strict(
                format!("decay vertex {}", index + 1),
                -decay,
            ));
        }
        out
    }

    /// By Finsler's lemma: where N'(A_i Q + Q A_i' + 2 alpha Q)N < 0 for a basis N of the vectors with N'B = 0, the
    /// conditions hold with Y = -sigma B'/2 for every sigma that is large enough, the same for all vertices.
    const ELIMINATES_GAIN: bool = true;

    fn completed(&self, plant: &VertexPlant, inverse: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let drift = plant.vertices.iter().map(|a| {
            let drift = a * inverse;
            -(&drift + drift.transpose()) - inverse * (2.0 * self.decay_rate)
        });
        let drift: Vec<DMatrix<f64>> = drift.collect();
        let gram = &plant.input * plant.input.transpose();
        let holds = |sigma: f64| {
            drift.iter().all(|drift| {
                let decay = drift + sigma * &gram;
                let room = DMatrix::from_diagonal(&(FINSLER_ROOM * decay.diagonal()));
                positive(&(decay - room))
            })
        };
        let sigmas = (-5..=30).map(|k| 4_f64.powi(k));
        let sigma = std::iter::once(0.0)
            .chain(sigmas)
            .find(|&sigma| holds(sigma))?;
        Some(plant.input.transpose() * (-2.0 * sigma))
    }

    fn guarantee_of(objective: f64) -> f64 {
        objective.sqrt()
    }

    fn objective_of(guarantee: f64) -> f64 {
        guarantee * guarantee
    }

    /// `sum_i (Z_i (A_i + B F) + (A_i + B F)' Z_i + 2 alpha Z_i)`. Its product with any Q > 0 is
    /// `sum_i <Z_i, (A_i + B F) Q + Q (A_i + B F)' + 2 alpha Q>`: positive if it is positive definite, negative if Q
    /// satisfies the strict decay conditions and some Z_i is not zero.
    fn refutation<S: Scalar>(&self, plant: &VertexPlant, z: &[DMatrix<f64>]) -> Option<Matrix<S>> {
        let gain = Matrix::<S>::exactly(plant.gain.as_ref()?);
        let fed_back = Matrix::exactly(&plant.input).times(&gain);
        let rate = S::from_f64(self.decay_rate);
        let twice = rate.clone() + rate;
        let zero = Matrix::zeros(plant.states(), plant.states());
        let pairs = plant.vertices.iter().zip(z);
        Some(pairs.fold(zero, |sum, (vertex, z)| {
            let z = Matrix::exactly(z);
            let closed = Matrix::exactly(vertex).plus(&fed_back);
            let decay = z.times(&closed).symmetrised();
            sum.plus(&decay).plus(&z.scaled(&twice))
        }))
    }

    /// P is scaled to `I < P < c^2 I`.
    fn claim(&self, found: &mut StateFeedback, _objective: f64) {
        let largest = found.lyapunov.symmetric_eigenvalues().max();
        // The smallest one through the inverse, which has more digits where they are far apart.
        let inverse = found.lyapunov.clone().try_inverse();
        let smallest = inverse.map_or(f64::NAN, |q| {
            1.0 / symmetric(&q).symmetric_eigenvalues().max()
        });
        found.lyapunov *= (1.0 + CLAIM_ALLOWANCE) / smallest;
        found.guarantee = (largest / smallest).sqrt() * (1.0 + CLAIM_ALLOWANCE);
    }

    fn statements<S: Scalar>(&self, proof: &Proof<S>, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let rate = S::from_f64(self.decay_rate);
        for (index, a) in proof.vertices.iter().enumerate() {
            let decay = proof.decay(a, &proof.gain, &rate);
            emit(format!("decay vertex {}", index + 1), decay);
        }
        let p = &proof.lyapunov;
        let identity = |value| Matrix::identity(p.nrows(), value);
        emit(
            "lyapunov above identity".into(),
            p.minus(&identity(S::one())),
        );
        let square = proof.guarantee.clone() * proof.guarantee.clone();
        emit("overshoot".into(), identity(square).minus(p));
    }

    fn assumptions(&self) -> Vec<String> {
        vec!["inputs without limits".to_string()]
    }
}
