//! A search that ends without the requested design.

use crate::programs::{Answer, Decision, Outcome, Session, Shortfall};

/// No design, for a reason.
pub fn denied(reason: String, runs: &Session) -> Outcome {
    let shortfall = Shortfall {
        reason,
        scale: None,
        angle_deg: None,
        limits: Vec::new(),
    };
    Outcome::Undecided(decision(shortfall, Vec::new(), runs))
}

/// The record of a search that did not reach what was asked for.
pub fn decision(shortfall: Shortfall, blocking: Vec<(String, f64)>, runs: &Session) -> Decision {
    Decision {
        answer: Answer::Undecided(None),
        slack: None,
        blocking,
        shortfall: Some(Box::new(shortfall)),
        solve_seconds: runs.seconds(),
        runs: runs.runs.clone(),
    }
}
