//! Design problems: answers known from theory and from the literature, plants on either side of a
//! limit, and designs with one number changed.

mod tampered;
mod units;
mod unreachable;
mod wanted;

use crate::exact::Exact;
use crate::tampering::*;
use nalgebra::{DMatrix, DVector};
use serde_json::{json, Value};
use synth::certify::interval::Interval;
use synth::certify::Verdict;
use synth::conditions::state_feedback::StateFeedback;
use synth::problem::{synthesize, Problem, ProblemDesignFile, ProblemOutcome, ProblemSynthesized};
use synth::solve::Solver;
use synth::synthesis::Solvers;

/// The objective may exceed the optimum by this much, relative: the price of a margin.
const ROOM_ABOVE_OPTIMUM: f64 = 1.1e-3;

fn problem(file: &Value) -> Problem {
    Problem::from_json(&file.to_string()).expect("a valid problem file")
}

fn shipped(name: &str) -> Value {
    let path = format!("{}/../models/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a shipped file");
    serde_json::from_str(&text).expect("JSON")
}

fn asked(plant: Value, problem: Value) -> Value {
    json!({
        "schema_version": 1,
        "name": "test",
        "plant": { "vertices": plant },
        "problem": problem,
    })
}

fn outcome(file: &Value) -> ProblemOutcome {
    let solvers = Solvers::both([Solver::Clarabel, Solver::Structured]);
    synthesize(&problem(file), &file.to_string(), &solvers, None)
        .expect("the solvers accept the problem")
}

#[track_caller]
fn proved(file: &Value) -> (ProblemSynthesized, StateFeedback) {
    let ProblemOutcome::Solved(design) = outcome(file) else {
        panic!("no feedback was found for {file}");
    };
    assert_eq!(
        design.report.verdict,
        Verdict::Proved,
        "{:?}",
        design.report
    );
    // What a reader of the file's text gets is proved too.
    let (read, problem) = ProblemDesignFile::from_json(&design.file.to_json()).expect("valid");
    assert_eq!(read, design.file);
    let report = read.verify(&problem).expect("a valid file");
    assert_eq!(report.verdict, Verdict::Proved);
    let feedback = read.feedback(&problem).expect("a valid file");
    (*design, feedback)
}

/// That there is none is proved.
#[track_caller]
fn assert_infeasible(file: &Value) {
    assert!(
        matches!(outcome(file), ProblemOutcome::Infeasible(_)),
        "{file}"
    );
}

/// That there is none is proved, or at least no feedback is found.
#[track_caller]
fn assert_no_feedback(file: &Value) {
    assert!(
        matches!(
            outcome(file),
            ProblemOutcome::Infeasible(_) | ProblemOutcome::Undecided(_)
        ),
        "{file}"
    );
}

#[track_caller]
fn assert_between(found: f64, least: f64, greatest: f64) {
    assert!(
        (least..=greatest).contains(&found),
        "{found} is not in [{least}, {greatest}]"
    );
}

/// x'' + c x' + k(t) x = 0 without feedback, with k(t) in [low, high].
fn oscillator(damping: f64, low: f64, high: f64, rate: f64) -> Value {
    let vertex = |k: f64| json!([[0, 1], [-k, -damping]]);
    let plant =
        json!({ "state_matrices": [vertex(low), vertex(high)], "input_matrix": [[0], [1]] });
    let mut file = asked(
        plant,
        json!({ "quadratic_stabilisation": { "decay_rate_per_s": rate } }),
    );
    file["gain"] = json!([[0, 0]]);
    file
}

#[test]
fn an_oscillator_is_quadratically_stable_up_to_the_circle_criterion() {
    // sqrt(k_max) - sqrt(k_min) < c.
    for (damping, low) in [(2.0, 1.0), (0.5, 4.0), (1.0, 0.01)] {
        let limit = (f64::sqrt(low) + damping).powi(2);
        proved(&oscillator(damping, low, 0.97 * limit, 0.0));
        proved(&oscillator(damping, low, 0.999 * limit, 0.0));
        assert_no_feedback(&oscillator(damping, low, 1.001 * limit, 0.0));
        assert_no_feedback(&oscillator(damping, low, 1.03 * limit, 0.0));
    }
}

#[test]
fn a_decay_rate_moves_the_limit_of_the_oscillator_as_a_shift_of_its_poles_does() {
    // With z = e^(alpha t) x: z'' + (c - 2 alpha) z' + (k - alpha c + alpha^2) z = 0.
    let (damping, low, rate) = (3.0, 3.0, 0.4);
    let shift = rate * rate - rate * damping;
    let reach = f64::sqrt(low + shift) + damping - 2.0 * rate;
    let limit = reach * reach - shift;
    proved(&oscillator(damping, low, 0.99 * limit, rate));
    assert_no_feedback(&oscillator(damping, low, 1.01 * limit, rate));
}

