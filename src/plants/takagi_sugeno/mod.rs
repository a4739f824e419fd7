//! Takagi-Sugeno models.

pub mod file;
pub mod gauge;

use nalgebra::{SMatrix, SVector};

use crate::sim::plant::Plant;

pub use file::*;

/// A Takagi-Sugeno plant x' = sum_i zeta_i(t) A_i x + B u + B_w tau of at most `N` states, `M` inputs
/// and `N` disturbances. A smaller plant is padded with zeros, which changes none of its numbers.
#[derive(Clone, Debug)]
pub struct TakagiSugenoPlant<const N: usize, const M: usize> {
    vertices: Vec<SMatrix<f64, N, N>>,
    input: SMatrix<f64, N, M>,
    disturbance: SMatrix<f64, N, N>,
    mixing: Mixing,
    rules: Option<synth::fuzzy::RuleModel>,
}

impl<const N: usize, const M: usize> TakagiSugenoPlant<N, M> {
    /// The padded plant of a checked vertex system, which must not be larger than `N` and `M`. `rules`:
    /// the memberships for [`Mixing::Model`], one for each vertex.
    pub fn new(
        system: &synth::fuzzy::VertexSystem,
        mixing: Mixing,
        rules: Option<synth::fuzzy::RuleModel>,
    ) -> Self {
        let vertices = system.state_matrices.iter();
        Self {
            vertices: vertices.map(crate::sim::embedding::matrix).collect(),
            input: crate::sim::embedding::matrix(&system.input_matrix),
            disturbance: crate::sim::embedding::matrix(&system.disturbance_matrix),
            mixing,
            rules,
        }
    }

    fn blend(&self, weights: &[f64], state: &SVector<f64, N>) -> SVector<f64, N> {
        let parts = self.vertices.iter().zip(weights);
        parts.fold(SVector::zeros(), |sum, (vertex, &weight)| {
            sum + vertex * state * weight
        })
    }

    fn drift(&self, time_s: f64, state: &SVector<f64, N>) -> SVector<f64, N> {
        match &self.mixing {
            Mixing::Constant(weights) => self.blend(weights, state),
            Mixing::Model => match &self.rules {
                Some(rules) => self.blend(&rules.memberships(state.as_slice()), state),
                None => SVector::zeros(),
            },
            Mixing::Cycle { dwell_s } => {
                let place = time_s / dwell_s;
                let fraction = place - place.floor();
                let count = self.vertices.len();
                let from = (place.floor() % count as f64) as usize % count;
                let to = (from + 1) % count;
                (self.vertices[from] * (1.0 - fraction) + self.vertices[to] * fraction) * state
            }
        }
    }
}

impl<const N: usize, const M: usize> Plant<N, M, N> for TakagiSugenoPlant<N, M> {
    fn derivative(
        &self,
        time_s: f64,
        state: &SVector<f64, N>,
        input: &SVector<f64, M>,
        disturbance: &SVector<f64, N>,
    ) -> SVector<f64, N> {
        self.drift(time_s, state) + self.input * input + self.disturbance * disturbance
    }

    fn project(&self, _state: &mut SVector<f64, N>) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_visits_each_vertex_and_comes_back() {
        let vertex = |rate: f64| nalgebra::DMatrix::from_element(1, 1, rate);
        let system = synth::fuzzy::VertexSystem {
            state_matrices: vec![vertex(1.0), vertex(2.0), vertex(4.0)],
            input_matrix: vertex(1.0),
            disturbance_matrix: vertex(1.0),
            output_matrix: vertex(1.0),
            input_limit: nalgebra::DVector::from_element(1, 1.0),
            disturbance_bound: 0.0,
            box_rows: nalgebra::DMatrix::zeros(0, 1),
            box_bounds: nalgebra::DVector::zeros(0),
        };
        let plant = TakagiSugenoPlant::<2, 1>::new(&system, Mixing::Cycle { dwell_s: 10.0 }, None);
        let one = SVector::from([1.0, 0.0]);
        let cases = [
            (0.0, 1.0),
            (5.0, 1.5),
            (10.0, 2.0),
            (20.0, 4.0),
            (25.0, 2.5),
            (30.0, 1.0),
        ];
        for (time, slope) in cases {
            assert!(
                (plant.drift(time, &one).x - slope).abs() < 1e-12,
                "at {time} s"
            );
        }
    }
}
