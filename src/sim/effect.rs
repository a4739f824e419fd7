//! Effects on the torque of actuators.

use nalgebra::SVector;

/// What changes the torque of the actuators, within their limits, before it acts.
pub trait Effect<const M: usize> {
    /// Changes the torque that is given from `time_s` on, N m.
    fn change(&mut self, time_s: f64, torque: &mut SVector<f64, M>);

    /// The actuators gave this torque for `span_s` seconds.
    fn acted(&mut self, _span_s: f64, _torque: &SVector<f64, M>) {}

    /// Times at which it begins or ends, s.
    fn discontinuities_s(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// A fault of one axis in a window of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Axis, from zero.
    pub axis: usize,
    /// Start of the window, s.
    pub from_s: f64,
    /// End of the window, s.
    pub until_s: f64,
    /// Fraction of the commanded torque that acts: 1 is healthy, 0 is dead. A torque that acts on top is
    /// part of the disturbance.
    pub effectiveness: f64,
}

impl<const M: usize> Effect<M> for Fault {
    fn change(&mut self, time_s: f64, torque: &mut SVector<f64, M>) {
        if (self.from_s..self.until_s).contains(&time_s) {
            torque[self.axis] *= self.effectiveness;
        }
    }

    fn discontinuities_s(&self) -> Vec<f64> {
        vec![self.from_s, self.until_s]
    }
}
