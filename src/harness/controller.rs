//! The flight controllers behind one trait.

use nalgebra::SVector;
use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;
use runtime::membership::Membership;
use runtime::{wu2018, xu2020};

/// An event-triggered controller that takes measurements `T` and commands `M` axes.
pub trait Controller<T, const M: usize> {
    /// Takes the sample at `time_s` seconds.
    fn step(&mut self, time_s: f64, measurement: &T) -> Command<M>;

    /// Whether this sample would be sent; the controller stays as it is.
    fn would_send(&self, time_s: f64, measurement: &T) -> bool;

    /// The largest difference of a membership at this sample and at the one sent last (the kappa of
    /// Xu and Huang 2020, Theorem 2); `None` without fuzzy rules.
    fn membership_mismatch(&self, _measurement: &T) -> Option<f64> {
        None
    }
}

impl Controller<AttitudeMeasurement, 3> for wu2018::Controller {
    #[inline]
    fn step(&mut self, time_s: f64, measurement: &AttitudeMeasurement) -> Command<3> {
        self.step(time_s, measurement)
    }

    fn would_send(&self, time_s: f64, measurement: &AttitudeMeasurement) -> bool {
        let mut trial = *self;
        trial.step(time_s, measurement).sent
    }
}

/// Xu and Huang's controller on attitude measurements.
#[derive(Clone, Copy, Debug)]
pub struct XuAttitude<S, const R: usize> {
    /// The flight code.
    pub controller: xu2020::Controller<S, 6, 3, R>,
    sent_weights: Option<[f64; R]>,
}

impl<S: Membership<6, R>, const R: usize> XuAttitude<S, R> {
    /// The controller before its first sample.
    pub fn new(controller: xu2020::Controller<S, 6, 3, R>) -> Self {
        Self {
            controller,
            sent_weights: None,
        }
    }
}

impl<S: Membership<6, R> + Copy, const R: usize> Controller<AttitudeMeasurement, 3>
    for XuAttitude<S, R>
{
    #[inline]
    fn step(&mut self, time_s: f64, measurement: &AttitudeMeasurement) -> Command<3> {
        let state = measurement.rigid_body_state();
        let command = self.controller.step(time_s, &state);
        if command.sent && R > 1 {
            self.sent_weights = Some(self.controller.law().membership().weights(&state));
        }
        command
    }

    fn would_send(&self, time_s: f64, measurement: &AttitudeMeasurement) -> bool {
        let mut trial = *self;
        trial.step(time_s, measurement).sent
    }

    fn membership_mismatch(&self, measurement: &AttitudeMeasurement) -> Option<f64> {
        let sent = self.sent_weights?;
        let state = measurement.rigid_body_state();
        let now = self.controller.law().membership().weights(&state);
        let differences = now.iter().zip(&sent).map(|(a, b)| (a - b).abs());
        Some(differences.fold(0.0, f64::max))
    }
}

/// Xu and Huang's controller on a padded state of any size.
#[derive(Clone, Copy, Debug)]
pub struct XuState<S, const N: usize, const M: usize, const R: usize> {
    controller: xu2020::Controller<S, N, M, R>,
    message_bytes: usize,
    sent_weights: Option<[f64; R]>,
}

impl<S: Membership<N, R>, const N: usize, const M: usize, const R: usize> XuState<S, N, M, R> {
    /// The controller for `states` states, padded to `N`.
    pub fn new(controller: xu2020::Controller<S, N, M, R>, states: usize) -> Self {
        Self {
            controller,
            message_bytes: runtime::command::BYTES_PER_NUMBER * states,
            sent_weights: None,
        }
    }
}

impl<S: Membership<N, R> + Copy, const N: usize, const M: usize, const R: usize>
    Controller<SVector<f64, N>, M> for XuState<S, N, M, R>
{
    fn step(&mut self, time_s: f64, measurement: &SVector<f64, N>) -> Command<M> {
        let mut command = self.controller.step(time_s, measurement);
        if command.sent {
            command.bytes = self.message_bytes;
            if R > 1 {
                let membership = self.controller.law().membership();
                self.sent_weights = Some(membership.weights(measurement));
            }
        }
        command
    }

    fn would_send(&self, time_s: f64, measurement: &SVector<f64, N>) -> bool {
        let mut trial = *self;
        trial.step(time_s, measurement).sent
    }

    fn membership_mismatch(&self, measurement: &SVector<f64, N>) -> Option<f64> {
        let sent = self.sent_weights?;
        let now = self.controller.law().membership().weights(measurement);
        let differences = now.iter().zip(&sent).map(|(a, b)| (a - b).abs());
        Some(differences.fold(0.0, f64::max))
    }
}

/// A controller chosen at run time.
pub type AnyController<T, const M: usize> = Box<dyn Controller<T, M>>;

impl<T, const M: usize> Controller<T, M> for AnyController<T, M> {
    fn step(&mut self, time_s: f64, measurement: &T) -> Command<M> {
        self.as_mut().step(time_s, measurement)
    }

    fn would_send(&self, time_s: f64, measurement: &T) -> bool {
        self.as_ref().would_send(time_s, measurement)
    }

    fn membership_mismatch(&self, measurement: &T) -> Option<f64> {
        self.as_ref().membership_mismatch(measurement)
    }
}
