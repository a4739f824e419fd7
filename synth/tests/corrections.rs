//! Each correction to the printed conditions of Xu & Huang 2020, shown by numbers: the printed term
//! does not give what the proof needs, the corrected one does.

#[path = "support/closed_loop.rs"]
mod closed_loop;
#[path = "support/exact.rs"]
mod exact;
#[path = "support/random.rs"]
mod random;

use closed_loop::{in_rows, magnitude, quadratic, schur_complement, Instant, Quantities, Terms};
use exact::Stream;
use nalgebra::{DMatrix, DVector};
use random::{assert_close, uniform, vector, Point, Sizes};
use synth::conditions::xu2020::{
    decrease, side_conditions, DesignUnknowns, Interval, Sector, Strictness, DEAD_ZONE_UNIT,
};
use synth::conditions::{Specification, Task};
use synth::fuzzy::TakagiSugeno;
use synth::lmi::Unknowns;

fn largest_eigenvalue(matrix: &DMatrix<f64>) -> f64 {
    matrix.clone().symmetric_eigenvalues().max()
}

/// The rows of (18), in order.
const STATE: usize = 0;
const RATE: usize = 1;
const SAMPLE: usize = 2;
const ERROR: usize = 3;
const DEAD_ZONE: usize = 4;

/// (18) for r = 1 and r = 2, both on the rows x, x', x(t_k^l), e, dead zone, tau.
#[derive(Clone)]
struct Decrease {
    start: DMatrix<f64>,
    end: DMatrix<f64>,
    states: usize,
    inputs: usize,
}

impl Decrease {
    /// As the crate states it.
    fn corrected(task: &Task, vertex: &DMatrix<f64>, point: &Point) -> Self {
        let at = |interval| decrease(task, vertex, interval, &point.design).value(&point.values);
        Decrease {
            start: at(Interval::Start),
            end: schur_complement(&at(Interval::End), task.system.states()),
            states: task.system.states(),
            inputs: task.system.inputs(),
        }
    }

    fn range(&self, row: usize) -> (usize, usize) {
        let n = self.states;
        (row * n, if row == DEAD_ZONE { self.inputs } else { n })
    }

    /// The same with one block above the diagonal replaced, and its mirror image.
    fn with_block(&self, row: usize, column: usize, block: &DMatrix<f64>) -> Self {
        let ((r, height), (c, width)) = (self.range(row), self.range(column));
        let mut out = self.clone();
        for matrix in [&mut out.start, &mut out.end] {
            matrix.view_mut((r, c), (height, width)).copy_from(block);
            matrix
                .view_mut((c, r), (width, height))
                .copy_from(&block.transpose());
        }
        out
    }

    fn block(&self, row: usize, column: usize) -> DMatrix<f64> {
        self.start
            .view(
                (self.range(row).0, self.range(column).0),
                (self.range(row).1, self.range(column).1),
            )
            .into_owned()
    }

    /// Xi_12 as printed: no U, but -L1 + L2'.
    fn with_printed_rate_block(&self, task: &Task, vertex: &DMatrix<f64>, point: &Point) -> Self {
        let [e1, e2, _] = task.specification.multiplier_weights;
        let qh = point.design.multiplier.value(&point.values);
        let l1h = point.design.free_state.value(&point.values);
        let l2h = point.design.free_sample.value(&point.values);
        let printed = -e1 * qh.transpose() + e2 * qh * vertex.transpose() - l1h + l2h.transpose();
        self.with_block(STATE, RATE, &printed)
    }

    /// Without Xi_45, as printed: the sector bound taken with N x(t_k^l).
    fn with_printed_sector(&self) -> Self {
        self.with_block(ERROR, DEAD_ZONE, &DMatrix::zeros(self.states, self.inputs))
    }

    /// The bound (28) a given part of the way from r = 1 to r = 2.
    fn bound(&self, rows: &DVector<f64>, fraction: f64) -> f64 {
        (1.0 - fraction) * quadratic(&self.start, rows) + fraction * quadratic(&self.end, rows)
    }
}

/// One random closed loop: plant, memberships frozen at one instant, unknowns, limits.
struct Case {
    task: Task,
    plant: DMatrix<f64>,
    point: Point,
    of: Quantities,
}

