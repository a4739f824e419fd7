//! The designs that an infeasibility proof does not cover.
//!
//! Dual multipliers that prove "no design" may be about some designs only. What a statement does not cover is part of
//! the statement: only one without a [`Limit`] states that no design exists.

use std::fmt;

use super::{DualMultipliers, Level, Refutation};
use crate::certify::signals::{bounded, reached_level};
use crate::claim::Claim;
use crate::model::Model;
use verified::interval::Interval;

/// A multiplier's bound must exceed what solvers return by this factor before it counts as none.
const BOUND_FACTOR: f64 = 1e6;

/// Designs that a refutation does not cover.
#[derive(Debug, Clone, PartialEq)]
pub enum Limit {
    /// The containment condition was refuted for these weights rho only; a design may have any rho > 0.
    ContainmentWeights(Vec<f64>),
    /// The level k2 = max(1, xi taubar^2 / phi) was taken at xi_max, where it is above 1; a design has its own xi
    /// and may have a lower level.
    LevelAtLargestWeight {
        /// xi_max.
        xi_max: f64,
        /// k2 there, rounded up.
        level: f64,
    },
    /// Multipliers with larger entries are not covered.
    MultiplierEntries {
        /// The bound R on the entries of Qh (SI units).
        bound: f64,
        /// The largest such entry that a solver returned for the model or its relaxation; infinite where none
        /// did.
        largest_returned: f64,
    },
}

/// The part of the designs that is covered, as the end of a sentence about them.
impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Limit::ContainmentWeights(weights) => {
                let list: Vec<String> = weights.iter().map(f64::to_string).collect();
                let list = list.join(", ");
                write!(f, "with the containment weight rho = {list} (no other rho is covered)")
            }
            Limit::LevelAtLargestWeight { xi_max, level } => write!(
                f,
                "with the level k2 = {:.5} of xi_max = {xi_max} (a smaller xi may have a lower level)",
                Claim::AtMost(*level)
            ),
            Limit::MultiplierEntries {
                bound,
                largest_returned,
            } => write!(
                f,
                "with multiplier entries up to R = {:.4} (SI units; solvers returned entries up to \
                 {largest_returned:.3e})",
                Claim::AtLeast(*bound)
            ),
        }
    }
}

/// The designs that proved sets of dual multipliers, one for each rho, do not cover. `largest_returned` is evaluated
/// only where a bound on the multiplier is left.
pub fn limits<E>(
    model: &Model,
    sets: &[DualMultipliers],
    refutations: &[Refutation],
    largest_returned: impl FnOnce() -> Result<f64, E>,
) -> Result<Vec<Limit>, E> {
    let mut out = Vec::new();
    let contains = !model.file.specs.must_contain.is_empty();
    if contains && sets.iter().all(|set| !set.must_contain.is_empty()) {
        let weights = sets.iter().map(|set| set.containment_weight);
        out.push(Limit::ContainmentWeights(weights.collect()));
    }
    let level = level_at_largest_weight(model);
    let own = refutations
        .iter()
        .all(|refutation| refutation.level == Level::One);
    // Not a number is no level of 1.
    if !own && (level.is_nan() || level > 1.0) {
        out.push(Limit::LevelAtLargestWeight {
            xi_max: model.file.specs.xi_max,
            level,
        });
    }
    let bounds = refutations.iter().map(|refutation| refutation.bound);
    let bound = bounds.fold(f64::MAX, f64::min);
    if bound < f64::MAX {
        let largest_returned = largest_returned()?;
        let beyond = bound >= BOUND_FACTOR * largest_returned;
        if !beyond {
            out.push(Limit::MultiplierEntries {
                bound,
                largest_returned,
            });
        }
    }
    Ok(out)
}

/// xi_max taubar^2 / phi, rounded up.
fn level_at_largest_weight(model: &Model) -> f64 {
    let specs = &model.file.specs;
    let weight = |_: &_| Interval::from(specs.xi_max);
    let reached = reached_level(&bounded(model), weight, &Interval::from(specs.phi_per_s));
    reached.hi()
}
