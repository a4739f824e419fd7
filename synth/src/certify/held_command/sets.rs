//! What holds on the certified set x'Ux <= 1 and in the end.

use super::Assembly;
use crate::certify::certified_set::{self, attitudes_contained, final_bounds, states_contained};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

impl<S: Scalar> Assembly<'_, S> {
    /// r < phi: the set cannot be left.
    pub(super) fn supply(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let room = S::one() - self.reached.clone();
        emit("supply below the set".into(), Matrix::identity(1, room));
    }

    /// The set lies in the region in which the plant's model holds.
    pub(super) fn region(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        for bound in &self.plants[0].region {
            let inside = self.inside(&bound.bound_squared, &bound.rows);
            emit(format!("box {}", bound.name), inside);
        }
    }

    /// |theta F_s x| <= ubar_s on the set.
    pub(super) fn within_limit(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        for (input, limit) in self.plants[0].input_limit.iter().enumerate() {
            let row = self.gain.row(input).scaled(&self.theta);
            let squared = limit.clone() * limit.clone();
            let inside = self.inside(&squared, &row);
            emit(format!("command within limit {}", input + 1), inside);
        }
    }

    /// Every attitude at rest up to the claimed radius is a certified start.
    pub(super) fn certified_attitudes(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let radius = self.certificate.certified_vector_part;
        attitudes_contained(&self.lyapunov, &S::one(), radius, emit);
    }

    /// Every state that the model requires is a certified start.
    pub(super) fn must_contain(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let states = &self.model.file.specs.must_contain;
        states_contained(&self.lyapunov, &S::one(), states, emit);
    }

    /// The bounds in the end.
    pub(super) fn final_bounds(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let claims = &self.certificate.final_bounds;
        final_bounds(&self.lyapunov, &self.reached, claims, emit);
    }

    /// |rows x| <= bound wherever x'Ux <= 1.
    pub(super) fn inside(&self, bound_squared: &S, rows: &Matrix<S>) -> Matrix<S> {
        certified_set::inside(&self.lyapunov, bound_squared, rows, S::one())
    }
}
