//! Each correction to the printed conditions of Xu & Huang 2020, shown by numbers: the printed term
//! does not give what the proof needs, the corrected one does.

use crate::closed_loop::{in_rows, magnitude, quadratic, Instant, Terms};
use crate::exact::Stream;
use crate::instants::{Case, Decrease, DEAD_ZONE, SAMPLE};
use crate::random;
use crate::random::{assert_close, vector, Point};
use nalgebra::{DMatrix, DVector};
use synth::conditions::xu2020::{
    side_conditions, DesignUnknowns, Sector, Strictness, DEAD_ZONE_UNIT,
};
use synth::conditions::{Specification, Task};
use synth::fuzzy::TakagiSugeno;
use synth::lmi::Unknowns;

fn largest_eigenvalue(matrix: &DMatrix<f64>) -> f64 {
    matrix.clone().symmetric_eigenvalues().max()
}

/// What a family of instants says about a bound on V' + phi V - xi |tau|^2.
#[derive(Default, Debug)]
struct Tally {
    instants: usize,
    saturated: usize,
    broken: usize,
    /// Instants where the bound is broken although the change to it had nothing to act on.
    broken_without_cause: usize,
    worst: f64,
}

/// Evaluates a bound at random instants of random closed loops; `cause` says whether the printed term
/// differs there.
fn tally(
    form: impl Fn(&Case) -> Decrease,
    cause: impl Fn(&Instant) -> bool,
    instants: usize,
) -> Tally {
    let mut stream = Stream(28);
    let mut out = Tally::default();
    while out.instants < instants {
        let case = Case::random(&mut stream);
        let matrices = form(&case);
        let hbar = case.task.specification.sampling_interval_max;
        for _ in 0..20 {
            // At a sample, inside the longest interval, inside a shorter one.
            let interval = hbar * [1.0, 1.0, 0.4][out.instants % 3];
            let elapsed = interval * [0.0, 0.5 + 0.5 * stream.signed_unit(), 0.7][out.instants % 3];
            let offset = if elapsed == 0.0 { 0.0 } else { 0.3 };
            let Some(at) = case.instant(&mut stream, offset) else {
                continue;
            };
            let first_rate = vector(&mut stream, case.task.system.states(), 10.0);
            let truth = case.derivative(&at, &first_rate, elapsed, interval);
            let rows = in_rows(&case.point.design, &case.of, &at);
            let gap = matrices.bound(&rows, elapsed / interval) - truth;
            let scale = magnitude(&matrices.start, &rows);
            out.instants += 1;
            out.saturated += usize::from(at.dead_zone.norm() > 0.0);
            out.worst = out.worst.min(gap / scale);
            if gap < -1e-10 * scale {
                out.broken += 1;
                out.broken_without_cause += usize::from(!cause(&at));
            }
        }
    }
    out
}

#[test]
fn the_corrected_form_bounds_the_derivative_of_the_functional() {
    let found = tally(|case| case.decrease(), |_| true, 6000);
    assert_eq!(found.broken, 0, "{found:?}");
    assert!(found.saturated > 500, "{found:?}");
}

#[test]
fn just_after_a_sample_the_corrected_form_exceeds_the_derivative_by_the_two_slacks_only() {
    let mut stream = Stream(29);
    let mut compared = 0;
    while compared < 500 {
        let case = Case::random(&mut stream);
        let Some(at) = case.instant(&mut stream, 0.0) else {
            continue;
        };
        let hbar = case.task.specification.sampling_interval_max;
        let truth = case.derivative(&at, &at.rate, 0.0, hbar);
        let terms = Terms::new(&case.task, &case.plant, &at, &case.of);
        assert!(
            terms.trigger >= 0.0 && terms.sector >= -1e-12,
            "both slacks are not negative"
        );
        let matrices = case.decrease();
        let rows = in_rows(&case.point.design, &case.of, &at);
        let bound = matrices.bound(&rows, 0.0);
        let scale = magnitude(&matrices.start, &rows);
        let rest = bound - truth - terms.trigger - terms.sector;
        assert!(rest.abs() <= 1e-12 * scale, "{rest:e} of {scale:e}");
        compared += 1;
    }
}