#[test]
fn a_plant_without_a_mode_to_reach_limits_the_decay_rate() {
    // Where k = 0 the mode at -1 cannot be moved.
    let mut file = shipped("uncertain-coupling");
    let rate = "/problem/quadratic_stabilisation/decay_rate_per_s";
    for (value, possible) in [(0.95, true), (0.99, true), (1.01, false), (1.05, false)] {
        *file.pointer_mut(rate).expect("the rate") = json!(value);
        match possible {
            true => drop(proved(&file)),
            false => assert_infeasible(&file),
        }
    }
    // Where k keeps its sign there is no such limit.
    *file.pointer_mut(rate).expect("the rate") = json!(5.0);
    file["plant"]["vertices"]["state_matrices"][0][0][1] = json!(0.5);
    proved(&file);
}

#[test]
fn an_uncertain_double_integrator_is_stabilised_until_its_coupling_may_vanish() {
    let cart = |width: f64| {
        let vertex = |k: f64| json!([[0, k], [0, 0]]);
        let vertices = [vertex(1.0 - width), vertex(1.0 + width)];
        asked(
            json!({ "state_matrices": vertices, "input_matrix": [[0], [1]] }),
            json!({ "quadratic_stabilisation": {} }),
        )
    };
    proved(&cart(0.97));
    assert_infeasible(&cart(1.03));
}

#[test]
fn the_overshoot_bounds_what_a_switching_plant_does() {
    let (_, found) = proved(&shipped("oscillator-stability"));
    let file = problem(&shipped("oscillator-stability"));
    let mut largest: f64 = 0.0;
    for start in 0..24 {
        let angle = f64::from(start) / 24.0 * std::f64::consts::PI;
        let mut x = DVector::from_vec(vec![angle.cos(), angle.sin()]);
        for _ in 0..4000 {
            // The vertex along which the norm grows fastest.
            let rates = file
                .plant
                .vertices
                .iter()
                .map(|a| (x.transpose() * a * &x)[(0, 0)]);
            let rates: Vec<f64> = rates.collect();
            let a = &file.plant.vertices[usize::from(rates[1] > rates[0])];
            x += 1e-3 * a * (&x + 5e-4 * a * &x);
            largest = largest.max(x.norm());
        }
    }
    assert_between(largest, 1.0, found.guarantee);
    assert!(found.guarantee < 2.4 && largest > 1.2, "{largest}");
}

/// x' = a x + u + w, z = [c x; u] with a < 0: gamma = c / sqrt(a^2 + c^2).
fn scalar(vertices: &[f64], weight: f64) -> Value {
    let matrices: Vec<Value> = vertices.iter().map(|a| json!([[a]])).collect();
    asked(
        json!({ "state_matrices": matrices, "input_matrix": [[1]] }),
        json!({ "h_infinity": {
            "disturbance_matrix": [[1]],
            "output_matrix": [[weight], [0]],
            "input_to_output_matrix": [[0], [1]],
        } }),
    )
}

#[test]
fn a_scalar_plant_has_its_known_smallest_gain() {
    for (a, weight) in [
        (-1.0, 1.0),
        (-3.0, 0.5),
        (-0.2, 4.0),
        (-1e-3, 1e-3),
        (-500.0, 100.0),
    ] {
        let optimum = weight / f64::hypot(a, weight);
        let (design, _) = proved(&scalar(&[a], weight));
        let gamma = design.file.certificate.guarantee;
        assert_between(gamma / optimum, 1.0, 1.0 + ROOM_ABOVE_OPTIMUM);
    }
    // Of two vertices the one nearer to instability decides.
    let (design, _) = proved(&scalar(&[-1.0, -2.0], 1.0));
    let gamma = design.file.certificate.guarantee;
    assert_between(
        gamma,
        0.5_f64.sqrt(),
        0.5_f64.sqrt() * (1.0 + ROOM_ABOVE_OPTIMUM),
    );
}

/// The largest singular value of C (j w I - A)^-1 B, from real matrices of twice the size.
fn frequency_gain(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>, w: f64) -> f64 {
    let n = a.nrows();
    let complex = |real: &DMatrix<f64>, imaginary: &DMatrix<f64>| {
        let (rows, columns) = real.shape();
        let mut out = DMatrix::zeros(2 * rows, 2 * columns);
        out.view_mut((0, 0), (rows, columns)).copy_from(real);
        out.view_mut((rows, columns), (rows, columns))
            .copy_from(real);
        out.view_mut((0, columns), (rows, columns))
            .copy_from(&-imaginary);
        out.view_mut((rows, 0), (rows, columns))
            .copy_from(imaginary);
        out
    };
    let none = |matrix: &DMatrix<f64>| DMatrix::zeros(matrix.nrows(), matrix.ncols());
    let pencil = complex(&-a, &(w * DMatrix::identity(n, n)));
    let inverse = pencil.try_inverse().expect("a stable loop");
    let response = complex(c, &none(c)) * inverse * complex(b, &none(b));
    response.singular_values().max()
}

