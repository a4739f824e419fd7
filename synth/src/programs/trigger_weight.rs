//! The trigger weight where nu = 0.
//!
//! With nu = 0 the trigger sends every sample that differs from the held state, so e = 0, and (18) without the rows of e
//! is what remains. In the rows (rest, e) the whole of (18) is `[R, C; C', -W] < 0`: it holds exactly when R < 0 and
//! `W > C' (-R)^-1 C`, so that any weight above all of these serves, and nothing is lost by leaving e out of the
//! program.

use nalgebra::DMatrix;

use crate::conditions::xu2020::{terms_at, Basis, DesignUnknowns, SamplingEnd, Signal};
use crate::conditions::Task;
use sdp::lmi::Affine;

/// Factor above the smallest weight.
const ABOVE: f64 = 2.0;

/// Share of the mean eigenvalue that is added in every direction, where the gain sees nothing.
const SHARE: f64 = 1e-3;

/// Wh for the values of the other unknowns; `None` where (18) does not hold without the rows of e.
pub(crate) fn sufficient(
    task: &Task,
    unknowns: &DesignUnknowns,
    values: &[f64],
) -> Option<DMatrix<f64>> {
    let whole = Task {
        held_is_sample: false,
        ..task.clone()
    };
    let n = task.system.states();
    let mut weight = DMatrix::zeros(n, n);
    for rule in 0..unknowns.gain_count() {
        let at_rule = unknowns.with_rule(rule);
        for &end in SamplingEnd::of(task) {
            let basis = Basis::published(&whole, end, &at_rule);
            for vertex in 0..task.system.vertices.len() {
                let terms = terms_at(&whole, end, &at_rule, vertex);
                let form = basis.form(&terms).value(values);
                weight = above(weight, &needed(&basis, &form)?);
            }
        }
    }
    let mean = weight.trace() / n as f64;
    Some(ABOVE * weight + DMatrix::identity(n, n) * (SHARE * mean))
}

/// `C' (-R)^-1 C` of one matrix.
fn needed(basis: &Basis, form: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let error = basis.map(Signal::Error);
    let others = basis.signals().iter().copied();
    let others: Vec<Signal> = others.filter(|signal| *signal != Signal::Error).collect();
    let rest = basis.selected(&others);
    let negative = -(&rest * form * rest.transpose());
    let cross = &rest * form * error.transpose();
    let factor = negative.cholesky()?;
    Some(cross.transpose() * factor.solve(&cross))
}

/// A matrix above both.
fn above(weight: DMatrix<f64>, needed: &DMatrix<f64>) -> DMatrix<f64> {
    let excess = needed - &weight;
    let eigen = (0.5 * (&excess + excess.transpose())).symmetric_eigen();
    let positive = eigen.eigenvalues.map(|value| value.max(0.0));
    let vectors = &eigen.eigenvectors;
    weight + vectors * DMatrix::from_diagonal(&positive) * vectors.transpose()
}

/// The unknowns with a weight that suffices.
pub(crate) fn with_weight(
    task: &Task,
    unknowns: &DesignUnknowns,
    values: &[f64],
) -> Option<DesignUnknowns> {
    let mut out = unknowns.clone();
    if task.held_is_sample {
        out.trigger_weight = Affine::constant(&sufficient(task, unknowns, values)?);
    }
    Some(out)
}
