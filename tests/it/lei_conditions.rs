//! The conditions of Lei et al. 2022, each against a value worked out by hand, on a parameter set where
//! it holds and on one where it fails.

use nalgebra::{Matrix3, Vector3};
use runtime::attitude::Quaternion;
use runtime::lei2022::{
    Barrier, CompositeTrigger, ControlLaw, DisturbanceCompensation, PerformanceFunction, VirtualLaw,
};
use steadfast::base::condition::Condition;
use steadfast::controllers::lei2022::{conditions, Bounds, Case};

/// A unit sphere with round numbers. The funnel does not narrow measurably and nothing disturbs.
fn gentle() -> Case {
    Case {
        law: ControlLaw {
            inertia: Matrix3::identity() * 2.0,
            performance: PerformanceFunction {
                initial: Vector3::repeat(0.81),
                terminal: Vector3::repeat(0.64),
                midpoint_s: 1e6,
                time_scale_s: 1e5,
            },
            barrier: Barrier {
                gain_j: 1e-3,
                width: 1.0,
            },
            virtual_law: VirtualLaw {
                gain: 1.6,
                rate_scale_rad_s: 0.1,
                slope: 10.0,
            },
            rate_gain: 3.0,
            disturbance: DisturbanceCompensation {
                bound_nm: 1e-6,
                smoothing_rad_s: 1e-6,
            },
        },
        trigger: CompositeTrigger {
            held_error_initial: 1e-9,
            held_error_terminal: 1e-12,
            longest_on_s: 1.0,
            envelope_initial_j: 1.0,
            envelope_terminal_j: 0.02,
            decay_rate_per_s: 0.01,
            buffer_j: 1e-40,
            relative_buffer: 0.0,
        },
        torque_limit: Vector3::repeat(1.0),
        error: Quaternion::from_axis_angle(&Vector3::z(), 1.0).unwrap(),
        rate_rad_s: Vector3::zeros(),
        disturbance_nm: Vector3::zeros(),
        rate_limit_rad_s: Some(0.3),
    }
}

/// The parameters of models/lei2022.json, with that start.
fn working() -> Case {
    let mut case = gentle();
    case.law.inertia = Matrix3::from_diagonal(&Vector3::new(2.8, 2.5, 1.9));
    case.law.performance = PerformanceFunction {
        initial: Vector3::new(0.47, 0.404435, 0.307944),
        terminal: Vector3::repeat(5e-3),
        midpoint_s: 50.0,
        time_scale_s: 6.4,
    };
    case.law.barrier.gain_j = 5e-5;
    case.law.virtual_law = VirtualLaw {
        gain: 1.505,
        rate_scale_rad_s: 0.0524,
        slope: 13.0,
    };
    case.law.rate_gain = 2.6;
    case.law.disturbance = DisturbanceCompensation {
        bound_nm: 1.5e-3,
        smoothing_rad_s: 2.8e-4,
    };
    case.trigger = CompositeTrigger {
        held_error_initial: 1.7e-3,
        held_error_terminal: 1e-5,
        longest_on_s: 1.0,
        envelope_initial_j: 4.2e-3,
        envelope_terminal_j: 2e-7,
        decay_rate_per_s: 0.18,
        buffer_j: 6e-8,
        relative_buffer: 0.0,
    };
    case.torque_limit = Vector3::repeat(0.05);
    let start = Vector3::new(0.4623, -0.3978, 0.3029);
    case.error = Quaternion::new(0.7323, start).normalised().unwrap();
    case.disturbance_nm = Vector3::new(9e-4, 6.5e-4, 1.3e-3);
    case.rate_limit_rad_s = Some(0.0524);
    case
}

#[track_caller]
fn find(case: &Case, statement: &str) -> Condition {
    let all = conditions(case);
    let found = all.iter().find(|one| one.statement.contains(statement));
    found
        .unwrap_or_else(|| panic!("no condition {statement}"))
        .clone()
}

#[track_caller]
fn assert_sides(condition: &Condition, left: f64, right: f64, tolerance: f64) {
    for (found, expected) in [(condition.left, left), (condition.right, right)] {
        let found = found.expect("a value");
        let error = (found - expected).abs();
        assert!(
            error <= tolerance * expected.abs(),
            "{}: {found} against {expected}",
            condition.statement
        );
    }
}

/// The condition must hold in one case and fail in the other.
#[track_caller]
fn assert_holds_and_fails(statement: &str, holds: &Case, fails: &Case) {
    let (held, failed) = (find(holds, statement), find(fails, statement));
    assert!(held.holds, "{held:?}");
    assert!(!failed.holds, "{failed:?}");
}