#[test]
fn a_symmetric_network_has_the_published_smallest_gain() {
    // Lidstrom and Rantzer, ACC 2016: |(A^2 + B B')^-1|^(1/2) for z = [x; u], w on every state.
    let file = shipped("buffer-network");
    let plant = problem(&file).plant;
    let (a, b) = (&plant.vertices[0], &plant.input);
    let gram = a * a + b * b.transpose();
    let optimum = (1.0 / gram.symmetric_eigenvalues().min()).sqrt();
    let (_, found) = proved(&file);
    assert_between(found.guarantee / optimum, 1.0, 1.0 + ROOM_ABOVE_OPTIMUM);
    assert_between(optimum, 2.798, 2.799);
    // An independent look at the closed loop: its frequency response.
    let closed = a + b * &found.gain;
    let mut output = DMatrix::zeros(5, 3);
    output
        .view_mut((0, 0), (3, 3))
        .copy_from(&DMatrix::identity(3, 3));
    output.view_mut((3, 0), (2, 3)).copy_from(&found.gain);
    let gains = (0..200).map(|k| {
        let w = if k == 0 {
            0.0
        } else {
            10_f64.powf(-3.0 + 0.03 * f64::from(k))
        };
        frequency_gain(&closed, &DMatrix::identity(3, 3), &output, w)
    });
    assert_between(
        gains.fold(0.0, f64::max),
        optimum * (1.0 - 1e-9),
        found.guarantee,
    );
}

#[test]
fn a_given_feedback_has_the_gain_of_its_frequency_response() {
    // x'' = u + w with u = -x - x', z = x: 1 / |1 - w^2 + j w| peaks at sqrt(4/3).
    let mut file = asked(
        json!({ "state_matrices": [[[0, 1], [0, 0]]], "input_matrix": [[0], [1]] }),
        json!({ "h_infinity": {
            "disturbance_matrix": [[0], [1]],
            "output_matrix": [[1, 0]],
        } }),
    );
    file["gain"] = json!([[-1, -1]]);
    let (design, found) = proved(&file);
    let peak = (4.0_f64 / 3.0).sqrt();
    assert_between(found.guarantee / peak, 1.0, 1.0 + ROOM_ABOVE_OPTIMUM);
    assert_eq!(design.file.controller.gain, vec![vec![-1.0, -1.0]]);
    // A feedback that does not stabilise has no gain.
    file["gain"] = json!([[-1, 1]]);
    assert_infeasible(&file);
}

#[test]
fn a_mode_that_no_input_reaches_leaves_no_gain() {
    let file = asked(
        json!({ "state_matrices": [[[1, 0], [0, -1]]], "input_matrix": [[0], [1]] }),
        json!({ "h_infinity": {
            "disturbance_matrix": [[1], [0]],
            "output_matrix": [[1, 1]],
        } }),
    );
    assert_infeasible(&file);
}

#[test]
fn the_published_ellipsoid_is_the_largest_of_its_shape() {
    // Hu, Lin and Chen 2002, example 1; the four digits printed leave 1e-3.
    let (_, found) = proved(&shipped("saturated-pendulum"));
    assert_between(found.guarantee, 0.999, 1.001);
    let published = DMatrix::from_row_slice(2, 2, &[0.1170, 0.0627, 0.0627, 0.0558]);
    assert!((&found.lyapunov - published).amax() < 2e-4, "{found:?}");
}

/// Steps of the saturated loop from a start; the final norm.
fn saturated_run(problem: &Problem, gain: &DMatrix<f64>, limit: f64, start: DVector<f64>) -> f64 {
    let plant = &problem.plant;
    let rate = |x: &DVector<f64>| {
        let input = (gain * x).map(|u| u.clamp(-limit, limit));
        &plant.vertices[0] * x + &plant.input * input
    };
    let (mut x, step) = (start, 1e-3);
    for _ in 0..20_000 {
        let middle = &x + 0.5 * step * rate(&x);
        x += step * rate(&middle);
        if x.norm() > 1e3 {
            break;
        }
    }
    x.norm()
}

