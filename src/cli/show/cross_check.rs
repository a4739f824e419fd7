//! The smallest bound from several solvers, as what it bounds.

use serde::Serialize;
use synth::model::Model;
use synth::programs::Optimum;
use synth::synthesis::CrossCheck;

/// The smallest bounds that solvers reported for one problem: of gamma, or of the guaranteed gain, whichever the model
/// asks to be small. They are not proved.
#[derive(Debug, Serialize)]
pub struct CrossCheckReport {
    /// Each solver's answer, in the order in which they were asked.
    found: Vec<SolverBound>,
    /// Distance of the first two bounds relative to the first; null when one is missing.
    relative_difference: Option<f64>,
}

/// One solver's smallest bound.
#[derive(Debug, Serialize)]
pub struct SolverBound {
    /// Name and version.
    solver: String,
    /// The solver's status.
    status: String,
    /// The smallest gamma; null where the guaranteed gain was made small.
    gamma: Option<f64>,
    /// The smallest bound of the guaranteed gain; null where gamma was made small.
    guaranteed_gain: Option<f64>,
    /// Wall time (s).
    seconds: f64,
}

impl CrossCheckReport {
    /// Of a model's solvers.
    pub fn new(model: &Model, check: &CrossCheck) -> Self {
        let optimum = Optimum::of(model);
        let found = check.found.iter().map(|found| {
            let bound = found.gamma.map(|value| optimum.bound(value));
            let is_gamma = optimum == Optimum::Gamma;
            SolverBound {
                solver: found.solver.clone(),
                status: found.status.clone(),
                gamma: bound.filter(|_| is_gamma),
                guaranteed_gain: bound.filter(|_| !is_gamma),
                seconds: found.seconds,
            }
        });
        CrossCheckReport {
            found: found.collect(),
            relative_difference: check.relative_difference,
        }
    }

    /// In words.
    pub fn lines(&self) -> Vec<String> {
        let found = self.found.iter().map(|found| {
            let bound = match (found.gamma, found.guaranteed_gain) {
                (Some(gamma), _) => format!("smallest gamma {gamma:.9}"),
                (None, Some(gain)) => format!("smallest bound of the guaranteed gain {gain:.9}"),
                (None, None) => "no bound".to_string(),
            };
            format!(
                "cross-check: {}: {bound}, {} in {:.2} s",
                found.solver, found.status, found.seconds
            )
        });
        let difference = match self.relative_difference {
            Some(difference) => format!("cross-check: relative difference {difference:.1e}"),
            None => "cross-check: one of the solvers found no bound".to_string(),
        };
        found.chain([difference]).collect()
    }
}
