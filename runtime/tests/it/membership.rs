//! Memberships of the spacecraft model: a partition of unity that reproduces the plant.

use crate::common::Plant;
use proptest::prelude::*;
use runtime::attitude::{skew, Quaternion};
use runtime::error::ParameterError;
use runtime::membership::{
    ConstantGain, GaussianRules, IntervalProduct, Membership, RigidBodyBox, RIGID_BODY_VERTICES,
};
use runtime::nalgebra::{Matrix3, Matrix6, Vector2, Vector3, Vector6};

fn inertia() -> Matrix3<f64> {
    Matrix3::new(350.0, 3.0, 4.0, 3.0, 270.0, 10.0, 4.0, 10.0, 190.0)
}

fn design_box() -> RigidBodyBox {
    RigidBodyBox::new([0.1, 0.2, 0.3], 0.6).unwrap()
}

/// System matrix of the rigid body, Xu and Huang 2020, below (7), at scheduling variables.
fn system_matrix([w1, w2, w3, q0]: [f64; 4]) -> Matrix6<f64> {
    let turning = skew(&Vector3::new(w1, w2, w3));
    let mut a = Matrix6::zeros();
    let gyroscopic = -inertia().try_inverse().unwrap() * turning * inertia();
    a.fixed_view_mut::<3, 3>(0, 0).copy_from(&gyroscopic);
    a.fixed_view_mut::<3, 3>(3, 0)
        .copy_from(&(Matrix3::identity() * (0.5 * q0)));
    a.fixed_view_mut::<3, 3>(3, 3).copy_from(&(turning * -0.5));
    a
}

/// Free motion of the rigid body, with no T-S model in between.
fn free_motion(state: &Vector6<f64>) -> Vector6<f64> {
    let rate: Vector3<f64> = state.fixed_rows::<3>(0).into();
    let q: Vector3<f64> = state.fixed_rows::<3>(3).into();
    let attitude = Quaternion::new((1.0 - q.dot(&q)).sqrt(), q);
    let acceleration = Plant::new(inertia()).acceleration(&rate, &Vector3::zeros());
    let kinematics = attitude.derivative(&rate).vector;
    let mut derivative = Vector6::zeros();
    derivative.fixed_rows_mut::<3>(0).copy_from(&acceleration);
    derivative.fixed_rows_mut::<3>(3).copy_from(&kinematics);
    derivative
}

/// States in the design box: q has norm at most sqrt(1 - 0.6^2) = 0.8.
fn state_in_box() -> impl Strategy<Value = Vector6<f64>> {
    let rate = [-0.1..0.1, -0.2..0.2, -0.3..0.3f64];
    let q = [-0.46..0.46, -0.46..0.46, -0.46..0.46f64];
    (rate, q).prop_map(|([a, b, c], [d, e, f])| Vector6::new(a, b, c, d, e, f))
}

