//! Late and lost messages.

use super::*;
use steadfast::sim::network::NetworkOutcome;

fn network(summary: &Summary) -> &NetworkOutcome {
    summary.network.as_ref().expect("a network")
}

#[test]
fn lost_messages_break_the_bound_unless_they_are_repeated() {
    let design = allowing(json!({ "lost_in_a_row": 2 }));
    let losses = json!({ "lost_in_a_row": 2, "loss": "worst" });
    let scenario = with(spacecraft(), "/network", losses);
    let scenario = with(
        scenario,
        &format!("{BODY}/disturbance"),
        json!({ "worst_nm": 0.01 }),
    );
    let repeated = run(&scenario, &design);
    assert_eq!(network(&repeated).repeats, 2);
    assert_eq!(network(&repeated).longest_loss, 2);
    assert!(network(&repeated).transmissions > network(&repeated).values);
    assert!(network(&repeated).oldest_sample_s <= 3.0 * 0.1);
    assert_said(
        certificate(&repeated),
        "messages lost in a row: 2; proved for up to 2",
        true,
    );
    assert_eq!(certificate(&repeated).bound_broken_steps, 0);
    assert!(certificate(&repeated).largest_lyapunov_ratio < 1.0);

    let scenario = with(scenario, "/network/repeats", json!(0));
    let once = run(&scenario, &design);
    assert_eq!(network(&once).transmissions, network(&once).values);
    assert!(certificate(&once).bound_broken_steps > 100);
    assert!(certificate(&once).largest_lyapunov_ratio > 1.5);
    let lines = &certificate(&once).not_covered;
    let expected = "a value is sent again at 0 following samples; the proof is for 2";
    assert!(lines.iter().any(|line| line == expected), "{lines:?}");
}

#[test]
fn late_messages_overtake_and_their_delay_is_compared_with_the_proved_one() {
    let design = allowing(json!({ "delay_s": 0.5 }));
    for (kind, factor, covered) in [
        ("random", 1.0, true),
        ("worst", 1.0, true),
        ("largest", 1.5, false),
    ] {
        let late = json!({ "delay_s": 0.5 * factor, "delay": kind });
        // Noise makes so many samples trigger that messages can overtake each other.
        let noise = json!({ "rate_rad_s": 1e-4, "attitude_deg": 0.03, "kind": "random" });
        let noisy = with(
            spacecraft(),
            &format!("{BODY}/sensors"),
            json!({ "bounded_error": noise }),
        );
        let summary = run(&with(noisy, "/network", late), &design);
        let network = network(&summary);
        assert_said(
            certificate(&summary),
            "delay from sample to torque: ",
            covered,
        );
        assert!(network.oldest_sample_s <= 0.1 + 0.5 * factor);
        assert_eq!(
            network.dropped_as_old > 0,
            kind != "largest",
            "{kind}: {network:?}"
        );
    }
    // The dead time of the actuators is part of it.
    let actuators = json!({ "delay_s": 0.3 });
    let scenario = with(spacecraft(), &format!("{BODY}/actuators"), actuators);
    let scenario = with(scenario, "/network", json!({ "delay_s": 0.3 }));
    let summary = run(&scenario, &design);
    assert_said(
        certificate(&summary),
        "delay from sample to torque: 0.6 s; proved for up to 0.5 s",
        false,
    );
}

#[test]
fn nothing_is_applied_before_the_first_message_has_arrived() {
    let design = allowing(json!({ "delay_s": 1, "lost_in_a_row": 3 }));
    let late =
        json!({ "delay_s": 1, "lost_in_a_row": 3, "loss": { "random": { "probability": 0.9 } } });
    let outcome = flown(&with(spacecraft(), "/network", late), &design);
    let first = network(&outcome.summary)
        .first_arrival_s
        .expect("an arrival");
    assert!((1.0..=1.3).contains(&first), "{first}");
    let trajectory = outcome.trajectory.expect("a trajectory");
    let columns = ["time_s", "torque_1_nm", "lyapunov_bound"];
    let columns = columns.map(|name| trajectory.column(name).expect("a column"));
    let [times, torques, bounds] = columns;
    for ((&time, &torque), &bound) in times.iter().zip(&torques).zip(&bounds) {
        assert_eq!(torque == 0.0, time < first, "at {time} s");
        assert_eq!(bound == 1.0, time <= first, "at {time} s");
    }
}
