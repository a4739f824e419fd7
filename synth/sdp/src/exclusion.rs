//! Infeasibility of any set of linear matrix inequalities, proved from dual weights.
//!
//! For `F0_k + sum_i y_i F_ik >= 0` (all k) and weights `Z_k >= 0`, every solution y satisfies
//! `0 <= sum_k <F0_k, Z_k> + sum_i y_i sum_k <F_ik, Z_k>`. With `c` above the first sum and `r_i` above the size of
//! each of the others, c < 0 excludes every y with `max |y_i| sum_i r_i < -c` (Farkas). The sums are taken in interval
//! arithmetic; that the weights are positive definite is proved as everywhere here.

use verified::definite::{prove_positive_definite, IntervalMatrix};
use verified::interval::Interval;
use verified::rounding::{add_up, div_down};

use crate::lmi::{svec_index, Entry, Semidefinite};

/// What the weights exclude.
#[derive(Debug, Clone, PartialEq)]
pub struct Exclusion {
    /// No y with all `|y_i|` below this satisfies the inequalities; infinite when no bound is needed, 0 when nothing
    /// is excluded.
    pub radius: f64,
    /// Upper bound of `sum_k <F0_k, Z_k>`.
    pub constant: f64,
    /// Upper bound of `sum_i |sum_k <F_ik, Z_k>|`.
    pub residual: f64,
    /// Name of a condition whose weight could not be proved semidefinite.
    pub indefinite: Option<String>,
}

/// Weights are raised by this much of their largest diagonal entry, so that those on the boundary can be proved.
const RAISE: f64 = 1e-14;

/// Checks weights, given as upper triangles by columns as in [`Solution::duals`](crate::solve::Solution::duals).
pub fn exclude(problem: &Semidefinite, weights: &[Vec<f64>]) -> Exclusion {
    let mut constant = Interval::ZERO;
    let mut products = vec![Interval::ZERO; problem.cost.len()];
    let mut indefinite = None;
    for (index, cone) in problem.cones.iter().enumerate() {
        let weight = weights
            .get(index)
            .filter(|weight| weight.len() == cone.height());
        let raised = weight.and_then(|weight| proved_weight(weight, cone.side));
        let Some(raised) = raised else {
            indefinite = Some(cone.name.clone());
            break;
        };
        constant += inner(&cone.constant, &raised);
        for (unknown, entries) in &cone.coefficients {
            products[*unknown] += inner(entries, &raised);
        }
    }
    let sizes = products.iter().map(|product| product.magnitude());
    let residual = sizes.fold(0.0, add_up);
    let constant = constant.hi();
    let excludes = indefinite.is_none() && constant < 0.0 && residual.is_finite();
    Exclusion {
        radius: match excludes {
            false => 0.0,
            true if residual == 0.0 => f64::INFINITY,
            true => div_down(-constant, residual),
        },
        constant,
        residual,
        indefinite,
    }
}

/// The weight, a little raised, when it is proved positive semidefinite. Rows of zeros take no part.
fn proved_weight(weight: &[f64], side: usize) -> Option<Vec<f64>> {
    if !weight.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let touched = |&row: &usize| (0..side).any(|other| weight[svec_index(row, other)] != 0.0);
    let rows: Vec<usize> = (0..side).filter(touched).collect();
    let mut raised = weight.to_vec();
    let largest = rows
        .iter()
        .map(|&row| weight[svec_index(row, row)])
        .fold(0.0, f64::max);
    for &row in &rows {
        raised[svec_index(row, row)] += RAISE * largest;
    }
    let entry = |i: usize, j: usize| Interval::from(raised[svec_index(rows[i], rows[j])]);
    let matrix = IntervalMatrix::from_upper(rows.len(), entry);
    let proved = rows.is_empty() || prove_positive_definite(&matrix).is_ok();
    proved.then_some(raised)
}

fn inner(entries: &[Entry], weight: &[f64]) -> Interval {
    entries.iter().fold(Interval::ZERO, |sum, entry| {
        let factor = Interval::from(entry.value) * Interval::from(entry.count());
        sum + factor * Interval::from(weight[svec_index(entry.row, entry.column)])
    })
}