#[test]
fn the_printed_rate_block_without_u_does_not_bound_the_derivative() {
    let printed = |case: &Case| {
        case.decrease()
            .with_printed_rate_block(&case.task, &case.plant, &case.point)
    };
    let found = tally(printed, |_| true, 3000);
    assert!(found.broken > found.instants / 10, "{found:?}");
    assert!(found.worst < -1e-3, "{found:?}");
}

#[test]
fn the_printed_form_without_the_error_block_does_not_bound_the_derivative_when_saturated() {
    let printed = |case: &Case| case.decrease().with_printed_sector();
    let cause = |at: &Instant| at.dead_zone.norm() > 0.0 && at.error.norm() > 0.0;
    let found = tally(printed, cause, 6000);
    assert!(found.broken > 100, "{found:?}");
    assert!(found.worst < -1e-4, "{found:?}");
    assert_eq!(found.broken_without_cause, 0, "{found:?}");
}

fn one_by_one(value: f64) -> DMatrix<f64> {
    DMatrix::from_element(1, 1, value)
}

/// x' = a x + b sat(u) + b_w tau, y = x with one state and one input.
fn scalar_task(a: f64, b: f64, b_w: f64, specification: Specification) -> Task {
    let system = TakagiSugeno {
        vertices: vec![one_by_one(a)],
        descriptors: Vec::new(),
        input: one_by_one(b),
        disturbance: one_by_one(b_w),
        output: one_by_one(1.0),
        input_limit: DVector::from_element(1, 1.0),
        disturbance_bound: 1.0,
        region: Vec::new(),
    };
    Task::new(system, specification)
}

fn specification(
    decay_rate: f64,
    interval: f64,
    threshold: f64,
    weights: [f64; 3],
) -> Specification {
    Specification {
        decay_rate,
        sampling_interval_max: interval,
        trigger_threshold: threshold,
        multiplier_weights: weights,
        disturbance_weight_max: 1000.0,
        must_contain: Vec::new(),
        containment_weight: 1.0,
        margin: 0.0,
    }
}

/// The unknowns of a scalar problem: (name, value); what is not named is 0.
fn scalar_point(task: &Task, values: &[(&str, f64)]) -> Point {
    let mut unknowns = Unknowns::new();
    let design = DesignUnknowns::new(&mut unknowns, task, Sector::Unknown);
    let mut point = Point {
        values: vec![0.0; unknowns.count()],
        unknowns,
        design,
    };
    for (name, value) in values {
        let unit = match *name {
            "Nh" => DEAD_ZONE_UNIT,
            "S" => DEAD_ZONE_UNIT.powi(2),
            _ => 1.0,
        };
        point.set(name, &one_by_one(value * unit));
    }
    point
}

#[test]
fn the_printed_conditions_hold_for_an_unstable_plant_without_control() {
    // x' = 3 x + tau, F = 0.
    let task = scalar_task(
        3.0,
        1.0,
        1.0,
        specification(0.05, 0.01, 0.05, [-1.3, 0.4, 0.7]),
    );
    let point = scalar_point(
        &task,
        &[
            ("Uh", 0.01),
            ("Yh", 1.0),
            ("Wh", 0.3),
            ("Qh", 1.0),
            ("L1h", 2.5),
            ("L2h", 0.8),
            ("S", 0.01),
            ("xi", 100.0),
            ("gamma", 3000.0),
        ],
    );
    let corrected = Decrease::corrected(&task, &one_by_one(3.0), &point);
    let printed = corrected.with_printed_rate_block(&task, &one_by_one(3.0), &point);
    assert!(largest_eigenvalue(&printed.start) < -0.05);
    assert!(largest_eigenvalue(&printed.end) < -0.05);
    for condition in side_conditions(&task, &point.design, &Strictness::fixed(0.0)) {
        let value = condition.expression().value(&point.values);
        let smallest = value.symmetric_eigenvalues().min();
        assert!(smallest >= 0.0, "{}: {smallest}", condition.name());
    }
    assert!(
        largest_eigenvalue(&corrected.start) > 0.05,
        "the corrected condition refuses it"
    );
}

