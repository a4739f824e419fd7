//! An answer does not depend on the units in which a problem is stated.

use super::*;
use crate::exact::Stream;

/// Units over six decades.
fn units(stream: &mut Stream, count: usize) -> Vec<f64> {
    (0..count)
        .map(|_| 10_f64.powf(3.0 * stream.signed_unit()))
        .collect()
}

fn matrix(stream: &mut Stream, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| stream.signed_unit())
}

fn rows(matrix: &DMatrix<f64>) -> Value {
    let rows = matrix.row_iter();
    json!(rows
        .map(|row| row.iter().copied().collect())
        .collect::<Vec<Vec<f64>>>())
}

/// `M` with its rows divided by the first units and its columns multiplied by the second.
fn changed(matrix: &DMatrix<f64>, rows: &[f64], columns: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
        matrix[(r, c)] / rows[r] * columns[c]
    })
}

/// A plant with the given number of vertices around a random one.
struct Plant {
    vertices: Vec<DMatrix<f64>>,
    input: DMatrix<f64>,
}

impl Plant {
    fn random(stream: &mut Stream, states: usize, inputs: usize, vertices: usize) -> Self {
        let mean = matrix(stream, states, states);
        Plant {
            vertices: (0..vertices)
                .map(|_| &mean + 0.1 * matrix(stream, states, states))
                .collect(),
            input: matrix(stream, states, inputs),
        }
    }

    fn restated(&self, states: &[f64], inputs: &[f64]) -> Value {
        let vertices = self.vertices.iter();
        let vertices: Vec<Value> = vertices
            .map(|a| rows(&changed(a, states, states)))
            .collect();
        json!({
            "state_matrices": vertices,
            "input_matrix": rows(&changed(&self.input, states, inputs)),
        })
    }
}

#[track_caller]
fn assert_equal(found: f64, known: f64) {
    assert_between(found / known, 0.999, 1.001);
}

/// Regions whose optimum is approached only as P becomes singular are found to this accuracy.
#[track_caller]
fn assert_nearly_equal(found: f64, known: f64) {
    assert_between(found / known, 0.997, 1.003);
}

fn guarantee(file: &Value) -> f64 {
    proved(file).1.guarantee
}

#[test]
fn the_smallest_gain_is_the_same_in_all_units_of_states_and_inputs() {
    let mut stream = Stream(81);
    for round in 0..12 {
        let (n, m) = (2 + round % 3, 1 + round % 2);
        let plant = Plant::random(&mut stream, n, m, 1 + round % 2);
        let (driven, output) = (matrix(&mut stream, n, 2), matrix(&mut stream, 2, n));
        let direct = matrix(&mut stream, 2, m) + DMatrix::identity(2, m);
        let file = |x: &[f64], u: &[f64], w: f64, z: f64| {
            let gain = json!({ "h_infinity": {
                "disturbance_matrix": rows(&changed(&driven, x, &[w, w])),
                "output_matrix": rows(&changed(&output, &[z, z], x)),
                "input_to_output_matrix": rows(&changed(&direct, &[z, z], u)),
            } });
            asked(plant.restated(x, u), gain)
        };
        let known = guarantee(&file(&vec![1.0; n], &vec![1.0; m], 1.0, 1.0));
        let (x, u) = (units(&mut stream, n), units(&mut stream, m));
        let [w, z] = [0, 1].map(|_| units(&mut stream, 1)[0]);
        assert_equal(guarantee(&file(&x, &u, w, z)) * z / w, known);
    }
}

#[test]
fn a_smallest_gain_of_0_stops_at_the_same_gain_in_all_units() {
    // Position of a mass with friction k: with a force w beside the input the infimum is 0.
    let mut stream = Stream(82);
    for friction in [0.0, 0.5, 3.0] {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, -friction]);
        let b = DMatrix::from_row_slice(2, 1, &[0.0, 1.0]);
        let output = DMatrix::from_row_slice(1, 2, &[1.0, 0.0]);
        let plant = Plant {
            vertices: vec![a],
            input: b.clone(),
        };
        let file = |x: &[f64], u: &[f64]| {
            let gain = json!({ "h_infinity": {
                "disturbance_matrix": rows(&changed(&b, x, &[1.0])),
                "output_matrix": rows(&changed(&output, &[1.0], x)),
            } });
            asked(plant.restated(x, u), gain)
        };
        let known = guarantee(&file(&[1.0; 2], &[1.0]));
        let (x, u) = (units(&mut stream, 2), units(&mut stream, 1));
        assert_equal(guarantee(&file(&x, &u)), known);
    }
}

#[test]
fn an_overshoot_is_the_same_in_all_units_of_the_inputs_and_is_found_in_all_units_of_the_states() {
    let mut stream = Stream(83);
    for round in 0..12 {
        let (n, m) = (2 + round % 3, 1 + round % 2);
        let plant = Plant::random(&mut stream, n, m, 1 + round % 2);
        let file = |x: &[f64], u: &[f64]| {
            asked(
                plant.restated(x, u),
                json!({ "quadratic_stabilisation": {} }),
            )
        };
        let ones = vec![1.0; n];
        let known = guarantee(&file(&ones, &vec![1.0; m]));
        let (x, u) = (units(&mut stream, n), units(&mut stream, m));
        assert_equal(guarantee(&file(&ones, &u)), known);
        proved(&file(&x, &u));
    }
}

#[test]
fn a_region_is_the_same_in_all_units() {
    let mut stream = Stream(84);
    for round in 0..9 {
        let (n, m) = (2 + round % 2, 1 + round % 2);
        let plant = Plant::random(&mut stream, n, m, 1);
        let file = |x: &[f64], u: &[f64]| {
            let weight = DMatrix::from_fn(n, n, |r, c| if r == c { x[r] * x[c] } else { 0.0 });
            let limits: Vec<f64> = u.iter().map(|unit| 1.0 / unit).collect();
            let region = json!({ "saturated_region": {
                "input_limit": limits,
                "decay_rate_per_s": 0.05,
                "reference": { "ellipsoid": rows(&weight) },
            } });
            asked(plant.restated(x, u), region)
        };
        let known = guarantee(&file(&vec![1.0; n], &vec![1.0; m]));
        let (x, u) = (units(&mut stream, n), units(&mut stream, m));
        assert_nearly_equal(guarantee(&file(&x, &u)), known);
    }
}
