//! Dual multipliers that prove infeasibility: their sum is that of the published conditions, exact arithmetic
//! confirms what is proved, and a changed number is accepted only where that is still true.

use crate::random;
use std::collections::HashMap;

use crate::exact::{is_positive_definite, rational, Exact, Stream};
use crate::numbers::numbers;
use crate::random::{Point, Sizes};
use nalgebra::DMatrix;
use serde_json::Value;
use synth::certify::infeasible::stationarity::{for_each_statement, Stationarity};
use synth::certify::infeasible::{
    refute, DeadZoneMoments, DualMultipliers, GainDuals, HeldMoments, InputDual, Level, Moments,
    RegionDual, VertexDual,
};
use synth::certify::interval::Interval;
use synth::certify::matrix::Matrix;
use synth::conditions::xu2020::{self, decrease, gain_suffix, vertex_term, Sector, DEAD_ZONE_UNIT};
use synth::conditions::{GainPlan, Task};
use synth::feasibility::{decide, Answer, Decision, InfeasibilityFile};
use synth::model::Model;
use synth::synthesis::{analyse, Outcome, Solvers};

fn symmetric(stream: &mut Stream, side: usize) -> DMatrix<f64> {
    let matrix = random::uniform(stream, side, side, 1.0);
    &matrix + matrix.transpose()
}

/// Random numbers in every place, definite or not. `given`: so many given gains, the weights being about
/// every other of them.
fn any_weights(
    stream: &mut Stream,
    model: &Model,
    determined: bool,
    given: usize,
) -> DualMultipliers {
    let system = model.plant.takagi_sugeno();
    let (n, m, d) = (system.states(), system.inputs(), system.disturbance.ncols());
    let moments = |stream: &mut Stream, determined: bool| Moments {
        vertices: (0..system.vertices.len())
            .map(|vertex| VertexDual {
                vertex: vertex + 1,
                moments: symmetric(stream, 2 * n),
            })
            .collect(),
        state_sample: random::uniform(stream, n, n, 1.0),
        multiplied_sample: (!determined).then(|| random::uniform(stream, n, n, 1.0)),
        sample: symmetric(stream, n),
        multiplied_disturbance: random::uniform(stream, n, d, 1.0),
        disturbance: symmetric(stream, d),
        held: Some(HeldMoments {
            multiplied_held: random::uniform(stream, n, n, 1.0),
            sample_held: random::uniform(stream, n, n, 1.0),
            held: symmetric(stream, n),
        }),
        dead_zone: (given > 0).then(|| DeadZoneMoments {
            multiplied: random::uniform(stream, n, m, 1.0),
            held: random::uniform(stream, n, m, 1.0),
            own: symmetric(stream, m),
        }),
    };
    let gain = |stream: &mut Stream, gain: usize| GainDuals {
        gain: gain + 1,
        start: moments(stream, false),
        end: moments(stream, determined && gain == 0),
        integral: symmetric(stream, n),
        state_integral: (gain > 0).then(|| random::uniform(stream, n, n, 1.0)),
        sample_integral: (gain > 0).then(|| random::uniform(stream, n, n, 1.0)),
        inputs: (0..m)
            .map(|_| InputDual {
                state: symmetric(stream, n),
                unit: stream.signed_unit(),
            })
            .collect(),
    };
    DualMultipliers {
        given: (0..given)
            .map(|_| random::uniform(stream, m, n, 1.0))
            .collect(),
        containment_weight: 0.7,
        gains: (0..given.max(1))
            .step_by(2)
            .map(|index| gain(stream, index))
            .collect(),
        region: system
            .region
            .iter()
            .map(|bound| RegionDual {
                state: symmetric(stream, n),
                cross: random::uniform(stream, n, bound.rows.nrows(), 1.0),
                unit: symmetric(stream, bound.rows.nrows()),
            })
            .collect(),
        must_contain: (0..model.file.specs.must_contain.len())
            .map(|_| symmetric(stream, n))
            .collect(),
    }
}

fn midpoints(matrix: &Matrix<Interval>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
        matrix.at(r, c).midpoint()
    })
}

fn collected(
    model: &Model,
    weights: &DualMultipliers,
) -> (HashMap<String, DMatrix<f64>>, Stationarity<Interval>) {
    let mut out = HashMap::new();
    let balance =
        for_each_statement::<Interval>(model, weights, Level::AtLargestWeight, |statement| {
            let old = out.insert(statement.name, midpoints(&statement.matrix));
            assert!(old.is_none(), "a name stands for two matrices");
        });
    (out, balance)
}

