//! The reduced decrease condition is exactly equivalent to the full one.

mod chordal;

use crate::exact::Stream;
use crate::printed::printed;
use crate::random;
use crate::random::{assert_close, positive_definite, uniform, Point, Sizes};
use crate::units::in_one_unit;
use nalgebra::DMatrix;
use synth::conditions::xu2020::{
    decrease, terms, Basis, SamplingEnd, Sector, Signal, Strictness, DEAD_ZONE_UNIT,
};
use synth::conditions::{FurtherSignal, Task};
use synth::lmi::{Affine, Condition, Unknowns};
use synth::model::Model;
use synth::reduce::cliques::{split, NotChordal, Split};
use synth::reduce::{decrease_conditions, Cliques};
use synth::solve::{Backend, Clarabel, Status};
use synth::synthesis::{assemble, Form, Goal};

const SECTORS: [Sector; 2] = [Sector::Unknown, Sector::Unsaturated];

fn smallest_eigenvalue(matrix: &DMatrix<f64>) -> f64 {
    matrix.clone().symmetric_eigenvalues().min()
}

/// T: the rows of the full condition from the reduced coordinates.
fn transform(task: &Task, point: &Point, interval: SamplingEnd) -> DMatrix<f64> {
    let at = Basis::reduced(task, interval, &point.design);
    let mut blocks = vec![
        at.map(Signal::State),
        at.map(Signal::Rate),
        at.map(Signal::Sample),
        at.map(Signal::Sample) - at.map(Signal::Held),
        at.map(Signal::DeadZone) / DEAD_ZONE_UNIT,
        at.map(Signal::Disturbance),
    ];
    if interval == SamplingEnd::End {
        blocks.push(at.map(Signal::Integral));
    }
    let rows: Vec<_> = blocks
        .iter()
        .flat_map(|block| block.row_iter())
        .map(|row| row.into_owned())
        .collect();
    DMatrix::from_rows(&rows)
}

/// M_i on (x, v), as a matrix on all reduced coordinates.
fn vertex_term(task: &Task, point: &Point, vertex: usize, side: usize) -> DMatrix<f64> {
    let n = task.system.states();
    let a_qt =
        &task.system.vertices[vertex] * point.design.multiplier.value(&point.values).transpose();
    let mut out = DMatrix::zeros(side, side);
    out.view_mut((n, 0), (n, n)).copy_from(&a_qt);
    out.view_mut((0, n), (n, n)).copy_from(&a_qt.transpose());
    out
}

#[test]
fn the_terms_make_the_printed_matrix() {
    let mut stream = Stream(18);
    for case in 0..40 {
        let sizes = Sizes::any(&mut stream);
        let task = random::model(&mut stream, sizes, false).task();
        let point = Point::random(&mut stream, &task, SECTORS[case % 2]);
        let identity = DMatrix::identity(task.system.states(), task.system.states());
        for interval in SamplingEnd::BOTH {
            for vertex in &task.system.vertices {
                let found = decrease(&task, vertex, interval, &point.design);
                let expected = printed(&task, (vertex, &identity), interval, &point.design);
                let (found, expected) = (found.value(&point.values), expected.value(&point.values));
                assert_close(&found, &expected, 1e-14, "printed matrix");
            }
        }
    }
}