impl Case {
    fn random(stream: &mut Stream) -> Self {
        let sizes = Sizes::any(stream);
        let task = random::model(stream, sizes, false).task();
        let mut weights = vector(stream, sizes.vertices, 1.0).map(f64::abs);
        weights /= weights.sum();
        let (n, m) = (sizes.states, sizes.inputs);
        let vertices = task.system.vertices.iter().zip(weights.iter());
        let plant = vertices.fold(DMatrix::zeros(n, n), |sum, (a, weight)| sum + a * *weight);
        let mut point = Point::random(stream, &task, Sector::Unknown);
        // N near F leaves room for saturation inside |(F - N) x| <= ubar.
        let gain = point.design.gain.value(&point.values);
        let near = 0.7 * &gain + uniform(stream, m, n, 0.1);
        point.set("Nh", &(DEAD_ZONE_UNIT * near));
        let of = Quantities::of(&point.design, &point.values);
        Case {
            task,
            plant,
            point,
            of,
        }
    }

    fn decrease(&self) -> Decrease {
        Decrease::corrected(&self.task, &self.plant, &self.point)
    }

    /// An instant of the closed loop: the trigger has just been checked, the held state lies in the
    /// set where the sector bound holds, x' solves the plant's equation. `None` when the drawn
    /// state is outside that set.
    fn instant(&self, stream: &mut Stream, state_offset: f64) -> Option<Instant> {
        let n = self.task.system.states();
        let specs = &self.task.specification;
        let limit = &self.task.system.input_limit;
        let held = vector(stream, n, 8.0);
        let direction = vector(stream, n, 1.0);
        let share = specs.trigger_threshold * 0.5 * (1.0 + stream.signed_unit());
        let weight = &self.of.trigger_weight;
        let length = share * quadratic(weight, &held) / quadratic(weight, &direction);
        let error = direction * length.sqrt();
        let command = &self.of.gain * &held;
        let inside = (&self.of.gain - &self.of.anti_windup) * &held;
        if inside
            .iter()
            .zip(limit.iter())
            .any(|(value, limit)| value.abs() > *limit)
        {
            return None;
        }
        let dead_zone = command.zip_map(limit, |u, limit| u - u.clamp(-limit, limit));
        let sample = &held + &error;
        let state = &sample + vector(stream, n, state_offset);
        let disturbance = vector(stream, self.task.system.disturbance.ncols(), 1.0);
        let rate = &self.plant * &state
            + &self.task.system.input * (command - &dead_zone)
            + &self.task.system.disturbance * &disturbance;
        Some(Instant {
            state,
            rate,
            sample,
            error,
            dead_zone,
            disturbance,
        })
    }

    /// V' + phi V - xi |tau|^2 from (21), `elapsed` after a sample in an interval of length
    /// `interval`, along the path x(alpha) since the sample that the instant's x(t_k^l), x and x' and
    /// a given first rate determine.
    fn derivative(
        &self,
        at: &Instant,
        first_rate: &DVector<f64>,
        elapsed: f64,
        interval: f64,
    ) -> f64 {
        let of = &self.of;
        let phi = self.task.specification.decay_rate;
        let integral = weighted_energy(&of.integral_weight, at, first_rate, elapsed, phi);
        2.0 * at.state.dot(&(&of.lyapunov * &at.rate))
            + phi * quadratic(&of.lyapunov, &at.state)
            + (interval - elapsed) * quadratic(&of.integral_weight, &at.rate)
            - integral
            - of.disturbance_weight * at.disturbance.norm_squared()
    }
}

/// The integral of e^(-phi (t - alpha)) x'(alpha)' Y x'(alpha) over the path, a cubic, by Simpson's
/// rule.
fn weighted_energy(
    weight: &DMatrix<f64>,
    at: &Instant,
    first_rate: &DVector<f64>,
    elapsed: f64,
    phi: f64,
) -> f64 {
    if elapsed == 0.0 {
        return 0.0;
    }
    let mean = (&at.state - &at.sample) / elapsed;
    let integrand = |s: f64| {
        // Derivative of the Hermite cubic at the fraction s of the path.
        let rate = &mean * (6.0 * s * (1.0 - s))
            + first_rate * ((1.0 - s) * (1.0 - 3.0 * s))
            + &at.rate * (s * (3.0 * s - 2.0));
        (-phi * elapsed * (1.0 - s)).exp() * quadratic(weight, &rate)
    };
    let steps = 64;
    let node = |index: usize| index as f64 / steps as f64;
    let sum: f64 = (0..=steps)
        .map(|index| {
            let factor = match index {
                0 => 1.0,
                last if last == steps => 1.0,
                odd if odd % 2 == 1 => 4.0,
                _ => 2.0,
            };
            factor * integrand(node(index))
        })
        .sum();
    sum * elapsed / (3.0 * steps as f64)
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