/// The moments of (18) in the published rows x, x', x(t_k^l), e, the dead zone's (for given gains), tau and
/// the integral's, from the cliques; what no clique holds is filled with random numbers.
fn published_moments(
    stream: &mut Stream,
    task: &Task,
    weights: &HashMap<String, DMatrix<f64>>,
    r: usize,
    suffix: &str,
) -> DMatrix<f64> {
    let (n, d) = (task.system.states(), task.system.disturbance.ncols());
    let m = task
        .gains
        .given
        .as_ref()
        .map_or(0, |gains| gains[0].nrows());
    let (x, v, k, w, p, t) = (0, n, 2 * n, 3 * n, 4 * n, 4 * n + m);
    let s = t + d;
    let side = if r == 2 { s + n } else { s };
    let mut reduced = symmetric(stream, side);
    let mut place = |name: &str, blocks: &[(usize, usize)]| {
        let clique = &weights[&format!("decrease r={r}{suffix} {name}")];
        let mut row = 0;
        for &(to_row, rows) in blocks {
            let mut column = 0;
            for &(to_column, columns) in blocks {
                let part = clique.view((row, column), (rows, columns));
                reduced
                    .view_mut((to_row, to_column), (rows, columns))
                    .copy_from(&part);
                column += columns;
            }
            row += rows;
        }
    };
    place("root", &[(x, n), (v, n), (k, n)]);
    place("disturbance", &[(v, n), (t, d)]);
    place("held state", &[(v, n), (k, n), (w, n)]);
    if m > 0 {
        place("dead zone", &[(p, m), (v, n), (w, n)]);
    }
    if r == 2 {
        place("integral", &[(x, n), (k, n), (s, n)]);
    }
    let specification = &task.specification;
    let [e1, e2, e3] = specification.multiplier_weights;
    let hbar = specification.sampling_interval_max;
    let root = (hbar * (specification.decay_rate * hbar).exp()).sqrt();
    let mut map = DMatrix::zeros(side, side);
    let mut block = |row: usize, column: usize, side: usize, value: f64| {
        for i in 0..side {
            map[(row + i, column + i)] = value;
        }
    };
    block(0, x, n, 1.0);
    block(n, v, n, 1.0 / e2);
    block(n, x, n, -e1 / e2);
    block(n, k, n, -e3 / e2);
    block(2 * n, k, n, 1.0);
    block(3 * n, k, n, 1.0);
    block(3 * n, w, n, -1.0);
    block(p, p, m, 1.0 / DEAD_ZONE_UNIT);
    block(t, t, d, 1.0);
    if r == 2 {
        // The proof's coordinate times the root is the published one.
        block(s, s, n, root);
    }
    &map * reduced * map.transpose()
}

fn inner(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    a.component_mul(b).sum()
}

/// `sum_k <G_k(y), Z_k>` from the published conditions.
fn published_sum(
    stream: &mut Stream,
    mut task: Task,
    point: &Point,
    weights: &DualMultipliers,
    matrices: &HashMap<String, DMatrix<f64>>,
) -> f64 {
    task.specification.containment_weight = weights.containment_weight;
    let n = task.system.states();
    let values = &point.values;
    let none = xu2020::Strictness::fixed(0.0);
    let mut sum = 0.0;
    let ends = || {
        let parts = weights.gains.iter();
        parts.flat_map(|part| [(part, 1, &part.start), (part, 2, &part.end)])
    };
    for condition in xu2020::conditions_without_gain(&task, &point.design, &none) {
        let matrix = condition.expression().value(values);
        let name = condition.name();
        if name == "disturbance weight bound" {
            let traces = ends().map(|(_, _, moments)| moments.disturbance.trace());
            sum += matrix[(0, 0)] * traces.sum::<f64>();
        } else if name.starts_with("sector weight") {
            sum += inner(&matrix, &matrices[name]) / DEAD_ZONE_UNIT.powi(2);
        } else if let Some(weight) = matrices.get(name) {
            sum += inner(&matrix, weight);
        } else {
            assert!(name.contains(" gain 2"), "no weight for {name}");
        }
    }
    let multiplier = point.design.multiplier.value(values);
    for (part, r, moments) in ends() {
        let interval = xu2020::SamplingEnd::BOTH[r - 1];
        let suffix = gain_suffix(task.gains.count, part.gain - 1);
        let zero = DMatrix::zeros(n, n);
        let design = point.design.with_rule(part.gain - 1);
        let lhs = decrease(&task, &zero, interval, &design).value(values);
        let published = published_moments(stream, &task, matrices, r, &suffix);
        sum -= inner(&lhs, &published);
        for weight in &moments.vertices {
            // The vertex term on the rows x, x', x(t_k^l), with (x, v) = (x, eps2 x') there.
            let mut only_rate = task.clone();
            only_rate.specification.multiplier_weights = [0.0, 1.0, 0.0];
            let term = vertex_term(
                &only_rate,
                &task.system.vertices[weight.vertex - 1],
                &multiplier,
            );
            let term = term.view((0, 0), (2 * n, 2 * n)).into_owned();
            sum -= inner(&term, &weight.moments);
        }
    }
    sum
}

