//! The parts of the controller of Yang et al. 2025, one by one.

use approx::assert_relative_eq;
use proptest::prelude::*;
use runtime::error::{AllowedRange, Field, ParameterError};
use runtime::nalgebra::{Matrix3, Matrix3x4, SMatrix, Vector3, Vector4};
use runtime::yang2025::allocation::Allocation;
use runtime::yang2025::envelope::{
    Adhesion, Bounds, Correction, Envelope, EnvelopeParameters, Resilience,
};
use runtime::yang2025::fault::{FaultEstimation, FaultEstimator, SampleInterval};
use runtime::yang2025::law::TransformedError;
use runtime::yang2025::performance::{Level, Performance, PerformanceFunction};

fn appointed(initial: f64, time: f64, rate: f64, offset: f64) -> Performance {
    Performance::AppointedTime {
        initial_level: initial,
        final_level: 1e-4,
        appointed_time_s: time,
        rate_per_s: rate,
        offset,
    }
}

fn parameters() -> EnvelopeParameters {
    EnvelopeParameters {
        performance: appointed(0.1, 40.0, 0.1, 0.9),
        shape: 1.0,
        one_sided: true,
        adhesion: Some(Adhesion {
            width: 3.0,
            exponent: 0.4,
            span_s: 40.0,
        }),
        resilience: Some(Resilience {
            fault_gain: 1.0,
            rate_gain: 0.5,
            decay_per_s: 0.17,
            decay_size: 4.0,
            away_width: 0.1,
            toward_width: 1.0,
        }),
    }
}

#[test]
fn the_coefficients_solve_the_boundary_conditions_of_the_paper() {
    let cases = [
        (40.0, [-0.01340839, 0.01170425, -0.00459472, 0.12113216]),
        (30.0, [-0.02652613, 0.02091179, -0.01092253, 0.14109335]),
        (60.0, [-0.00325728, 0.00314194, -0.00082255, 0.10683969]),
    ];
    for (time, expected) in cases {
        let function = PerformanceFunction::new(appointed(0.1, time, 0.1, 0.9)).unwrap();
        let found = function.coefficients().unwrap();
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-8, "{found} at {time} s");
        }
        assert_relative_eq!(function.at(0.0).value, 0.1, max_relative = 1e-13);
        let level = function.at(time);
        assert_eq!((level.value, level.slope), (1e-4, 0.0));
    }
}

#[test]
fn the_printed_denominator_of_z4_misses_the_final_level() {
    let (rate, offset, time): (f64, f64, f64) = (0.1, 0.9, 40.0);
    let (alpha, beta) = ((rate * time + offset).sinh(), (rate * time + offset).cosh());
    let pace = std::f64::consts::FRAC_PI_2 / time;
    let bracket = rate.powi(2) * alpha.powi(3)
        - 2.0 * rate.powi(2) * alpha * beta.powi(2)
        - rate * beta * pace * alpha.powi(2)
        - pace.powi(2) * alpha.powi(3);
    let numerator = (0.1 - 1e-4) * pace.powi(2) * alpha.powi(4) * offset.sinh();
    let level_at_the_end = |last_term: f64| {
        let z4 = numerator / (bracket * offset.sinh() + last_term);
        let z3 = -rate * beta * z4 / (pace * alpha.powi(2));
        let z2 = (2.0 * rate.powi(2) * alpha * beta.powi(2) - rate.powi(2) * alpha.powi(3)) * z4
            / (pace.powi(2) * alpha.powi(4));
        let z1 = 0.1 - z4 / offset.sinh() - z3;
        z1 + z2 + z4 / alpha
    };
    let corrected = level_at_the_end(pace.powi(2) * alpha.powi(4));
    assert_relative_eq!(corrected, 1e-4, max_relative = 1e-9);
    assert!((level_at_the_end(1.0) - 1e-4).abs() > 0.05);
}

