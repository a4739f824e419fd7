//! Reproducible random matrices, models and points for the tests of the conditions.
//!
//! Included with `#[path]` by several test programs, none of which uses all of it.
#![allow(dead_code)]

use nalgebra::{DMatrix, DVector};
use synth::conditions::xu2020::{
    full_condition, side_conditions, DesignUnknowns, SamplingEnd, Sector, Strictness,
    DEAD_ZONE_UNIT,
};
use synth::conditions::Task;
use synth::lmi::{Condition, Unknowns};
use synth::model::{
    GainForm, LinearBound, Mismatch, Model, ModelFile, Objective, PlantFile, Specs, VerticesPlant,
    MODEL_SCHEMA_VERSION,
};

use crate::exact::Stream;

/// Numbers of a random model.
#[derive(Debug, Clone, Copy)]
pub struct Sizes {
    pub states: usize,
    pub inputs: usize,
    pub vertices: usize,
}

impl Sizes {
    /// 2 to 4 states, 1 or 2 inputs, 2 to 5 vertices.
    pub fn any(stream: &mut Stream) -> Self {
        Sizes {
            states: stream.integer(2, 4) as usize,
            inputs: stream.integer(1, 2) as usize,
            vertices: stream.integer(2, 5) as usize,
        }
    }
}

/// Entries uniform in `[-size, size)`.
pub fn uniform(stream: &mut Stream, rows: usize, columns: usize, size: f64) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| size * stream.signed_unit())
}

/// Entries uniform in `[-size, size)`.
pub fn vector(stream: &mut Stream, length: usize, size: f64) -> DVector<f64> {
    DVector::from_fn(length, |_, _| size * stream.signed_unit())
}

/// Symmetric, smallest eigenvalue at least 0.3.
pub fn positive_definite(stream: &mut Stream, side: usize) -> DMatrix<f64> {
    let root = uniform(stream, side, side, 1.0);
    &root * root.transpose() + DMatrix::identity(side, side) * 0.3
}

/// Well conditioned, not symmetric.
pub fn invertible(stream: &mut Stream, side: usize) -> DMatrix<f64> {
    uniform(stream, side, side, 0.4) + DMatrix::identity(side, side)
}

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let row = |r: usize| matrix.row(r).iter().copied().collect();
    (0..matrix.nrows()).map(row).collect()
}

/// A model with random vertex systems. With `stable`, the symmetric part of every state matrix is
/// negative definite.
pub fn model(stream: &mut Stream, sizes: Sizes, stable: bool) -> Model {
    let Sizes {
        states,
        inputs,
        vertices,
    } = sizes;
    let shift = if stable { 1.2 } else { 0.0 };
    let state_matrices = (0..vertices).map(|_| {
        let random = uniform(stream, states, states, 0.6);
        let skewed = if stable {
            &random - random.transpose() + 0.3 * &random
        } else {
            random
        };
        rows(&(skewed - DMatrix::identity(states, states) * shift))
    });
    let state_matrices = state_matrices.collect();
    let plant = VerticesPlant {
        state_matrices,
        input_matrix: rows(&uniform(stream, states, inputs, 1.0)),
        disturbance_matrix: Some(rows(&uniform(stream, states, 1, 1.0))),
        output_matrix: Some(rows(&uniform(stream, states - 1, states, 1.0))),
        input_limit: (0..inputs).map(|_| 2.0 + stream.signed_unit()).collect(),
        disturbance_bound: 0.1,
        region: vec![LinearBound {
            row: uniform(stream, 1, states, 1.0).iter().copied().collect(),
            bound: 2.0,
        }],
    };
    let file = ModelFile {
        schema_version: MODEL_SCHEMA_VERSION,
        name: "random".to_string(),
        source: String::new(),
        plant: PlantFile::Vertices(plant),
        imperfections: Default::default(),
        specs: Specs {
            trigger_floor: None,
            phi_per_s: 0.2,
            hbar_s: 0.05,
            hmin_s: None,
            nu: 0.1,
            nu_min: None,
            threshold_update: None,
            eps: [1.0, 0.8, 0.6],
            xi_max: 20.0,
            objective: Objective::Gamma,
            gamma: None,
            gamma_max: None,
            must_contain: Vec::new(),
            outer: None,
            search: None,
            command_trigger: None,
            margin: 1e-6,
        },
        gains: GainForm::Constant,
        mismatch: Mismatch::None,
    };
    Model::new(file).expect("a valid model")
}