fn any_state() -> impl Strategy<Value = Vector6<f64>> {
    proptest::array::uniform6(-3.0..3.0f64).prop_map(Vector6::from)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn weights_are_not_negative_and_sum_to_one_everywhere(state in any_state()) {
        let weights = design_box().vertex_weights(&state);
        prop_assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)));
        prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_weighted_vertices_are_the_nonlinear_rigid_body(state in state_in_box()) {
        let rules = design_box();
        prop_assert!(rules.contains_state(&state));
        let mut derivative = Vector6::zeros();
        for (index, weight) in rules.vertex_weights(&state).into_iter().enumerate() {
            derivative += system_matrix(rules.vertex(index).unwrap()) * state * weight;
        }
        prop_assert!((derivative - free_motion(&state)).norm() < 1e-14);
    }

    #[test]
    fn scheduling_variables_are_the_weighted_vertices(state in state_in_box()) {
        let rules = design_box();
        let mut mean = [0.0; 4];
        for (index, weight) in rules.vertex_weights(&state).into_iter().enumerate() {
            for (value, corner) in mean.iter_mut().zip(rules.vertex(index).unwrap()) {
                *value += weight * corner;
            }
        }
        for (value, expected) in mean.iter().zip(RigidBodyBox::scheduling_variables(&state)) {
            prop_assert!((value - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn outside_of_the_box_the_weights_are_those_of_the_nearest_boundary(
        z in proptest::array::uniform2(-9.0..9.0f64),
    ) {
        let rules = IntervalProduct::<2, 4>::new([-1.0, 2.0], [1.0, 5.0]).unwrap();
        let nearest = [z[0].clamp(-1.0, 1.0), z[1].clamp(2.0, 5.0)];
        prop_assert_eq!(rules.weights(&z), rules.weights(&nearest));
        prop_assert_eq!(rules.contains(&z), z == nearest);
    }

    #[test]
    fn gaussian_weights_sum_to_one_and_the_nearest_rule_counts_most(
        x in proptest::array::uniform2(-50.0..50.0f64),
    ) {
        let (centres, rules) = three_rules();
        let state = Vector2::from(x);
        let weights = rules.weights(&state);
        prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        let distance = |rule: usize| (state - centres[rule]).norm();
        for a in 0..3 {
            for b in 0..3 {
                prop_assert!(distance(a) > distance(b) || weights[a] >= weights[b]);
            }
        }
    }
}

fn three_rules() -> ([Vector2<f64>; 3], GaussianRules<2, 3>) {
    let centres = [
        Vector2::zeros(),
        Vector2::new(1.0, 1.0),
        Vector2::new(-1.0, 0.5),
    ];
    (
        centres,
        GaussianRules::new(centres, Vector2::repeat(0.5)).unwrap(),
    )
}

#[test]
fn bit_k_of_a_vertex_index_selects_the_upper_bound_of_variable_k() {
    let rules = design_box();
    assert_eq!(rules.vertex(0), Some([-0.1, -0.2, -0.3, 0.6]));
    assert_eq!(rules.vertex(1), Some([0.1, -0.2, -0.3, 0.6]));
    assert_eq!(rules.vertex(2), Some([-0.1, 0.2, -0.3, 0.6]));
    assert_eq!(rules.vertex(4), Some([-0.1, -0.2, 0.3, 0.6]));
    assert_eq!(rules.vertex(8), Some([-0.1, -0.2, -0.3, 1.0]));
    assert_eq!(rules.vertex(15), Some([0.1, 0.2, 0.3, 1.0]));
    assert_eq!(rules.vertex(16), None);
}

#[test]
fn at_a_vertex_only_its_own_rule_counts() {
    let rules = IntervalProduct::<3, 8>::new([-1.0, 0.0, 2.0], [1.0, 4.0, 3.0]).unwrap();
    for vertex in 0..8 {
        let weights = rules.weights(&rules.vertex(vertex).unwrap());
        for (index, weight) in weights.into_iter().enumerate() {
            assert_eq!(weight, if index == vertex { 1.0 } else { 0.0 });
        }
    }
}

#[test]
fn a_state_beyond_the_rate_bound_or_the_angle_bound_is_outside() {
    let rules = design_box();
    let contains = |state: [f64; 6]| rules.contains_state(&Vector6::from(state));
    assert!(contains([0.1, -0.2, 0.3, 0.0, 0.0, 0.0]));
    assert!(!contains([0.1001, 0.0, 0.0, 0.0, 0.0, 0.0]));
    assert!(contains([0.0, 0.0, 0.0, 0.79, 0.0, 0.0]));
    assert!(!contains([0.0, 0.0, 0.0, 0.0, 0.81, 0.0]));
    assert!(!contains([f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]));
}

#[test]
fn a_vector_part_longer_than_one_is_outside_even_of_the_half_turn_box() {
    let rules = RigidBodyBox::new([1.0; 3], 0.0).unwrap();
    let state = Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 1.01);
    assert!(!rules.contains_state(&state));
    assert_eq!(RigidBodyBox::scheduling_variables(&state)[3], 0.0);
}

#[test]
fn the_box_serves_scheduled_and_constant_gains() {
    let rules = design_box();
    let state = Vector6::new(0.05, 0.0, 0.0, 0.3, 0.0, 0.0);
    let scheduled: [f64; RIGID_BODY_VERTICES] = rules.weights(&state);
    let constant: [f64; 1] = rules.weights(&state);
    assert_eq!(scheduled, rules.vertex_weights(&state));
    assert_eq!(constant, [1.0]);
    let unbounded: [f64; 1] = ConstantGain.weights(&(state * 1e9));
    assert_eq!(unbounded, [1.0]);
    assert!(Membership::<6, 1>::contains(&ConstantGain, &(state * 1e9)));
    assert!(!Membership::<6, 1>::contains(&rules, &(state * 1e9)));
}

#[test]
fn gaussian_weights_stay_defined_where_every_exponential_underflows() {
    let (_, rules) = three_rules();
    assert_eq!(rules.weights(&Vector2::new(1e6, 1e6)), [0.0, 1.0, 0.0]);
    assert_eq!(rules.weights(&Vector2::repeat(1e300)), [1.0 / 3.0; 3]);
}

#[test]
fn an_interval_without_width_is_refused_with_its_bounds() {
    let error = IntervalProduct::<2, 4>::new([0.0, 3.0], [1.0, 3.0]).unwrap_err();
    assert!(matches!(
        error,
        ParameterError::EmptyInterval { lower, upper, .. } if lower == 3.0 && upper == 3.0
    ));
    assert_eq!(
        error.to_string(),
        "lower[1]: the interval from 3 to 3 contains nothing"
    );
    let error = IntervalProduct::<1, 2>::new([f64::NAN], [1.0]).unwrap_err();
    assert!(matches!(error, ParameterError::NotFinite { .. }));
    assert!(IntervalProduct::<1, 2>::new([-1e308], [1e308]).is_err());
}

#[test]
fn a_box_without_rate_or_with_a_scalar_part_of_one_is_refused() {
    assert!(RigidBodyBox::new([0.1, 0.0, 0.1], 0.5).is_err());
    assert!(RigidBodyBox::new([0.1; 3], 1.0).is_err());
    assert!(RigidBodyBox::new([0.1; 3], -0.1).is_err());
    let error = RigidBodyBox::new([0.1, 0.1, f64::INFINITY], 0.5).unwrap_err();
    assert_eq!(
        error.to_string(),
        "rate_bound_rad_s[2] is inf, not a finite number"
    );
}

#[test]
fn gaussian_rules_refuse_a_width_of_zero_and_a_centre_that_is_not_finite() {
    assert!(GaussianRules::new([Vector2::zeros()], Vector2::new(1.0, 0.0)).is_err());
    let error = GaussianRules::new(
        [Vector2::zeros(), Vector2::new(0.0, f64::NAN)],
        Vector2::repeat(1.0),
    )
    .unwrap_err();
    assert_eq!(
        error.to_string(),
        "centres[1][1][0] is NaN, not a finite number"
    );
}