#[test]
fn the_printed_product_of_n_and_m_is_not_affine_and_its_set_is_not_convex() {
    let task = scalar_task(
        -1.0,
        0.5,
        0.3,
        specification(0.2, 0.05, 0.1, [1.0, 0.5, 0.5]),
    );
    let with = |n: f64, s: f64| {
        let point = scalar_point(
            &task,
            &[
                ("Uh", 1.0),
                ("Yh", 0.5),
                ("Wh", 0.5),
                ("Qh", 1.0),
                ("L1h", -1.0),
                ("L2h", 1.0),
                ("Nh", n),
                ("S", s),
                ("xi", 4.0),
            ],
        );
        Decrease::corrected(&task, &one_by_one(-1.0), &point)
    };
    // The printed rows: the dead-zone row not multiplied by S = M^-1.
    let printed = |n: f64, m: f64| {
        let mut rows = DVector::from_element(6, 1.0);
        rows[DEAD_ZONE] = m / DEAD_ZONE_UNIT;
        let rows = DMatrix::from_diagonal(&rows);
        let corrected = with(n, 1.0 / m);
        let out = Decrease {
            start: &rows * &corrected.start * &rows,
            end: &rows * &corrected.end * &rows,
            ..corrected
        };
        // N'M in Xi_35, as printed (eps3 = b = 1/2).
        assert_close(
            &out.block(SAMPLE, DEAD_ZONE),
            &one_by_one(-0.25 + n * m),
            1e-12,
            "Xi_35",
        );
        assert_close(
            &out.block(DEAD_ZONE, DEAD_ZONE),
            &one_by_one(-2.0 * m),
            1e-12,
            "Xi_55",
        );
        out
    };
    let worst =
        |form: &Decrease| largest_eigenvalue(&form.start).max(largest_eigenvalue(&form.end));
    let ends = [(0.1, 1.0), (1e-4, 1000.0)];
    for (n, m) in ends {
        assert!(
            worst(&printed(n, m)) < -0.3,
            "both ends satisfy the printed condition"
        );
    }
    let middle = (0.5 * (ends[0].0 + ends[1].0), 0.5 * (ends[0].1 + ends[1].1));
    assert!(
        worst(&printed(middle.0, middle.1)) > 0.3,
        "their average does not"
    );
    let average = |a: &Decrease, b: &Decrease| 0.5 * (&a.start + &b.start);
    let between = average(&printed(0.1, 1.0), &printed(1e-4, 1000.0));
    let distance = printed(middle.0, middle.1).start - between;
    assert!(
        random::size(&distance) > 1.0,
        "the printed block is not affine"
    );

    let corrected_ends = [with(0.1, 1.0), with(1e-4, 1e-3)];
    let corrected_middle = with(middle.0, 0.5 * (1.0 + 1e-3));
    let between = average(&corrected_ends[0], &corrected_ends[1]);
    assert_close(
        &corrected_middle.start,
        &between,
        1e-14,
        "the corrected matrix is affine",
    );
    assert!(worst(&corrected_middle) < 0.0);
}

#[test]
fn the_printed_sector_bound_with_the_last_sample_fails_when_the_held_state_differs() {
    // u = F x(t_k) with F = -1, N = -0.6, ubar = 1; x(t_k) = 2, x(t_k^l) = 1.5.
    let (f, n, limit) = (-1.0_f64, -0.6, 1.0);
    let (held, sample) = (2.0, 1.5);
    let command = f * held;
    let dead_zone = command - command.clamp(-limit, limit);
    for state in [held, sample] {
        assert!(((f - n) * state).abs() <= limit, "inside the set (16)");
    }
    assert!(
        dead_zone * (dead_zone - n * sample) > 0.09,
        "(17) with x(t_k^l)"
    );
    assert!(
        dead_zone * (dead_zone - n * held) <= 0.0,
        "(17) with x(t_k)"
    );
}

/// The rule below (10), printed: only a lower bound.
fn updated_threshold(threshold: f64, mu: [f64; 3], moved: f64, least: f64) -> f64 {
    let factor = 1.0 - 2.0 * mu[0] / std::f64::consts::PI * (mu[1] * (moved - mu[2])).atan();
    (threshold * factor).max(least)
}

