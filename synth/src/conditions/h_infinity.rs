//! H-infinity state feedback: the smallest L2 gain from a disturbance to an output.
//!
//! The bounded real lemma with Q = P^-1, Y = F Q: P. Gahinet, P. Apkarian, "A linear matrix inequality
//! approach to H-infinity control", Int. J. Robust and Nonlinear Control 4 (1994) 421-448; Boyd et al.,
//! "Linear Matrix Inequalities in System and Control Theory", SIAM 1994, section 7.5.

use nalgebra::DMatrix;

use super::state_feedback::{
    power_of_two, DesignProblem, Proof, StateFeedback, Transformed, Units, VertexPlant,
};
use sdp::lmi::{Affine, Condition, Strictness, SymmetricBlocks};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// `x' = A(t) x + B u + B_w w`, `z = C x + D u + D_w w`: the L2 norm of z is below gamma times that of w,
/// from rest, for every A(t) in the hull.
#[derive(Debug, Clone, PartialEq)]
pub struct HInfinity {
    /// B_w, n x d.
    pub disturbance: DMatrix<f64>,
    /// C, p x n.
    pub output: DMatrix<f64>,
    /// D, p x m.
    pub input_to_output: DMatrix<f64>,
    /// D_w, p x d.
    pub disturbance_to_output: DMatrix<f64>,
}

impl DesignProblem for HInfinity {
    const NAME: &'static str = "h_infinity";
    const GUARANTEE: &'static str = "gamma: |z| < gamma |w| in L2, from rest";

    fn units(&self, plant: &VertexPlant) -> Units {
        let units = Units::of(plant, 1.0);
        Units {
            disturbance: power_of_two(1.0 / (units.time * self.disturbance.norm())),
            output: power_of_two(self.output.norm()),
            ..units
        }
    }

    /// The first diagonal block of the bounded real lemma asks for no rate.
    fn decay_rate(&self) -> f64 {
        0.0
    }

    fn in_units(&self, units: &Units) -> Self {
        let inputs = DMatrix::from_diagonal(&units.input);
        let disturbance = units.disturbance;
        HInfinity {
            disturbance: &self.disturbance * (units.time * disturbance / units.state),
            output: &self.output * (units.state / units.output),
            input_to_output: &self.input_to_output * inputs / units.output,
            disturbance_to_output: &self.disturbance_to_output * (disturbance / units.output),
        }
    }

    /// `Q > 0` and
    ///
    /// ```text
    /// [ A_i Q + Q A_i' + B Y + Y'B',  B_w,       (C Q + D Y)' ]
    /// [ *                             -gamma I,  D_w'         ]  <  0.
    /// [ *                             *          -gamma I     ]
    /// ```
    fn conditions(
        &self,
        plant: &VertexPlant,
        transformed: &Transformed,
        strictness: &Strictness,
    ) -> Vec<Condition> {
        let (d, p) = (self.disturbance.ncols(), self.output.nrows());
        let gamma = |side| {
            transformed
                .objective
                .times_matrix(&DMatrix::identity(side, side))
        };
        let q = &transformed.inverse;
        let output = &self.output * q + &self.input_to_output * &transformed.gain;
        let mut out = vec![strictness.positive("inverse positive", q.clone())];
        for (index, a) in plant.vertices.iter().enumerate() {
            let decay = transformed.decay(a, &plant.input, &transformed.gain, 0.0);
            let driven = Affine::constant(&self.disturbance);
            let direct = Affine::constant(&self.disturbance_to_output.transpose());
            let lhs = SymmetricBlocks::of(&[
                &[&decay, &driven, &output.transposed()],
                &[&-gamma(d), &direct],
                &[&-gamma(p)],
            ]);
            let name = format!("bounded real vertex {}", index + 1);
            out.push(strictness.positive(name, -lhs));
        }
        out
    }

    /// In other units dV/dt <= gamma |w|^2 - |z|^2 / gamma holds for another multiple of V.
    fn claim(&self, found: &mut StateFeedback, objective: f64, units: &Units) {
        found.lyapunov *= units.time * units.disturbance * units.output;
        found.guarantee = objective * (units.output / units.disturbance);
    }

    fn statements<S: Scalar>(&self, proof: &Proof<S>, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let exactly = |matrix: &DMatrix<f64>| Matrix::<S>::exactly(matrix);
        let (d, p) = (self.disturbance.ncols(), self.output.nrows());
        let feedthrough = exactly(&self.input_to_output).times(&proof.gain);
        let output = exactly(&self.output).plus(&feedthrough);
        let gamma = |side| Matrix::identity(side, proof.guarantee.clone());
        emit("lyapunov positive".into(), proof.lyapunov.clone());
        for (index, a) in proof.vertices.iter().enumerate() {
            let driven = proof.lyapunov.times(&exactly(&self.disturbance));
            let direct = exactly(&self.disturbance_to_output.transpose());
            let (seen, decay) = (output.transposed(), proof.decay(a, &proof.gain, &S::zero()));
            let matrix = Matrix::symmetric(&[
                &[&decay, &driven.negated(), &seen.negated()],
                &[&gamma(d), &direct.negated()],
                &[&gamma(p)],
            ]);
            emit(format!("bounded real vertex {}", index + 1), matrix);
        }
    }

    fn assumptions(&self) -> Vec<String> {
        vec![
            "inputs without limits".to_string(),
            "a disturbance of finite energy".to_string(),
        ]
    }
}
