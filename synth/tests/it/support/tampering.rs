//! Designs with one number changed, and the judge of what the check says about them.
//!
//! Included with `#[path]` by several test programs, none of which uses all of it.
#![allow(dead_code)]

use crate::numbers;
use nalgebra::DMatrix;
use serde_json::Value;
use synth::certify::interval::Interval;
use synth::certify::matrix::Matrix;

use crate::exact::{is_positive_definite, Exact};

pub use numbers::numbers;

/// A true condition may be refused when its smallest eigenvalue, after scaling to a unit diagonal,
/// is below this.
pub const ROOM: f64 = 1e-9;

/// Every number of the parts that a proof reads.
pub fn numbers_of_proof(design: &Value) -> Vec<String> {
    let mut out = Vec::new();
    for part in ["model", "controller", "certificate"] {
        numbers(&design[part], &format!("/{part}"), &mut out);
    }
    out
}

/// The entry that mirrors an entry of a symmetric matrix.
pub fn mirrored(path: &str) -> Option<String> {
    let symmetric = [
        "trigger_weight",
        "error_weight",
        "lyapunov",
        "integral_weight",
        "inertia_kg_m2",
        "ellipsoid",
    ];
    let mut parts: Vec<&str> = path.split('/').collect();
    let last = parts.len() - 1;
    if !symmetric.contains(parts.get(last.checked_sub(2)?)?) || parts[last] == parts[last - 1] {
        return None;
    }
    parts.swap(last, last - 1);
    Some(parts.join("/"))
}

/// One changed number, or two that mirror each other.
pub struct Change {
    pub paths: Vec<String>,
    pub value: f64,
}

impl Change {
    pub fn text(&self, design: &Value) -> String {
        let mut changed = design.clone();
        for path in &self.paths {
            *changed.pointer_mut(path).expect("a path of the design") = Value::from(self.value);
        }
        changed.to_string()
    }
}

/// The changes `by` of every number; of a symmetric matrix one-sided and mirrored ones.
pub fn changes(design: &Value, by: &[fn(f64) -> f64]) -> Vec<Change> {
    let mut out = Vec::new();
    for path in numbers_of_proof(design) {
        let before = design
            .pointer(&path)
            .and_then(Value::as_f64)
            .expect("a number");
        for change in by {
            let value = change(before);
            if value == before {
                continue;
            }
            let mut sets = vec![vec![path.clone()]];
            if let Some(other) = mirrored(&path).filter(|other| path < *other) {
                sets.push(vec![path.clone(), other]);
            }
            out.extend(sets.into_iter().map(|paths| Change { paths, value }));
        }
    }
    out
}

pub const TEN_PERCENT: [fn(f64) -> f64; 2] = [|x| x * 1.1, |x| x * 0.9];
pub const GROSS: [fn(f64) -> f64; 3] = [|_| 0.0, |x| -x, |_| 1e30];

/// Exact L D L'.
pub fn exactly_positive_definite(matrix: &Matrix<Exact>) -> bool {
    let row = |r: usize| {
        (0..matrix.ncols())
            .map(|c| matrix.at(r, c).clone())
            .collect()
    };
    let rows: Vec<Vec<Exact>> = (0..matrix.nrows()).map(row).collect();
    is_positive_definite(&rows)
}

/// The smallest eigenvalue after scaling to a unit diagonal, in plain floating point.
pub fn scaled_smallest_eigenvalue(matrix: &Matrix<Interval>) -> f64 {
    let middle = |r: usize, c: usize| matrix.at(r, c).midpoint();
    let scaled = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
        middle(r, c) / (middle(r, r) * middle(c, c)).sqrt()
    });
    scaled.symmetric_eigenvalues().min()
}
