//! Integration of the plant between events, with the input held.

use nalgebra::SVector;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::plant::Plant;
use crate::base::bounded::{As, Positive, Tolerance};

/// How the plant is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Method {
    /// The classical Runge-Kutta method of order 4.
    RungeKutta4 {
        /// Longest step, above 0 (s); 1/32 s when the integrator is left out.
        #[serde(with = "As::<Positive>")]
        step_s: f64,
    },
    /// Dormand and Prince's adaptive method of order 8, with a step chosen from its error estimate: the
    /// reference that the other is checked against.
    DormandPrince853 {
        /// Allowed error of a step, relative to the state (and absolute where it is below 1), in
        /// [1e-14, 0.001].
        #[serde(with = "As::<Tolerance>")]
        tolerance: f64,
    },
}

impl Default for Method {
    fn default() -> Self {
        Method::RungeKutta4 { step_s: 0.03125 }
    }
}

/// State after one step of the classical Runge-Kutta method, of `step_s` seconds from `time_s`, with the input held. `disturbance` holds
/// its values at the start, the middle and the end of the step.
#[inline(always)]
pub fn runge_kutta_step<P, const N: usize, const M: usize, const D: usize>(
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