#[test]
fn a_threshold_bounded_from_below_only_breaks_the_trigger_inequality_and_the_bound() {
    let design = 0.1;
    let mu = [10.0, 1.0, 0.02];
    // Near rest the state hardly moves between triggers.
    let unclamped = (0..10).fold(design, |nu, _| updated_threshold(nu, mu, 1e-3, design));
    assert!(
        unclamped > 3.0 * design,
        "it grows by up to 12.7 % at every trigger: {unclamped}"
    );
    let clamped = (0..10).fold(design, |nu, _| {
        updated_threshold(nu, mu, 1e-3, design).min(design)
    });
    assert_eq!(clamped, design);

    let mut stream = Stream(25);
    for _ in 0..50 {
        let mut case = Case::random(&mut stream);
        case.task.specification.trigger_threshold = design;
        let n = case.task.system.states();
        let weight = &case.of.trigger_weight;
        // A small held state, so that nothing saturates, and an error between the two thresholds.
        let held = vector(&mut stream, n, 1e-2);
        let direction = vector(&mut stream, n, 1.0);
        let between = 0.5 * (design + unclamped);
        let length = between * quadratic(weight, &held) / quadratic(weight, &direction);
        let error = direction * length.sqrt();
        let sample = &held + &error;
        let rate = &case.plant * &sample + &case.task.system.input * (&case.of.gain * &held);
        let at = Instant {
            state: sample.clone(),
            rate,
            sample,
            error,
            dead_zone: DVector::zeros(case.task.system.inputs()),
            disturbance: DVector::zeros(case.task.system.disturbance.ncols()),
        };
        let triggers = |threshold: f64| {
            quadratic(weight, &at.error) >= threshold * quadratic(weight, &at.held())
        };
        assert!(!triggers(unclamped), "the printed rule sends nothing");
        assert!(triggers(clamped), "the clamped rule sends");
        let terms = Terms::new(&case.task, &case.plant, &at, &case.of);
        assert!(terms.trigger < 0.0, "(25) is broken");
        let hbar = case.task.specification.sampling_interval_max;
        let truth = case.derivative(&at, &at.rate, 0.0, hbar);
        let rows = in_rows(&case.point.design, &case.of, &at);
        let bound = case.decrease().bound(&rows, 0.0);
        assert!(bound < truth, "(28) is broken: {bound:e} against {truth:e}");
        // By exactly what (25) is short of.
        assert!((bound - truth - terms.trigger).abs() <= 1e-6 * terms.trigger.abs());
    }
}

#[test]
fn the_printed_rho_in_the_gain_condition_admits_a_gain_bound_below_the_true_gain() {
    // x' = -x + tau, y = x: sup|y| / sup|tau| = 1. With phi = 1 and U = xi,
    // V' + phi V - xi |tau|^2 = -xi (x - tau)^2.
    let task = scalar_task(-1.0, 1.0, 1.0, specification(1.0, 0.01, 0.1, [1.0; 3]));
    let xi = 4.0;
    for tenths in -20..=20 {
        let (x, tau) = (f64::from(tenths) / 10.0, 0.7);
        let derivative = 2.0 * xi * x * (tau - x) + xi * x * x - xi * tau * tau;
        assert!(derivative <= 1e-12);
    }
    let printed = |gamma: f64, rho: f64| {
        let rows = [xi, 0.0, 1.0, 0.0, gamma - rho, 0.0, 1.0, 0.0, gamma];
        DMatrix::from_row_slice(3, 3, &rows)
    };
    let smallest = |matrix: DMatrix<f64>| matrix.symmetric_eigenvalues().min();
    // rho is the vector of premise variables, 0 at rest; any value below gamma passes.
    let wrong = 0.3;
    assert!(
        smallest(printed(wrong, 0.0)) > 0.0,
        "a bound of 0.3 on a gain of 1"
    );
    assert!(smallest(printed(wrong, xi)) < 0.0, "with xi it is refused");
    let holds = |gamma: f64| {
        let point = scalar_point(
            &task,
            &[
                ("Uh", xi),
                ("Yh", 1.0),
                ("Wh", 1.0),
                ("Qh", 1.0),
                ("S", 1.0),
                ("xi", xi),
                ("gamma", gamma),
            ],
        );
        let conditions = side_conditions(&task, &point.design, &Strictness::fixed(0.0));
        let mut gain = conditions
            .iter()
            .filter(|condition| condition.name().contains("gain"));
        assert_eq!(gain.clone().count(), 2);
        gain.all(|condition| smallest(condition.expression().value(&point.values)) > 0.0)
    };
    assert!(!holds(wrong));
    assert!(!holds(xi - 0.01));
    assert!(holds(xi + 0.01));
}