#[test]
fn a_further_bounded_signal_counts_like_another_column_of_the_disturbance() {
    use synth::reduce::cliques::{elimination, members};
    use synth::reduce::vertex_slack::ELIMINATED;
    let mut stream = Stream(31);
    for case in 0..20 {
        let sizes = Sizes::any(&mut stream);
        let mut task = random::model(&mut stream, sizes, false).task();
        let mut wide = task.clone();
        let second = uniform(&mut stream, task.system.states(), 1, 1.0);
        let columns = [&task.system.disturbance, &second].map(|of| of.column(0).into_owned());
        wide.system.disturbance = DMatrix::from_columns(&columns);
        task.further_signals.push(FurtherSignal {
            name: "second disturbance",
            coefficient: second,
            bound: 0.1,
        });
        let [mut point, other] = [&task, &wide].map(|task| {
            let mut same = Stream(100 + case as u64);
            Point::random(&mut same, task, SECTORS[case % 2])
        });
        let xi = point.design.disturbance_weight.value(&point.values);
        point.set("xi second disturbance", &xi);
        for interval in SamplingEnd::BOTH {
            for vertex in &task.system.vertices {
                let found = decrease(&task, vertex, interval, &point.design);
                let expected = decrease(&wide, vertex, interval, &other.design);
                let (found, expected) = (found.value(&point.values), expected.value(&other.values));
                assert_close(&found, &expected, 1e-14, "matrix of two disturbances");
            }
            let basis = Basis::reduced(&task, interval, &point.design);
            let all = terms(&task, interval, &point.design);
            let cliques = members(&basis, &elimination(&basis, &all, &ELIMINATED));
            let own = vec![Signal::Further("second disturbance"), Signal::Multiplied];
            assert_eq!(cliques[0], ("second disturbance", own));
        }
    }
}

#[test]
fn the_cliques_read_off_the_terms_are_those_of_the_book() {
    use synth::reduce::cliques::{elimination, members};
    use synth::reduce::vertex_slack::ELIMINATED;
    use Signal::{DeadZone, Disturbance, Held, Integral, Multiplied, Sample, State};
    let mut stream = Stream(9);
    let sizes = Sizes::any(&mut stream);
    let task = random::model(&mut stream, sizes, false).task();
    for sector in SECTORS {
        let point = Point::random(&mut stream, &task, sector);
        for interval in SamplingEnd::BOTH {
            let basis = Basis::reduced(&task, interval, &point.design);
            let all = terms(&task, interval, &point.design);
            let found = members(&basis, &elimination(&basis, &all, &ELIMINATED));
            let mut expected = vec![("disturbance", vec![Disturbance, Multiplied])];
            if sector == Sector::Unknown {
                expected.push(("dead zone", vec![DeadZone, Multiplied, Held]));
            }
            expected.push(("held state", vec![Held, Multiplied, Sample]));
            if interval == SamplingEnd::End {
                expected.push(("integral", vec![Integral, State, Sample]));
            }
            let mut root = vec![State, Multiplied, Sample];
            if sector == Sector::Unsaturated {
                // Without sector unknowns the dead zone has no rows.
                root.push(DeadZone);
            }
            expected.push(("root", root));
            assert_eq!(found, expected);
        }
    }
}

#[test]
fn the_full_matrix_in_the_reduced_coordinates_is_the_common_form_plus_the_vertex_term() {
    let mut stream = Stream(5);
    for case in 0..40 {
        let sizes = Sizes::any(&mut stream);
        let task = random::model(&mut stream, sizes, false).task();
        let point = Point::random(&mut stream, &task, SECTORS[case % 2]);
        for interval in SamplingEnd::BOTH {
            let t = transform(&task, &point, interval);
            assert_eq!(t.nrows(), t.ncols());
            assert!(t.clone().try_inverse().is_some(), "a congruence");
            let at = Basis::reduced(&task, interval, &point.design);
            let form = at
                .form(&terms(&task, interval, &point.design))
                .value(&point.values);
            for vertex in 0..sizes.vertices {
                let a = &task.system.vertices[vertex];
                let full = decrease(&task, a, interval, &point.design).value(&point.values);
                let expected = &form + vertex_term(&task, &point, vertex, t.ncols());
                assert_close(&(t.transpose() * full * &t), &expected, 1e-13, "congruence");
            }
        }
    }
}

/// The blocks x, v, x(t_k^l), x(t_k), dead zone, tau, integral that a named clique is made of.
fn blocks_of(clique: &str) -> &'static [usize] {
    match clique {
        "disturbance" => &[5, 1],
        "dead zone" => &[4, 1, 3],
        "held state" => &[3, 1, 2],
        "integral" => &[6, 0, 2],
        "root" => &[0, 1, 2],
        other => panic!("no clique is called {other}"),
    }
}