proptest! {
    #[test]
    fn the_appointed_time_function_falls_and_arrives_with_zero_slope_and_curvature(
        time in 1.0..500.0_f64,
        turns in 0.05..50.0_f64,
        offset in 0.01..5.0_f64,
        initial in 0.001..1.0_f64,
    ) {
        let rate = turns / time;
        let function = PerformanceFunction::new(appointed(initial, time, rate, offset)).unwrap();
        let drop = initial - 1e-4;
        prop_assert!((function.at(0.0).value - initial).abs() < 1e-9 * initial);
        let almost = function.at(time * (1.0 - 1e-12));
        prop_assert!((almost.value - 1e-4).abs() < 1e-9 * initial, "value {}", almost.value);
        prop_assert!(almost.slope.abs() < 1e-8 * drop / time, "slope {}", almost.slope);
        let [_, z2, _, z4] = function.coefficients().unwrap();
        let argument = rate * time + offset;
        let (cosecant, cotangent) = (1.0 / argument.sinh(), 1.0 / argument.tanh());
        let pace = std::f64::consts::FRAC_PI_2 / time;
        let curvature = -pace * pace * z2
            + z4 * rate * rate * cosecant * (2.0 * cotangent * cotangent - 1.0);
        prop_assert!(curvature.abs() < 1e-7 * drop / (time * time), "curvature {curvature}");
        let mut last = function.at(0.0).value;
        for index in 1..=400 {
            let at = function.at(time * f64::from(index) / 400.0);
            prop_assert!(at.slope <= 1e-9 * drop / time, "slope {} at {index}", at.slope);
            prop_assert!(at.value <= last + 1e-12 * initial);
            last = at.value;
        }
    }

    #[test]
    fn the_envelope_starts_around_any_error_and_its_slopes_are_those_of_its_values(
        start in -0.99..0.99_f64,
        time in 0.0..60.0_f64,
        torque in -1.0..1.0_f64,
        rate in -0.01..0.01_f64,
    ) {
        let envelope = Envelope::new(parameters()).unwrap();
        let fresh = Correction::default();
        prop_assert!(envelope.at(0.0, start, &fresh).position(start).abs() < 1e-12);
        // Where (12) ends its slope is zero, but not beyond what a difference sees.
        prop_assume!((time - 40.0).abs() > 0.01);
        let mut correction = fresh;
        envelope.drive(&mut correction, torque, 0.2, rate);
        let mut correction = envelope.advance(&correction, 2.0);
        envelope.drive(&mut correction, torque, 0.2, rate);
        let step = 1e-4;
        let now = envelope.at(time, start, &correction);
        let then = envelope.at(time + step, start, &envelope.advance(&correction, step));
        for (now, then) in [(now.lower, then.lower), (now.upper, then.upper)] {
            let difference = (then.value - now.value) / step;
            prop_assert!((difference - now.slope).abs() < 1e-4 * (1.0 + now.slope.abs()));
        }
        prop_assert!(now.lower.value < now.upper.value);
    }

    #[test]
    fn the_correction_only_widens_and_most_where_the_fault_pushes(
        start in -0.5..0.5_f64,
        time in 0.0..100.0_f64,
        torque in 0.25..1.0_f64,
        up in any::<bool>(),
    ) {
        let envelope = Envelope::new(parameters()).unwrap();
        let fresh = Correction::default();
        let torque = if up { torque } else { -torque };
        let mut correction = fresh;
        envelope.drive(&mut correction, torque, 0.2, 0.0);
        let correction = envelope.advance(&correction, 3.0);
        let narrow = envelope.at(time, start, &fresh);
        let wide = envelope.at(time, start, &correction);
        let above = wide.upper.value - narrow.upper.value;
        let below = narrow.lower.value - wide.lower.value;
        prop_assert!(above > 0.0 && below > 0.0);
        let (toward, away) = if up { (above, below) } else { (below, above) };
        assert_relative_eq!(toward, correction.value.abs().tanh(), max_relative = 1e-9);
        assert_relative_eq!(away, 0.1 * toward, max_relative = 1e-9);
    }

    #[test]
    fn the_transformed_error_has_the_derivative_it_says(
        position in -0.99..0.99_f64,
        rate in -0.1..0.1_f64,
        lower_slope in -0.1..0.1_f64,
        upper_slope in -0.1..0.1_f64,
    ) {
        let step = 1e-7;
        let at = |time: f64| Bounds {
            lower: Level { value: -0.3 + lower_slope * time, slope: lower_slope },
            upper: Level { value: 0.5 + upper_slope * time, slope: upper_slope },
        };
        let error = 0.1 + 0.4 * position;
        let now = TransformedError::new(error, rate, &at(0.0));
        let then = TransformedError::new(error + rate * step, rate, &at(step));
        let difference = (then.value - now.value) / step;
        prop_assert!(now.inside);
        prop_assert!((difference - now.slope).abs() < 1e-4 * (1.0 + now.slope.abs()));
    }

    #[test]
    fn an_observer_is_stable_at_any_interval(seconds in 1e-4..1e3_f64, bandwidth in 0.01..100.0_f64) {
        let kind = FaultEstimation::ExtendedState { bandwidth_rad_s: bandwidth };
        let mut estimator = FaultEstimator::new(kind, Matrix3::identity()).unwrap();
        estimator.update(&Vector3::new(1.0, 0.0, 0.0), None, None);
        let interval = SampleInterval { seconds, torque: Vector3::zeros() };
        for _ in 0..200 {
            estimator.update(&Vector3::zeros(), None, Some(&interval));
            prop_assert!(estimator.fault().amax() <= 1.0 / seconds * 1.000_001);
        }
    }
}

