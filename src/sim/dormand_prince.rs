//! Dormand and Prince's method of order 8 with error estimates of order 5 and 3.

use nalgebra::SVector;

use super::disturbance::Disturbance;
use super::dormand_prince_coefficients::{ERROR_3, ERROR_5, NODES, STAGES, STAGE_WEIGHTS, WEIGHTS};
use super::plant::Plant;

/// Bounds of the change from one step to the next.
const SMALLEST_CHANGE: f64 = 0.2;
const LARGEST_CHANGE: f64 = 5.0;
/// Fraction of the step that the error estimate allows which is taken.
const SAFETY: f64 = 0.9;
/// Steps are never shorter than this many roundings of the time.
const SHORTEST_STEP_IN_ROUNDINGS: f64 = 16.0;

/// Adaptive integration of one plant under one disturbance.
#[derive(Clone, Debug)]
pub struct DormandPrince<'a, P, const N: usize, const M: usize, const D: usize> {
    /// The plant.
    pub plant: &'a P,
    /// Its disturbance.
    pub disturbance: &'a Disturbance<D>,
    /// Allowed error of a step, relative to the state (and absolute where it is below 1).
    pub tolerance: f64,
    /// Step tried next, s.
    pub trial_s: f64,
}

impl<P, const N: usize, const M: usize, const D: usize> DormandPrince<'_, P, N, M, D>
where
    P: Plant<N, M, D>,
{
    /// One accepted step from `time_s`, at most to `until_s`, with the input held: the time reached
    /// and the state there.
    pub fn step(
        &mut self,
        time_s: f64,
        until_s: f64,
        state: &SVector<f64, N>,
        input: &SVector<f64, M>,
    ) -> (f64, SVector<f64, N>) {
        let shortest = SHORTEST_STEP_IN_ROUNDINGS * f64::EPSILON * until_s.abs();
        loop {
            let left = until_s - time_s;
            let whole = self.trial_s >= left;
            let step = if whole { left } else { self.trial_s };
            let (mut next, error) = self.attempt(time_s, step, state, input);
            let change = if error > 0.0 {
                (SAFETY * error.powf(-0.125)).clamp(SMALLEST_CHANGE, LARGEST_CHANGE)
            } else {
                LARGEST_CHANGE
            };
            let accepted = error <= 1.0 || step <= shortest || !error.is_finite();
            // A step cut short by an event says little about the next one.
            if !(accepted && whole) || step * change > self.trial_s {
                self.trial_s = step * change;
            }
            if accepted {
                self.plant.project(&mut next);
                return (if whole { until_s } else { time_s + step }, next);
            }
        }
    }

    /// One step and its error in units of the tolerance.
    fn attempt(
        &self,
        time_s: f64,
        step: f64,
        state: &SVector<f64, N>,
        input: &SVector<f64, M>,
    ) -> (SVector<f64, N>, f64) {
        let mut slopes = [SVector::<f64, N>::zeros(); STAGES];
        for stage in 0..STAGES {
            let at = state + combination(&slopes, STAGE_WEIGHTS[stage]) * step;
            let time = time_s + NODES[stage] * step;
            slopes[stage] = self
                .plant
                .derivative(time, &at, input, &self.disturbance.at(time));
        }
        let next = state + combination(&slopes, &WEIGHTS) * step;
        let scale = state.zip_map(&next, |a, b| self.tolerance * a.abs().max(b.abs()).max(1.0));
        let fifth = combination(&slopes, &ERROR_5)
            .component_div(&scale)
            .norm_squared();
        let third = combination(&slopes, &ERROR_3)
            .component_div(&scale)
            .norm_squared();
        let denominator = ((fifth + 0.01 * third) * N as f64).sqrt();
        let error = if denominator > 0.0 {
            step * fifth / denominator
        } else {
            0.0
        };
        (next, error)
    }
}

fn combination<const N: usize>(slopes: &[SVector<f64, N>], weights: &[f64]) -> SVector<f64, N> {
    let terms = slopes.iter().zip(weights);
    terms.fold(SVector::zeros(), |sum, (slope, &weight)| {
        sum + slope * weight
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plants::RigidBody;
    use crate::sim::disturbance::{DisturbanceCursor, Harmonic};
    use crate::sim::integrator::runge_kutta_step;
    use crate::sim::rigid_body_state::{rigid_body_state, RigidBodyState};
    use nalgebra::{Matrix3, Vector3};
    use runtime::attitude::Quaternion;

    const DURATION_S: f64 = 64.0;

    fn tumbling() -> (RigidBody, RigidBodyState, Disturbance<3>) {
        let inertia = Matrix3::new(3.5, 0.03, 0.04, 0.03, 2.7, 0.1, 0.04, 0.1, 1.9);
        let rate = Vector3::new(0.2, -0.3, 0.1);
        let mut disturbance = Disturbance::none();
        disturbance.harmonics.push(Harmonic {
            frequency_rad_s: 0.6,
            sine: Vector3::new(0.02, 0.0, -0.01),
            cosine: Vector3::new(0.0, 0.03, 0.01),
        });
        let start = rigid_body_state(&Quaternion::identity(), &rate);
        (RigidBody::new(inertia).unwrap(), start, disturbance)
    }

    fn adaptive(tolerance: f64) -> RigidBodyState {
        let (body, mut state, disturbance) = tumbling();
        let mut integrator = DormandPrince {
            plant: &body,
            disturbance: &disturbance,
            tolerance,
            trial_s: 1.0,
        };
        let mut time = 0.0;
        while time < DURATION_S {
            (time, state) = integrator.step(time, DURATION_S, &state, &Vector3::zeros());
        }
        state
    }

    fn fixed(steps: u32) -> RigidBodyState {
        let (body, mut state, disturbance) = tumbling();
        let mut cursor = DisturbanceCursor::new(&disturbance, 0.0);
        let step = DURATION_S / f64::from(steps);
        for index in 0..steps {
            let time = f64::from(index) * step;
            let values = cursor.step(time, step);
            state = runge_kutta_step(&body, time, &state, step, &Vector3::zeros(), &values);
        }
        state
    }

    #[test]
    fn tightening_the_tolerance_converges_to_1e_12() {
        let exact = adaptive(1e-14);
        let errors = [1e-6, 1e-9, 1e-12].map(|tolerance| (adaptive(tolerance) - exact).amax());
        println!("{errors:?}");
        assert!(errors[0] < 1e-4 && errors[0] > errors[1] && errors[1] > errors[2]);
        assert!(errors[2] < 1e-10);
    }

    #[test]
    fn the_fixed_step_converges_to_the_reference_with_order_4() {
        let exact = adaptive(1e-13);
        let error = |steps| (fixed(steps) - exact).amax();
        let (coarse, fine) = (error(256), error(512));
        println!("{coarse:e}, {fine:e}");
        assert!(fine > 1e-12);
        assert!((12.0..22.0).contains(&(coarse / fine)), "{}", coarse / fine);
    }
}