#[test]
fn the_gain_of_the_virtual_law_outweighs_the_saturation_up_to_the_use_of_the_funnel() {
    let mut weak = working();
    weak.law.virtual_law.gain = 1.49;
    assert_holds_and_fails("k_m tanh", &working(), &weak);
    // tanh(13 * 1.5) is 1 to rounding.
    assert_sides(&find(&working(), "k_m tanh"), 1.505, 1.5, 1e-12);
}

#[test]
fn the_virtual_rate_is_bounded_by_the_norm_of_the_funnel() {
    // 1.505 * 0.0524 * sqrt(0.47^2 + 0.404435^2 + 0.307944^2)
    let found = find(&working(), "rate limit");
    assert_sides(&found, 0.0524, 0.054_597, 1e-4);
    assert!(found.note.contains("3.7065e-2"), "{}", found.note);
    assert_holds_and_fails("rate limit", &gentle(), &working());
    let mut unlimited = gentle();
    unlimited.rate_limit_rad_s = None;
    let found = find(&unlimited, "rate limit");
    assert!(found.left.is_none() && !found.holds, "{found:?}");
}

#[test]
fn the_first_layer_cannot_decay_under_a_funnel_that_ends_in_time() {
    // 0.7323 / |q| * 0.0524, and 4 * 2 / 6.4 * (sqrt 0.47 - sqrt 0.005) / (sqrt 0.47 + sqrt 0.005)
    let found = find(&working(), "max |rho_i'| / rho_i");
    assert_sides(&found, 0.038_373, 1.016_26, 1e-4);
    assert!(found.note.contains("5.2400e-2"), "{}", found.note);
    // 0.1 cos(0.5) against 4 * 2e-5 * 0.1 / 1.7.
    let held = find(&gentle(), "max |rho_i'| / rho_i");
    assert_sides(&held, 0.087_758, 4.705_9e-6, 1e-4);
    assert_holds_and_fails("max |rho_i'| / rho_i", &gentle(), &working());
}

#[test]
fn the_closed_form_of_the_steepest_contraction_is_the_largest_of_samples() {
    let case = working();
    let largest = (0..200_000)
        .map(|index| f64::from(index) * 1e-3)
        .map(|time| {
            let width = case.law.performance.value(time);
            case.law.performance.rate(time).component_div(&width).amax()
        })
        .fold(0.0, f64::max);
    let closed = Bounds::new(&case).funnel_contraction_per_s;
    assert!(
        (closed - largest).abs() < 1e-8,
        "{closed} against {largest}"
    );
}

#[test]
fn the_disturbance_term_must_cover_each_component() {
    assert_sides(&find(&working(), "D_m >="), 1.5e-3, 1.3e-3, 1e-12);
    let mut strong = working();
    strong.disturbance_nm.z = 1.6e-3;
    assert_holds_and_fails("D_m >=", &working(), &strong);
}

#[test]
fn the_second_layer_decays_for_the_best_free_constant() {
    // D_0 = 3 * 0.2785 * 2.8e-4 * 1.5e-3 = 3.5091e-7; b solves D_0 b^2 + m b - m K_2 = 0: 2.3997.
    let found = find(&working(), "K_2 > b / 2");
    let d0: f64 = 3.0 * 0.2785 * 2.8e-4 * 1.5e-3;
    let b = (-1e-5 + (1e-10 + 4.0 * d0 * 1e-5 * 2.6).sqrt()) / (2.0 * d0);
    assert_sides(&found, 2.6, 0.5 * b, 1e-9);
    assert!(found.holds);
    let mut none = working();
    none.law.rate_gain = -1.0;
    assert!(!find(&none, "K_2 > b / 2").holds);
}

#[test]
fn the_decay_conditions_are_those_of_the_proof_and_not_the_printed_ones() {
    // C_1 = C_eps = B_1 = 0.038373 - 1.01626.
    let total = find(&working(), "C_1 > beta");
    assert_sides(&total, -0.977_89, 0.18, 1e-4);
    let first = find(&working(), "C_eps > beta / 2");
    assert_sides(&first, -0.977_89, 0.09, 1e-4);
    for found in [total, first] {
        let printed_wrong = found.note.contains("printed the wrong way round");
        assert!(
            printed_wrong && found.note.contains("which holds"),
            "{found:?}"
        );
    }
    assert_holds_and_fails("C_1 > beta", &gentle(), &working());
    assert_holds_and_fails("C_eps > beta / 2", &gentle(), &working());
    assert!(find(&gentle(), "C_1 > beta").note.contains("which fails"));
}

#[test]
fn the_start_condition_needs_a_decay_that_beats_the_envelope() {
    let undefined = find(&working(), "V(0) >");
    assert_eq!(undefined.right, None);
    assert!(!undefined.holds);
    let held = find(&gentle(), "V(0) >");
    assert!(held.holds, "{held:?}");
    let mut noisy = gentle();
    noisy.trigger.held_error_initial = 1.0;
    assert_holds_and_fails("V(0) >", &gentle(), &noisy);
}

