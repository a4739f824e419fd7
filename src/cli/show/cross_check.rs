//! The smallest gamma from both solvers.

use serde::Serialize;
use synth::synthesis::{CrossCheck, SolverOptimum};

/// What both solvers say.
#[derive(Debug, Serialize)]
pub struct CrossCheckReport<'a> {
    /// Each solver's answer.
    found: Vec<SolverGamma<'a>>,
    /// Distance of the gammas relative to the first; null when one is missing.
    relative_difference: Option<f64>,
}

/// One solver's answer.
#[derive(Debug, Serialize)]
struct SolverGamma<'a> {
    /// Name and version.
    solver: &'a str,
    /// Its own word for how it ended.
    status: &'a str,
    /// The smallest gamma; null when it found none.
    gamma: Option<f64>,
    /// Wall time (s).
    seconds: f64,
}

impl<'a> CrossCheckReport<'a> {
    /// From the comparison.
    pub fn new(check: &'a CrossCheck) -> Self {
        let one = |found: &'a SolverOptimum| SolverGamma {
            solver: &found.solver,
            status: &found.status,
            gamma: found.gamma,
            seconds: found.seconds,
        };
        CrossCheckReport {
            found: check.found.iter().map(one).collect(),
            relative_difference: check.relative_difference,
        }
    }

    /// In words.
    pub fn lines(&self) -> Vec<String> {
        let found = self.found.iter().map(|found| {
            let gamma = found.gamma;
            let gamma = gamma.map_or("none".to_string(), |gamma| format!("{gamma:.9}"));
            format!(
                "cross-check: {}: smallest gamma {gamma}, {} in {:.2} s",
                found.solver, found.status, found.seconds
            )
        });
        let difference = match self.relative_difference {
            Some(difference) => format!("cross-check: relative difference {difference:.1e}"),
            None => "cross-check: one of the solvers found no gamma".to_string(),
        };
        found.chain([difference]).collect()
    }
}
