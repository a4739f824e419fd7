//! The conditions of Theorems 1 and 2 against the proof's own terms, against each other, and
//! against the nonlinear plant.

use crate::random;
use std::collections::BTreeMap;

use crate::closed_loop::{
    in_rows, magnitude, quadratic, schur_complement, Instant, Quantities, Terms,
};
use crate::exact::Stream;
use crate::random::{assert_close, vector, Point, Sizes};
use crate::simulation::{EventTriggeredLoop, Plant, Promise};
use nalgebra::{DMatrix, DVector};
use synth::certify::interval::Interval as Enclosure;
use synth::certify::theorem1::{for_each_condition, Certificate};
use synth::certify::Verdict;
use synth::conditions::xu2020::{decrease, SamplingEnd, Sector, DEAD_ZONE_UNIT};
use synth::conditions::Task;
use synth::design::recover;
use synth::model::Model;
use synth::scaling::Scaling;
use synth::solve::Solver;
use synth::synthesis::{synthesize, Outcome, Solvers};

const XU2020: &str = include_str!("../../../models/xu2020.json");
const DOUBLE_INTEGRATOR: &str = include_str!("../../../models/double-integrator.json");

/// psi with arbitrary entries: nothing relates x', e and the dead zone to the other rows.
fn any_instant(stream: &mut Stream, task: &Task) -> Instant {
    let (n, m) = (task.system.states(), task.system.inputs());
    Instant {
        state: vector(stream, n, 1.0),
        rate: vector(stream, n, 1.0),
        sample: vector(stream, n, 1.0),
        error: vector(stream, n, 1.0),
        dead_zone: vector(stream, m, 1.0),
        disturbance: vector(stream, task.system.disturbance.ncols(), 1.0),
    }
}

fn assert_published_matrix_equals_the_proof(sector: Sector) {
    let mut stream = Stream(2020);
    for _ in 0..40 {
        let sizes = Sizes::any(&mut stream);
        let task = random::model(&mut stream, sizes, false).task();
        let point = Point::random(&mut stream, &task, sector);
        let of = Quantities::of(&point.design, &point.values);
        let vertex = &task.system.vertices[0];
        let matrix =
            |interval| decrease(&task, vertex, interval, &point.design).value(&point.values);
        let start = matrix(SamplingEnd::Start);
        let end = schur_complement(&matrix(SamplingEnd::End), task.system.states());
        for _ in 0..5 {
            let mut at = any_instant(&mut stream, &task);
            if sector == Sector::Unsaturated {
                at.dead_zone.fill(0.0);
            }
            let terms = Terms::new(&task, vertex, &at, &of);
            let rows = in_rows(&point.design, &of, &at);
            for (form, expected) in [(&start, terms.at_start()), (&end, terms.at_end())] {
                let value = quadratic(form, &rows);
                let scale = magnitude(form, &rows);
                assert!(
                    (value - expected).abs() <= 1e-12 * scale,
                    "{value:e} against {expected:e}"
                );
            }
        }
    }
}

#[test]
fn the_published_matrix_is_the_quadratic_form_of_the_proof() {
    assert_published_matrix_equals_the_proof(Sector::Unknown);
}

#[test]
fn without_sector_unknowns_it_is_the_form_at_zero_dead_zone() {
    assert_published_matrix_equals_the_proof(Sector::Unsaturated);
}

/// Midpoints of the matrices of the check, by name.
fn checked_matrices(model: &Model, certificate: &Certificate) -> BTreeMap<String, DMatrix<f64>> {
    let mut out = BTreeMap::new();
    for_each_condition::<Enclosure>(model, certificate, |statement| {
        let matrix = &statement.matrix;
        let midpoints = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
            let entry = matrix.at(r, c);
            assert!(
                entry.radius() <= 1e-10 * entry.magnitude().max(1.0),
                "{}",
                statement.name
            );
            entry.midpoint()
        });
        assert!(
            out.insert(statement.name, midpoints).is_none(),
            "a name appears twice"
        );
    });
    out
}

/// Units that differ between the states, inputs and the disturbance.
fn uneven_scaling(task: &Task, stream: &mut Stream) -> Scaling {
    let mut power = |length| {
        DVector::from_fn(length, |_, _| {
            f64::from(stream.integer(-4, 4) as i32).exp2()
        })
    };
    Scaling {
        state: power(task.system.states()),
        input: power(task.system.inputs()),
        disturbance: power(1)[0],
    }
}

/// The map from the rows of a condition of Theorem 2 in scaled units to the rows of the same
/// condition of Theorem 1 in SI units.
struct ToChecked<'a> {
    model: &'a Model,
    task: &'a Task,
    scaling: &'a Scaling,
    point: &'a Point,
}

