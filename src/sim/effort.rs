//! What the actuators did.

use nalgebra::SVector;

/// Torque of a run, for `M` axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Effort<const M: usize> {
    /// Largest torque of any axis, N m.
    pub max_torque: f64,
    /// Integral over time of the magnitudes of all axes, N m s.
    pub impulse: f64,
    /// Time in which a torque acted, s.
    pub on_s: f64,
    /// Times at which the torque that acts changed.
    pub updates: u64,
    last: SVector<f64, M>,
}

impl<const M: usize> Effort<M> {
    /// Nothing yet: no torque acts.
    pub fn new() -> Self {
        Self {
            max_torque: 0.0,
            impulse: 0.0,
            on_s: 0.0,
            updates: 0,
            last: SVector::zeros(),
        }
    }

    /// This torque acts from now on.
    #[inline]
    pub fn begin(&mut self, torque: &SVector<f64, M>) {
        if *torque != self.last {
            self.updates += 1;
            self.last = *torque;
            self.max_torque = self.max_torque.max(torque.amax());
        }
    }

    /// The torque acted for `span_s` seconds.
    #[inline]
    pub fn end(&mut self, span_s: f64, torque: &SVector<f64, M>) {
        let magnitude = torque.iter().map(|value| value.abs()).sum::<f64>();
        self.impulse += span_s * magnitude;
        if magnitude != 0.0 {
            self.on_s += span_s;
        }
    }
}

impl<const M: usize> Default for Effort<M> {
    fn default() -> Self {
        Self::new()
    }
}
