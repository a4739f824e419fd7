//! The hand-over from the large set to the small one in a design file, and the largest level at which it can be proved.

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::recover::largest_eigenvalue;
use crate::certify::interval::Interval;
use crate::certify::theorem1::{
    decided, for_each_hand_over_condition, Certificate, HandOver, HeldWeights,
};
use crate::certify::{judge_all, Verdict};
use crate::model::{check_positive, Model, ModelError};

/// How every certified start of the large set comes under the certificate of the small one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SetHandOverFile {
    /// rho': x'Ux of the large set falls to this level, at which it lies in the small set.
    pub level: f64,
    /// For each input of each gain, gain after gain: what shows that the state held then asks for no more than the limit.
    pub held_state: Vec<HeldWeightsFile>,
}

/// a and b of the bound on what a held state asks for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeldWeightsFile {
    /// a: weight of the state in the large set.
    pub state_weight: f64,
    /// b: weight of the trigger's decision.
    pub trigger_weight: f64,
}

impl SetHandOverFile {
    /// As it is written.
    pub(crate) fn of(hand_over: &HandOver) -> Self {
        let held = hand_over.held.iter().map(|weights| HeldWeightsFile {
            state_weight: weights.state,
            trigger_weight: weights.trigger,
        });
        SetHandOverFile {
            level: hand_over.level,
            held_state: held.collect(),
        }
    }

    /// Its numbers, for a design with so many rows of gains.
    pub(super) fn read(&self, rows: usize) -> Result<HandOver, ModelError> {
        check_positive("outer.hand_over.level", self.level)?;
        if self.held_state.len() != rows {
            let found = self.held_state.len();
            let reason = format!(
                "must have {rows} entries, one for each input of each gain, and has {found}"
            );
            return Err(ModelError::choice("outer.hand_over.held_state", &reason));
        }
        let mut held = Vec::with_capacity(rows);
        for (row, own) in self.held_state.iter().enumerate() {
            let field = |key: &str| format!("outer.hand_over.held_state[{row}].{key}");
            check_positive(&field("state_weight"), own.state_weight)?;
            check_positive(&field("trigger_weight"), own.trigger_weight)?;
            held.push(HeldWeights {
                state: own.state_weight,
                trigger: own.trigger_weight,
            });
        }
        Ok(HandOver {
            level: self.level,
            held,
        })
    }
}

/// Relative distance of the level from the largest one.
const ROOM: f64 = 1e-3;

/// Values of b that are tried, on a logarithmic scale from just above the smallest one.
const TRIED: usize = 80;
const CLOSEST: f64 = 1e-4;
const FARTHEST: f64 = 1e4;

/// The hand-over at the largest level, which is reached first; `None` where none is proved.
pub(crate) fn hand_over(
    (large_model, large): (&Model, &Certificate),
    (small_model, small): (&Model, &Certificate),
) -> Option<HandOver> {
    let triangle = large.lyapunov.clone().cholesky()?.l().try_inverse()?;
    let in_set =
        |matrix: &DMatrix<f64>| largest_eigenvalue(&(&triangle * matrix * triangle.transpose()));
    let bound = HeldBound {
        small_model,
        small,
        in_set: &in_set,
    };
    let limits = small_model.plant.takagi_sugeno().input_limit;
    let mut level = 1.0 / in_set(&small.lyapunov);
    if small_model.file.imperfections.is_networked() {
        let triangle = large
            .integral_weight
            .clone()
            .cholesky()?
            .l()
            .try_inverse()?;
        let integral =
            largest_eigenvalue(&(&triangle * &small.integral_weight * triangle.transpose()));
        level = level.min(1.0 / integral);
    }
    let mut chosen = Vec::new();
    for (gain, anti_windup) in small.gains().zip(small.anti_windups()) {
        let difference = gain - anti_windup;
        for (row, &limit) in difference.row_iter().zip(limits.iter()) {
            let (own, weights) = bound.largest_level(&row.transpose(), limit)?;
            level = level.min(own);
            chosen.push((own, weights));
        }
    }
    level = level.min(1.0) * (1.0 - ROOM);
    // A row that does not limit the level has room, half of which its state's weight takes.
    let held = chosen.into_iter().map(|(own, weights)| HeldWeights {
        state: weights.state * (own / level).sqrt(),
        ..weights
    });
    let held = held.collect();
    let found = HandOver { level, held };
    let proved = judge_all(Vec::new(), |emit| {
        let (large, small) = ((large_model, large), (small_model, small));
        for_each_hand_over_condition::<Interval>(large, small, &found, emit);
    });
    (proved.verdict == Verdict::Proved).then_some(found)
}

/// What is needed to bound what a held state asks for.
struct HeldBound<'a, InSet> {
    small_model: &'a Model,
    small: &'a Certificate,
    /// The largest value of x'Mx where x'Ux <= 1 for the large set's U.
    in_set: &'a InSet,
}

impl<InSet: Fn(&DMatrix<f64>) -> f64> HeldBound<'_, InSet> {
    /// The largest level at which a row of F - N stays within its limit, with a and b.
    fn largest_level(&self, row: &DVector<f64>, limit: f64) -> Option<(f64, HeldWeights)> {
        let trigger = &self.small.trigger_weight * self.small.trigger_multiple;
        let measured = self.small.measurement.as_ref();
        let error = measured.map_or(&trigger, |measured| &measured.error_weight);
        let held = error - &trigger * self.small_model.file.specs.nu;
        let added = decided(self.small_model, self.small);
        let spread = row.dot(&(held.clone().try_inverse()? * row));
        // Any b does where the row is 0.
        let least = match spread > 0.0 {
            true => spread,
            false => f64::EPSILON * limit * limit / ((self.in_set)(error) + added),
        };
        let step = (FARTHEST / CLOSEST).powf(1.0 / (TRIED - 1) as f64);
        let tried = (0..TRIED).filter_map(|k| {
            let b = least * (1.0 + CLOSEST * step.powi(k as i32));
            let left = held.clone() * b - row * row.transpose();
            let spread = error * left.try_inverse()? * error * (b * b) - error * b;
            let a = (self.in_set)(&spread);
            let level = (limit * limit - b * added) / a;
            (a > 0.0 && level > 0.0).then_some((
                level,
                HeldWeights {
                    state: a,
                    trigger: b,
                },
            ))
        });
        tried.max_by(|one, other| one.0.total_cmp(&other.0))
    }
}