fn offsets(sizes: &[usize]) -> Vec<usize> {
    (0..sizes.len())
        .map(|block| sizes[..block].iter().sum())
        .collect()
}

/// The rows that a list of blocks stands for.
fn rows_of(blocks: &[usize], sizes: &[usize]) -> Vec<usize> {
    let offsets = offsets(sizes);
    blocks
        .iter()
        .flat_map(|&b| offsets[b]..offsets[b] + sizes[b])
        .collect()
}

/// A matrix on the given rows, as one on all of them.
fn embedded(part: &DMatrix<f64>, rows: &[usize], side: usize) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(side, side);
    for (r, &row) in rows.iter().enumerate() {
        for (c, &column) in rows.iter().enumerate() {
            out[(row, column)] += part[(r, c)];
        }
    }
    out
}

struct Reduced {
    conditions: Vec<Condition>,
    point: Point,
}

/// The reduced conditions on top of a point; the new unknowns have the value 0.
fn reduced(task: &Task, mut point: Point, margin: f64) -> Reduced {
    let all: Vec<usize> = (0..task.system.vertices.len()).collect();
    let conditions = decrease_conditions(
        task,
        &all,
        &mut point.unknowns,
        &point.design,
        &Strictness::fixed(margin),
        Cliques::Split,
    );
    point.values.resize(point.unknowns.count(), 0.0);
    Reduced { conditions, point }
}

impl Reduced {
    fn value(&self, name: &str) -> DMatrix<f64> {
        let condition = self
            .conditions
            .iter()
            .find(|condition| condition.name() == name);
        condition
            .expect("a condition of this name")
            .expression()
            .value(&self.point.values)
    }

    /// The cliques of one end of the interval with their blocks.
    fn cliques(&self, interval: SamplingEnd) -> Vec<(String, &'static [usize])> {
        let prefix = format!("decrease r={} clique ", interval.index());
        let names = self.conditions.iter().filter_map(|condition| {
            let clique = condition.name().strip_prefix(&prefix)?;
            Some((condition.name().to_string(), blocks_of(clique)))
        });
        names.collect()
    }

    /// Sets a matrix unknown of one end of the interval: its name's first or second occurrence.
    fn set(&mut self, name: &str, interval: SamplingEnd, matrix: &DMatrix<f64>) {
        let names = self.point.unknowns.names();
        let first = format!("{name}[0,0]");
        let starts: Vec<usize> = (0..names.len()).filter(|&k| names[k] == first).collect();
        let start = match starts.len() {
            1 => starts[0],
            _ => starts[interval.index() - 1],
        };
        let mut next = start;
        for column in 0..matrix.ncols() {
            for row in 0..=column {
                assert_eq!(names[next], format!("{name}[{row},{column}]"));
                self.point.values[next] = matrix[(row, column)];
                next += 1;
            }
        }
    }
}

/// -T'(Lambda_i + margin I) T, what must be positive semidefinite at vertex i.
fn full_in_reduced_coordinates(
    task: &Task,
    point: &Point,
    interval: SamplingEnd,
    vertex: usize,
    margin: f64,
) -> DMatrix<f64> {
    let t = transform(task, point, interval);
    let a = &task.system.vertices[vertex];
    let full = decrease(task, a, interval, &point.design).value(&point.values);
    let side = full.nrows();
    -t.transpose() * (full + DMatrix::identity(side, side) * margin) * t
}

