//! Infeasibility of Theorem 2, proved.
//!
//! The conditions of Theorem 2 (Xu & Huang, corrected, constant gain, not strict, without margin)
//! are matrices `G_k(y) >= 0`, affine in the unknowns y. Positive semidefinite weights `Z_k` with
//! `sum_k <G_k(y), Z_k> = constant < 0` for every y show that no y satisfies all of them.
//!
//! The weights of (18) are given as second moments of its coordinates: x, v = eps1 x + eps2 x' +
//! eps3 x(t_k^l), x(t_k^l), the held state w, tau and, for r = 2, the integral's coordinate s. Only
//! the blocks that occur in (18) are given; they form the cliques of a chordal pattern, and clique
//! matrices that are all positive definite are blocks of one positive definite matrix (R. Grone,
//! C. R. Johnson, E. M. Sa, H. Wolkowicz, Linear Algebra Appl. 58 (1984) 109-124). The moments of
//! (x, v) are the sum of one weight for each vertex.
//!
//! What the equalities determine is not given but computed from the rest, in [`balance`]: the sum
//! then does not depend on y at all, whatever the rounding. Where that is impossible (eps3 = 0) one
//! residual remains, and the proof covers multipliers whose entries stay within a bound.
//!
//! With given gains F_j the conditions hold for every vertex with every gain, and there are unknowns of
//! the dead zone p as well, Nh_j and S: their moments are a further clique {p, v, w} for each gain. Weights
//! may leave gains and vertices out; what cannot hold for some cannot hold for all.
//!
//! Nothing here comes from a solver but the numbers of [`Weights`], and any numbers will do for
//! which the matrices are positive definite and the constant is negative.

pub mod balance;
mod end;
mod scope;

pub use balance::Level;
pub use scope::{limits, Limit};

use nalgebra::DMatrix;

use self::balance::{for_each_statement, Balance};
use super::interval::Interval;
use super::rounding::{div_down, mul_up, next_down};
use super::{judge, ConditionMargin};
use crate::conditions::GainPlan;
use crate::model::{Mismatch, Model};

/// Weight of (18) at one vertex: second moments of (x, v), 2n x 2n, symmetric.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexWeight {
    /// Index of the vertex, from 0.
    pub vertex: usize,
    /// The moments.
    pub moments: DMatrix<f64>,
}

/// Moments with the held state w = x(t_k).
#[derive(Debug, Clone, PartialEq)]
pub struct HeldMoments {
    /// E[v w'], n x n.
    pub multiplied_held: DMatrix<f64>,
    /// E[x(t_k^l) w'], n x n.
    pub sample_held: DMatrix<f64>,
    /// E[w w'], n x n, symmetric.
    pub held: DMatrix<f64>,
}

/// Moments with the dead zone p, for given gains.
#[derive(Debug, Clone, PartialEq)]
pub struct DeadZoneMoments {
    /// E[v p'], n x m.
    pub multiplied: DMatrix<f64>,
    /// E[w p'], n x m.
    pub held: DMatrix<f64>,
    /// E[p p'], m x m, symmetric.
    pub own: DMatrix<f64>,
}

/// Weights of (18) at one end of the sampling interval. n states, m inputs, d disturbances.
#[derive(Debug, Clone, PartialEq)]
pub struct Moments {
    /// One weight for each vertex that matters; those left out have weight 0.
    pub vertices: Vec<VertexWeight>,
    /// E[x x(t_k^l)'], n x n.
    pub state_sample: DMatrix<f64>,
    /// E[v x(t_k^l)'], n x n; `None` when the balance of the multiplier determines it (r = 2 of the first
    /// gain only).
    pub multiplied_sample: Option<DMatrix<f64>>,
    /// E[x(t_k^l) x(t_k^l)'], n x n, symmetric.
    pub sample: DMatrix<f64>,
    /// E[v tau'], n x d.
    pub multiplied_disturbance: DMatrix<f64>,
    /// E[tau tau'], d x d, symmetric.
    pub disturbance: DMatrix<f64>,
    /// Moments with the held state; `None` stands for w = x(t_k^l) (no trigger error).
    pub held: Option<HeldMoments>,
    /// Moments with the dead zone; `None` exactly where the gain is free.
    pub dead_zone: Option<DeadZoneMoments>,
}

/// Moments of the integral's coordinate s with the states, r = 2.
#[derive(Debug, Clone, PartialEq)]
pub struct IntegralCross {
    /// E[x s'], n x n.
    pub state: DMatrix<f64>,
    /// E[x(t_k^l) s'], n x n.
    pub sample: DMatrix<f64>,
}

/// Weight of one condition (19): `[ state, *; *, unit ]`.
#[derive(Debug, Clone, PartialEq)]
pub struct InputWeight {
    /// n x n, symmetric.
    pub state: DMatrix<f64>,
    /// The corner.
    pub unit: f64,
}

/// Weight of one condition of the region, with k rows: `[ state, cross; *, unit ]`.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionWeight {
    /// n x n, symmetric.
    pub state: DMatrix<f64>,
    /// n x k.
    pub cross: DMatrix<f64>,
    /// k x k, symmetric.
    pub unit: DMatrix<f64>,
}

