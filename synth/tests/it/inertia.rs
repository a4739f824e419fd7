//! Uncertain inertia: the vertices are those of the set, the reduced form loses nothing, the check reads every
//! vertex, and wrong sets are refused.

use crate::exact::Stream;
use nalgebra::{DMatrix, Matrix3, Vector3, Vector4};
use synth::certify::interval::Interval;
use synth::certify::plant::{inertia_bounds, DescriptorPlant};
use synth::conditions::Task;
use synth::fuzzy::{triangle_excess, ExactSpacecraft, InertiaUncertainty};
use synth::model::{InertiaUncertaintyFile, Model, Plant, PlantFile};
use synth::solve::{Backend, Clarabel, Status};
use synth::synthesis::{assemble, scaled_task, Form, Goal, FIRST_UNITS};

const XU2020: &str = include_str!("../../../models/xu2020.json");

fn uncertain(diagonal_percent: f64, off_diagonal_percent: f64) -> InertiaUncertainty {
    InertiaUncertainty {
        diagonal_percent,
        off_diagonal_percent,
        off_diagonal_amount: 0.0,
    }
}

fn craft(uncertainty: InertiaUncertainty) -> ExactSpacecraft {
    let model = Model::from_json(XU2020).expect("a valid model");
    match model.plant {
        Plant::Spacecraft(craft) => ExactSpacecraft {
            inertia_uncertainty: uncertainty,
            ..craft
        },
        _ => panic!("a spacecraft is expected"),
    }
}

/// The shipped spacecraft with a changed plant.
fn model_with(
    set: InertiaUncertaintyFile,
    change: impl FnOnce(&mut synth::model::ModelFile),
) -> Result<Model, String> {
    let mut file = Model::from_json(XU2020).expect("a valid model").file;
    match &mut file.plant {
        PlantFile::Exact(exact) => exact.inertia_uncertainty = Some(set),
        _ => panic!("a spacecraft is expected"),
    }
    change(&mut file);
    Model::new(file).map_err(|error| error.to_string())
}

fn percent(diagonal_percent: f64, off_diagonal_percent: f64) -> InertiaUncertaintyFile {
    InertiaUncertaintyFile {
        diagonal_percent,
        off_diagonal_percent,
        off_diagonal_kg_m2: 0.0,
    }
}

fn midpoints(matrix: &synth::certify::matrix::Matrix<Interval>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
        matrix.at(r, c).midpoint()
    })
}

#[test]
fn six_uncertain_entries_give_1024_vertices_and_no_uncertainty_gives_16() {
    let system = craft(uncertain(10.0, 10.0)).takagi_sugeno();
    assert_eq!(
        (system.vertices.len(), system.descriptors.len()),
        (1024, 1024)
    );
    let system = craft(uncertain(5.0, 0.0)).takagi_sugeno();
    assert_eq!(
        (system.vertices.len(), system.descriptors.len()),
        (128, 128)
    );
    let plain = craft(uncertain(0.0, 0.0)).takagi_sugeno();
    assert_eq!((plain.vertices.len(), plain.descriptors.len()), (16, 0));
}