#[test]
fn the_envelope_starts_above_the_energy_of_the_rate_error() {
    let mut low = working();
    low.trigger.envelope_initial_j = 3e-3;
    assert_holds_and_fails("S2(0) >= V2(0)", &working(), &low);
    // At rest z2 = -alpha. In set E r is parallel to q to the saturation of tanh(13 q / rho), so
    // |alpha| = 0.078862 * |r|, and V2 = alpha' J alpha / 2.
    let r = Vector3::new(0.47, -0.404435, 0.307944) * 1.0;
    let alpha = r * 0.078_862;
    let moments = Vector3::new(2.8, 2.5, 1.9);
    let expected = 0.5 * alpha.component_mul(&alpha).dot(&moments);
    assert_sides(&find(&working(), "S2(0) >= V2(0)"), 4.2e-3, expected, 1e-3);
}

#[test]
fn the_envelope_of_a_working_set_ends_below_what_the_proof_allows_for_the_disturbance() {
    let found = find(&working(), "S2_inf > V2_inf");
    let d0: f64 = 3.0 * 0.2785 * 2.8e-4 * 1.5e-3;
    let b = (-1e-5 + (1e-10 + 4.0 * d0 * 1e-5 * 2.6).sqrt()) / (2.0 * d0);
    let residual = (d0 + 0.5e-5 / b) / ((5.2 - b) / 2.8);
    assert_sides(&found, 2e-7, residual, 1e-9);
    assert_holds_and_fails("S2_inf > V2_inf", &gentle(), &working());
}

#[test]
fn the_constant_of_youngs_inequality_makes_the_residual_smallest() {
    let case = working();
    let bounds = Bounds::new(&case);
    let residual = |b: f64| (bounds.disturbance_residual_w + 0.5e-5 / b) / ((5.2 - b) / 2.8);
    let best = bounds.second_layer_residual_j;
    for factor in [0.9, 0.99, 1.01, 1.1] {
        assert!(
            residual(bounds.young_constant_nm_s * factor) > best,
            "{factor}"
        );
    }
}

#[test]
fn the_funnel_must_hold_the_rate_error_that_the_trigger_tolerates() {
    // 0.078862 * 0.005 against sqrt(2 * 1.4e-7 / 1.9).
    let found = find(&working(), "k_m M_omega rho_inf");
    assert_sides(&found, 3.943_1e-4, 3.838_9e-4, 1e-4);
    let mut loose = working();
    loose.trigger.envelope_terminal_j = 3e-7;
    assert_holds_and_fails("k_m M_omega rho_inf", &working(), &loose);
    loose.trigger.relative_buffer = 0.4;
    assert!(find(&loose, "k_m M_omega rho_inf").holds);
}

#[test]
fn the_time_on_is_bounded_from_below_and_the_bound_needs_its_constant_part() {
    for case in [gentle(), working()] {
        let all = conditions(&case);
        let times: Vec<_> = all.iter().filter(|one| one.place == "(69)").collect();
        assert_eq!(times.len(), 2);
        assert!(times.iter().all(|one| one.holds), "{times:?}");
        // The allowed error only shrinks.
        assert!(times[0].left > times[1].left);
    }
    let mut none = working();
    none.trigger.held_error_terminal = 0.0;
    let all = conditions(&none);
    let end = all
        .iter()
        .find(|one| one.name == "time on, in the end")
        .unwrap();
    assert!(!end.holds, "{end:?}");
}

#[test]
fn the_time_off_is_bounded_only_when_the_gain_of_a_pulse_exceeds_the_buffer() {
    assert_holds_and_fails("N_k > delta_m", &gentle(), &working());
    let held = find(&gentle(), "N_k > delta_m");
    assert!(held.note.contains("the time off is at least"), "{held:?}");
    let failed = find(&working(), "N_k > delta_m");
    // S2_inf is below V2_inf, so a pulse gains nothing.
    assert!(failed.left < Some(0.0), "{failed:?}");
    assert!(failed.note.contains("no positive solution"), "{failed:?}");
    assert_eq!(failed.right, Some(6e-8));
}

