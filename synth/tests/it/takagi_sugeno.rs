//! The exact T-S model of the rigid spacecraft is the rigid spacecraft.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3, Vector4, Vector6};
use proptest::prelude::*;
use synth::certify::interval::Interval;
use synth::certify::matrix::Matrix;
use synth::certify::plant::DescriptorPlant;
use synth::fuzzy::{ExactSpacecraft, VertexSystem, SPACECRAFT_VERTICES};
use synth::model::Plant;

/// A body of physical shape: principal moments that satisfy the triangle inequality, turned by any
/// angle.
fn inertia() -> impl Strategy<Value = Matrix3<f64>> {
    let moments = (0.1..1.0_f64, 0.1..1.0_f64, 0.1..1.0_f64);
    let angles = (-3.0..3.0_f64, -1.5..1.5_f64, -3.0..3.0_f64);
    (moments, angles, -3..4_i32).prop_map(|((a, b, c), (roll, pitch, yaw), decade)| {
        let turn = Rotation3::from_euler_angles(roll, pitch, yaw).into_inner();
        let principal = Matrix3::from_diagonal(&Vector3::new(b + c, c + a, a + b));
        let inertia = turn * principal * turn.transpose() * 10.0_f64.powi(decade);
        0.5 * (inertia + inertia.transpose())
    })
}

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-size..size).prop_map(Vector3::from)
}

fn spacecraft() -> impl Strategy<Value = ExactSpacecraft> {
    let rates = prop::array::uniform3(0.01..2.0_f64);
    (inertia(), rates, 0.05..0.99_f64).prop_map(|(inertia, rates, scalar_part_min)| {
        ExactSpacecraft {
            inertia_uncertainty: Default::default(),
            inertia,
            torque_limit: Vector3::new(1.0, 2.0, 3.0),
            disturbance_bound: 0.01,
            rate_bound: Vector3::from(rates),
            scalar_part_min,
            gyroscopic_form: None,
            output_weights: [1.0; 6],
            exchange: Default::default(),
            at_rest: false,
        }
    })
}

/// A state in the box: rates as fractions of their bounds, a vector part of a norm up to
/// sqrt(1 - q0min^2).
fn state(
    craft: &ExactSpacecraft,
    rates: &Vector3<f64>,
    direction: &Vector3<f64>,
    radius: f64,
) -> Vector6<f64> {
    let rate = craft.rate_bound.component_mul(rates);
    let reach = (1.0 - craft.scalar_part_min * craft.scalar_part_min).sqrt();
    let vector_part = direction.normalize() * (radius * reach);
    Vector6::new(
        rate[0],
        rate[1],
        rate[2],
        vector_part[0],
        vector_part[1],
        vector_part[2],
    )
}

fn scheduling(state: &Vector6<f64>) -> Vector4<f64> {
    let scalar_part = (1.0 - state.fixed_rows::<3>(3).norm_squared()).sqrt();
    Vector4::new(state[0], state[1], state[2], scalar_part)
}

/// (2) and (3) of the paper, entry by entry.
fn rigid_body(
    craft: &ExactSpacecraft,
    state: &Vector6<f64>,
    torque: &Vector3<f64>,
) -> Vector6<f64> {
    let (w, q) = (
        state.fixed_rows::<3>(0).into_owned(),
        state.fixed_rows::<3>(3).into_owned(),
    );
    let q0 = (1.0 - q.norm_squared()).sqrt();
    let momentum = craft.inertia * w;
    let gyroscopic = Vector3::new(
        w[1] * momentum[2] - w[2] * momentum[1],
        w[2] * momentum[0] - w[0] * momentum[2],
        w[0] * momentum[1] - w[1] * momentum[0],
    );
    let acceleration = craft
        .inertia
        .cholesky()
        .expect("positive definite")
        .solve(&(torque - gyroscopic));
    let kinematics = 0.5
        * Vector3::new(
            q0 * w[0] - q[2] * w[1] + q[1] * w[2],
            q[2] * w[0] + q0 * w[1] - q[0] * w[2],
            -q[1] * w[0] + q[0] * w[1] + q0 * w[2],
        );
    Vector6::from_iterator(acceleration.iter().chain(kinematics.iter()).copied())
}

