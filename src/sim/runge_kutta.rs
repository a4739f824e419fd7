//! The classical Runge-Kutta method of order 4.

use nalgebra::SVector;

use super::plant::Plant;

/// State after one step of `step_s` seconds from `time_s`, with the input held. `disturbance` holds
/// its values at the start, the middle and the end of the step.
#[inline(always)]
pub fn step<P, const N: usize, const M: usize, const D: usize>(
    plant: &P,
    time_s: f64,
    state: &SVector<f64, N>,
    step_s: f64,
    input: &SVector<f64, M>,
    disturbance: &[SVector<f64, D>; 3],
) -> SVector<f64, N>
where
    P: Plant<N, M, D>,
{
    let half = 0.5 * step_s;
    let [start, middle, end] = disturbance;
    let k1 = plant.derivative(time_s, state, input, start);
    let k2 = plant.derivative(time_s + half, &(state + k1 * half), input, middle);
    let k3 = plant.derivative(time_s + half, &(state + k2 * half), input, middle);
    let k4 = plant.derivative(time_s + step_s, &(state + k3 * step_s), input, end);
    let mut next = state + (k1 + (k2 + k3) * 2.0 + k4) * (step_s / 6.0);
    plant.project(&mut next);
    next
}
