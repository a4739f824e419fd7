//! T-S models made of local rules.
//!
//! Each rule describes the plant near some state; in between, the memberships blend the
//! rules. Such a model interpolates the plant and does not equal it: whatever is proved with it is
//! proved for the blend.

use std::collections::HashSet;

use nalgebra::{Matrix3, Vector3, Vector4, Vector6};
use runtime::local_rules::{normalise, FuzzySet};

use super::exact::skew;
use super::{BoxCondition, TakagiSugeno, VertexSystem};

/// A checked model of local rules.
#[derive(Debug, Clone, PartialEq)]
pub struct RuleModel {
    /// The rules' systems; the box is |x_k| <= bound of each state.
    pub system: VertexSystem,
    /// `sets[i][k]`: the fuzzy set of rule i over state k.
    pub sets: Vec<Vec<FuzzySet>>,
    /// For a spacecraft: its inertia J [kg m^2].
    pub inertia: Option<Matrix3<f64>>,
    /// For a spacecraft: (omega [rad/s], q0) at which each rule freezes A.
    pub frozen_at: Vec<Vector4<f64>>,
}

/// How far a blend of rules is from the rigid spacecraft, at the worst point found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlendError {
    /// Norm of the difference of J omega' [N m].
    pub torque_nm: f64,
    /// Norm of the difference of q' [1/s].
    pub attitude_rate_per_s: f64,
    /// State at which the torque error is that large.
    pub torque_at: Vector6<f64>,
    /// State at which the error of q' is that large.
    pub attitude_at: Vector6<f64>,
}

/// A search that would take too long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooComplicated;

/// Combinations looked at before the search for an uncovered point is given up.
const COVER_BUDGET: usize = 1 << 20;

/// Points on each axis of the grid on which the model error is looked for.
const ERROR_GRID: usize = 5;

/// Rounds of the local search that follows.
const ERROR_ROUNDS: usize = 60;

impl RuleModel {
    /// The T-S model.
    pub fn takagi_sugeno(&self) -> TakagiSugeno {
        let mut out = self.system.takagi_sugeno();
        out.region = out.region.into_iter().enumerate().map(named).collect();
        out
    }

    /// Weights of the rules at a state (n entries); outside of the box those of its nearest point.
    pub fn memberships(&self, state: &[f64]) -> Vec<f64> {
        let bounds = &self.system.box_bounds;
        let mut weights = vec![1.0; self.sets.len()];
        let mut exponents = vec![0.0; self.sets.len()];
        for (rule, sets) in self.sets.iter().enumerate() {
            for ((set, value), bound) in sets.iter().zip(state).zip(bounds.iter()) {
                let (factor, exponent) = set.grade(value.clamp(-bound, *bound));
                weights[rule] *= factor;
                exponents[rule] += exponent;
            }
        }
        normalise(&mut weights, &exponents);
        weights
    }

    /// A point of the box at which every rule has weight 0, if there is one. Exact: between the corners
    /// of the fuzzy sets nothing changes, so the corners and one point between each two decide.
    pub fn uncovered_point(&self) -> Result<Option<Vec<f64>>, TooComplicated> {
        let all: Vec<usize> = (0..self.sets.len()).collect();
        let mut search = CoverSearch {
            model: self,
            seen: HashSet::new(),
            point: Vec::new(),
        };
        search.descend(&all)
    }

    /// The largest difference found between the blend and the rigid spacecraft over the box; `None`
    /// for other plants. The maximum over a grid, then refined about its worst points: a lower bound
    /// of the worst, not an upper one.
    pub fn worst_model_error(&self) -> Option<BlendError> {
        let inertia = self.inertia?;
        let bounds = Vector6::from_iterator(self.system.box_bounds.iter().copied());
        let torque = |x: &Vector6<f64>| self.difference(&inertia, x).map(|both| both.0);
        let attitude = |x: &Vector6<f64>| self.difference(&inertia, x).map(|both| both.1);
        let (torque_nm, torque_at) = largest(&bounds, torque);
        let (attitude_rate_per_s, attitude_at) = largest(&bounds, attitude);
        Some(BlendError {
            torque_nm,
            attitude_rate_per_s,
            torque_at,
            attitude_at,
        })
    }