/// What the entries of x' are rounded relative to.
fn scale(craft: &ExactSpacecraft, state: &Vector6<f64>, torque: &Vector3<f64>) -> f64 {
    let moments = craft.inertia.symmetric_eigenvalues();
    let rate = state.fixed_rows::<3>(0).norm();
    let condition = moments.max() / moments.min();
    rate + condition * rate * rate + torque.norm() / moments.min()
}

const ROUNDING: f64 = 1e-13;

/// Nothing is written beside the sources: a failing seed is printed.
fn cases(count: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(count)
    }
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn on_the_box_the_blended_vertices_equal_the_nonlinear_plant(
        craft in spacecraft(),
        rates in vector(1.0),
        direction in vector(1.0),
        radius in 0.0..1.0_f64,
        torque in vector(5.0),
    ) {
        prop_assume!(direction.norm() > 1e-3);
        let state = state(&craft, &rates, &direction, radius);
        let model = craft.takagi_sugeno();
        let memberships = craft.memberships(&scheduling(&state));
        let at = DVector::from_column_slice(state.as_slice());
        let input = DVector::from_column_slice(torque.as_slice());
        let blended = memberships.iter().zip(&model.vertices).fold(
            &model.input * input,
            |sum, (membership, vertex)| sum + vertex * &at * *membership,
        );
        let blended = Vector6::from_column_slice(blended.as_slice());
        let tolerance = ROUNDING * scale(&craft, &state, &torque);
        let plant = rigid_body(&craft, &state, &torque);
        prop_assert!((blended - plant).norm() <= tolerance, "{blended} {plant}");
        let shipped = craft.right_hand_side(&state, &torque);
        prop_assert!((shipped - plant).norm() <= tolerance, "{shipped} {plant}");
    }

    #[test]
    fn memberships_are_not_negative_and_sum_to_one_on_the_box(
        craft in spacecraft(),
        rates in vector(1.0),
        direction in vector(1.0),
        radius in 0.0..1.0_f64,
    ) {
        prop_assume!(direction.norm() > 1e-3);
        let scheduling = scheduling(&state(&craft, &rates, &direction, radius));
        let memberships = craft.memberships(&scheduling);
        prop_assert!(memberships.iter().all(|membership| *membership >= -1e-14));
        let sum: f64 = memberships.iter().sum();
        prop_assert!((sum - 1.0).abs() <= 1e-13);
        // The scheduling variables themselves are the blend of the corners.
        let blend = (0..SPACECRAFT_VERTICES)
            .fold(Vector4::zeros(), |sum, vertex| sum + craft.corner(vertex) * memberships[vertex]);
        prop_assert!((blend - scheduling).norm() <= 1e-13 * (1.0 + scheduling.norm()));
    }

    #[test]
    fn the_vertices_are_the_corners_of_the_box_and_each_is_met_by_one_rule(craft in spacecraft()) {
        let model = craft.takagi_sugeno();
        prop_assert_eq!(model.vertices.len(), SPACECRAFT_VERTICES);
        for (vertex, matrix) in model.vertices.iter().enumerate() {
            let corner = craft.corner(vertex);
            for axis in 0..3 {
                prop_assert_eq!(corner[axis].abs(), craft.rate_bound[axis]);
            }
            prop_assert!(corner[3] == 1.0 || corner[3] == craft.scalar_part_min);
            prop_assert_eq!(matrix, &craft.state_matrix(&corner));
            let memberships = craft.memberships(&corner);
            for (other, membership) in memberships.iter().enumerate() {
                prop_assert_eq!(*membership, f64::from(other == vertex));
            }
            for other in 0..vertex {
                prop_assert_ne!(corner, craft.corner(other));
            }
        }
    }

    #[test]
    fn the_check_states_the_same_plant_multiplied_by_the_inertia(craft in spacecraft()) {
        let model = craft.takagi_sugeno();
        let plant = DescriptorPlant::<Interval>::new(&Plant::Spacecraft(craft.clone()));
        let descriptor = midpoints(&plant.descriptor);
        let mut expected = DMatrix::identity(6, 6);
        expected.view_mut((0, 0), (3, 3)).copy_from(&craft.inertia);
        prop_assert_eq!(&descriptor, &expected);
        prop_assert_eq!(plant.vertices.len(), model.vertices.len());
        let moments = craft.inertia.symmetric_eigenvalues();
        let condition = moments.max() / moments.min();
        for (checked, vertex) in plant.vertices.iter().zip(&model.vertices) {
            let (checked, expected) = (midpoints(checked), &descriptor * vertex);
            let size = expected.norm();
            prop_assert!((checked - expected).norm() <= ROUNDING * condition * size);
        }
        for (checked, matrix) in [
            (&plant.input, &model.input),
            (&plant.disturbance, &model.disturbance),
        ] {
            let distance = midpoints(checked) - &descriptor * matrix;
            prop_assert!(distance.norm() <= ROUNDING * condition);
        }
        prop_assert_eq!(midpoints(&plant.output), model.output);
        prop_assert_eq!(plant.region.len(), model.region.len());
        for (checked, bound) in plant.region.iter().zip(&model.region) {
            prop_assert_eq!(&checked.name, &bound.name);
            prop_assert_eq!(midpoints(&checked.rows), bound.rows.clone());
            let distance = checked.bound_squared.midpoint() - bound.bound_squared;
            prop_assert!(distance.abs() <= 1e-15);
        }
    }
}