#[test]
fn at_any_point_the_cliques_and_a_vertex_block_add_up_to_the_full_condition_of_that_vertex() {
    // So whenever all parts are positive semidefinite, every full condition holds with its margin.
    let mut stream = Stream(12);
    for case in 0..30 {
        let sizes = Sizes::any(&mut stream);
        let task = random::model(&mut stream, sizes, false).task();
        let point = Point::random(&mut stream, &task, SECTORS[case % 2]);
        let margin = 0.25;
        let mut reduced = reduced(&task, point, margin);
        for value in &mut reduced.point.values {
            if *value == 0.0 {
                *value = stream.signed_unit();
            }
        }
        for interval in SamplingEnd::BOTH {
            let sizes_of = Basis::reduced(&task, interval, &reduced.point.design)
                .sizes()
                .to_vec();
            let side = sizes_of.iter().sum();
            let cliques = reduced.cliques(interval);
            assert_eq!(
                cliques.len(),
                3 + usize::from(case % 2 == 0) + interval.index() - 1
            );
            let together =
                cliques
                    .iter()
                    .fold(DMatrix::zeros(side, side), |sum, (name, blocks)| {
                        sum + embedded(&reduced.value(name), &rows_of(blocks, &sizes_of), side)
                    });
            for vertex in 0..sizes.vertices {
                let name = format!("decrease r={} vertex {}", interval.index(), vertex + 1);
                let own = embedded(&reduced.value(&name), &rows_of(&[0, 1], &sizes_of), side);
                let whole =
                    full_in_reduced_coordinates(&task, &reduced.point, interval, vertex, margin);
                assert_close(&(&together + own), &whole, 1e-12, &name);
            }
        }
    }
}

/// The Schur complement of the rows not kept, on the kept rows.
fn complement_on(matrix: &DMatrix<f64>, kept: &[usize]) -> DMatrix<f64> {
    let rest: Vec<usize> = (0..matrix.nrows())
        .filter(|row| !kept.contains(row))
        .collect();
    let corner = matrix.select_rows(&rest).select_columns(&rest);
    let beside = matrix.select_rows(kept).select_columns(&rest);
    let own = matrix.select_rows(kept).select_columns(kept);
    own - &beside * corner.try_inverse().expect("positive definite") * beside.transpose()
}

/// Part of the room left after each step that the next part gets.
const SHARE: f64 = 0.25;

/// Gives the slack and the separators the values that the proof of exactness constructs: Schur
/// complements, moved inside by a part of the room there is.
fn complete(reduced: &mut Reduced, task: &Task, margin: f64) {
    let n = task.system.states();
    for interval in SamplingEnd::BOTH {
        let sizes = Basis::reduced(task, interval, &reduced.point.design)
            .sizes()
            .to_vec();
        let side: usize = sizes.iter().sum();
        let full =
            |vertex| full_in_reduced_coordinates(task, &reduced.point, interval, vertex, margin);
        let common = full(0) + vertex_term(task, &reduced.point, 0, side);
        let corner: Vec<usize> = (0..2 * n).collect();
        let rooms = (0..task.system.vertices.len())
            .map(|vertex| smallest_eigenvalue(&complement_on(&full(vertex), &corner)));
        let room = SHARE * rooms.fold(f64::INFINITY, f64::min);
        let slack = complement_on(&common, &corner) - DMatrix::identity(2 * n, 2 * n) * room;
        let mut rest = common - embedded(&slack, &corner, side);
        reduced.set(&format!("Z{}", interval.index()), interval, &slack);
        let cliques = reduced.cliques(interval);
        let mut remaining: Vec<usize> = (0..side).collect();
        for (name, blocks) in &cliques[..cliques.len() - 1] {
            let clique = name.rsplit_once("clique ").expect("the name of a clique").1;
            let before = rest.select_rows(&remaining).select_columns(&remaining);
            let residual = rows_of(&blocks[..1], &sizes);
            let kept: Vec<usize> = (0..remaining.len())
                .filter(|&place| !residual.contains(&remaining[place]))
                .collect();
            let room = SHARE * smallest_eigenvalue(&complement_on(&before, &kept));
            remaining.retain(|row| !residual.contains(row));
            let separator = rows_of(&blocks[1..], &sizes);
            let shared = handed_over(&rest, &residual, &separator, room);
            rest -= embedded(&shared, &separator, side);
            reduced.set(&format!("separator {clique}"), interval, &shared);
        }
    }
}

