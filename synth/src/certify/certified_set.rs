//! What a certificate states about a set x'Ux <= level: what it lies in, what it contains, and where its states end.

use crate::certify::certificate::FinalBounds;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// `[ factor U, rows' ; *, unit I ]`: |rows x|^2 <= factor unit x'Ux.
pub fn inside<S: Scalar>(lyapunov: &Matrix<S>, factor: &S, rows: &Matrix<S>, unit: S) -> Matrix<S> {
    let corner = Matrix::identity(rows.nrows(), unit);
    let upper = [&lyapunov.scaled(factor), &rows.transposed()];
    Matrix::symmetric(&[&upper, &[&corner]])
}

/// x0'U x0 < level for each of the states.
pub fn states_contained<S: Scalar>(
    lyapunov: &Matrix<S>,
    level: &S,
    states: &[Vec<f64>],
    emit: &mut (impl FnMut(String, Matrix<S>) + ?Sized),
) {
    for (index, state) in states.iter().enumerate() {
        let state = Matrix::from_fn(state.len(), 1, |r, _| S::from_f64(state[r]));
        let value = state.transposed().times(lyapunov).times(&state);
        let room = level.clone() - value.at(0, 0).clone();
        let name = format!("must contain state {}", index + 1);
        emit(name, Matrix::identity(1, room));
    }
}

/// s^2 U_qq < level I: every attitude at rest with |q| <= s is in the set. For spacecraft.
pub fn attitudes_contained<S: Scalar>(
    lyapunov: &Matrix<S>,
    level: &S,
    vector_part: f64,
    emit: &mut (impl FnMut(String, Matrix<S>) + ?Sized),
) {
    let radius = S::from_f64(vector_part);
    let attitude = lyapunov
        .block(3, 3, 3, 3)
        .scaled(&(radius.clone() * radius));
    let room = Matrix::identity(3, level.clone()).minus(&attitude);
    emit("certified attitudes".into(), room);
}

/// s^2 U > level P'P: where x'Ux <= level, |P x| <= s. P is the rate or the vector part. For spacecraft.
pub fn final_bounds<S: Scalar>(
    lyapunov: &Matrix<S>,
    level: &S,
    claims: &FinalBounds,
    emit: &mut (impl FnMut(String, Matrix<S>) + ?Sized),
) {
    let parts = [
        ("rate", 0, claims.rate),
        ("attitude", 3, claims.vector_part),
    ];
    for (name, first, claim) in parts {
        let claim = S::from_f64(claim);
        let own = first..first + 3;
        let reached = Matrix::from_fn(6, 6, |r, c| match r == c && own.contains(&r) {
            true => level.clone(),
            false => S::zero(),
        });
        let room = lyapunov.scaled(&(claim.clone() * claim)).minus(&reached);
        emit(format!("final {name} bound"), room);
    }
}