/// Every constant that the paper only says exists bounds what it should on a run of states.
#[test]
fn the_bounds_on_the_virtual_law_hold_on_samples() {
    let case = working();
    let bounds = Bounds::new(&case);
    let law = &case.law;
    let mut worst = (0.0f64, 0.0f64);
    for index in 0..4000u32 {
        let phase = f64::from(index);
        let axis = Vector3::new(
            (phase * 0.7).sin(),
            (phase * 1.3).cos(),
            (phase * 0.9).sin(),
        );
        let time = 0.02 * phase;
        let width = law.performance.value(time);
        let angle = 2.0 * (width.min() * (phase * 0.31).sin().abs()).min(0.9).asin();
        let error = Quaternion::from_axis_angle(&axis.normalize(), angle)
            .unwrap()
            .shortest();
        let rate = axis.normalize() * bounds.rate_rad_s * (phase * 0.17).cos().abs();
        let width_rate = law.performance.rate(time);
        let acceleration = law
            .virtual_law
            .acceleration(&error, &rate, &width, &width_rate);
        worst.0 = worst.0.max(acceleration.norm());
        let torque = law.barrier.compensation(&error, &width);
        worst.1 = worst.1.max(torque.norm());
    }
    assert!(
        worst.0 <= bounds.virtual_acceleration_rad_s2,
        "{worst:?} {bounds:?}"
    );
    assert!(worst.1 <= bounds.compensation_nm, "{worst:?} {bounds:?}");
    // A bound of another order of magnitude would bound nothing.
    assert!(
        worst.0 >= 0.05 * bounds.virtual_acceleration_rad_s2,
        "{worst:?} {bounds:?}"
    );
}

/// (58) to (60) and (69), with the constants that the paper leaves open taken as found.
fn time_on(case: &Case, bounds: &Bounds, transient: f64) -> f64 {
    let (least, most) = bounds.inertia_kg_m2;
    let law = &case.law;
    let gain = law.rate_gain + law.disturbance.bound_nm / law.disturbance.smoothing_rad_s;
    let rate = bounds.rate_rad_s;
    let r1 = most * rate * (1.0 / least) + rate + gain / least;
    let bc = (1.0 + 3f64.sqrt()) * law.disturbance.bound_nm
        + most * bounds.virtual_acceleration_rad_s2
        + bounds.compensation_nm;
    let r2 = gain * bounds.virtual_acceleration_rad_s2
        + most * bounds.virtual_jerk_rad_s3
        + bc * most * rate / least
        + bc * rate
        + bc * gain / least
        + bounds.compensation_rate_nm_s;
    let q1 = r1 * law.rate_gain + 2.0 * r1 + 1.0;
    let q2 = 2.0 / least * r1 * law.rate_gain;
    let q3 = r2 * r2;
    let g2 = bounds.second_layer_residual_j;
    let g1 = case.trigger.envelope_initial_j - g2;
    let (s, m) = (
        case.trigger.held_error_initial,
        case.trigger.held_error_terminal,
    );
    let (m1, m2) = (q1 * s + q2 * g1, q1 * m + q2 * g2 + q3);
    (transient + m) / (transient * case.trigger.decay_rate_per_s + m1 + m2)
}

#[test]
fn the_times_between_events_are_those_of_the_papers_formulas() {
    for case in [gentle(), working()] {
        let bounds = Bounds::new(&case);
        let all = conditions(&case);
        let found: Vec<f64> = all
            .iter()
            .filter(|one| one.place == "(69)")
            .filter_map(|one| one.left)
            .collect();
        let start = time_on(&case, &bounds, case.trigger.held_error_initial);
        let end = time_on(&case, &bounds, 0.0);
        assert!((found[0] / start - 1.0).abs() < 1e-9, "{found:?} {start}");
        assert!((found[1] / end - 1.0).abs() < 1e-9, "{found:?} {end}");
        // beta times the time is far below 1, so 1 - e^(-x) is x.
        let gap = case.trigger.envelope_terminal_j - bounds.second_layer_residual_j;
        let gain = gap * case.trigger.decay_rate_per_s * end;
        let left = find(&case, "N_k > delta_m").left.unwrap();
        assert!((left / gain - 1.0).abs() < 1e-6, "{left} {gain}");
    }
}

#[test]
fn the_time_off_solves_80() {
    let case = gentle();
    let bounds = Bounds::new(&case);
    let condition = find(&case, "N_k > delta_m");
    let words: Vec<&str> = condition.note.split(' ').collect();
    let time: f64 = words[words.len() - 2].parse().unwrap();
    let (trigger, nk) = (&case.trigger, condition.left.unwrap());
    let a0 = bounds.drift_rate;
    let slope =
        trigger.decay_rate_per_s * (trigger.envelope_initial_j - trigger.envelope_terminal_j);
    let w1 = 2.0 / a0 * (trigger.envelope_initial_j - nk).sqrt();
    let terms = 0.25 * a0 * a0 * time * time + (slope + 0.5 * a0 * a0 * w1) * time;
    assert!(
        (terms / (nk - trigger.buffer_j) - 1.0).abs() < 1e-3,
        "{terms} {nk}"
    );
}

#[test]
fn the_rate_is_bounded_by_the_virtual_rate_and_the_envelope() {
    // 0.054597 + sqrt(2 * 4.2e-3 / 1.9)
    assert!((Bounds::new(&working()).rate_rad_s - 0.121_088).abs() < 1e-6);
}
