//! A sampled, event-triggered, saturated closed loop with its Lyapunov functional.
#![allow(dead_code)]

use nalgebra::{DMatrix, DVector};
use synth::certify::theorem1::Certificate;
use synth::model::Model;

use crate::closed_loop::quadratic;
use crate::exact::Stream;

/// What a run showed.
#[derive(Debug, Clone, Copy)]
pub struct Promise {
    /// Largest `V' + phi V - xi |tau|^2` over the steps, relative to phi V + xi |tau|^2: not above 0
    /// when the promise is kept.
    pub excess: f64,
    /// Largest |y|.
    pub largest_output: f64,
    pub triggers: usize,
    pub samples: usize,
}

/// x' for a state and what acts on the input.
pub type Plant<'a> = &'a dyn Fn(&DVector<f64>, &DVector<f64>) -> DVector<f64>;

/// The controller of a certificate on a plant `x' = f(x, input + disturbance)`.
pub struct EventTriggeredLoop<'a> {
    certificate: &'a Certificate,
    plant: Plant<'a>,
    input: DMatrix<f64>,
    output: DMatrix<f64>,
    limit: DVector<f64>,
    pub disturbance_bound: f64,
    decay_rate: f64,
    sampling_interval_max: f64,
    threshold: f64,
}

/// Steps of the integration in one sampling interval.
const STEPS: usize = 4;

impl<'a> EventTriggeredLoop<'a> {
    pub fn new(model: &Model, certificate: &'a Certificate, plant: Plant<'a>) -> Self {
        let system = model.plant.takagi_sugeno();
        EventTriggeredLoop {
            certificate,
            plant,
            limit: system.input_limit,
            disturbance_bound: system.disturbance_bound,
            decay_rate: model.file.specs.phi_per_s,
            sampling_interval_max: model.file.specs.hbar_s,
            threshold: model.file.specs.nu,
            input: system.input,
            output: system.output,
        }
    }

    /// The disturbance of full size that raises x'Ux fastest.
    fn disturbance(&self, state: &DVector<f64>) -> DVector<f64> {
        let pull = self.input.transpose() * (&self.certificate.lyapunov * state);
        let norm = pull.norm();
        if norm > 0.0 {
            pull * (self.disturbance_bound / norm)
        } else {
            let mut any = DVector::zeros(pull.nrows());
            any[0] = self.disturbance_bound;
            any
        }
    }

    /// (x', I') for x and the integral I of (21) since the last sample.
    fn derivative(
        &self,
        state: &DVector<f64>,
        integral: f64,
        input: &DVector<f64>,
    ) -> (DVector<f64>, f64) {
        let rate = (self.plant)(state, &(input + self.disturbance(state)));
        let growth = quadratic(&self.certificate.integral_weight, &rate);
        (rate, growth - self.decay_rate * integral)
    }

    /// One step of the classical Runge-Kutta method.
    fn step(
        &self,
        state: &DVector<f64>,
        integral: f64,
        input: &DVector<f64>,
        dt: f64,
    ) -> (DVector<f64>, f64) {
        let (k1, i1) = self.derivative(state, integral, input);
        let (k2, i2) =
            self.derivative(&(state + &k1 * (dt / 2.0)), integral + i1 * dt / 2.0, input);
        let (k3, i3) =
            self.derivative(&(state + &k2 * (dt / 2.0)), integral + i2 * dt / 2.0, input);
        let (k4, i4) = self.derivative(&(state + &k3 * dt), integral + i3 * dt, input);
        let rate = (k1 + (k2 + k3) * 2.0 + k4) / 6.0;
        (
            state + rate * dt,
            integral + (i1 + 2.0 * (i2 + i3) + i4) / 6.0 * dt,
        )
    }

    fn command(&self, held: &DVector<f64>) -> DVector<f64> {
        (&self.certificate.gain * held).zip_map(&self.limit, |u, limit| u.clamp(-limit, limit))
    }

    fn triggers(&self, sample: &DVector<f64>, held: &DVector<f64>) -> bool {
        let weight = &self.certificate.trigger_weight;
        quadratic(weight, &(sample - held)) >= self.threshold * quadratic(weight, held)
    }

    /// Runs from a start state with random sampling intervals, every fourth one the longest.
    pub fn run(&self, start: &DVector<f64>, duration: f64, stream: &mut Stream) -> Promise {
        let (mut state, mut held) = (start.clone(), start.clone());
        let (mut time, mut samples, mut triggers) = (0.0, 0, 0);
        let (mut excess, mut largest_output) = (f64::NEG_INFINITY, 0.0_f64);
        while time < duration {
            if samples == 0 || self.triggers(&state, &held) {
                held = state.clone();
                triggers += 1;
            }
            let fraction = match samples % 4 {
                0 => 1.0,
                _ => 0.02 + 0.49 * (1.0 + stream.signed_unit()),
            };
            let interval = fraction * self.sampling_interval_max;
            let input = self.command(&held);
            let dt = interval / STEPS as f64;
            let mut integral = 0.0;
            for step in 0..STEPS {
                let rest = interval - step as f64 * dt;
                let before = self.functional(&state, rest, integral);
                (state, integral) = self.step(&state, integral, &input, dt);
                let after = self.functional(&state, rest - dt, integral);
                let scale = (self.decay_rate * before + self.supply()) * dt;
                excess = excess.max((after - self.allowed(before, dt)) / scale);
                largest_output = largest_output.max((&self.output * &state).norm());
            }
            samples += 1;
            time += interval;
        }
        Promise {
            excess,
            largest_output,
            triggers,
            samples,
        }
    }

    /// (21): x'Ux + (time to the next sample) I.
    fn functional(&self, state: &DVector<f64>, rest: f64, integral: f64) -> f64 {
        quadratic(&self.certificate.lyapunov, state) + rest * integral
    }

    /// (30) over one step with a disturbance of full size.
    fn allowed(&self, before: f64, dt: f64) -> f64 {
        let forgetting = (-self.decay_rate * dt).exp();
        forgetting * before + self.supply() * (1.0 - forgetting) / self.decay_rate
    }

    /// xi |tau|^2.
    fn supply(&self) -> f64 {
        self.certificate.disturbance_weight * self.disturbance_bound.powi(2)
    }
}