/// B A^-1 B' + room I for the residual's own block A and its block B beside the separator.
fn handed_over(
    whole: &DMatrix<f64>,
    residual: &[usize],
    separator: &[usize],
    room: f64,
) -> DMatrix<f64> {
    let corner = whole.select_rows(residual).select_columns(residual);
    let beside = whole.select_rows(separator).select_columns(residual);
    let inverse = corner.try_inverse().expect("positive definite");
    let shared = &beside * inverse * beside.transpose();
    let side = separator.len();
    0.5 * (&shared + shared.transpose()) + DMatrix::identity(side, side) * room
}

fn solve(task: &Task, form: Form, goal: Goal) -> (Point, synth::solve::Solution) {
    let assembled = assemble(task, form, goal);
    let lowered = assembled.problem.lower();
    let solution = Clarabel::default()
        .solve(&lowered, goal.accuracy(task), None)
        .expect("a problem with finite numbers");
    let point = Point {
        unknowns: assembled.problem.unknowns,
        design: assembled.design,
        values: solution.values.clone(),
    };
    (point, solution)
}

fn double_integrator() -> Model {
    let text = include_str!("../../../models/double-integrator.json");
    Model::from_json(text).expect("a valid model")
}

/// The shipped example and random stable vertex systems.
fn solvable_models(stream: &mut Stream, count: usize) -> Vec<Model> {
    let mut out = vec![double_integrator()];
    out.extend((0..count).map(|_| {
        let sizes = Sizes::any(stream);
        random::model(stream, sizes, true)
    }));
    out
}

#[test]
fn every_point_of_the_full_condition_extends_to_one_of_the_reduced_condition() {
    let mut stream = Stream(1988);
    for model in solvable_models(&mut stream, 3) {
        let task = in_one_unit(&model);
        let (_, smallest) = solve(&task, Form::Full, Goal::SmallestGain);
        let gain_bound = 1.05 * smallest.objective;
        let (point, _) = solve(&task, Form::Full, Goal::LargestMargin { gain_bound });
        let margin = 1e-6;
        let vertices = 0..task.system.vertices.len();
        let given = SamplingEnd::BOTH.map(|interval| {
            let matrices = vertices
                .clone()
                .map(|vertex| full_in_reduced_coordinates(&task, &point, interval, vertex, margin));
            matrices
                .map(|matrix| smallest_eigenvalue(&matrix))
                .fold(f64::INFINITY, f64::min)
        });
        assert!(
            given.iter().all(|&room| room > 0.0),
            "strictly feasible: {given:?}"
        );
        let mut reduced = reduced(&task, point, margin);
        complete(&mut reduced, &task, margin);
        for condition in &reduced.conditions {
            let value = condition.expression().value(&reduced.point.values);
            let smallest = smallest_eigenvalue(&value);
            assert!(smallest > 0.0, "{}: {smallest:e}", condition.name());
        }
    }
}

#[test]
fn both_forms_have_the_same_smallest_gain_bound() {
    let mut stream = Stream(77);
    let mut compared = 0;
    for model in solvable_models(&mut stream, 7) {
        let task = in_one_unit(&model);
        let results =
            [Form::Chordal, Form::Full].map(|form| solve(&task, form, Goal::SmallestGain).1);
        let [small, full] = &results;
        let converged =
            [small, full].map(|found| matches!(found.status, Status::Solved | Status::Inaccurate));
        assert_eq!(
            converged[0], converged[1],
            "the forms differ in feasibility"
        );
        let accurate = [small, full].map(|found| found.status == Status::Solved);
        let distance = (small.objective / full.objective - 1.0).abs();
        if accurate == [true, true] {
            assert!(
                distance <= 1e-5,
                "{} against {}",
                small.objective,
                full.objective
            );
            compared += 1;
        } else if converged[0] {
            // The solver itself promises no more on these.
            assert!(
                distance <= 1e-3,
                "{} against {}",
                small.objective,
                full.objective
            );
        }
    }
    assert!(compared >= 6, "{compared} models were solved in both forms");
}