#[test]
fn an_error_outside_of_the_bounds_stays_finite_and_points_back() {
    let level = |value| Level { value, slope: 0.5 };
    let bounds = Bounds {
        lower: level(-0.1),
        upper: level(0.1),
    };
    for (error, sign) in [(0.1, 1.0), (0.7, 1.0), (-0.1, -1.0), (-3.0, -1.0)] {
        let transformed = TransformedError::new(error, 1.0, &bounds);
        assert!(!transformed.inside);
        assert_eq!(transformed.slope, 0.0);
        assert!(transformed.value * sign > 13.0 && transformed.value.is_finite());
    }
}

#[test]
fn without_its_corrections_the_envelope_is_wide_on_the_side_of_the_start() {
    let bare = EnvelopeParameters {
        adhesion: None,
        resilience: None,
        ..parameters()
    };
    let fresh = Correction::default();
    let envelope = Envelope::new(bare).unwrap();
    let bounds = envelope.at(0.0, 0.3, &fresh);
    assert_relative_eq!(bounds.lower.value, -1e-4, max_relative = 1e-9);
    assert_relative_eq!(bounds.upper.value, 0.2 - 1e-4, max_relative = 1e-9);
    let mirrored = envelope.at(0.0, -0.3, &fresh);
    assert_relative_eq!(
        mirrored.lower.value,
        -bounds.upper.value,
        max_relative = 1e-9
    );
    let settled = envelope.at(50.0, 0.3, &fresh);
    assert_relative_eq!(settled.lower.value, -1e-4, max_relative = 1e-9);
    assert_relative_eq!(settled.upper.value, 1e-4, max_relative = 1e-9);
    let two_sided = Envelope::new(EnvelopeParameters {
        one_sided: false,
        ..bare
    });
    let bounds = two_sided.unwrap().at(0.0, 0.3, &fresh);
    assert_relative_eq!(bounds.lower.value, -0.1, max_relative = 1e-9);
    assert_relative_eq!(bounds.upper.value, 0.1, max_relative = 1e-9);
}

