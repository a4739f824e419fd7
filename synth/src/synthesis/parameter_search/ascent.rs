//! Maximisation with the gradient that the dual solution gives: a quasi-Newton method inside bounds.

use nalgebra::{DMatrix, DVector};

use super::evaluator::{Evaluator, SearchPoint};
use super::space::Space;
use crate::programs::SynthesisError;

/// Relative increase of the objective in one round below which another round is not worth it.
const SMALL_INCREASE: f64 = 2e-3;

/// First and largest change of a coordinate in a round.
const STEPS: [f64; 2] = [0.4, 1.2];

/// Smallest change of a coordinate worth trying.
const SMALLEST_STEP: f64 = 2e-3;

/// The shorter of the two steps tried in a round, as a fraction of the longer.
const SHORTER: f64 = 0.3;

/// Rounds in a row with a small increase after which the search ends.
const SMALL_INCREASES: usize = 2;

struct Ascent<'a> {
    space: &'a Space,
    best: SearchPoint,
    /// Estimate of the inverse of minus the second derivative.
    curvature: DMatrix<f64>,
    known: bool,
    longest: f64,
}

/// Maximises from a solved point, in at most so many rounds; each solves at two points. `emit` is called with every point that is better than the last; `false` stops the
/// search.
pub fn ascend(
    evaluator: &Evaluator<'_>,
    start: SearchPoint,
    rounds: usize,
    emit: &mut dyn FnMut(&SearchPoint) -> bool,
) -> Result<SearchPoint, SynthesisError> {
    let size = start.coordinates.len();
    let mut ascent = Ascent {
        space: evaluator.space,
        best: start,
        curvature: DMatrix::identity(size, size),
        known: false,
        longest: STEPS[0],
    };
    let mut small = 0;
    for _ in 0..rounds {
        let Some(direction) = ascent.direction() else {
            break;
        };
        let objective = ascent.best.objective;
        let found = ascent.try_both(evaluator, &direction)?;
        match found {
            Some((point, whole)) => {
                if whole {
                    ascent.longest = (1.6 * ascent.longest).min(STEPS[1]);
                } else {
                    ascent.longest *= 0.6;
                }
                ascent.learn(&point);
                ascent.best = point;
                if !emit(&ascent.best) {
                    break;
                }
            }
            None => {
                ascent.longest *= 0.5 * SHORTER;
                if ascent.longest < SMALLEST_STEP {
                    break;
                }
                continue;
            }
        }
        let increase = ascent.best.objective - objective;
        small = match increase < SMALL_INCREASE {
            true => small + 1,
            false => 0,
        };
        if small >= SMALL_INCREASES {
            break;
        }
    }
    Ok(ascent.best)
}

impl Ascent<'_> {
    /// The gradient, with 0 for the coordinates that would leave their bounds.
    fn free_slope(&self) -> DVector<f64> {
        let ranges = self.space.ranges.iter();
        let parts = ranges.zip(&self.best.coordinates).zip(&self.best.slope);
        let parts = parts.map(|((range, &at), &slope)| {
            let [low, high] = range.coordinates();
            let out = (slope > 0.0 && at >= high) || (slope < 0.0 && at <= low);
            if out || !slope.is_finite() {
                0.0
            } else {
                slope
            }
        });
        DVector::from_iterator(self.best.coordinates.len(), parts)
    }

    /// The search direction, no coordinate changed by more than the longest step; `None` at an optimum.
    fn direction(&mut self) -> Option<DVector<f64>> {
        let slope = self.free_slope();
        let mask = |mut vector: DVector<f64>| {
            for (entry, part) in vector.iter_mut().zip(&slope) {
                if *part == 0.0 {
                    *entry = 0.0;
                }
            }
            vector
        };
        let mut direction = mask(&self.curvature * &slope);
        let largest = slope.amax();
        if largest < 1e-9 {
            return None;
        }
        if direction.dot(&slope) < 1e-3 * direction.norm() * slope.norm() {
            self.known = false;
        }
        if !self.known {
            direction = slope.clone() / largest * self.longest;
        }
        let reach = direction.amax();
        if reach > self.longest {
            direction *= self.longest / reach;
        }
        Some(direction)
    }

    /// The better of a long and a short step, if it is better than the best so far, and whether it is the long one.
    fn try_both(
        &self,
        evaluator: &Evaluator<'_>,
        direction: &DVector<f64>,
    ) -> Result<Option<(SearchPoint, bool)>, SynthesisError> {
        let at = |part: f64| {
            let from = DVector::from_column_slice(&self.best.coordinates);
            let to: Vec<f64> = (from + direction * part).iter().copied().collect();
            self.space.inside(&to)
        };
        let solve = |coordinates: Vec<f64>| evaluator.solve(&coordinates, &self.best.linearisation);
        let (long, short) = rayon::join(|| solve(at(1.0)), || solve(at(SHORTER)));
        let objective = |point: &Option<SearchPoint>| {
            let objective = point.as_ref().map(|point| point.objective);
            objective.unwrap_or(f64::NEG_INFINITY)
        };
        let (long, short) = (long?, short?);
        let whole = objective(&long) >= objective(&short);
        let better = if whole { long } else { short };
        let better = better.filter(|point| point.objective > self.best.objective);
        Ok(better.map(|point| (point, whole)))
    }

    /// The BFGS update of the curvature by a step.
    fn learn(&mut self, to: &SearchPoint) {
        let vector = |values: &[f64]| DVector::from_column_slice(values);
        let step = vector(&to.coordinates) - vector(&self.best.coordinates);
        let change = vector(&self.best.slope) - vector(&to.slope);
        let along = step.dot(&change);
        let least = 1e-10 * step.norm() * change.norm();
        if along.is_nan() || least.is_nan() || along <= least {
            return;
        }
        let size = step.len();
        if !self.known {
            self.curvature = DMatrix::identity(size, size) * (along / change.norm_squared());
            self.known = true;
        }
        let left = DMatrix::identity(size, size) - &step * change.transpose() / along;
        self.curvature =
            &left * &self.curvature * left.transpose() + &step * step.transpose() / along;
    }
}
