//! A search that ends without the requested design.

use crate::programs::{Answer, Decision, LimitingFactors, Outcome, Session};

/// The outcome without a design, with its reason.
pub fn no_design(reason: String, runs: &Session) -> Outcome {
    let limiting_factors = LimitingFactors {
        reason,
        scale: None,
        angle_deg: None,
        limits: Vec::new(),
    };
    Outcome::Undecided(undecided_decision(limiting_factors, Vec::new(), runs))
}

/// The record of a search that missed a requirement.
pub fn undecided_decision(
    limiting_factors: LimitingFactors,
    blocking: Vec<(String, f64)>,
    runs: &Session,
) -> Decision {
    Decision {
        answer: Answer::Undecided(None),
        slack: None,
        blocking,
        limiting_factors: Some(Box::new(limiting_factors)),
        solve_seconds: runs.seconds(),
        runs: runs.runs.clone(),
    }
}