#[test]
fn the_correction_dies_out_without_a_fault() {
    let envelope = Envelope::new(parameters()).unwrap();
    let mut correction = Correction::default();
    envelope.drive(&mut correction, 0.5, 0.2, 0.0);
    correction = envelope.advance(&correction, 10.0);
    // delta_3 / delta_4 is 0.0425 1/s.
    let peak = correction.value;
    assert!(peak > 2.0);
    for _ in 0..20_000 {
        // A rate alone does not feed it.
        envelope.drive(&mut correction, 0.1, 0.2, 0.3);
        correction = envelope.advance(&correction, 0.01);
    }
    assert!(correction.value > 0.0 && correction.value < 0.01 * peak);
}

#[test]
fn a_low_pass_answers_a_step_as_a_first_order_lag_does() {
    let inertia = Matrix3::from_diagonal(&Vector3::new(89.0, 61.0, 57.0));
    let kind = FaultEstimation::LowPass {
        time_constant_s: 0.2,
    };
    let (low_pass, observer) = step_answers(kind, inertia);
    for (time, estimate) in low_pass {
        let expected = 0.3 * (1.0 - (-time / 0.2_f64).exp());
        assert!((estimate - expected).abs() < 1e-9, "{estimate} at {time} s");
    }
    // Two poles at 10 rad/s: 1 - (1 + 10 t) exp(-10 t), up to the sampling.
    for (time, estimate) in observer {
        let expected = 0.3 * (1.0 - (1.0 + 10.0 * time) * (-10.0 * time).exp());
        assert!(
            (estimate - expected).abs() < 0.03 * 0.3,
            "{estimate} at {time} s"
        );
    }
}

/// Estimates of 0.3 N m about axis 2 from rest, under a known torque of -0.1 N m.
type Answer = Vec<(f64, f64)>;
fn step_answers(low_pass: FaultEstimation, inertia: Matrix3<f64>) -> (Answer, Answer) {
    let observer = FaultEstimation::ExtendedState {
        bandwidth_rad_s: 10.0,
    };
    let answer = |kind| {
        let mut estimator = FaultEstimator::new(kind, inertia).unwrap();
        let interval = SampleInterval {
            seconds: 0.01,
            torque: Vector3::new(0.0, -0.1, 0.0),
        };
        let mut out = Vec::new();
        for index in 0..=100 {
            let time = 0.01 * f64::from(index);
            let rate = Vector3::new(0.0, 0.2 * time / 61.0, 0.0);
            estimator.update(&rate, None, (index > 0).then_some(&interval));
            out.push((time, estimator.fault().y));
        }
        out
    };
    (answer(low_pass), answer(observer))
}

#[test]
fn an_external_fault_stays_in_force_until_the_next_one() {
    let mut estimator =
        FaultEstimator::new(FaultEstimation::External, Matrix3::identity()).unwrap();
    let fault = Vector3::new(0.1, -0.2, 0.3);
    estimator.update(&Vector3::zeros(), Some(&fault), None);
    estimator.update(&Vector3::repeat(9.0), None, None);
    assert_eq!(*estimator.fault(), fault);
}

/// Four thrusters along the corners of a tetrahedron.
fn tetrahedron() -> Matrix3x4<f64> {
    Matrix3x4::new(
        1.0, 1.0, -1.0, -1.0, //
        1.0, -1.0, 1.0, -1.0, //
        1.0, -1.0, -1.0, 1.0,
    ) / 3f64.sqrt()
}

#[test]
fn four_actuators_give_the_torque_up_to_the_authority_of_an_axis() {
    let allocation = Allocation::new(tetrahedron(), Vector4::repeat(0.2)).unwrap();
    let torque = Vector3::new(0.05, -0.08, 0.1);
    let command = allocation.command(&torque);
    assert!((allocation.torque(&command) - torque).amax() < 1e-15);
    // Each of the four gives sqrt(3)/4 of a torque about an axis.
    let authority = 0.2 * 4.0 / 3f64.sqrt();
    assert!((allocation.authority() - Vector3::repeat(authority)).amax() < 1e-12);
    let edge = Vector3::new(authority, 0.0, 0.0);
    assert!((allocation.torque(&allocation.command(&edge)) - edge).amax() < 1e-12);
    let beyond = allocation.command(&(edge * 1.5));
    assert!(beyond.amax() <= 0.2);
}