/// Every (E, A) of the set and the box is the combination of the vertices with product weights, for the
/// synthesis and for the check; both have the same vertices in the same order.
#[test]
fn every_inertia_of_the_set_is_a_combination_of_the_vertices() {
    let craft = craft(uncertain(10.0, 30.0));
    let nominal = craft.inertia;
    let plants = DescriptorPlant::<Interval>::each_inertia(&Plant::Spacecraft(craft.clone()));
    let system = craft.takagi_sugeno();
    assert_eq!(plants.len(), 64);
    let to_descriptor = Plant::Spacecraft(craft.clone()).descriptor();
    let mut stream = Stream(8);
    for _ in 0..20 {
        let places: [f64; 6] = std::array::from_fn(|_| 0.5 + 0.5 * stream.signed_unit());
        let inertia = craft.inertia_uncertainty.member(&nominal, &places);
        assert!(craft.inertia_uncertainty.excess(&nominal, &inertia) <= 0.0);
        let rate = Vector3::from_fn(|k, _| craft.rate_bound[k] * stream.signed_unit());
        let low = craft.scalar_part_min;
        let scalar = low + (1.0 - low) * (0.5 + 0.5 * stream.signed_unit());
        let scheduling = Vector4::new(rate[0], rate[1], rate[2], scalar);
        let of_box = craft.memberships(&scheduling);
        let of_set = |vertex: usize| -> f64 {
            let factor = |(bit, place): (usize, &f64)| match vertex >> bit & 1 {
                1 => *place,
                _ => 1.0 - *place,
            };
            places.iter().enumerate().map(factor).product()
        };
        let (mut state, mut descriptor) = (DMatrix::zeros(6, 6), DMatrix::zeros(6, 6));
        let (mut own_state, mut own_descriptor) = (state.clone(), state.clone());
        for (index, plant) in plants.iter().enumerate() {
            for (corner, membership) in of_box.iter().enumerate() {
                let weight = of_set(index) * membership;
                state += midpoints(&plant.vertices[corner]) * weight;
                descriptor += midpoints(&plant.descriptor) * weight;
                let vertex = 16 * index + corner;
                own_state += &to_descriptor * &system.vertices[vertex] * weight;
                own_descriptor += &to_descriptor * &system.descriptors[vertex] * weight;
            }
        }
        let known = ExactSpacecraft {
            inertia,
            inertia_uncertainty: InertiaUncertainty::default(),
            ..craft.clone()
        };
        let mut expected_descriptor = DMatrix::identity(6, 6);
        expected_descriptor
            .view_mut((0, 0), (3, 3))
            .copy_from(&inertia);
        let expected = &expected_descriptor * known.state_matrix(&scheduling);
        for found in [&state, &own_state] {
            assert!((found - &expected).amax() < 1e-11 * nominal.amax());
        }
        for found in [&descriptor, &own_descriptor] {
            assert!((found - &expected_descriptor).amax() < 1e-11 * nominal.amax());
        }
    }
}

/// x'Jx >= x'(J0 - T W T)x for every J of the set, T the signs of x; and the bound is reached.
#[test]
fn the_four_bounds_of_the_set_lie_below_every_inertia_of_it() {
    let craft = craft(uncertain(20.0, 80.0));
    let bounds: Vec<DMatrix<f64>> = inertia_bounds::<Interval>(&craft)
        .iter()
        .map(midpoints)
        .collect();
    assert_eq!(bounds.len(), 4);
    let vertices = craft.inertia_uncertainty.vertices(&craft.inertia);
    for bound in &bounds {
        let reached = vertices
            .iter()
            .any(|vertex| (vertex - Matrix3::from_fn(|r, c| bound[(r, c)])).amax() < 1e-9);
        assert!(reached, "each bound is a vertex of the set");
    }
    let mut stream = Stream(3);
    for _ in 0..200 {
        let x = Vector3::from_fn(|_, _| stream.signed_unit());
        let value = |matrix: &Matrix3<f64>| (x.transpose() * matrix * x)[(0, 0)];
        let of_bounds = bounds
            .iter()
            .map(|bound| value(&Matrix3::from_fn(|r, c| bound[(r, c)])))
            .fold(f64::INFINITY, f64::min);
        let of_set = vertices.iter().map(value).fold(f64::INFINITY, f64::min);
        assert!((of_bounds - of_set).abs() <= 1e-9 * craft.inertia.amax());
    }
}

#[test]
fn a_set_with_an_inertia_that_is_not_positive_definite_is_refused() {
    assert!(model_with(percent(99.0, 0.0), |_| ()).is_err());
    let wide = InertiaUncertaintyFile {
        off_diagonal_kg_m2: 250.0,
        ..percent(0.0, 0.0)
    };
    let message = model_with(wide, |_| ()).unwrap_err();
    assert!(
        message.starts_with(
            "field 'plant.exact.inertia_uncertainty': the set must hold positive definite inertias only"
        ),
        "{message}"
    );
    // Just inside: the smallest eigenvalue over the set is positive.
    assert!(model_with(percent(90.0, 0.0), |_| ()).is_ok());
}

