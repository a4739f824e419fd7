//! Quadratic stabilisation with a decay rate: one quadratic function and one state feedback for every
//! plant in the hull.
//!
//! J. Bernussou, P. L. D. Peres, J. C. Geromel, "A linear programming oriented procedure for quadratic
//! stabilization of uncertain systems", Systems & Control Letters 13 (1989) 65-72; S. Boyd, L. El Ghaoui,
//! E. Feron, V. Balakrishnan, "Linear Matrix Inequalities in System and Control Theory", SIAM 1994,
//! section 7.2.

use nalgebra::DMatrix;

use super::state_feedback::{DesignProblem, Proof, StateFeedback, Transformed, Units, VertexPlant};
use sdp::lmi::{Affine, Condition, Strictness};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// `|x(t)| <= c e^(-alpha t) |x(0)|` for every A(t) in the hull, with the smallest c that the method
/// gives.
#[derive(Debug, Clone, PartialEq)]
pub struct QuadraticStabilisation {
    /// alpha [1/s], 0 or above.
    pub decay_rate: f64,
}

/// Relative allowance in the claimed c and in P > I, so that the check can prove them.
const CLAIM_ALLOWANCE: f64 = 1e-5;

impl DesignProblem for QuadraticStabilisation {
    const NAME: &'static str = "quadratic_stabilisation";
    const GUARANTEE: &'static str = "overshoot c: |x(t)| <= c e^(-alpha t) |x(0)|";

    fn units(&self, plant: &VertexPlant) -> Units {
        Units::of(plant, 1.0)
    }

    fn decay_rate(&self) -> f64 {
        self.decay_rate
    }

    fn in_units(&self, units: &Units) -> Self {
        QuadraticStabilisation {
            decay_rate: self.decay_rate * units.time,
        }
    }

    /// `I <= Q <= kappa I` and `A_i Q + Q A_i' + B Y + Y'B' + 2 alpha Q < 0`; kappa = c^2 is minimised.
    fn conditions(
        &self,
        plant: &VertexPlant,
        transformed: &Transformed,
        strictness: &Strictness,
    ) -> Vec<Condition> {
        let n = plant.states();
        let q = &transformed.inverse;
        let kappa = transformed.objective.times_matrix(&DMatrix::identity(n, n));
        let mut out = vec![
            strictness.positive("inverse above identity", q - &Affine::identity(n, 1.0)),
            Condition::semidefinite("inverse bounded", &kappa - q),
        ];
        for (index, a) in plant.vertices.iter().enumerate() {
            let decay = transformed.decay(a, &plant.input, &transformed.gain, self.decay_rate);
            out.push(strictness.positive(format!("decay vertex {}", index + 1), -decay));
        }
        out
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
    fn claim(&self, found: &mut StateFeedback, _objective: f64, _units: &Units) {
        let eigenvalues = found.lyapunov.symmetric_eigenvalues();
        let (smallest, largest) = (eigenvalues.min(), eigenvalues.max());
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