#[test]
fn the_sum_of_the_weighted_conditions_is_the_balance_whatever_the_unknowns() {
    let mut stream = Stream(41);
    for round in 0..80 {
        let sizes = Sizes::any(&mut stream);
        let mut model = random::model(&mut stream, sizes, false);
        if round % 3 == 0 {
            let state = random::vector(&mut stream, sizes.states, 1.0);
            let mut file = model.file.clone();
            file.specs.must_contain = vec![state.iter().copied().collect()];
            model = Model::new(file).expect("a valid model");
        }
        let determined = round % 2 == 0;
        // None given, one, two (one of them without weight) or three.
        let given = (round / 6) % 4;
        let weights = any_weights(&mut stream, &model, determined, given);
        let mut task = model.task();
        let mut sector = Sector::Unsaturated;
        if given > 0 {
            sector = Sector::Unknown;
            task.gains = GainPlan {
                count: given,
                mismatch: None,
                given: Some(weights.given.clone()),
            };
        }
        let (matrices, balance) = collected(&model, &weights);
        assert_eq!(balance.residual.is_none(), determined);
        for _ in 0..3 {
            let point = Point::random(&mut stream, &task, sector);
            let expected = published_sum(&mut stream, task.clone(), &point, &weights, &matrices);
            let multiplier = point.design.multiplier.value(&point.values);
            let rest = balance.residual.as_ref().map_or(0.0, |residual| {
                2.0 * inner(&midpoints(residual), &multiplier)
            });
            let found = balance.constant.midpoint() + rest;
            let sizes = matrices.values().map(|matrix| matrix.abs().sum());
            let scale: f64 = sizes.sum::<f64>() * 100.0;
            let error = (found - expected).abs() / scale;
            assert!(error < 1e-13, "{found} {expected} in round {round}");
        }
    }
}

fn certificate(text: &str) -> InfeasibilityFile {
    let model = Model::from_json(text).expect("a valid model");
    let decision = decide(&model, text, &Solvers::suited_to(&model), None).expect("a decision");
    match decision.answer {
        Answer::Infeasible(proof) => proof.file,
        other => panic!("not infeasible: {other:?}"),
    }
}

fn with(text: &str, pointer: &str, value: Value) -> String {
    let mut model: Value = serde_json::from_str(text).expect("JSON");
    *model.pointer_mut(pointer).expect("a field") = value;
    model.to_string()
}

/// A file that says that a gain has no proof.
fn refuted_gain(text: &str, gains: &[DMatrix<f64>]) -> InfeasibilityFile {
    let model = Model::from_json(text).expect("a valid model");
    let solvers = Solvers::suited_to(&model);
    let outcome = analyse(&model, text, gains, "", &solvers, None);
    match outcome.expect("an outcome") {
        Outcome::Infeasible(Decision {
            answer: Answer::Infeasible(proof),
            ..
        }) => proof.file,
        other => panic!("not infeasible: {other:?}"),
    }
}

/// An unstable gain on the cart.
fn unstable_cart() -> InfeasibilityFile {
    let text = include_str!("../../../models/double-integrator.json");
    refuted_gain(text, &[DMatrix::from_row_slice(1, 2, &[1.0, 1.0])])
}

fn weak_cart() -> InfeasibilityFile {
    let text = include_str!("../../../models/double-integrator.json");
    certificate(&with(text, "/plant/vertices/input_limit/0", 0.01.into()))
}

/// Whether the weights prove infeasibility, in exact arithmetic.
fn exactly_true(model: &Model, weights: &DualMultipliers) -> bool {
    let level = refute(model, weights).level;
    let mut definite = true;
    let balance = for_each_statement::<Exact>(model, weights, level, |statement| {
        let matrix = &statement.matrix;
        let row = |r: usize| -> Vec<Exact> {
            (0..matrix.ncols())
                .map(|c| matrix.at(r, c).clone())
                .collect()
        };
        let rows: Vec<Vec<Exact>> = (0..matrix.nrows()).map(row).collect();
        definite = definite && is_positive_definite(&rows);
    });
    definite && balance.constant.0 < rational(0.0)
}

