//! Units of a design problem: one power of two for each state and input, so that they undo exactly.

use nalgebra::{DMatrix, DVector};

use super::vertex_plant::VertexPlant;
use crate::balancing::balanced;
use crate::riccati::stabilising;

/// The power of two nearest to a positive number in ratio; 1 for anything else.
pub fn power_of_two(value: f64) -> f64 {
    match value.is_finite() && value > 0.0 {
        true => value.log2().round().clamp(-500.0, 500.0).exp2(),
        false => 1.0,
    }
}

/// Units of a scaled problem; every one is a power of two, so that they undo exactly.
#[derive(Debug, Clone, PartialEq)]
pub struct Units {
    /// Unit of time (s).
    pub time: f64,
    /// Unit of each state.
    pub state: DVector<f64>,
    /// Unit of each input.
    pub input: DVector<f64>,
    /// Unit of the disturbance.
    pub disturbance: f64,
    /// Unit of the output.
    pub output: f64,
    /// Unit of the objective.
    pub objective: f64,
    /// x'Px of the scaled problem is this part of that of the file's.
    pub energy: f64,
}

/// About how large the numbers of a problem are, in the file's units.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// Of each state; a common factor of all is free where they come from the plant alone.
    pub state: DVector<f64>,
    /// Of each input, where a solution is known.
    pub input: Option<DVector<f64>>,
    /// Of the objective, where a solution is known.
    pub objective: Option<f64>,
}

/// Weight of the input in the regulator that gives the first sizes, in balanced units.
const INPUT_WEIGHTS: [f64; 3] = [1.0, 1e-4, 1e4];

impl Sizes {
    /// From the plant: balanced, then `D_ii = X_ii^(-1/2)` of the linear-quadratic regulator of the mean vertex, which
    /// decays at the given rate [1/s].
    pub fn of(plant: &VertexPlant, rate: f64) -> Self {
        let nothing_known = vec![None; plant.states()];
        let first = balanced(&plant.vertices, &plant.input, &nothing_known);
        let sizes = Sizes {
            state: first.clone(),
            input: None,
            objective: None,
        };
        let units = Units::of(plant, &sizes);
        let scaled = plant.in_units(&units);
        let n = plant.states();
        let mut mean = scaled.mean() + units.time * rate * DMatrix::identity(n, n);
        let mut input = scaled.input.clone();
        if let Some(gain) = &scaled.gain {
            mean += &input * gain;
            input = DMatrix::zeros(n, 0);
        }
        let gram = &input * input.transpose();
        let identity = DMatrix::identity(n, n);
        let solved = INPUT_WEIGHTS
            .iter()
            .find_map(|weight| stabilising(&mean, &(&gram / *weight), &identity));
        let Some(x) = solved.filter(|x| x.diagonal().iter().all(|&entry| entry > 0.0)) else {
            return sizes;
        };
        Sizes {
            state: first.zip_map(&x.diagonal(), |unit, entry| unit / entry.sqrt()),
            ..sizes
        }
    }

    /// The same sizes with another common factor.
    pub fn times(mut self, factor: f64) -> Self {
        self.state *= factor;
        self
    }
}

impl Units {
    /// The unit of time makes the largest vertex about 1, those of the inputs the columns of B.
    pub fn of(plant: &VertexPlant, sizes: &Sizes) -> Self {
        let state = sizes.state.map(power_of_two);
        let inside = |a: &DMatrix<f64>| {
            DMatrix::from_fn(a.nrows(), a.ncols(), |r, c| {
                a[(r, c)] * (state[c] / state[r])
            })
        };
        let norms = plant.vertices.iter().map(|a| inside(a).norm());
        let time = power_of_two(1.0 / norms.fold(0.0, f64::max));
        let inputs = plant.input.column_iter().enumerate().map(|(s, column)| {
            let known = sizes.input.as_ref().map(|input| input[s]);
            let known = known.filter(|size| *size > 0.0 && size.is_finite());
            let own = 1.0 / (time * column.component_div(&state).norm());
            power_of_two(known.unwrap_or(own))
        });
        Units {
            time,
            input: DVector::from_iterator(plant.input.ncols(), inputs),
            state,
            disturbance: 1.0,
            output: 1.0,
            objective: 1.0,
            energy: 1.0,
        }
    }

    /// A column or several, n rows, of what drives the state: `D^-1 M`.
    pub fn driving(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
            matrix[(r, c)] / self.state[r]
        })
    }

    /// A row or several, n columns, that read the state: `M D`.
    pub fn reading(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
            matrix[(r, c)] * self.state[c]
        })
    }

    /// `D M D` of a symmetric matrix, n x n, that weighs the state.
    pub fn weighing(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
            matrix[(r, c)] * (self.state[r] * self.state[c])
        })
    }

    /// `D^-1 M D^-1`, the inverse of [`Units::weighing`].
    pub fn unweighed(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
            matrix[(r, c)] / (self.state[r] * self.state[c])
        })
    }

    /// A gain, m x n, back in the file's units.
    pub fn gain_in_file_units(&self, gain: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(gain.nrows(), gain.ncols(), |r, c| {
            gain[(r, c)] * (self.input[r] / self.state[c])
        })
    }
}

impl VertexPlant {
    /// The plant in other units.
    pub fn in_units(&self, units: &Units) -> Self {
        let scaled = |a: &DMatrix<f64>| units.time * units.reading(&units.driving(a));
        let by_inputs = |matrix: DMatrix<f64>| matrix * DMatrix::from_diagonal(&units.input);
        VertexPlant {
            vertices: self.vertices.iter().map(scaled).collect(),
            input: by_inputs(units.time * units.driving(&self.input)),
            gain: self.gain.as_ref().map(|gain| {
                DMatrix::from_fn(gain.nrows(), gain.ncols(), |r, c| {
                    gain[(r, c)] * (units.state[c] / units.input[r])
                })
            }),
        }
    }
}