impl ToChecked<'_> {
    /// x = D Qh' xh.
    fn state(&self) -> DMatrix<f64> {
        let multiplier = self.point.design.multiplier.value(&self.point.values);
        DMatrix::from_diagonal(&self.scaling.state) * multiplier.transpose()
    }

    fn decrease(&self, side: usize) -> DMatrix<f64> {
        let specs = &self.model.file.specs;
        let state = self.state();
        let mut blocks = vec![state.clone(); 4];
        if let Some(sector) = &self.point.design.sector {
            let weight = sector.weight.value(&self.point.values);
            blocks.push(DMatrix::from_diagonal(&self.scaling.input) * weight * DEAD_ZONE_UNIT);
        }
        let d = self.task.system.disturbance.ncols();
        blocks.push(DMatrix::identity(d, d) * self.scaling.disturbance);
        let so_far: usize = blocks.iter().map(|block| block.nrows()).sum();
        if side > so_far {
            let growth = specs.hbar_s * (specs.phi_per_s * specs.hbar_s).exp();
            blocks.push(state / growth.sqrt());
        }
        block_diagonal(&blocks)
    }

    fn map(&self, name: &str, side: usize) -> Option<DMatrix<f64>> {
        let bordered = |state: DMatrix<f64>, unit: f64| {
            let rest = side - state.nrows();
            block_diagonal(&[state, DMatrix::identity(rest, rest) * unit])
        };
        // gamma and xi share their unit, the inverse square of the disturbance's.
        let gain_unit = self.scaling.disturbance;
        let index = || {
            name.rsplit(' ')
                .next()
                .and_then(|word| word.parse::<usize>().ok())
        };
        if name.starts_with("decrease") {
            Some(self.decrease(side))
        } else if name.ends_with("positive") {
            Some(self.state())
        } else if name.starts_with("sector weight") {
            // S = M^-1 is the congruence of M by S.
            let input = index()? - 1;
            let sector = self.point.design.sector.as_ref()?;
            let weight = sector.weight.value(&self.point.values)[(input, input)];
            Some(DMatrix::from_element(
                1,
                1,
                self.scaling.input[input] * weight * DEAD_ZONE_UNIT,
            ))
        } else if name.starts_with("anti-windup") {
            Some(bordered(
                self.state() / self.scaling.input[index()? - 1],
                1.0,
            ))
        } else if name == "peak gain" {
            Some(bordered(self.state(), gain_unit))
        } else if name == "gain bound above disturbance weight" {
            Some(DMatrix::from_element(1, 1, gain_unit))
        } else if let Some(bound) = name.strip_prefix("box ") {
            let region = self.model.task().system.region;
            let both = region.iter().zip(&self.task.system.region);
            let (before, after) = both.into_iter().find(|(before, _)| before.name == bound)?;
            let unit = (before.bound_squared / after.bound_squared).sqrt();
            Some(bordered(self.state() / unit, 1.0))
        } else {
            None
        }
    }
}

fn block_diagonal(blocks: &[DMatrix<f64>]) -> DMatrix<f64> {
    let rows = blocks.iter().map(|block| block.nrows()).sum();
    let columns = blocks.iter().map(|block| block.ncols()).sum();
    let mut out = DMatrix::zeros(rows, columns);
    let (mut row, mut column) = (0, 0);
    for block in blocks {
        out.view_mut((row, column), block.shape()).copy_from(block);
        row += block.nrows();
        column += block.ncols();
    }
    out
}

/// Every condition of Theorem 2 at random unknowns is the congruence of the condition of the same
/// name that the check assembles from the recovered design; the number compared.
fn compare_with_the_check(model: &Model, stream: &mut Stream, sector: Sector) -> usize {
    let si = model.task();
    let scaling = uneven_scaling(&si, stream);
    let task = scaling.apply(&si);
    let mut point = Point::random(stream, &task, sector);
    // The check takes the invariant set's level from xi, synthesis from the largest xi.
    let largest = task.specification.disturbance_weight_max;
    point.set("xi", &DMatrix::from_element(1, 1, largest));
    let certificate = recover(
        model,
        &point.design,
        &point.values,
        (&scaling, &model.task()),
    )
    .expect("invertible");
    let checked = checked_matrices(model, &certificate);
    let to_checked = ToChecked {
        model,
        task: &task,
        scaling: &scaling,
        point: &point,
    };
    let mut compared = 0;
    for condition in point.conditions(&task) {
        let name = condition.name();
        let value = condition.expression().value(&point.values);
        let Some(map) = to_checked.map(name, value.nrows()) else {
            assert_eq!(name, "disturbance weight bound", "not compared");
            continue;
        };
        let other = checked
            .get(name)
            .unwrap_or_else(|| panic!("'{name}' is not checked"));
        let kept = without_dead_zone(other, map.nrows(), &task);
        let expected = map.transpose() * kept * &map;
        assert_close(&value, &expected, 1e-11, name);
        compared += 1;
    }
    compared
}