#[test]
fn wrong_uncertainties_are_refused_in_one_sentence() {
    let refused =
        |set, change: fn(&mut synth::model::ModelFile)| model_with(set, change).unwrap_err();
    assert_eq!(
        refused(percent(-1.0, 0.0), |_| ()),
        "field 'plant.exact.inertia_uncertainty.diagonal_percent': the value -1 is not allowed; it must be in [0, 100]"
    );
    assert_eq!(
        refused(percent(10.0, 101.0), |_| ()),
        "field 'plant.exact.inertia_uncertainty.off_diagonal_percent': the value 101 is not allowed; it must be in [0, 100]"
    );
    let negative = InertiaUncertaintyFile {
        off_diagonal_kg_m2: -0.5,
        ..percent(1.0, 1.0)
    };
    assert_eq!(
        refused(negative, |_| ()),
        "field 'plant.exact.inertia_uncertainty.off_diagonal_kg_m2': the value -0.5 is not allowed; it must be 0 or above"
    );
    let without_products = |file: &mut synth::model::ModelFile| {
        if let PlantFile::Exact(exact) = &mut file.plant {
            exact.inertia_kg_m2 = [[350.0, 0.0, 0.0], [0.0, 270.0, 0.0], [0.0, 0.0, 190.0]];
        }
    };
    assert!(refused(percent(0.0, 10.0), without_products)
        .ends_with("a percentage of 0 is 0; give off_diagonal_kg_m2 instead"));
    let scheduled = |file: &mut synth::model::ModelFile| {
        file.gains = synth::model::GainForm::Scheduled;
        file.mismatch = synth::model::Mismatch::Kappa(0.1);
    };
    assert!(refused(percent(10.0, 10.0), scheduled)
        .starts_with("field 'gains': scheduled gains are designed for a known inertia only"));
}

#[test]
fn the_triangle_inequality_says_which_inertias_no_rigid_body_has() {
    let diagonal = |moments: [f64; 3]| Matrix3::from_diagonal(&Vector3::from(moments));
    assert!(triangle_excess(&diagonal([3.0, 4.0, 7.1])) > 0.0);
    assert!(triangle_excess(&diagonal([3.0, 4.0, 6.9])) < 0.0);
}

/// A cart whose mass is known to `percent`: `m v' = -friction v + sat(u) + tau`.
fn cart(percent: f64) -> Task {
    let model = Model::from_json(include_str!("../../../models/double-integrator.json"))
        .expect("a valid model");
    let (_, mut task) = scaled_task(&model, &FIRST_UNITS);
    let known = task.system.vertices.clone();
    task.system.vertices.clear();
    for mass in [1.0 - percent / 100.0, 1.0 + percent / 100.0] {
        for vertex in &known {
            task.system.vertices.push(vertex.clone());
            let descriptor = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, mass]);
            task.system.descriptors.push(descriptor);
        }
    }
    task
}

fn smallest_gain(task: &Task, form: Form) -> f64 {
    let problem = assemble(task, form, Goal::SmallestGain).problem.lower();
    let accuracy = Goal::SmallestGain.accuracy(task);
    let solution = Clarabel::default().solve(&problem, accuracy, None);
    let solution = solution.expect("a problem with finite numbers");
    assert!(
        matches!(solution.status, Status::Solved | Status::Inaccurate),
        "{}",
        solution.status_text
    );
    solution.objective
}

/// Solvers reach gamma to about this.
const SOLVER: f64 = 3e-6;

#[test]
fn the_reduced_forms_with_an_uncertain_mass_lose_nothing_against_the_full_one() {
    for (percent, eps3) in [(5.0, 1.0), (20.0, 1.0), (20.0, 0.4), (20.0, 0.0)] {
        let mut task = cart(percent);
        task.specification.multiplier_weights[2] = eps3;
        let full = smallest_gain(&task, Form::Full);
        for form in [Form::Chordal, Form::VertexRelaxed] {
            let reduced = smallest_gain(&task, form);
            let difference = (reduced - full).abs() / full;
            println!(
                "{percent} %, eps3 {eps3}: full {full}, {} {reduced}",
                form.name()
            );
            assert!(
                difference < SOLVER,
                "{percent} %, eps3 {eps3}: {difference:e}"
            );
        }
    }
}

#[test]
fn gamma_grows_with_the_uncertainty_and_starts_at_that_of_the_known_mass() {
    let mut known = cart(0.0);
    known.system.vertices.truncate(2);
    known.system.descriptors.clear();
    let plain = smallest_gain(&known, Form::Chordal);
    let nearly = smallest_gain(&cart(1e-6), Form::Chordal);
    assert!((nearly - plain).abs() < SOLVER * plain, "{nearly} {plain}");
    let mut last = nearly;
    for percent in [5.0, 10.0, 20.0, 30.0] {
        let gain = smallest_gain(&cart(percent), Form::Chordal);
        assert!(gain > last, "{percent} %: {gain} after {last}");
        last = gain;
    }
    assert!(last > 1.05 * plain, "30 % costs something: {last} {plain}");
}
