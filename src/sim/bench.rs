//! A plant in its surroundings, and what its state is measured by.

use std::ops::Range;

use nalgebra::SVector;

use super::actuator::ActuatorData;
use super::disturbance::Disturbance;
use super::metrics::Measured;
use super::pointing::ErrorStatistics;

/// What the state of a plant of `N` states, `M` inputs and `D` disturbances is measured by in a run. A
/// certificate is about `L` states.
pub trait Gauge<const N: usize, const M: usize, const D: usize, const L: usize> {
    /// What an exact sensor sees.
    type Seen: Copy;

    /// The quantities of a profile, with units.
    const QUANTITIES: &'static [&'static str];

    /// What an exact sensor sees of a state.
    fn see(&self, time_s: f64, state: &SVector<f64, N>) -> Self::Seen;

    /// Takes the state at the start and at the end of each step.
    fn watch(&mut self, _state: &SVector<f64, N>) {}

    /// The disturbance that acts on a certificate's plant: `disturbance`, and what the actuators give beside the torque
    /// `input` that is asked of them.
    fn acting_disturbance(
        &self,
        _state: &SVector<f64, N>,
        _input: &SVector<f64, M>,
        disturbance: &SVector<f64, D>,
    ) -> SVector<f64, D> {
        *disturbance
    }

    /// The largest norm and components of the wheels' momentum so far, N m s; `None` without wheels.
    fn momentum_peaks(&self) -> Option<[f64; 4]> {
        None
    }

    /// The state that a certificate is about.
    fn certified(&self, seen: &Self::Seen) -> SVector<f64, L>;

    /// The run has settled when the error's magnitude stays within this.
    fn settle_tolerance(&self) -> f64;

    /// Square of the magnitude that settles.
    fn settling_square(&self, seen: &Self::Seen) -> f64;

    /// Square of the error whose root mean square and peak over the tail are reported.
    fn tail_square(&self, seen: &Self::Seen) -> f64;

    /// Values of [`Self::QUANTITIES`].
    fn quantities(&self, seen: &Self::Seen) -> Vec<f64>;

    /// Columns of the trajectory between the time and whether a message was sent.
    fn columns(&self) -> Vec<String>;

    /// Which of them are the inputs.
    fn inputs(&self) -> Range<usize>;

    /// Which of them are the disturbance's; none by default.
    fn disturbances(&self) -> Range<usize> {
        0..0
    }

    /// Appends the values of the columns.
    fn write(
        &self,
        seen: &Self::Seen,
        input: &SVector<f64, M>,
        disturbance: &SVector<f64, D>,
        row: &mut Vec<f64>,
    );

    /// Adds what this plant measures; `last` is what was seen last.
    fn measure(&self, error: &ErrorStatistics, last: &Self::Seen, measured: &mut Measured);
}

/// A plant in its surroundings, ready for a run: all but the controller.
#[derive(Debug, Clone)]
pub struct Bench<P, S, G, const N: usize, const M: usize, const D: usize> {
    /// The plant.
    pub plant: P,
    /// State at the start.
    pub initial: SVector<f64, N>,
    /// The disturbance.
    pub disturbance: Disturbance<D>,
    /// The sensor.
    pub sensor: S,
    /// The actuators.
    pub actuators: ActuatorData<M>,
    /// Times at which what the state should be changes abruptly, s.
    pub reference_jumps_s: Vec<f64>,
    /// What its state is measured by.
    pub gauge: G,
}

impl<P, S, G, const N: usize, const M: usize, const D: usize> Bench<P, S, G, N, M, D> {
    /// Times at which something changes abruptly before `duration_s`, s, increasing.
    pub fn discontinuities_s(&self, duration_s: f64) -> Vec<f64> {
        let mut times_s = self.actuators.discontinuities_s();
        times_s.extend(&self.reference_jumps_s);
        times_s.extend(self.disturbance.discontinuities_s());
        times_s.retain(|&time| time > 0.0 && time < duration_s);
        times_s.sort_by(f64::total_cmp);
        times_s.dedup();
        times_s
    }
}