#[test]
fn actuators_that_leave_an_axis_out_are_refused() {
    let mut matrix = tetrahedron();
    matrix.row_mut(2).copy_from(&tetrahedron().row(1));
    let refused = Allocation::new(matrix, Vector4::repeat(0.2));
    assert!(matches!(refused, Err(ParameterError::RankDeficient { .. })));
    let two = SMatrix::<f64, 3, 2>::new(1.0, 0.0, 0.0, 1.0, 0.0, 0.0);
    let refused = Allocation::new(two, SMatrix::<f64, 2, 1>::repeat(0.2));
    assert!(matches!(refused, Err(ParameterError::RankDeficient { .. })));
    let mut matrix = tetrahedron();
    matrix[(1, 2)] = f64::NAN;
    let refused = Allocation::new(matrix, Vector4::repeat(0.2));
    let field = Field::entry("actuator_matrix", 1, 2);
    assert!(
        matches!(refused, Err(ParameterError::NotFinite { field: found, .. }) if found == field)
    );
}

#[test]
fn parameters_of_the_envelope_out_of_range_are_refused() {
    let refused = |change: fn(&mut EnvelopeParameters)| {
        let mut parameters = parameters();
        change(&mut parameters);
        Envelope::new(parameters).unwrap_err()
    };
    let out_of_range = |name, value, allowed| ParameterError::OutOfRange {
        field: Field::scalar(name),
        value,
        allowed,
    };
    let positive = AllowedRange::POSITIVE;
    assert_eq!(
        refused(|p| p.shape = 0.0),
        out_of_range("shape", 0.0, positive)
    );
    assert_eq!(
        refused(|p| p.adhesion.as_mut().unwrap().width = 0.5),
        out_of_range("width", 0.5, AllowedRange::half_open(1.0, f64::INFINITY))
    );
    assert_eq!(
        refused(|p| p.resilience.as_mut().unwrap().decay_size = -4.0),
        out_of_range("decay_size", -4.0, positive)
    );
    assert_eq!(
        refused(|p| p.performance = appointed(1e-5, 40.0, 0.1, 0.9)),
        out_of_range(
            "initial_level",
            1e-5,
            AllowedRange::open(1e-4, f64::INFINITY)
        )
    );
    let refused = refused(|p| p.performance = appointed(0.1, 1e5, 0.1, 0.9));
    assert!(refused
        .to_string()
        .contains("rate_per_s * appointed_time_s is 10000"));
}

/// As the book has it: the drive of the last sample, the decay at the end of the interval, and (11) for the slope.
#[test]
fn the_correction_is_stepped_as_documented() {
    let envelope = Envelope::new(parameters()).unwrap();
    let mut correction = Correction::default();
    let mut expected = 0.0_f64;
    // A fault of 0.5 N m where 0.2 N m are available, then none; the error moves by 0.03 1/s.
    for (fault, seconds) in [(0.5, 0.01), (0.5, 2.0), (-0.7, 0.3), (0.1, 5.0)] {
        envelope.drive(&mut correction, fault, 0.2, 0.03);
        let excess = f64::max(f64::abs(fault) - 0.2, 0.0);
        let drive = if excess > 0.0 {
            f64::signum(fault) * excess + 0.5 * 0.03
        } else {
            0.0
        };
        let size = expected.abs() + 4.0;
        assert_relative_eq!(
            correction.slope,
            drive - 0.17 * expected / size,
            max_relative = 1e-13
        );
        correction = envelope.advance(&correction, seconds);
        expected = (expected + seconds * drive) / (1.0 + seconds * 0.17 / size);
        assert_relative_eq!(correction.value, expected, max_relative = 1e-13);
    }
    assert!(expected != 0.0);
}
