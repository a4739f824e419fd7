//! What a Takagi-Sugeno plant is measured by in a run: the norm of its state.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};
use synth::fuzzy::RuleModel;

use super::{TakagiSugenoFile, TakagiSugenoPlant, TakagiSugenoSystem};
use crate::sim::actuator::ActuatorData;
use crate::sim::bench::{Bench, Gauge};
use crate::sim::embedding;
use crate::sim::gain_error::GainError;
use crate::sim::measurement_error::BoundedError;
use crate::sim::metrics::Measured;
use crate::sim::plant::PlantFile;
use crate::sim::pointing::ErrorStatistics;
use crate::sim::sensor::StateSensor;

/// The state, of which the first components are not padding.
#[derive(Debug, Clone)]
pub struct StateGauge {
    states: usize,
    inputs: usize,
    settle_tolerance: f64,
}

/// A Takagi-Sugeno plant in its surroundings, padded to `N` states and `M` inputs.
pub type StateBench<const N: usize, const M: usize> =
    Bench<TakagiSugenoPlant<N, M>, StateSensor<N>, StateGauge, N, M, N>;

impl TakagiSugenoSystem {
    /// The plant, ready for a run with this seed. `rules`: see [`TakagiSugenoPlant::new`]; `worst`: F'B'U of the design.
    pub fn bench<const N: usize, const M: usize>(
        &self,
        settle_tolerance: f64,
        rules: Option<RuleModel>,
        worst: SMatrix<f64, N, N>,
        seed: u64,
    ) -> StateBench<N, M> {
        let (states, inputs) = self.system.input_matrix.shape();
        let sensor = StateSensor::new(states, self.state_noise, seed);
        let sensor = match self.measurement_error.clone() {
            None => sensor,
            Some(bounds) => sensor.with_error(BoundedError::new(bounds, Some(worst), seed)),
        };
        Bench {
            plant: TakagiSugenoPlant::new(&self.system, self.mixing.clone(), rules),
            initial: embedding::vector(&self.initial_state),
            disturbance: self.disturbance.padded(),
            sensor,
            actuators: ActuatorData {
                limit: embedding::filled(self.system.input_limit.as_slice(), f64::INFINITY),
                delay_s: self.input_delay_s,
                gain_error: self.gain_error.as_ref().map(GainError::resized),
                ..ActuatorData::ideal()
            },
            reference_jumps_s: Vec::new(),
            gauge: StateGauge {
                states,
                inputs,
                settle_tolerance,
            },
        }
    }
}

impl<const N: usize, const M: usize> Gauge<N, M, N, N> for StateGauge {
    type Seen = SVector<f64, N>;

    const QUANTITIES: &'static [&'static str] = TakagiSugenoFile::QUANTITIES;

    #[inline]
    fn see(&self, _time_s: f64, state: &SVector<f64, N>) -> SVector<f64, N> {
        *state
    }

    #[inline]
    fn certified(&self, seen: &SVector<f64, N>) -> SVector<f64, N> {
        *seen
    }

    fn settle_tolerance(&self) -> f64 {
        self.settle_tolerance
    }

    #[inline]
    fn settling_square(&self, seen: &SVector<f64, N>) -> f64 {
        seen.norm_squared()
    }

    #[inline]
    fn tail_square(&self, seen: &SVector<f64, N>) -> f64 {
        seen.norm_squared()
    }

    fn quantities(&self, seen: &SVector<f64, N>) -> Vec<f64> {
        vec![seen.norm()]
    }

    fn columns(&self) -> Vec<String> {
        let states = (1..=self.states).map(|index| format!("state_{index}"));
        let inputs = (1..=self.inputs).map(|index| format!("input_{index}"));
        let norm = std::iter::once("state_norm".to_string());
        states.chain(inputs).chain(norm).collect()
    }

    fn inputs(&self) -> Range<usize> {
        self.states..self.states + self.inputs
    }

    fn write(
        &self,
        seen: &SVector<f64, N>,
        input: &SVector<f64, M>,
        _disturbance: &SVector<f64, N>,
        row: &mut Vec<f64>,
    ) {
        row.extend(seen.iter().take(self.states));
        row.extend(input.iter().take(self.inputs));
        row.push(seen.norm());
    }

    fn measure(&self, error: &ErrorStatistics, last: &SVector<f64, N>, measured: &mut Measured) {
        measured.final_state_norm = Some(last.norm()).filter(|norm| norm.is_finite());
        measured.rms_state_norm = error.tail_rms();
    }
}
