//! Random semidefinite programs with a known answer.
#![allow(dead_code)]

use synth::lmi::{svec_index, Cone, Entry, Semidefinite};

/// SplitMix64: the same numbers in every run.
pub struct Stream(u64);

impl Stream {
    pub fn new(seed: u64) -> Self {
        Stream(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03)
    }

    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    pub fn integer(&mut self, least: usize, most: usize) -> usize {
        least + (self.unit() * (most - least + 1) as f64) as usize
    }
}

/// A positive definite matrix, upper triangle by columns.
fn definite(stream: &mut Stream, side: usize) -> Vec<f64> {
    let root: Vec<f64> = (0..side * side).map(|_| stream.signed()).collect();
    let mut out = vec![0.0; side * (side + 1) / 2];
    for column in 0..side {
        for row in 0..=column {
            let sum: f64 = (0..side)
                .map(|k| root[k * side + row] * root[k * side + column])
                .sum();
            out[svec_index(row, column)] = sum + if row == column { 0.3 } else { 0.0 };
        }
    }
    out
}

pub fn inner(entries: &[Entry], weight: &[f64]) -> f64 {
    let term = |e: &Entry| {
        let count = if e.row == e.column { 1.0 } else { 2.0 };
        count * e.value * weight[svec_index(e.row, e.column)]
    };
    entries.iter().map(term).sum()
}

/// Random cones without constants: every unknown occurs somewhere.
fn cones(stream: &mut Stream) -> (usize, Vec<Cone>) {
    let sides: Vec<usize> = (0..stream.integer(1, 5))
        .map(|_| stream.integer(1, 8))
        .collect();
    let room: usize = sides.iter().map(|side| side * (side + 1) / 2).sum();
    let unknowns = stream.integer(1, 12).min(room.div_ceil(2));
    let cones = sides.iter().enumerate().map(|(index, &side)| {
        let mut coefficients = Vec::new();
        for unknown in 0..unknowns {
            let must = unknown % sides.len() == index;
            if !must && stream.unit() < 0.4 {
                continue;
            }
            let mut entries = Vec::new();
            for column in 0..side {
                for row in 0..=column {
                    if stream.unit() < 0.3 || (must && row == 0 && column == 0) {
                        entries.push(Entry {
                            row,
                            column,
                            value: stream.signed(),
                        });
                    }
                }
            }
            if !entries.is_empty() {
                coefficients.push((unknown, entries));
            }
        }
        Cone {
            name: format!("cone {index}"),
            side,
            constant: Vec::new(),
            coefficients,
        }
    });
    (unknowns, cones.collect())
}

fn dense(upper: &[f64], side: usize) -> Vec<Entry> {
    let places = (0..side).flat_map(|column| (0..=column).map(move |row| (row, column)));
    places
        .map(|(row, column)| Entry {
            row,
            column,
            value: upper[svec_index(row, column)],
        })
        .collect()
}

/// Strictly feasible, as its dual is: the optimum exists on both sides.
pub fn feasible(seed: u64) -> Semidefinite {
    let mut stream = Stream::new(seed);
    let (unknowns, mut cones) = cones(&mut stream);
    let inside: Vec<f64> = (0..unknowns).map(|_| stream.signed()).collect();
    let mut cost = vec![0.0; unknowns];
    for cone in &mut cones {
        let mut constant = definite(&mut stream, cone.side);
        let weight = definite(&mut stream, cone.side);
        for (unknown, entries) in &cone.coefficients {
            for e in entries {
                constant[svec_index(e.row, e.column)] -= inside[*unknown] * e.value;
            }
            cost[*unknown] += inner(entries, &weight);
        }
        cone.constant = dense(&constant, cone.side);
    }
    Semidefinite {
        cost,
        offset: stream.signed(),
        cones,
    }
}

/// Without a solution: some positive definite weights show it.
pub fn infeasible(seed: u64) -> Semidefinite {
    let mut stream = Stream::new(seed);
    let (unknowns, mut cones) = cones(&mut stream);
    let weights: Vec<Vec<f64>> = cones
        .iter()
        .map(|cone| definite(&mut stream, cone.side))
        .collect();
    // Each unknown's first entry (0, 0) makes its products with the weights cancel.
    for unknown in 0..unknowns {
        let own = unknown % cones.len();
        let sum: f64 = cones
            .iter()
            .zip(&weights)
            .flat_map(|(cone, weight)| {
                let entries = cone.coefficients.iter().filter(|(u, _)| *u == unknown);
                entries.map(move |(_, entries)| inner(entries, weight))
            })
            .sum();
        let entries = cones[own]
            .coefficients
            .iter_mut()
            .find(|(u, _)| *u == unknown);
        let (_, entries) = entries.expect("every unknown occurs in its own cone");
        let corner = entries.iter_mut().find(|e| (e.row, e.column) == (0, 0));
        let corner = corner.expect("with a corner");
        corner.value -= sum / weights[own][0];
        if corner.value.abs() < 1e-12 {
            // Nothing but rounding: an unknown that does nothing.
            corner.value = 0.0;
        }
    }
    let mut sum = 0.0;
    for (cone, weight) in cones.iter_mut().zip(&weights) {
        let height = cone.side * (cone.side + 1) / 2;
        let constant: Vec<f64> = (0..height).map(|_| stream.signed()).collect();
        cone.constant = dense(&constant, cone.side);
        sum += inner(&cone.constant, weight);
    }
    let trace: f64 = (0..cones[0].side)
        .map(|k| weights[0][svec_index(k, k)])
        .sum();
    let shift = (sum + 0.2 + stream.unit()) / trace;
    for entry in cones[0].constant.iter_mut().filter(|e| e.row == e.column) {
        entry.value -= shift;
    }
    let cost = (0..unknowns).map(|_| stream.signed()).collect();
    Semidefinite {
        cost,
        offset: 0.0,
        cones,
    }
}