/// The check always has a dead-zone block; synthesis without sector unknowns has none.
fn without_dead_zone(matrix: &DMatrix<f64>, side: usize, task: &Task) -> DMatrix<f64> {
    if matrix.nrows() == side {
        return matrix.clone();
    }
    let (first, count) = (4 * task.system.states(), task.system.inputs());
    matrix
        .clone()
        .remove_rows(first, count)
        .remove_columns(first, count)
}

#[test]
fn the_check_assembles_the_congruence_of_every_synthesis_condition() {
    let mut stream = Stream(18);
    for sector in [Sector::Unknown, Sector::Unsaturated] {
        for _ in 0..10 {
            let sizes = Sizes::any(&mut stream);
            let model = random::model(&mut stream, sizes, false);
            let compared = compare_with_the_check(&model, &mut stream, sector);
            let sector_rows = if sector == Sector::Unknown {
                sizes.inputs
            } else {
                0
            };
            assert_eq!(
                compared,
                3 + sector_rows + 2 * sizes.vertices + sizes.inputs + 3
            );
        }
    }
}

#[test]
fn the_check_of_a_spacecraft_in_descriptor_form_agrees_with_synthesis() {
    let model = Model::from_json(XU2020).expect("a valid model");
    let mut stream = Stream(6);
    let compared = compare_with_the_check(&model, &mut stream, Sector::Unknown);
    assert_eq!(compared, 3 + 3 + 32 + 3 + 2 + 4);
}

fn proved_design(text: &str) -> (Model, Certificate) {
    let model = Model::from_json(text).expect("a valid model");
    let outcome = synthesize(
        &model,
        text,
        &Solvers::both([Solver::Clarabel, Solver::Structured]),
        None,
    );
    let Ok(Outcome::Solved(design)) = outcome else {
        panic!("no design was found");
    };
    assert_eq!(design.report.verdict, Verdict::Proved);
    let certificate = design.file.certificate(&model).expect("a valid design");
    (model, certificate)
}

#[test]
fn the_functional_of_a_proved_spacecraft_decreases_along_the_nonlinear_plant() {
    let (model, certificate) = proved_design(XU2020);
    let synth::model::Plant::Spacecraft(craft) = &model.plant else {
        panic!("xu2020 is a spacecraft");
    };
    let plant = |state: &DVector<f64>, input: &DVector<f64>| {
        let torque = nalgebra::Vector3::from_column_slice(input.as_slice());
        let state = nalgebra::Vector6::from_column_slice(state.as_slice());
        DVector::from_column_slice(craft.right_hand_side(&state, &torque).as_slice())
    };
    check_promises(&model, &certificate, &plant);
}

#[test]
fn the_functional_of_a_proved_vertex_system_decreases_while_the_vertices_vary() {
    let (model, certificate) = proved_design(DOUBLE_INTEGRATOR);
    // The friction depends on the state and sweeps the whole hull.
    let plant = |state: &DVector<f64>, force: &DVector<f64>| {
        let friction = 0.05 * (1.0 + (300.0 * (state[0] + state[1])).sin());
        DVector::from_vec(vec![state[1], force[0] - friction * state[1]])
    };
    check_promises(&model, &certificate, &plant);
}

fn check_promises(model: &Model, certificate: &Certificate, plant: Plant) {
    let closed_loop = EventTriggeredLoop::new(model, certificate, plant);
    let mut stream = Stream(30);
    let n = certificate.lyapunov.nrows();
    let mut tightest = f64::NEG_INFINITY;
    for _ in 0..12 {
        let direction = vector(&mut stream, n, 1.0);
        let start = &direction / quadratic(&certificate.lyapunov, &direction).sqrt();
        let Promise {
            excess,
            triggers,
            samples,
            ..
        } = closed_loop.run(&start, 20.0, &mut stream);
        assert!(excess <= 1e-6, "V' + phi V - xi |tau|^2 reached {excess:e}");
        assert!(
            triggers > 1 && triggers < samples,
            "{triggers} triggers, {samples} samples"
        );
        tightest = tightest.max(excess);
    }
    let rest = closed_loop.run(&DVector::zeros(n), 60.0, &mut stream);
    // The functional comes near its bound, so a wrong term would show.
    assert!(
        tightest.max(rest.excess) > -1.0,
        "the bound is loose: {tightest} {}",
        rest.excess
    );
    let bound = certificate.guaranteed_gain * closed_loop.disturbance_bound;
    assert!(
        rest.largest_output <= bound,
        "{} above {bound}",
        rest.largest_output
    );
    assert!(
        rest.largest_output > 0.2 * bound,
        "{} of {bound}",
        rest.largest_output
    );

    let mut reversed = certificate.clone();
    reversed.gain = -&reversed.gain;
    let direction = DVector::from_element(n, 1.0);
    let start = 0.1 * &direction / quadratic(&certificate.lyapunov, &direction).sqrt();
    let broken = EventTriggeredLoop::new(model, &reversed, plant).run(&start, 5.0, &mut stream);
    assert!(
        broken.excess > 1e-3,
        "a reversed gain must break the promise: {}",
        broken.excess
    );
}