fn midpoints(matrix: &Matrix<Interval>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
        matrix.at(r, c).midpoint()
    })
}

#[test]
fn off_the_box_the_blend_is_no_longer_convex() {
    let memberships = simple_craft(0.8).memberships(&Vector4::new(0.2, 0.0, 0.0, 0.9));
    assert!(memberships.iter().any(|membership| *membership < -0.05));
}

#[test]
fn a_box_of_one_attitude_still_has_memberships_that_sum_to_one() {
    let craft = simple_craft(1.0);
    let scheduling = Vector4::new(0.03, -0.02, 0.1, 1.0);
    let memberships = craft.memberships(&scheduling);
    assert!(memberships.iter().all(|membership| *membership >= 0.0));
    assert!((memberships.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    let blend = craft
        .takagi_sugeno()
        .vertices
        .iter()
        .zip(memberships)
        .fold(DMatrix::zeros(6, 6), |sum, (vertex, membership)| {
            sum + vertex * membership
        });
    assert!((blend - craft.state_matrix(&scheduling)).norm() < 1e-14);
}

fn simple_craft(scalar_part_min: f64) -> ExactSpacecraft {
    ExactSpacecraft {
        inertia_uncertainty: Default::default(),
        inertia: Matrix3::from_diagonal(&Vector3::new(3.0, 2.0, 1.5)),
        torque_limit: Vector3::new(1.0, 1.0, 1.0),
        disturbance_bound: 0.0,
        rate_bound: Vector3::new(0.1, 0.1, 0.1),
        scalar_part_min,
        gyroscopic_form: None,
        output_weights: [1.0; 6],
        exchange: Default::default(),
        at_rest: false,
    }
}

#[test]
fn a_vertex_model_is_passed_on_as_it_is() {
    let system = VertexSystem {
        state_matrices: vec![
            DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -2.0, -3.0]),
            DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -4.0, -5.0]),
        ],
        input_matrix: DMatrix::from_row_slice(2, 1, &[0.0, 7.0]),
        disturbance_matrix: DMatrix::from_row_slice(2, 1, &[1.0, 0.5]),
        output_matrix: DMatrix::from_row_slice(1, 2, &[1.0, 0.0]),
        input_limit: DVector::from_vec(vec![2.0]),
        disturbance_bound: 0.25,
        box_rows: DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 3.0, 4.0]),
        box_bounds: DVector::from_vec(vec![0.5, 6.0]),
    };
    let model = system.takagi_sugeno();
    assert_eq!((model.states(), model.inputs()), (2, 1));
    assert_eq!(model.vertices, system.state_matrices);
    assert_eq!(
        model.region[1].rows,
        DMatrix::from_row_slice(1, 2, &[3.0, 4.0])
    );
    assert_eq!(model.region[1].bound_squared, 36.0);
    let plant = DescriptorPlant::<Interval>::new(&Plant::Vertices(system.clone()));
    assert_eq!(midpoints(&plant.descriptor), DMatrix::identity(2, 2));
    for (checked, matrix) in plant.vertices.iter().zip(&system.state_matrices) {
        assert_eq!(&midpoints(checked), matrix);
    }
    assert_eq!(midpoints(&plant.input), system.input_matrix);
    assert_eq!(midpoints(&plant.disturbance), system.disturbance_matrix);
    assert_eq!(midpoints(&plant.region[1].rows), model.region[1].rows);
    assert_eq!(plant.region[1].bound_squared.midpoint(), 36.0);
}
