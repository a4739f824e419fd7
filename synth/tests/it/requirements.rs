//! Facts that are decided without a search.

use std::sync::atomic::{AtomicUsize, Ordering};

use synth::requirements::{best, Facts};
use synth::solve::Solver;
use synth::synthesis::{Form, Solvers};

/// A spacecraft with a torque limit of 5 mN m about its weakest axis and this bound on the disturbance (N m).
fn facts(disturbance_nm: &str) -> (Facts, String) {
    let text = format!(
        r#"{{ "schema_version": 1, "name": "windy",
             "plant": {{ "exact": {{
               "inertia_kg_m2": [[0.12, 0, 0], [0, 0.1, 0], [0, 0, 0.05]],
               "torque_limit_nm": [0.02, 0.005, 0.01], "disturbance_bound_nm": {disturbance_nm} }} }},
             "specs": {{ "sample_hz": 4 }}, "requirements": {{ "pointing_deg": 5 }} }}"#
    );
    let facts = Facts::from_json(&text).expect("facts");
    (facts, text)
}

#[test]
fn a_disturbance_that_reaches_the_weakest_torque_leaves_no_design_and_is_not_searched() {
    let solvers = Solvers::named(Solver::Structured, Form::Chordal);
    for reaching in ["0.005", "0.0050001", "3"] {
        let (facts, text) = facts(reaching);
        assert!(facts.is_overwhelmed());
        let tried = AtomicUsize::new(0);
        let watch = |_| {
            tried.fetch_add(1, Ordering::Relaxed);
        };
        let found = best(&facts, &text, &solvers, None, &watch).expect("an answer");
        assert!(found.candidate.is_none() && !found.stopped);
        assert_eq!(tried.into_inner(), 0, "{reaching}");
    }
    let (below, _) = facts("0.004999999999999999");
    assert!(!below.is_overwhelmed());
}