    /// Norms of the differences of J omega' and of q' at a state; `None` where |q| > 1.
    fn difference(&self, inertia: &Matrix3<f64>, state: &Vector6<f64>) -> Option<(f64, f64)> {
        let rate: Vector3<f64> = state.fixed_rows::<3>(0).into_owned();
        let vector_part: Vector3<f64> = state.fixed_rows::<3>(3).into_owned();
        let scalar = 1.0 - vector_part.norm_squared();
        if scalar < 0.0 {
            return None;
        }
        let weights = self.memberships(state.as_slice());
        let frozen = self.frozen_at.iter().zip(&weights);
        let blended: Vector4<f64> = frozen.map(|(at, weight)| at * *weight).sum();
        // A is affine in (omega, q0), so the blend of the A_i is A at the blend of their places.
        let spin = skew(&(rate - blended.fixed_rows::<3>(0)));
        let torque = spin * (inertia * rate);
        let attitude = 0.5 * ((scalar.sqrt() - blended[3]) * rate - spin * vector_part);
        Some((torque.norm(), attitude.norm()))
    }
}

fn named((index, mut bound): (usize, BoxCondition)) -> BoxCondition {
    bound.name = format!("state {}", index + 1);
    bound
}

/// Depth first over the states: the rules that still have a weight above 0 at a depth.
struct CoverSearch<'a> {
    model: &'a RuleModel,
    /// Sets of rules known to cover everything below a depth.
    seen: HashSet<(usize, Vec<usize>)>,
    point: Vec<f64>,
}

impl CoverSearch<'_> {
    fn descend(&mut self, alive: &[usize]) -> Result<Option<Vec<f64>>, TooComplicated> {
        let depth = self.point.len();
        let states = self.model.system.box_bounds.len();
        if alive.is_empty() {
            let mut point = self.point.clone();
            point.resize(states, 0.0);
            return Ok(Some(point));
        }
        let key = (depth, alive.to_vec());
        if depth == states || self.seen.contains(&key) {
            return Ok(None);
        }
        if self.seen.len() >= COVER_BUDGET {
            return Err(TooComplicated);
        }
        for value in self.places(depth) {
            let positive = |rule: &&usize| self.model.sets[**rule][depth].grade(value).0 > 0.0;
            let next: Vec<usize> = alive.iter().filter(positive).copied().collect();
            self.point.push(value);
            let found = self.descend(&next)?;
            self.point.pop();
            if found.is_some() {
                return Ok(found);
            }
        }
        self.seen.insert(key);
        Ok(None)
    }

    /// The corners of the sets over one state inside the box, its ends, and the middles in between.
    fn places(&self, state: usize) -> Vec<f64> {
        let bound = self.model.system.box_bounds[state];
        let mut corners = vec![-bound, bound];
        for sets in &self.model.sets {
            match sets[state] {
                FuzzySet::Triangular { left, peak, right } => corners.extend([left, peak, right]),
                FuzzySet::Trapezoidal {
                    left,
                    left_top,
                    right_top,
                    right,
                } => corners.extend([left, left_top, right_top, right]),
                FuzzySet::Any | FuzzySet::Never | FuzzySet::Gaussian { .. } => {}
            }
        }
        corners.retain(|corner| corner.abs() <= bound);
        corners.sort_by(f64::total_cmp);
        corners.dedup();
        let middles: Vec<f64> = corners
            .windows(2)
            .map(|pair| 0.5 * (pair[0] + pair[1]))
            .collect();
        corners.extend(middles);
        corners.sort_by(f64::total_cmp);
        corners
    }
}

/// The largest value of a function on the box |x_k| <= bounds[k]: grid, then pattern search.
fn largest(
    bounds: &Vector6<f64>,
    value: impl Fn(&Vector6<f64>) -> Option<f64>,
) -> (f64, Vector6<f64>) {
    let steps = ERROR_GRID - 1;
    let mut best = (0.0, Vector6::zeros());
    for index in 0..ERROR_GRID.pow(6) {
        let place = |k: usize| (index / ERROR_GRID.pow(k as u32)) % ERROR_GRID;
        let at = |k: usize| bounds[k] * (2.0 * place(k) as f64 / steps as f64 - 1.0);
        let state = Vector6::from_fn(|k, _| at(k));
        if let Some(error) = value(&state).filter(|error| *error > best.0) {
            best = (error, state);
        }
    }
    let mut step = 1.0 / steps as f64;
    for _ in 0..ERROR_ROUNDS {
        let mut improved = false;
        for k in 0..6 {
            for sign in [-1.0, 1.0] {
                let mut state = best.1;
                state[k] = (state[k] + sign * step * bounds[k]).clamp(-bounds[k], bounds[k]);
                if let Some(error) = value(&state).filter(|error| *error > best.0) {
                    best = (error, state);
                    improved = true;
                }
            }
        }
        if !improved {
            step *= 0.5;
        }
    }
    best
}