#[test]
fn exact_arithmetic_confirms_the_proofs() {
    let text = include_str!("../../../models/xu2020.json");
    let mut weak: Value = serde_json::from_str(text).expect("JSON");
    weak["plant"]["exact"]["torque_limit_nm"] = serde_json::json!([0.7, 0.7, 0.7]);
    // In the paper's form of the gyroscopic torque; in another one there is a design.
    weak["plant"]["exact"]["gyroscopic_form_kg_m2"] = serde_json::json!(vec![[0.0; 3]; 3]);
    let weak = weak.to_string();
    for file in [weak_cart(), unstable_cart(), certificate(&weak)] {
        let (file, model) = InfeasibilityFile::from_json(&file.to_json()).expect("a valid file");
        for weights in file.weights(&model).expect("weights") {
            assert!(refute(&model, &weights).proved);
            assert!(exactly_true(&model, &weights));
        }
    }
}

/// The path of the entry across the diagonal of a square matrix.
fn mirrored(path: &str) -> Option<String> {
    let mut parts: Vec<&str> = path.split('/').collect();
    let last = parts.len() - 1;
    let index = |part: &str| part.parse::<usize>().is_ok();
    if !(index(parts[last]) && index(parts[last - 1])) || parts[last] == parts[last - 1] {
        return None;
    }
    parts.swap(last, last - 1);
    Some(parts.join("/"))
}

#[test]
fn a_changed_number_is_accepted_only_where_the_certificate_is_still_true() {
    change_every_number(&weak_cart());
}

#[test]
fn a_changed_number_of_a_given_gains_certificate_is_accepted_only_where_it_is_still_true() {
    change_every_number(&unstable_cart());
}

#[test]
fn weights_of_one_gain_prove_nothing_about_a_stabilising_one() {
    let mut file = unstable_cart();
    file.gains = vec![vec![vec![-1.0, -2.0]]];
    let (file, model) = InfeasibilityFile::from_json(&file.to_json()).expect("a valid file");
    let outcome = &file.verify(&model).expect("weights")[0];
    assert!(!outcome.proved && outcome.bound == 0.0);
}

#[test]
fn weights_that_do_not_belong_to_the_statement_prove_nothing() {
    let file = unstable_cart();
    let model = Model::new(file.model.clone()).expect("a valid model");
    let weights = file.weights(&model).expect("weights").remove(0);
    assert!(refute(&model, &weights).proved);
    let mut unknown_gain = weights.clone();
    unknown_gain.gains[0].gain = 2;
    let mut free_gain = weights.clone();
    free_gain.given.clear();
    let mut nothing = weights.clone();
    nothing.gains.clear();
    let mut no_dead_zone = weights.clone();
    no_dead_zone.gains[0].start.dead_zone = None;
    for wrong in [unknown_gain, free_gain, nothing, no_dead_zone] {
        assert!(!refute(&model, &wrong).proved);
    }
}

fn change_every_number(file: &InfeasibilityFile) {
    let original: Value = serde_json::from_str(&file.to_json()).expect("JSON");
    let mut paths = Vec::new();
    for part in ["model", "gains", "infeasibility"] {
        numbers(&original[part], &format!("/{part}"), &mut paths);
    }
    assert!(paths.len() > 150, "{}", paths.len());
    let changes: [fn(f64) -> f64; 5] = [
        |v| -v,
        |_| 0.0,
        |v| 1.5 * v,
        |v| v * (1.0 + 1e-3),
        |v| v + 1.0,
    ];
    let (mut accepted, mut refused, mut invalid) = (0, 0, 0);
    for path in &paths {
        let before = original
            .pointer(path)
            .and_then(Value::as_f64)
            .expect("a number");
        for change in changes {
            let mut changed = original.clone();
            for path in [Some(path.clone()), mirrored(path)].into_iter().flatten() {
                if let Some(place) = changed.pointer_mut(&path) {
                    if place.as_f64() == Some(before) {
                        *place = Value::from(change(before));
                    }
                }
            }
            let Ok((file, model)) = InfeasibilityFile::from_json(&changed.to_string()) else {
                invalid += 1;
                continue;
            };
            for weights in file.weights(&model).expect("weights") {
                if refute(&model, &weights).proved {
                    accepted += 1;
                    assert!(
                        exactly_true(&model, &weights),
                        "{path} = {}",
                        change(before)
                    );
                } else {
                    refused += 1;
                }
            }
        }
    }
    eprintln!("{accepted} accepted and true, {refused} refused, {invalid} invalid");
    assert!(accepted > 0 && refused > accepted / 10 && invalid > 0);
}
