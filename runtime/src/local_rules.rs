//! Memberships of local rules: "IF x_1 is about this AND x_4 is about that, THEN ...".
//!
//! The weight of a rule is the product of the grades of its fuzzy sets, divided by the sum over all
//! rules (zeta in (8) of Xu and Huang 2020).

use nalgebra::SVector;

use crate::error::{AllowedRange, Element, Field, ParameterError};
use crate::membership::Membership;

pub use crate::membership::normalise;

/// A fuzzy set over one state; numbers in that state's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FuzzySet {
    /// Every value belongs fully: the state is no premise of the rule.
    Any,
    /// No value belongs: the rule is never used.
    Never,
    /// 0 up to `left`, linear to 1 at `peak`, linear to 0 at `right`; `left <= peak <= right` and not
    /// all equal. An end that equals the peak is a step.
    Triangular {
        /// Where the grade begins to rise.
        left: f64,
        /// Where it is 1.
        peak: f64,
        /// Where it is 0 again.
        right: f64,
    },
    /// 0 up to `left`, linear to 1 at `left_top`, 1 up to `right_top`, linear to 0 at `right`; in this
    /// order, and `left < right`.
    Trapezoidal {
        /// Where the grade begins to rise.
        left: f64,
        /// Where it is first 1.
        left_top: f64,
        /// Where it is last 1.
        right_top: f64,
        /// Where it is 0 again.
        right: f64,
    },
    /// `exp(-((x - centre) / width)^2 / 2)`.
    Gaussian {
        /// Where the grade is 1.
        centre: f64,
        /// Standard deviation, above 0.
        width: f64,
    },
}

impl FuzzySet {
    /// True when the numbers are finite and in order.
    pub fn is_valid(&self) -> bool {
        let ordered = |points: &[f64]| {
            let finite = points.iter().all(|point| point.is_finite());
            let rising = points.iter().zip(points.iter().skip(1));
            finite && rising.into_iter().all(|(a, b)| a <= b) && points.first() < points.last()
        };
        match (*self, self.corners()) {
            (_, Some(corners)) => ordered(&corners),
            (FuzzySet::Gaussian { centre, width }, _) => {
                centre.is_finite() && width.is_finite() && width > 0.0
            }
            _ => true,
        }
    }

    /// Where the grade leaves 0, reaches 1, leaves 1 and reaches 0, of a set with straight sides.
    fn corners(&self) -> Option<[f64; 4]> {
        match *self {
            FuzzySet::Triangular { left, peak, right } => Some([left, peak, peak, right]),
            FuzzySet::Trapezoidal {
                left,
                left_top,
                right_top,
                right,
            } => Some([left, left_top, right_top, right]),
            _ => None,
        }
    }

    /// What an invalid set is refused with.
    fn refusal(&self, field: Field) -> ParameterError {
        if let FuzzySet::Gaussian { width, .. } = *self {
            return ParameterError::OutOfRange {
                field,
                value: width,
                allowed: AllowedRange::POSITIVE,
            };
        }
        let everything = [f64::NEG_INFINITY, 0.0, 0.0, f64::INFINITY];
        let [lower, .., upper] = self.corners().unwrap_or(everything);
        ParameterError::EmptyInterval {
            field,
            lower,
            upper,
        }
    }

    /// The grade of a value as `factor exp(-exponent)`, `0 <= factor <= 1`, `exponent >= 0`. A sum of
    /// exponents stays meaningful where the product of the grades underflows.
    pub fn grade(&self, value: f64) -> (f64, f64) {
        match (*self, self.corners()) {
            (_, Some(corners)) => (trapezoid(value, corners), 0.0),
            (FuzzySet::Gaussian { centre, width }, _) => {
                let offset = (value - centre) / width;
                (1.0, 0.5 * offset * offset)
            }
            (FuzzySet::Never, _) => (0.0, 0.0),
            _ => (1.0, 0.0),
        }
    }
}

fn trapezoid(value: f64, [left, left_top, right_top, right]: [f64; 4]) -> f64 {
    if left_top <= value && value <= right_top {
        1.0
    } else if left < value && value < left_top {
        (value - left) / (left_top - left)
    } else if right_top < value && value < right {
        (right - value) / (right - right_top)
    } else {
        0.0
    }
}

/// Local rules over an `N`-dimensional state, on the box `|x_k| <= bounds[k]`. Outside of it the
/// weights are those of the nearest point of the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalRules<const N: usize, const R: usize> {
    sets: [[FuzzySet; N]; R],
    bounds: SVector<f64, N>,
}

impl<const N: usize, const R: usize> LocalRules<N, R> {
    /// `sets[i][k]`: the fuzzy set of rule i over state k. `bounds`: of the magnitude of each state,
    /// in its unit; infinity where the state has none.
    ///
    /// # Errors
    /// A set whose numbers are not finite or not in order; a bound that is not positive.
    pub fn new(sets: [[FuzzySet; N]; R], bounds: SVector<f64, N>) -> Result<Self, ParameterError> {
        const { assert!(R >= 1, "a fuzzy model has at least one rule") };
        for (rule, row) in sets.iter().enumerate() {
            for (column, set) in row.iter().enumerate() {
                if !set.is_valid() {
                    let element = Element::RuleEntry {
                        rule,
                        row: 0,
                        column,
                    };
                    return Err(set.refusal(Field::at("sets", element)));
                }
            }
        }
        for (index, bound) in bounds.iter().enumerate() {
            if *bound != f64::INFINITY {
                AllowedRange::POSITIVE.check(Field::component("bounds", index), *bound)?;
            }
        }
        Ok(Self { sets, bounds })
    }
}

impl<const N: usize, const R: usize> Membership<N, R> for LocalRules<N, R> {
    fn weights(&self, state: &SVector<f64, N>) -> [f64; R] {
        let mut weights = [1.0; R];
        let mut exponents = [0.0; R];
        let rules = self.sets.iter().zip(weights.iter_mut().zip(&mut exponents));
        for (sets, (weight, total)) in rules {
            for (set, (value, bound)) in sets.iter().zip(state.iter().zip(self.bounds.iter())) {
                let (factor, exponent) = set.grade(value.max(-bound).min(*bound));
                *weight *= factor;
                *total += exponent;
            }
        }
        normalise(&mut weights, &exponents);
        weights
    }

    fn contains(&self, state: &SVector<f64, N>) -> bool {
        let within = state.iter().zip(self.bounds.iter());
        within
            .into_iter()
            .all(|(value, bound)| value.abs() <= *bound)
    }
}
