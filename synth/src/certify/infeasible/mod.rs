//! Infeasibility of Theorem 2, proved.
//!
//! The conditions of Theorem 2 (Xu & Huang, corrected, constant gain, not strict, without margin)
//! are matrices `G_k(y) >= 0`, affine in the unknowns y. Positive semidefinite dual multipliers `Z_k` with
//! `sum_k <G_k(y), Z_k> = constant < 0` for every y show that no y satisfies all of them.
//!
//! Those of (18) are given as second moments of its coordinates: x, v = eps1 x + eps2 x' +
//! eps3 x(t_k^l), x(t_k^l), the held state w, tau and, for r = 2, the integral's coordinate s. Only
//! the blocks that occur in (18) are given; they form the cliques of a chordal pattern, and clique
//! matrices that are all positive definite are blocks of one positive definite matrix (R. Grone,
//! C. R. Johnson, E. M. Sa, H. Wolkowicz, Linear Algebra Appl. 58 (1984) 109-124). The moments of
//! (x, v) are the sum of one multiplier for each vertex.
//!
//! What the equalities determine is not given but computed from the rest, in [`stationarity`]: the sum
//! then does not depend on y at all, whatever the rounding. Where that is impossible (eps3 = 0) one
//! residual remains, and the proof covers multipliers whose entries stay within a bound.
//!
//! With given gains F_j the conditions hold for every vertex with every gain, and there are unknowns of
//! the dead zone p as well, Nh_j and S: their moments are a further clique {p, v, w} for each gain. Dual multipliers
//! may leave gains and vertices out; what cannot hold for some cannot hold for all.
//!
//! Nothing here comes from a solver but the numbers of [`DualMultipliers`], and any numbers suffice for
//! which the matrices are positive definite and the constant is negative.

mod moments;
mod multipliers;
mod scope;
pub mod stationarity;

pub(crate) use multipliers::{check_length, missing};
pub use multipliers::{
    DeadZoneMoments, DualMultipliers, GainDuals, HeldMoments, InputDual, Moments, RegionDual,
    VertexDual,
};
pub use scope::{limits, Limit};
pub use stationarity::Level;

use self::stationarity::{for_each_statement, Stationarity};
use super::{decide_all, judge, ConditionMargin, ExactReport};
use crate::model::Model;
use verified::exact::Exact;
use verified::interval::Interval;
use verified::matrix::Matrix;
use verified::rounding::{div_down, mul_up, next_down};
use verified::scalar::Scalar;

/// The outcome of the check of [`DualMultipliers`].
#[derive(Debug, Clone, PartialEq)]
pub struct Refutation {
    /// No design exists (with [`Refutation::bound`]).
    pub proved: bool,
    /// The dual multipliers that must be positive definite.
    pub conditions: Vec<ConditionMargin>,
    /// Upper bound of `sum_k <F0_k, Z_k>`; it must be negative.
    pub constant: f64,
    /// Which level k2 the statement is about.
    pub level: Level,
    /// No design exists whose multiplier Qh (SI units) has all entries within this bound: the
    /// largest double when no bound is needed, 0 when nothing is proved.
    pub bound: f64,
}

impl Refutation {
    /// True when the proof needs no bound on the unknowns.
    pub fn unbounded(&self) -> bool {
        self.bound == f64::MAX
    }
}

/// Checks that the dual multipliers show that no design exists for the model, with k2 = 1, which covers every xi, or else
/// with the k2 of xi_max.
pub fn refute(model: &Model, weights: &DualMultipliers) -> Refutation {
    let first = refute_at(model, weights, Level::One);
    if first.proved || model.file.specs.xi_max.is_infinite() {
        return first;
    }
    let second = refute_at(model, weights, Level::AtLargestWeight);
    match second.proved {
        true => second,
        false => first,
    }
}

fn refute_at(model: &Model, weights: &DualMultipliers, level: Level) -> Refutation {
    let mut conditions = Vec::new();
    if !(weights.fits(model) && model.is_refuted_by_ideal_loop()) {
        return Refutation {
            proved: false,
            conditions,
            constant: f64::INFINITY,
            level,
            bound: 0.0,
        };
    }
    let mut definite = true;
    let stationarity = for_each_statement::<Interval>(model, weights, level, |statement| {
        let (proved, margin) = judge(&statement);
        definite &= proved;
        conditions.push(ConditionMargin {
            name: statement.name,
            margin,
        });
    });
    let bound = match definite {
        true => covered(&stationarity),
        false => 0.0,
    };
    Refutation {
        proved: bound > 0.0,
        conditions,
        constant: stationarity.constant.hi(),
        level,
        bound,
    }
}

/// Decides exactly what [`refute`] proved: every matrix, and that the sum is negative for all entries of Qh within its
/// bound. The last statement is named `sum of the conditions`.
pub fn refute_exactly(model: &Model, weights: &DualMultipliers, found: &Refutation) -> ExactReport {
    decide_all(|emit| {
        if !(weights.fits(model) && model.is_refuted_by_ideal_loop()) {
            return emit(SUM.to_string(), Matrix::identity(1, -Exact::one()));
        }
        let sum = for_each_statement::<Exact>(model, weights, found.level, |statement| {
            emit(statement.name, statement.matrix);
        });
        let Stationarity { constant, residual } = sum;
        let twice = Exact::from_f64(found.bound) * Exact::from_f64(2.0);
        let places = residual.iter().flat_map(Matrix::entries);
        let largest = places.fold(constant, |sum, entry| {
            let entry = entry.clone();
            sum + twice.clone() * entry.clone().max(-entry)
        });
        emit(SUM.to_string(), Matrix::identity(1, -largest));
    })
}

/// Name of the statement that the weighted sum of the conditions is negative.
const SUM: &str = "sum of the conditions";

/// The largest R with `constant + 2 R sum |residual| < 0`, 0 when there is none.
fn covered(stationarity: &Stationarity<Interval>) -> f64 {
    let constant = stationarity.constant.hi();
    // Not a number compares as false.
    if !(constant < 0.0 && stationarity.constant.is_bounded()) {
        return 0.0;
    }
    let Some(residual) = &stationarity.residual else {
        return f64::MAX;
    };
    let sum = residual.magnitude_sum();
    if sum == 0.0 {
        return f64::MAX;
    }
    // Strictly below: half of what would make the sum vanish is lost at most in the last digit.
    let bound = next_down(div_down(-constant, mul_up(2.0, sum)));
    match bound.is_finite() && bound > 0.0 {
        true => bound,
        false => 0.0,
    }
}
