//! What holds on the certified set x'Ux <= 1 and in the end.

use super::Assembly;
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

    /// s^2 U_qq < I: every attitude at rest with |q| <= s is a certified start.
    pub(super) fn certified_attitudes(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let radius = S::from_f64(self.certificate.certified_vector_part);
        let square = radius.clone() * radius;
        let attitude = self.lyapunov.block(3, 3, 3, 3).scaled(&square);
        let room = Matrix::identity(3, S::one()).minus(&attitude);
        emit("certified attitudes".into(), room);
    }

    /// x0'U x0 < 1 for every state that the model requires.
    pub(super) fn must_contain(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let states = self.model.file.specs.must_contain.iter().enumerate();
        for (index, state) in states {
            let state = Matrix::from_fn(state.len(), 1, |r, _| S::from_f64(state[r]));
            let value = state.transposed().times(&self.lyapunov).times(&state);
            let room = S::one() - value.at(0, 0).clone();
            let name = format!("must contain state {}", index + 1);
            emit(name, Matrix::identity(1, room));
        }
    }

    /// s^2 U > r/phi P'P: in the end |P x| <= s, for the rate and for the vector part.
    pub(super) fn final_bounds(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let claims = &self.certificate.final_bounds;
        let parts = [
            ("rate", 0, claims.rate),
            ("attitude", 3, claims.vector_part),
        ];
        for (name, first, claim) in parts {
            let claim = S::from_f64(claim);
            let scaled = self.lyapunov.scaled(&(claim.clone() * claim));
            let reached = Matrix::from_fn(6, 6, |r, c| {
                match r == c && (first..first + 3).contains(&r) {
                    true => self.reached.clone(),
                    false => S::zero(),
                }
            });
            emit(format!("final {name} bound"), scaled.minus(&reached));
        }
    }

    /// `[ bound^2 U, rows' ; *, I ]`: |rows x| <= bound wherever x'Ux <= 1.
    pub(super) fn inside(&self, bound_squared: &S, rows: &Matrix<S>) -> Matrix<S> {
        let corner = Matrix::identity(rows.nrows(), S::one());
        let upper = [&self.lyapunov.scaled(bound_squared), &rows.transposed()];
        Matrix::symmetric(&[&upper, &[&corner]])
    }
}
