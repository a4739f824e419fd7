//! T-S models given directly by their vertex systems.

use nalgebra::{DMatrix, DVector};

use super::{BoxCondition, TakagiSugeno};

/// `x' = A(t) x + B sat(u) + B_w tau` with A(t) anywhere in the convex hull of the given matrices,
/// as long as |h_r x| <= b_r for every row of the box.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexSystem {
    /// State matrices A_i, n x n.
    pub state_matrices: Vec<DMatrix<f64>>,
    /// Input matrix B, n x m.
    pub input_matrix: DMatrix<f64>,
    /// Disturbance matrix B_w, n x d.
    pub disturbance_matrix: DMatrix<f64>,
    /// Output matrix C, p x n.
    pub output_matrix: DMatrix<f64>,
    /// Saturation level of each input.
    pub input_limit: DVector<f64>,
    /// Bound on the Euclidean norm of the disturbance.
    pub disturbance_bound: f64,
    /// Rows h_r of the box, k x n (k may be 0).
    pub box_rows: DMatrix<f64>,
    /// Bounds b_r of the box, k.
    pub box_bounds: DVector<f64>,
}

impl VertexSystem {
    /// Numbers of states, inputs, disturbances, outputs.
    pub fn sizes(&self) -> (usize, usize, usize, usize) {
        (
            self.input_matrix.nrows(),
            self.input_matrix.ncols(),
            self.disturbance_matrix.ncols(),
            self.output_matrix.nrows(),
        )
    }

    /// The same data in the common form.
    pub fn takagi_sugeno(&self) -> TakagiSugeno {
        let region = (0..self.box_rows.nrows()).map(|row| BoxCondition {
            name: format!("row {}", row + 1),
            rows: self.box_rows.rows(row, 1).into_owned(),
            bound_squared: self.box_bounds[row] * self.box_bounds[row],
        });
        TakagiSugeno {
            vertices: self.state_matrices.clone(),
            descriptors: Vec::new(),
            input: self.input_matrix.clone(),
            disturbance: self.disturbance_matrix.clone(),
            output: self.output_matrix.clone(),
            input_limit: self.input_limit.clone(),
            disturbance_bound: self.disturbance_bound,
            region: region.collect(),
        }
    }
}