/// Weights of the conditions of one gain.
#[derive(Debug, Clone, PartialEq)]
pub struct GainWeights {
    /// Which of the given gains, from 0; 0 where the gain is free.
    pub gain: usize,
    /// Weights of (18), r = 1.
    pub start: Moments,
    /// Weights of (18), r = 2.
    pub end: Moments,
    /// E[s s'], n x n, symmetric: the integral's coordinate in r = 2.
    pub integral: DMatrix<f64>,
    /// Its moments with the states; `None` exactly for the first gain, where the balance of L1h and L2h
    /// determines them.
    pub integral_cross: Option<IntegralCross>,
    /// Weights of (19), one for each input.
    pub inputs: Vec<InputWeight>,
}

/// Weights that show that no design exists, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// The given gains F_j, m x n, that no design has; empty: no constant gain has one.
    pub given: Vec<DMatrix<f64>>,
    /// The weight rho of the containment condition; above 0. Without effect when the model has no
    /// states that must be contained.
    pub containment_weight: f64,
    /// Weights of the conditions of each gain that matters: at least one, and exactly one where the gain is
    /// free.
    pub gains: Vec<GainWeights>,
    /// Weights of the region's conditions, in their order.
    pub region: Vec<RegionWeight>,
    /// Weights of the containment conditions, n x n, symmetric, one for each state; empty where the rest is
    /// refuted already, which covers every rho.
    pub must_contain: Vec<DMatrix<f64>>,
}

impl Weights {
    /// True when the model's conditions hold for rule i of the plant with gain i, not for every vertex
    /// with every gain.
    pub fn is_matched(&self, model: &Model) -> bool {
        matches!(model.file.mismatch, Mismatch::Kappa(_))
            && self.given.len() > 1
            && model.plant.membership_count() == Some(self.given.len())
    }

    /// Every weight belongs to a condition that there is, and the parts that are determined or without
    /// meaning are left out.
    fn fits(&self, model: &Model) -> bool {
        let free = self.given.is_empty();
        // Weights about a free gain say nothing about scheduled ones.
        let constant = model.task().gains == GainPlan::constant();
        let matched = self.is_matched(model);
        let known = |part: &GainWeights| match free {
            true => part.gain == 0,
            false => part.gain < self.given.len(),
        };
        let pairs = |part: &GainWeights| {
            let mut vertices = part.start.vertices.iter().chain(&part.end.vertices);
            !matched || vertices.all(|weight| weight.vertex == part.gain)
        };
        let dead_zone = |part: &GainWeights| {
            let ends = [&part.start, &part.end];
            ends.iter().all(|end| end.dead_zone.is_none() == free)
        };
        let count = self.gains.len();
        count > 0
            && (!free || (count == 1 && constant))
            && self.gains.iter().enumerate().all(|(index, part)| {
                let first = index == 0;
                let given = part.end.multiplied_sample.is_some();
                let determinable = first && (free || part.end.held.is_some());
                known(part)
                    && pairs(part)
                    && dead_zone(part)
                    && part.integral_cross.is_none() == first
                    && part.start.multiplied_sample.is_some()
                    && (given || determinable)
            })
    }
}

/// The outcome of the check of [`Weights`].
#[derive(Debug, Clone, PartialEq)]
pub struct Refutation {
    /// No design exists (with [`Refutation::bound`]).
    pub proved: bool,
    /// The weights that must be positive definite.
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

/// Checks that the weights show that no design exists for the model, with k2 = 1, which covers every xi, or else
/// with the k2 of xi_max.
pub fn refute(model: &Model, weights: &Weights) -> Refutation {
    let first = refute_at(model, weights, Level::One);
    if first.proved {
        return first;
    }
    let second = refute_at(model, weights, Level::AtLargestWeight);
    match second.proved {
        true => second,
        false => first,
    }
}

fn refute_at(model: &Model, weights: &Weights, level: Level) -> Refutation {
    let mut conditions = Vec::new();
    if !weights.fits(model) {
        return Refutation {
            proved: false,
            conditions,
            constant: f64::INFINITY,
            level,
            bound: 0.0,
        };
    }
    let mut definite = true;
    let balance = for_each_statement::<Interval>(model, weights, level, |statement| {
        let (proved, margin) = judge(&statement);
        definite &= proved;
        conditions.push(ConditionMargin {
            name: statement.name,
            margin,
        });
    });
    let bound = match definite {
        true => covered(&balance),
        false => 0.0,
    };
    Refutation {
        proved: bound > 0.0,
        conditions,
        constant: balance.constant.hi(),
        level,
        bound,
    }
}

/// The largest R with `constant + 2 R sum |residual| < 0`, 0 when there is none.
fn covered(balance: &Balance<Interval>) -> f64 {
    let constant = balance.constant.hi();
    // Not a number compares as false.
    if !(constant < 0.0 && balance.constant.is_bounded()) {
        return 0.0;
    }
    let Some(residual) = &balance.residual else {
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
