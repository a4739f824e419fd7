//! Gains that are asked for, an infimum of 0, and plants that need units of their own.

use super::*;

/// A unit mass with a force as input, another as disturbance, z its position and, weighed, the input.
fn mass(weight: f64, further: &Value) -> Value {
    let mut gain = json!({
        "disturbance_matrix": [[0], [1]],
        "output_matrix": [[1, 0], [0, 0]],
        "input_to_output_matrix": [[0], [weight]],
    });
    for (key, value) in further.as_object().expect("an object") {
        gain[key] = value.clone();
    }
    asked(
        json!({ "state_matrices": [[[0, 1], [0, 0]]], "input_matrix": [[0], [1]] }),
        json!({ "h_infinity": gain }),
    )
}

#[test]
fn a_gain_that_is_asked_for_is_met_from_below() {
    for gamma in [1e-4, 0.02, 5.0] {
        let (_, found) = proved(&mass(0.0, &json!({ "gamma": gamma })));
        assert_between(found.guarantee / gamma, 1.0 - 1e-6, 1.0);
    }
}

#[test]
fn a_gain_below_the_infimum_is_answered_with_the_nearest() {
    // The input must cancel the disturbance at frequency 0: the gain of w to [x; u] is at least the weight.
    let (weight, asked_for) = (0.5, 0.4);
    let (_, smallest) = proved(&mass(weight, &json!({})));
    assert!(smallest.guarantee > weight);
    let file = mass(weight, &json!({ "gamma": asked_for }));
    let ProblemOutcome::Undecided(failure) = outcome(&file) else {
        panic!("an answer to {file}");
    };
    let nearest = failure.answer.nearest.expect("a feedback");
    assert_between(nearest / smallest.guarantee, 0.999, 1.001);
}

#[test]
fn the_smallest_gain_is_sought_below_the_largest_allowed_one() {
    let (_, free) = proved(&mass(0.5, &json!({})));
    let (_, found) = proved(&mass(0.5, &json!({ "gamma_max": 2.0 })));
    assert_between(found.guarantee / free.guarantee, 0.999, 1.001);
    // Without a weight on the input any number is met.
    let (_, found) = proved(&mass(0.0, &json!({ "gamma_max": 1e-5 })));
    assert!(found.guarantee <= 1e-5, "{}", found.guarantee);
}

#[test]
fn a_double_integrator_holds_a_ball_as_large_as_its_rate_allows() {
    // x'' = u/J, |u| <= ubar: with decay rate alpha the rate of a start is at most ubar / (2 alpha J), as alpha
    // becomes small.
    for (inertia, limit, rate) in [(1.0, 1.0, 0.01), (2.0, 3.0, 0.02), (380.0, 2.0, 1e-4)] {
        let file = asked(
            json!({ "state_matrices": [[[0, 1], [0, 0]]], "input_matrix": [[0], [1.0 / inertia]] }),
            json!({ "saturated_region": { "input_limit": [limit], "decay_rate_per_s": rate } }),
        );
        let (_, found) = proved(&file);
        let known = limit / (2.0 * rate * inertia);
        assert_between(found.guarantee / known, 0.995, 1.0);
    }
}

#[test]
fn a_plant_with_stiff_vertices_needs_no_overshoot() {
    // With Q = I the one direction that no input reaches decays at every vertex: c = 1.
    let vertex = |k: f64| json!([[0, 0, 0], [0, 0, 0], [0, -k, 0]]);
    let file = asked(
        json!({
            "state_matrices": [vertex(40.0), vertex(6e5)],
            "input_matrix": [[1, 0], [0, 1], [0, -500]],
        }),
        json!({ "quadratic_stabilisation": { "decay_rate_per_s": 0.01 } }),
    );
    let (_, found) = proved(&file);
    assert_between(found.guarantee, 1.0, 1.002);
}

#[test]
fn a_stable_chain_in_unlike_units_is_proved() {
    // Triangular and Hurwitz: in other units of the states the overshoot is as near to 1 as one likes.
    let mut file = asked(
        json!({
            "state_matrices": [[[-0.02, 0, 0], [3e-6, -0.03, 0], [0, 4e4, -0.5]]],
            "input_matrix": [[1], [0], [0]],
        }),
        json!({ "quadratic_stabilisation": {} }),
    );
    file["gain"] = json!([[0, 0, 0]]);
    proved(&file);
}

#[test]
fn a_pendulum_on_a_cart_behind_a_lag_has_one_feedback_for_both_rules() {
    for lag in [40.0, 700.0] {
        let vertex = |k: f64, b: f64| json!([[0, 1, 0], [k, 0, -b], [0, 0, -lag]]);
        let file = asked(
            json!({
                "state_matrices": [vertex(15.0, 0.15), vertex(9.0, 0.006)],
                "input_matrix": [[0], [0], [lag]],
            }),
            json!({ "quadratic_stabilisation": { "decay_rate_per_s": 0.2 } }),
        );
        let (design, _) = proved(&file);
        let optimality = design.optimality.expect("a best objective");
        assert!(optimality.relative_gap < 0.01, "{optimality:?}");
    }
}
