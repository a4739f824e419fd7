//! Random affine expressions with their values, and a reader of SDPA text.
#![allow(dead_code)]

use nalgebra::DMatrix;
use synth::lmi::{svec_index, Affine, Semidefinite, Unknowns};

use crate::exact::Stream;

/// Small integers: every product and sum below is exact, so values are compared to the last bit.
fn integers(stream: &mut Stream, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| stream.integer(-9, 9) as f64)
}

/// An expression, its value computed with plain matrices, and the point.
pub struct Pair {
    pub expression: Affine,
    pub value: DMatrix<f64>,
}

impl Pair {
    pub fn check(&self, values: &[f64]) {
        assert_eq!(self.expression.value(values), self.value);
        assert_eq!(
            (self.expression.nrows(), self.expression.ncols()),
            self.value.shape()
        );
    }
}

/// Unknowns of every kind with integer values, and an affine r x c expression of all of them.
pub struct World {
    pub stream: Stream,
    pub unknowns: Unknowns,
    pub values: Vec<f64>,
}

impl World {
    pub fn new(seed: u64) -> Self {
        World {
            stream: Stream(seed),
            unknowns: Unknowns::new(),
            values: Vec::new(),
        }
    }

    pub fn draw(&mut self) {
        while self.values.len() < self.unknowns.count() {
            let value = self.stream.integer(-9, 9) as f64;
            self.values.push(value);
        }
    }

    pub fn general(&mut self, rows: usize, columns: usize) -> Pair {
        let first = self.unknowns.count();
        let expression = self.unknowns.general("G", rows, columns);
        self.draw();
        let value = DMatrix::from_fn(rows, columns, |r, c| self.values[first + c * rows + r]);
        Pair { expression, value }
    }

    pub fn symmetric(&mut self, side: usize) -> Pair {
        let first = self.unknowns.count();
        let expression = self.unknowns.symmetric("S", side);
        self.draw();
        let value = DMatrix::from_fn(side, side, |r, c| {
            self.values[first + svec_index(r.min(c), r.max(c))]
        });
        Pair { expression, value }
    }

    pub fn diagonal(&mut self, side: usize) -> Pair {
        let first = self.unknowns.count();
        let expression = self.unknowns.diagonal("D", side);
        self.draw();
        let value = DMatrix::from_fn(side, side, |r, c| {
            if r == c {
                self.values[first + r]
            } else {
                0.0
            }
        });
        Pair { expression, value }
    }

    pub fn scalar(&mut self) -> Pair {
        let first = self.unknowns.count();
        let expression = self.unknowns.scalar("s");
        self.draw();
        let value = DMatrix::from_element(1, 1, self.values[first]);
        Pair { expression, value }
    }

    pub fn constant(&mut self, rows: usize, columns: usize) -> DMatrix<f64> {
        integers(&mut self.stream, rows, columns)
    }

    /// constant + general + left * general * right, all random.
    pub fn affine(&mut self, rows: usize, columns: usize) -> Pair {
        let (inner_rows, inner_columns) = (columns, rows);
        let (plain, inner) = (
            self.general(rows, columns),
            self.general(inner_rows, inner_columns),
        );
        let left = self.constant(rows, inner_rows);
        let right = self.constant(inner_columns, columns);
        let constant = self.constant(rows, columns);
        Pair {
            expression: Affine::constant(&constant)
                + plain.expression
                + &(&left * &inner.expression) * &right,
            value: constant + plain.value + left * inner.value * right,
        }
    }
}

/// The matrix of a lowered cone at a point.
pub fn lowered_value(lowered: &Semidefinite, cone: usize, values: &[f64]) -> DMatrix<f64> {
    let cone = &lowered.cones[cone];
    let mut upper = DMatrix::zeros(cone.side, cone.side);
    for entry in &cone.constant {
        upper[(entry.row, entry.column)] += entry.value;
    }
    for (unknown, entries) in &cone.coefficients {
        for entry in entries {
            upper[(entry.row, entry.column)] += entry.value * values[*unknown];
        }
    }
    mirrored(&upper)
}

fn mirrored(upper: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(upper.nrows(), upper.ncols(), |r, c| {
        upper[(r.min(c), r.max(c))]
    })
}

/// A reader of SDPA sparse text: `min c'y  s.t.  sum_i y_i F_i - F_0 >= 0`.
pub struct Sdpa {
    pub names: Vec<String>,
    pub offset: f64,
    pub cost: Vec<f64>,
    /// By block: F_0, F_1, ...
    pub matrices: Vec<Vec<DMatrix<f64>>>,
}

impl Sdpa {
    pub fn read(text: &str) -> Self {
        let comments: Vec<&str> = text
            .lines()
            .filter_map(|line| line.strip_prefix('"'))
            .collect();
        let mut lines = text.lines().filter(|line| !line.starts_with('"'));
        let mut next = || lines.next().expect("one more line");
        let numbers = |line: &str| -> Vec<f64> {
            line.split_whitespace()
                .map(|word| word.parse().expect("a number"))
                .collect()
        };
        let unknowns: usize = next().parse().expect("a count");
        let blocks: usize = next().parse().expect("a count");
        let sides: Vec<usize> = numbers(next()).iter().map(|side| *side as usize).collect();
        let cost = numbers(next());
        assert_eq!((sides.len(), cost.len()), (blocks, unknowns));
        let zeros = |side: &usize| vec![DMatrix::zeros(*side, *side); unknowns + 1];
        let mut matrices: Vec<Vec<DMatrix<f64>>> = sides.iter().map(zeros).collect();
        for line in lines {
            let words: Vec<&str> = line.split_whitespace().collect();
            assert_eq!(words.len(), 5, "{line}");
            let index = |k: usize| words[k].parse::<usize>().expect("an index");
            let (row, column) = (index(2), index(3));
            assert!(row <= column, "{line}");
            let entry = &mut matrices[index(1) - 1][index(0)][(row - 1, column - 1)];
            assert_eq!(*entry, 0.0, "{line} comes twice");
            *entry = words[4].parse().expect("a number");
        }
        let after = |prefix: &str| {
            let found = comments.iter().filter_map(|line| line.strip_prefix(prefix));
            found.map(str::to_string).collect::<Vec<_>>()
        };
        let names = after("block ")
            .iter()
            .map(|line| line.split_once(": ").expect("a name").1.to_string())
            .collect();
        Sdpa {
            names,
            offset: after("objective offset ")[0].parse().expect("a number"),
            cost,
            matrices,
        }
    }

    pub fn value(&self, block: usize, values: &[f64]) -> DMatrix<f64> {
        let matrices = &self.matrices[block];
        let start = -&matrices[0];
        let terms = matrices[1..].iter().zip(values);
        mirrored(&terms.fold(start, |sum, (matrix, value)| sum + matrix * *value))
    }
}
