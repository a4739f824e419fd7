//! Dual multipliers of the conditions, and which of them fit a model.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::conditions::GainPlan;
use crate::model::bounded::{As, Flushed, FromOne, Rows};
use crate::model::{Mismatch, Model};

/// Dual multiplier of (18) at one vertex.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VertexDual {
    /// The vertex; files number vertices from 1.
    #[serde(with = "As::<FromOne>")]
    pub vertex: usize,
    /// Second moments of (x, v), 2n x 2n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub moments: DMatrix<f64>,
}

/// Moments with the held state w = x(t_k).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeldMoments {
    /// E[v w'], n x n.
    #[serde(with = "As::<Rows>")]
    pub multiplied_held: DMatrix<f64>,
    /// E[x(t_k^l) w'], n x n.
    #[serde(with = "As::<Rows>")]
    pub sample_held: DMatrix<f64>,
    /// E[w w'], n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub held: DMatrix<f64>,
}

/// Moments with the dead zone p, for given gains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeadZoneMoments {
    /// E[v p'], n x m.
    #[serde(rename = "multiplied_zone", with = "As::<Rows>")]
    pub multiplied: DMatrix<f64>,
    /// E[w p'], n x m.
    #[serde(rename = "held_zone", with = "As::<Rows>")]
    pub held: DMatrix<f64>,
    /// E[p p'], m x m, symmetric.
    #[serde(rename = "zone", with = "As::<Rows>")]
    pub own: DMatrix<f64>,
}

/// Dual multipliers of (18) at one end of the sampling interval. n states, m inputs, d disturbances.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Moments {
    /// One for each vertex that matters; the multipliers of the others are 0.
    pub vertices: Vec<VertexDual>,
    /// E[x x(t_k^l)'], n x n.
    #[serde(with = "As::<Rows>")]
    pub state_sample: DMatrix<f64>,
    /// E[v x(t_k^l)'], n x n; `None` when the stationarity of the multiplier determines it (r = 2 of the first
    /// gain only).
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        with = "As::<Option<Rows>>"
    )]
    pub multiplied_sample: Option<DMatrix<f64>>,
    /// E[x(t_k^l) x(t_k^l)'], n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub sample: DMatrix<f64>,
    /// E[v tau'], n x d.
    #[serde(with = "As::<Rows>")]
    pub multiplied_disturbance: DMatrix<f64>,
    /// E[tau tau'], d x d, symmetric.
    #[serde(with = "As::<Rows>")]
    pub disturbance: DMatrix<f64>,
    /// Moments with the held state; `None` stands for w = x(t_k^l) (no trigger error).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held: Option<HeldMoments>,
    /// Moments with the dead zone; `None` exactly where the gain is free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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

/// Dual multiplier of one condition (19): `[ state, *; *, unit ]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InputDual {
    /// n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub state: DMatrix<f64>,
    /// The corner.
    #[serde(with = "As::<Flushed>")]
    pub unit: f64,
}

/// Dual multiplier of one condition of the region, with k rows: `[ state, cross; *, unit ]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionDual {
    /// n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub state: DMatrix<f64>,
    /// n x k.
    #[serde(with = "As::<Rows>")]
    pub cross: DMatrix<f64>,
    /// k x k, symmetric.
    #[serde(with = "As::<Rows>")]
    pub unit: DMatrix<f64>,
}

/// Dual multipliers of the conditions of one gain.
#[derive(Debug, Clone, PartialEq)]
pub struct GainDuals {
    /// Which of the given gains, from 0; 0 where the gain is free.
    pub gain: usize,
    /// Dual multipliers of (18), r = 1.
    pub start: Moments,
    /// Dual multipliers of (18), r = 2.
    pub end: Moments,
    /// E[s s'], n x n, symmetric: the integral's coordinate in r = 2.
    pub integral: DMatrix<f64>,
    /// Its moments with the states; `None` exactly for the first gain, where the stationarity of L1h and L2h
    /// determines them.
    pub integral_cross: Option<IntegralCross>,
    /// Dual multipliers of (19), one for each input.
    pub inputs: Vec<InputDual>,
}

/// Dual multipliers that show that no design exists, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct DualMultipliers {
    /// The given gains F_j, m x n, that no design has; empty: no constant gain has one.
    pub given: Vec<DMatrix<f64>>,
    /// The weight rho of the containment condition; above 0. Without effect when the model has no
    /// states that must be contained.
    pub containment_weight: f64,
    /// Dual multipliers of the conditions of each gain that matters: at least one, and exactly one where the gain is
    /// free.
    pub gains: Vec<GainDuals>,
    /// Dual multipliers of the region's conditions, in their order.
    pub region: Vec<RegionDual>,
    /// Dual multipliers of the containment conditions, n x n, symmetric, one for each state; empty where the rest is
    /// refuted already, which covers every rho.
    pub must_contain: Vec<DMatrix<f64>>,
}

impl DualMultipliers {
    /// True when the model's conditions hold for rule i of the plant with gain i, not for every vertex
    /// with every gain.
    pub fn is_matched(&self, model: &Model) -> bool {
        matches!(model.file.mismatch, Mismatch::Kappa(_))
            && self.given.len() > 1
            && model.plant.membership_count() == Some(self.given.len())
    }

    /// Every dual multiplier belongs to an existing condition, and the parts that are determined or without
    /// meaning are left out.
    pub(super) fn fits(&self, model: &Model) -> bool {
        let free = self.given.is_empty();
        // Dual multipliers about a free gain prove nothing about scheduled ones.
        let constant = model.task().gains == GainPlan::constant();
        let matched = self.is_matched(model);
        let known = |part: &GainDuals| match free {
            true => part.gain == 0,
            false => part.gain < self.given.len(),
        };
        let pairs = |part: &GainDuals| {
            let mut vertices = part.start.vertices.iter().chain(&part.end.vertices);
            !matched || vertices.all(|weight| weight.vertex == part.gain)
        };
        let dead_zone = |part: &GainDuals| {
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
