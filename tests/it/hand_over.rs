//! From the large set of a design to its small one: proved, and flown.

use serde_json::{json, Value};
use steadfast::run::design::Design;
use steadfast::run::summary::RunVerdict;

use crate::falsification::{boundary, designed_from, flown, scenario, starts_asked};
use crate::support::random::Random;

/// The proved design of models/xu2020-both.json with imperfections, and xi_max of the large set a share of what it is.
fn designed(imperfections: &Value, share: f64) -> Design {
    let text = include_str!("../../models/xu2020-both.json");
    let mut model: Value = serde_json::from_str(text).expect("JSON");
    let largest = &mut model["specs"]["outer"]["xi_max"];
    *largest = json!(share * largest.as_f64().expect("a number"));
    designed_from(model, imperfections)
}

/// Starts of each design in the short search.
const FEW: usize = 24;

#[test]
fn every_start_of_the_large_set_comes_under_the_small_certificate_in_the_proved_time() {
    let measurement = json!({ "rate_rad_s": 1e-5, "attitude_deg": 0.0114591 });
    let cases = [
        ("none", json!({}), 1.0),
        ("measurement", json!({ "measurement": measurement }), 1.0),
        // With messages under way the integral terms have to shrink as well.
        ("delay 20 ms", json!({ "delay_s": 0.02 }), 0.4),
    ];
    for (name, imperfections, share) in cases {
        let design = designed(&imperfections, share);
        let outer = design.outer.as_ref().expect("a large set");
        let due = outer.hand_over_time().expect("a hand-over is proved");
        let mut random = Random(37);
        let (mut latest, mut tightest) = (0.0_f64, 0.0_f64);
        let flights = starts_asked().unwrap_or(FEW);
        for index in 0..flights {
            let start = boundary(&design, index, &mut random);
            let how = (index % 4 != 3, 1.2 * due);
            let scenario = scenario(&design, &start, how, &mut random);
            let (outcome, verdict) = flown(&design, &scenario);
            assert!(outcome.covers_run, "{outcome:#?}");
            assert_ne!(verdict, RunVerdict::ProofBroken, "{outcome:#?}\n{scenario}");
            let inner = outcome.inner.expect("a small set");
            let entered = inner.entered_s.expect("an entry");
            // Rounding, and with late messages the first sample after the time.
            assert!(
                !inner.late && entered <= due + 0.1,
                "{entered} {due}\n{scenario}"
            );
            assert_eq!(inner.violations(), 0, "{inner:#?}\n{scenario}");
            latest = latest.max(entered / due);
            tightest = tightest.max(inner.largest_lyapunov_ratio);
        }
        println!("| {name} | {flights} | {due:.1} | {latest:.3} | {tightest:.4} |");
        assert!(
            latest > 0.01 && tightest > 0.001,
            "{name}: {latest} {tightest}"
        );
    }
}
