//! A plant whose state matrix lies in the convex hull of vertices.

use nalgebra::DMatrix;

/// `x' = A(t) x + B u` with A(t) in the convex hull of the vertices. n states, m inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexPlant {
    /// A_i, n x n.
    pub vertices: Vec<DMatrix<f64>>,
    /// B, n x m.
    pub input: DMatrix<f64>,
    /// A given feedback F, m x n, to be analysed; without it one is designed.
    pub gain: Option<DMatrix<f64>>,
}

impl VertexPlant {
    /// Number of states n.
    pub fn states(&self) -> usize {
        self.input.nrows()
    }

    /// Number of inputs m.
    pub fn inputs(&self) -> usize {
        self.input.ncols()
    }

    /// The mean of the vertices, n x n.
    pub fn mean(&self) -> DMatrix<f64> {
        let n = self.states();
        let sum = self.vertices.iter();
        let sum = sum.fold(DMatrix::zeros(n, n), |sum, a| sum + a);
        sum / self.vertices.len() as f64
    }
}