#[test]
fn a_designed_feedback_reaches_the_strip_that_no_input_can_leave() {
    // x1 + x2 grows by itself and is moved by 5 sat(u): |x1 + x2| < 5 is all that any feedback can
    // hold (Hu, Lin and Qiu 2002), so the largest ball has radius 5 / sqrt(2).
    let mut file = shipped("saturated-pendulum");
    file.as_object_mut().expect("an object").remove("gain");
    file["problem"]["saturated_region"]["reference"] = json!({ "ellipsoid": [[1, 0], [0, 1]] });
    let (_, found) = proved(&file);
    let limit = 5.0 / 2.0_f64.sqrt();
    assert_between(found.guarantee / limit, 0.999, 1.0);
    let problem = problem(&file);
    for k in 0..16 {
        let angle = f64::from(k) / 8.0 * std::f64::consts::PI;
        let start = found.guarantee * DVector::from_vec(vec![angle.cos(), angle.sin()]);
        let end = saturated_run(&problem, &found.gain, 1.0, start);
        assert!(end < 0.1, "from {angle} rad the loop ends at {end}");
    }
    let beyond = DVector::from_vec(vec![2.6, 2.6]);
    assert!(saturated_run(&problem, &found.gain, 1.0, beyond) > 100.0);
}

#[test]
fn an_unstable_scalar_plant_is_held_up_to_what_its_input_can_do() {
    // x' = a x + b sat(u): |x| < b ubar / a, for every feedback that stabilises.
    for (a, b, limit) in [(1.0, 1.0, 1.0), (0.02, 5.0, 0.3), (40.0, 0.01, 2e3)] {
        let mut file = asked(
            json!({ "state_matrices": [[[a]]], "input_matrix": [[b]] }),
            json!({ "saturated_region": { "input_limit": [limit] } }),
        );
        let known = b * limit / a;
        for gain in [None, Some(-3.0 * a / b), Some(-50.0 * a / b)] {
            match gain {
                Some(gain) => file["gain"] = json!([[gain]]),
                None => drop(file.as_object_mut().expect("an object").remove("gain")),
            }
            let (_, found) = proved(&file);
            assert_between(found.guarantee / known, 0.999, 1.0);
        }
    }
}

#[test]
fn the_box_and_the_reference_points_bound_the_region() {
    let region = json!({
        "input_limit": [1],
        "reference": { "points": [[1, 0], [0, 1]] },
        "box": [{ "row": [1, 0], "bound": 0.5 }, { "row": [0, 2], "bound": 3 }],
    });
    let file = asked(
        json!({ "state_matrices": [[[0, 1], [1, 0]]], "input_matrix": [[0], [5]] }),
        json!({ "saturated_region": region }),
    );
    let (_, found) = proved(&file);
    // The first point can be blown up to half its length only.
    assert_between(found.guarantee, 0.4995, 0.5);
    let spread = found.lyapunov.clone().try_inverse().expect("definite");
    assert!(spread[(0, 0)] < 0.25 && spread[(1, 1)] < 2.25);
}

#[test]
fn the_size_of_the_reference_set_and_of_the_box_does_not_matter() {
    // beta is the box over the point's length, from 1e-9 to 1e9.
    for (bound, length) in [(1e-9, 1.0), (1e-3, 1e6), (0.25, 1e-8), (1.0, 1.0)] {
        let region = json!({
            "input_limit": [1],
            "reference": { "points": [[length, 0]] },
            "box": [{ "row": [1, 0], "bound": bound }],
        });
        let file = asked(
            json!({ "state_matrices": [[[0, 1], [1, 0]]], "input_matrix": [[0], [5]] }),
            json!({ "saturated_region": region }),
        );
        let (_, found) = proved(&file);
        assert_between(found.guarantee * length / bound, 0.999, 1.0);
    }
}

#[test]
fn a_stable_plant_gets_a_region_as_large_as_is_looked_for() {
    let file = asked(
        json!({ "state_matrices": [[[-1]]], "input_matrix": [[1]] }),
        json!({ "saturated_region": { "input_limit": [1] } }),
    );
    let (_, found) = proved(&file);
    assert!(found.guarantee > 900.0, "{}", found.guarantee);
}

#[test]
fn two_inputs_saturate_one_by_one() {
    let file = asked(
        json!({
            "state_matrices": [[[0.1, -0.1], [0.1, -3.0]]],
            "input_matrix": [[5, 0], [0, 1]],
        }),
        json!({ "saturated_region": { "input_limit": [5, 2], "decay_rate_per_s": 0.01 } }),
    );
    let (design, found) = proved(&file);
    let decays = design.report.conditions.iter();
    let decays = decays.filter(|condition| condition.name.starts_with("decay"));
    assert_eq!(decays.count(), 4);
    assert!(found.guarantee > 50.0, "{}", found.guarantee);
}
