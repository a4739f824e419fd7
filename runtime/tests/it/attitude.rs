//! Quaternions, rotations and their errors.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use proptest::prelude::*;
use runtime::attitude::{skew, AttitudeMeasurement, Quaternion, SignHysteresis};
use runtime::command::HoldReason;
use runtime::error::ParameterError;
use runtime::nalgebra::{Matrix3, Vector3};

fn vector(bound: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-bound..bound, -bound..bound, -bound..bound].prop_map(Vector3::from)
}

fn attitude() -> impl Strategy<Value = Quaternion> {
    (vector(1.0), 0.0..2.0 * PI)
        .prop_filter("an axis", |(axis, _)| axis.norm() > 1e-3)
        .prop_map(|(axis, angle)| Quaternion::from_axis_angle(&axis, angle).unwrap())
}

fn close(left: &Quaternion, right: &Quaternion) -> bool {
    let difference = (left.scalar - right.scalar).abs() + (left.vector - right.vector).norm();
    difference < 1e-12
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_skew_matrix_gives_the_cross_product(a in vector(5.0), b in vector(5.0)) {
        prop_assert!((skew(&a) * b - a.cross(&b)).norm() < 1e-12);
        prop_assert_eq!(skew(&a).transpose(), -skew(&a));
    }

    #[test]
    fn the_product_keeps_the_norm_and_is_associative(a in attitude(), b in attitude(), c in attitude()) {
        prop_assert!(((a * b).norm() - 1.0).abs() < 1e-12);
        prop_assert!(close(&((a * b) * c), &(a * (b * c))));
    }

    #[test]
    fn the_state_of_a_measured_attitude_has_the_sign_of_the_measured_scalar_part(
        true_error in attitude(),
        axis in vector(1.0),
        off in 0.0..0.1f64,
        negated in any::<bool>(),
    ) {
        prop_assume!(axis.norm() > 1e-3);
        let true_error = true_error.shortest();
        prop_assume!(true_error.scalar > 2.0 * libm::sin(off / 4.0));
        let measured = true_error * Quaternion::from_axis_angle(&axis, off).unwrap();
        let measured = if negated { -measured } else { measured };
        let state = |error: Quaternion| {
            let measurement = AttitudeMeasurement { error, rate_rad_s: Vector3::zeros() };
            measurement.rigid_body_state()
        };
        let error = (state(measured) - state(true_error)).norm();
        prop_assert!(error <= 0.5 * off + 1e-14, "{error} for {off} rad");
    }

    #[test]
    fn the_error_from_itself_is_the_identity(q in attitude()) {
        prop_assert!(close(&q.error_from(&q), &Quaternion::identity()));
    }

    #[test]
    fn the_error_brings_the_desired_attitude_to_the_actual_one(q in attitude(), d in attitude()) {
        prop_assert!(close(&(d * q.error_from(&d)), &q));
    }

    #[test]
    fn rotation_matrices_compose_like_quaternions(a in attitude(), b in attitude()) {
        let product = b.direction_cosine_matrix() * a.direction_cosine_matrix();
        prop_assert!(((a * b).direction_cosine_matrix() - product).norm() < 1e-12);
        prop_assert!((product * product.transpose() - Matrix3::identity()).norm() < 1e-12);
        prop_assert!((product.determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn both_signs_of_a_quaternion_are_one_attitude(q in attitude()) {
        prop_assert_eq!((-q).direction_cosine_matrix(), q.direction_cosine_matrix());
        prop_assert_eq!((-q).rotation_angle_rad(), q.rotation_angle_rad());
        prop_assert!(q.shortest().scalar >= 0.0);
        prop_assert_eq!(q.shortest(), (-q).shortest());
    }

    #[test]
    fn the_rotation_angle_is_the_shorter_way_round(
        axis in vector(1.0).prop_filter("an axis", |axis| axis.norm() > 1e-3),
        angle in 0.0..2.0 * PI,
    ) {
        let found = Quaternion::from_axis_angle(&axis, angle).unwrap().rotation_angle_rad();
        prop_assert!((found - angle.min(2.0 * PI - angle)).abs() < 1e-12);
    }

    #[test]
    fn kinematics_keep_the_norm(q in attitude(), rate in vector(2.0)) {
        let derivative = q.derivative(&rate);
        let norm_rate = q.scalar * derivative.scalar + q.vector.dot(&derivative.vector);
        prop_assert!(norm_rate.abs() < 1e-14);
    }

    #[test]
    fn kinematics_are_the_limit_of_small_body_rotations(q in attitude(), rate in vector(2.0)) {
        prop_assume!(rate.norm() > 1e-3);
        let step = 1e-6;
        let turned = |time: f64| q * Quaternion::from_axis_angle(&rate, rate.norm() * time).unwrap();
        let (ahead, behind) = (turned(step), turned(-step));
        let derivative = q.derivative(&rate);
        prop_assert!(((ahead.scalar - behind.scalar) / (2.0 * step) - derivative.scalar).abs() < 1e-8);
        let vector = (ahead.vector - behind.vector) / (2.0 * step);
        prop_assert!((vector - derivative.vector).norm() < 1e-8);
    }

    #[test]
    fn the_rotation_matrix_obeys_its_own_kinematics(q in attitude(), rate in vector(2.0)) {
        prop_assume!(rate.norm() > 1e-3);
        let step = 1e-6;
        let matrix = |time: f64| {
            let turn = Quaternion::from_axis_angle(&rate, rate.norm() * time).unwrap();
            (q * turn).direction_cosine_matrix()
        };
        let derivative = (matrix(step) - matrix(-step)) / (2.0 * step);
        prop_assert!((derivative + skew(&rate) * q.direction_cosine_matrix()).norm() < 1e-8);
    }

    #[test]
    fn the_rate_error_vanishes_when_the_body_follows_the_reference(q in attitude(), desired in vector(0.1)) {
        let rate = q.direction_cosine_matrix() * desired;
        prop_assert!(q.rate_error(&rate, &desired).norm() < 1e-15);
    }

    #[test]
    fn renormalising_gives_norm_one_and_the_same_direction(q in attitude(), scale in 1e-3..1e3) {
        let scaled = Quaternion::new(q.scalar * scale, q.vector * scale);
        let unit = scaled.normalised().unwrap();
        prop_assert!((unit.norm() - 1.0).abs() < 1e-15);
        prop_assert!(close(&unit, &q));
    }

    #[test]
    fn scalar_first_and_scalar_last_hold_the_same_quaternion(q in attitude()) {
        prop_assert_eq!(Quaternion::from_scalar_first(q.to_scalar_first()), q);
        prop_assert_eq!(Quaternion::from_scalar_last(q.to_scalar_last()), q);
        prop_assert_eq!(q.to_scalar_first()[0], q.to_scalar_last()[3]);
    }
}

#[test]
fn the_scalar_is_where_the_name_of_the_constructor_says() {
    let first = Quaternion::from_scalar_first([0.1, 0.2, 0.3, 0.4]);
    let last = Quaternion::from_scalar_last([0.2, 0.3, 0.4, 0.1]);
    assert_eq!(first, last);
    assert_eq!(first.scalar, 0.1);
}

#[test]
fn the_units_multiply_as_hamilton_carved_them() {
    let unit = |axis: usize| Quaternion::new(0.0, Vector3::ith(axis, 1.0));
    assert_eq!(unit(0) * unit(1), unit(2));
    assert_eq!(unit(1) * unit(2), unit(0));
    assert_eq!(unit(2) * unit(0), unit(1));
    assert_eq!(unit(0) * unit(0), -Quaternion::identity());
}

#[test]
fn a_yaw_turns_the_reference_x_axis_to_minus_body_y() {
    let yaw = Quaternion::from_euler_321(PI / 2.0, 0.0, 0.0);
    let seen = yaw.direction_cosine_matrix() * Vector3::new(1.0, 0.0, 0.0);
    assert_relative_eq!(seen, Vector3::new(0.0, -1.0, 0.0), epsilon = 1e-15);
}

/// The start that Yang et al. 2025 print is roll 18, then pitch 5, then yaw 37 degrees. Undoing it is
/// the sequence 3-2-1 with the angles negated.
#[test]
fn euler_angles_agree_with_the_product_of_axis_rotations() {
    let about = |axis: usize, degrees: f64| {
        Quaternion::from_axis_angle(&Vector3::ith(axis, 1.0), degrees.to_radians()).unwrap()
    };
    let printed = Quaternion::from_scalar_first([0.9336, 0.1619, -0.0087, 0.3196]);
    let product = about(0, 18.0) * about(1, 5.0) * about(2, 37.0);
    assert_relative_eq!(product.vector, printed.vector, epsilon = 5e-5);
    assert_relative_eq!(product.scalar, printed.scalar, epsilon = 5e-5);
    let reversed =
        Quaternion::from_euler_321(-37f64.to_radians(), -5f64.to_radians(), -18f64.to_radians());
    assert!(close(&reversed, &product.conjugate()));
}

#[test]
fn tiny_rotation_angles_keep_their_digits() {
    let angle = 1e-12;
    let q = Quaternion::from_axis_angle(&Vector3::new(0.0, 1.0, 0.0), angle).unwrap();
    assert_relative_eq!(q.rotation_angle_rad(), angle, max_relative = 1e-14);
}

#[test]
fn a_zero_quaternion_and_a_zero_axis_cannot_be_normalised() {
    let zero = Quaternion::new(0.0, Vector3::zeros());
    assert_eq!(zero.normalised().unwrap_err().norm, 0.0);
    assert!(Quaternion::new(f64::NAN, Vector3::zeros())
        .normalised()
        .is_err());
    assert!(Quaternion::new(f64::INFINITY, Vector3::zeros())
        .normalised()
        .is_err());
    assert!(Quaternion::from_axis_angle(&Vector3::zeros(), 1.0).is_err());
    assert!(Quaternion::from_axis_angle(&Vector3::x(), f64::NAN).is_err());
}

#[test]
fn a_measurement_check_names_the_first_bad_component() {
    let good = AttitudeMeasurement {
        error: Quaternion::identity(),
        rate_rad_s: Vector3::zeros(),
    };
    assert_eq!(good.check(), Ok(()));
    for component in 0..7 {
        let mut bad = good;
        match component {
            0 => bad.error.scalar = f64::NAN,
            1..=3 => bad.error.vector[component - 1] = f64::INFINITY,
            _ => bad.rate_rad_s[component - 4] = f64::NEG_INFINITY,
        }
        assert_eq!(
            bad.check(),
            Err(HoldReason::NonFiniteMeasurement { component })
        );
    }
}

#[test]
fn a_measured_quaternion_far_from_unit_length_is_refused() {
    let with_scalar = |scalar| AttitudeMeasurement {
        error: Quaternion::new(scalar, Vector3::zeros()),
        rate_rad_s: Vector3::zeros(),
    };
    assert_eq!(with_scalar(1.005).check(), Ok(()));
    assert_eq!(with_scalar(-0.995).check(), Ok(()));
    assert_eq!(
        with_scalar(0.0).check(),
        Err(HoldReason::NotUnitQuaternion { norm: 0.0 })
    );
    assert_eq!(
        with_scalar(1.5).check(),
        Err(HoldReason::NotUnitQuaternion { norm: 1.5 })
    );
}

#[test]
fn the_rigid_body_state_takes_the_quaternion_with_positive_scalar() {
    let measurement = AttitudeMeasurement {
        error: Quaternion::from_scalar_first([-0.5, 0.5, -0.5, 0.5]),
        rate_rad_s: Vector3::new(1.0, 2.0, 3.0),
    };
    let state = measurement.rigid_body_state();
    assert_eq!(state.as_slice(), [1.0, 2.0, 3.0, -0.5, 0.5, -0.5]);
}

#[test]
fn the_sign_changes_only_past_the_hysteresis() {
    let mut sign = SignHysteresis::new(0.1).unwrap();
    let signs = [0.05, -0.05, -0.1, -0.11, 0.05, 0.1, 0.11, f64::NAN].map(|q0| sign.update(q0));
    assert_eq!(signs, [1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0, 1.0]);
    sign.reset();
    assert_eq!(sign.update(-0.01), -1.0);
    assert_eq!(SignHysteresis::new(0.0).unwrap().update(0.0), 1.0);
}

#[test]
fn a_hysteresis_of_one_is_refused() {
    let error = SignHysteresis::new(1.0).unwrap_err();
    assert!(matches!(error, ParameterError::OutOfRange { value, .. } if value == 1.0));
    assert_eq!(error.to_string(), "hysteresis is 1, allowed is [0, 1)");
}
