//! From the set of starts to a smaller set: at a sample, with the command that is held then.

use super::Assembly;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

impl<S: Scalar> Assembly<'_, S> {
    /// The set x'Ux <= rho' is reached, lies in the last set, and a command decided upon in it is one of the last set.
    pub(super) fn hands_over_to(
        &self,
        last: &Assembly<S>,
        level: f64,
        emit: &mut dyn FnMut(String, Matrix<S>),
    ) {
        let level = S::from_f64(level);
        let reached = level.clone() - self.reached.clone();
        let single = |value: S| Matrix::identity(1, value);
        emit("hand-over level reached".into(), single(reached));
        let contained = self.lyapunov.minus(&last.lyapunov.scaled(&level));
        emit("hand-over set contained".into(), contained);
        // Every decision leaves |u| <= (1 + al) |F x| + ga, and theta |u_s| has to stay within the limit.
        let spread = S::one() + self.relative.clone();
        for (input, limit) in last.plants[0].input_limit.iter().enumerate() {
            let largest = limit.clone() / last.theta.clone() - self.absolute.clone();
            let name = format!("held command within limit {}", input + 1);
            emit(
                format!("{name}, room for the state's part"),
                single(largest.clone()),
            );
            let bound = largest / spread.clone();
            let squared = bound.clone() * bound / level.clone();
            emit(name, self.inside(&squared, &self.gain));
        }
    }
}
