//! Certificates that there is no solution.

use super::iterate::{positive_definite, Factors};
use super::layout::Layout;
use super::system::System;

/// The unknowns' size (in balanced units, sum of absolute values) below which a ray must exclude every solution.
const EXCLUDED_SIZE: f64 = 1e9;

/// Corrections of a ray.
const CORRECTIONS: usize = 3;

/// From a point's multipliers, a ray that proves the inequalities infeasible: Z > 0 with `<constant, Z> = -1` and
/// every `<A_i, Z>` zero to rounding. For any y, `<constant + A(y), Z> <= -1 + sum |y_i <A_i, Z>|`: with residuals below
/// 1/r no solution with `sum |y_i| <= r` exists. `None` when this Z is not such a ray, nor near one.
pub fn dual(
    layout: &Layout,
    system: &System,
    factors: &Factors,
    z: &[f64],
    threads: usize,
) -> Option<Vec<f64>> {
    let mut ray = z.to_vec();
    let mut residual = vec![0.0; layout.cost.len()];
    let mut shift = vec![0.0; layout.cost.len()];
    let mut matrix = vec![0.0; layout.length];
    let mut correction = vec![0.0; layout.length];
    for _ in 0..CORRECTIONS {
        // The nearest point of <A_i, Z> = 0, in the metric of the direction.
        layout.adjoint(&ray, threads, &mut residual);
        system.solve(&residual, &mut shift);
        layout.evaluate(0.0, &shift, threads, &mut matrix);
        factors.sandwich(layout, z, &matrix, threads, &mut correction);
        ray.iter_mut().zip(&correction).for_each(|(z, c)| *z -= c);
        if let Some(ray) = accepted(layout, &ray) {
            return Some(ray);
        }
    }
    None
}

/// A ray from multipliers that need no correction.
pub fn accepted(layout: &Layout, z: &[f64]) -> Option<Vec<f64>> {
    let strength = -layout.against_constant(z);
    let mut residual = vec![0.0; layout.cost.len()];
    layout.adjoint(z, 1, &mut residual);
    let error: f64 = residual.iter().map(|r| r.abs()).sum();
    let proves =
        strength > 0.0 && error * EXCLUDED_SIZE <= strength && positive_definite(layout, z);
    proves.then(|| z.iter().map(|entry| entry / strength).collect())
}

/// From a point's unknowns, a ray along which the objective falls for ever: `A(y) >= 0` to rounding and `c'y = -1`.
pub fn primal(layout: &Layout, y: &[f64]) -> Option<Vec<f64>> {
    let fall = -super::dense::dot(&layout.cost, y);
    if !(fall > 0.0 && fall.is_finite()) {
        return None;
    }
    let ray: Vec<f64> = y.iter().map(|value| value / fall).collect();
    let mut matrix = vec![0.0; layout.length];
    layout.evaluate(0.0, &ray, 1, &mut matrix);
    layout.add_identity(1.0 / EXCLUDED_SIZE, &mut matrix);
    positive_definite(layout, &matrix).then_some(ray)
}