/// The unknowns of Theorem 2 with a value for each.
pub struct Point {
    pub unknowns: Unknowns,
    pub design: DesignUnknowns,
    pub values: Vec<f64>,
}

impl Point {
    /// Symmetric matrices positive definite, multiplier invertible, gamma above xi; otherwise random.
    pub fn random(stream: &mut Stream, task: &Task, sector: Sector) -> Self {
        let (n, m) = (task.system.states(), task.system.inputs());
        let mut unknowns = Unknowns::new();
        let design = DesignUnknowns::new(&mut unknowns, task, sector);
        let mut point = Point {
            values: vec![0.0; unknowns.count()],
            unknowns,
            design,
        };
        for name in ["Uh", "Yh", "Wh"] {
            point.set(name, &positive_definite(stream, n));
        }
        point.set("Qh", &invertible(stream, n));
        point.set("L1h", &uniform(stream, n, n, 1.0));
        point.set("L2h", &uniform(stream, n, n, 1.0));
        if task.gains.given.is_none() {
            point.set("Fh", &uniform(stream, m, n, 1.0));
        }
        if sector == Sector::Unknown {
            let weight = vector(stream, m, 0.4).add_scalar(1.0);
            point.set("Nh", &(DEAD_ZONE_UNIT * uniform(stream, m, n, 1.0)));
            for rule in 2..=task.gains.count {
                let anti_windup = DEAD_ZONE_UNIT * uniform(stream, m, n, 1.0);
                point.set(&format!("Nh{rule}"), &anti_windup);
            }
            point.set(
                "S",
                &(DEAD_ZONE_UNIT.powi(2) * DMatrix::from_diagonal(&weight)),
            );
        }
        point.set(
            "xi",
            &DMatrix::from_element(1, 1, 1.5 + 0.5 * stream.signed_unit()),
        );
        point.set(
            "gamma",
            &DMatrix::from_element(1, 1, 3.5 + 0.5 * stream.signed_unit()),
        );
        point
    }

    /// Every condition of Theorem 2 in the full form, without margin.
    pub fn conditions(&self, task: &Task) -> Vec<Condition> {
        let strictness = Strictness::fixed(0.0);
        let mut out = side_conditions(task, &self.design, &strictness);
        for interval in SamplingEnd::BOTH {
            for vertex in 0..task.system.vertices.len() {
                out.push(full_condition(
                    task,
                    vertex,
                    interval,
                    &self.design,
                    &strictness,
                ));
            }
        }
        out
    }

    /// Gives the matrix unknown `name` the value `matrix`, entry by entry.
    pub fn set(&mut self, name: &str, matrix: &DMatrix<f64>) {
        let mut found = 0;
        for (value, entry) in self.values.iter_mut().zip(self.unknowns.names()) {
            let (matrix_name, index) = entry.split_once('[').unwrap_or((entry, "0]"));
            if matrix_name != name {
                continue;
            }
            let index: Vec<usize> = index
                .trim_end_matches(']')
                .split(',')
                .map(|number| number.parse().expect("an index"))
                .collect();
            *value = matrix[(index[0], index[index.len() - 1])];
            found += 1;
        }
        assert!(found > 0, "no unknown is called {name}");
    }
}

/// The largest magnitude of an entry.
pub fn size(matrix: &DMatrix<f64>) -> f64 {
    matrix
        .iter()
        .fold(0.0, |largest, entry| entry.abs().max(largest))
}

/// Panics when two matrices differ by more than `tolerance` times the larger one's size.
pub fn assert_close(left: &DMatrix<f64>, right: &DMatrix<f64>, tolerance: f64, what: &str) {
    assert_eq!(left.shape(), right.shape(), "{what}");
    let scale = size(left).max(size(right)).max(f64::MIN_POSITIVE);
    let distance = size(&(left - right)) / scale;
    assert!(
        distance <= tolerance,
        "{what}: relative distance {distance:e}\n{left}\n{right}"
    );
}
