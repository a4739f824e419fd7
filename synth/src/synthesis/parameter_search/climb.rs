//! Uphill with the slopes that the multipliers give: a quasi-Newton method inside limits.

use nalgebra::{DMatrix, DVector};

use super::inner::{Inner, SearchPoint};
use super::parameters::Space;
use crate::programs::SynthesisError;

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// Most rounds; each solves at two points.
    pub rounds: usize,
    /// A rise of the height per round that is not worth another round.
    pub rise: f64,
}

/// First and largest change of a coordinate in a round.
const STEPS: [f64; 2] = [0.4, 1.2];

/// Smallest change of a coordinate worth trying.
const SMALLEST_STEP: f64 = 2e-3;

/// The shorter of the two steps tried in a round, as a part of the longer.
const SHORTER: f64 = 0.3;

/// Rounds in a row with a small rise after which the search ends.
const SMALL_RISES: usize = 2;

struct Ascent<'a> {
    space: &'a Space,
    best: SearchPoint,
    /// Estimate of the inverse of minus the second derivative.
    curvature: DMatrix<f64>,
    known: bool,
    longest: f64,
}

/// Climbs from a solved point. `tell` hears of every point that is better than the last, and says whether
/// to go on.
pub fn climb(
    inner: &Inner<'_>,
    start: SearchPoint,
    effort: Effort,
    tell: &mut dyn FnMut(&SearchPoint) -> bool,
) -> Result<SearchPoint, SynthesisError> {
    let size = start.coordinates.len();
    let mut ascent = Ascent {
        space: inner.space,
        best: start,
        curvature: DMatrix::identity(size, size),
        known: false,
        longest: STEPS[0],
    };
    let mut small = 0;
    for _ in 0..effort.rounds {
        let Some(direction) = ascent.direction() else {
            break;
        };
        let height = ascent.best.value.height;
        let found = ascent.try_both(inner, &direction)?;
        match found {
            Some((point, whole)) => {
                if whole {
                    ascent.longest = (1.6 * ascent.longest).min(STEPS[1]);
                } else {
                    ascent.longest *= 0.6;
                }
                ascent.learn(&point);
                ascent.best = point;
                if !tell(&ascent.best) {
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
        let rise = ascent.best.value.height - height;
        small = if rise < effort.rise { small + 1 } else { 0 };
        if small >= SMALL_RISES {
            break;
        }
    }
    Ok(ascent.best)
}

impl Ascent<'_> {
    /// The slope without the parts that lead out of the limits.
    fn free_slope(&self) -> DVector<f64> {
        let ranges = self.space.ranges.iter();
        let parts = ranges
            .zip(&self.best.coordinates)
            .zip(&self.best.value.slope);
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

    /// Where to go, no coordinate farther than the longest step; `None` on a summit.
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
        inner: &Inner<'_>,
        direction: &DVector<f64>,
    ) -> Result<Option<(SearchPoint, bool)>, SynthesisError> {
        let at = |part: f64| {
            let from = DVector::from_column_slice(&self.best.coordinates);
            let to: Vec<f64> = (from + direction * part).iter().copied().collect();
            self.space.inside(&to)
        };
        let solve = |coordinates: Vec<f64>| -> Result<Option<SearchPoint>, SynthesisError> {
            let value = inner.solve(&coordinates, &self.best.value.linearisation)?;
            Ok(value.map(|value| SearchPoint { coordinates, value }))
        };
        let (long, short) = rayon::join(|| solve(at(1.0)), || solve(at(SHORTER)));
        let height = |point: &Option<SearchPoint>| {
            let height = point.as_ref().map(|point| point.value.height);
            height.unwrap_or(f64::NEG_INFINITY)
        };
        let (long, short) = (long?, short?);
        let whole = height(&long) >= height(&short);
        let better = if whole { long } else { short };
        let better = better.filter(|point| point.value.height > self.best.value.height);
        Ok(better.map(|point| (point, whole)))
    }

    /// The BFGS update of the curvature by a step.
    fn learn(&mut self, to: &SearchPoint) {
        let vector = |values: &[f64]| DVector::from_column_slice(values);
        let step = vector(&to.coordinates) - vector(&self.best.coordinates);
        let change = vector(&self.best.value.slope) - vector(&to.value.slope);
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
