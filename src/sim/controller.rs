//! The flight controllers behind one trait.

use nalgebra::SVector;
use runtime::command::Command;
use runtime::lei2022::SwitchCount;

/// What is true at a sample, before the controller's step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth<'a, const M: usize> {
    /// Time, s.
    pub time_s: f64,
    /// State of the plant.
    pub state: &'a [f64],
    /// Disturbance, with everything that acts whatever is commanded.
    pub disturbance: &'a [f64],
    /// What the actuators have been commanded last, as far as the controller's end of the link knows: a lost
    /// word makes them hold something else.
    pub held: SVector<f64, M>,
    /// What acts on the plant because of it.
    pub acting: SVector<f64, M>,
}

/// An event-triggered controller that takes measurements `T` and commands `M` axes.
pub trait Controller<T, const M: usize> {
    /// Takes the sample at `time_s` seconds.
    fn step(&mut self, time_s: f64, measurement: &T) -> Command<M>;

    /// Given before each step what no sensor measures. Only for controllers that are tried with perfect
    /// knowledge of something, or beside whose output an encoder works.
    fn observe_truth(&mut self, _truth: &Truth<M>) {}

    /// Whether this sample would be sent; the controller is unchanged.
    fn would_send(&self, time_s: f64, measurement: &T) -> bool;

    /// The largest difference of a membership at this sample and at the one sent last (the kappa of
    /// Xu and Huang 2020, Theorem 2); `None` without fuzzy rules.
    fn membership_mismatch(&self, _measurement: &T) -> Option<f64> {
        None
    }

    /// Names, with units, of what the controller shows of itself: columns of the trajectory.
    fn signal_names(&self) -> &'static [&'static str] {
        &[]
    }

    /// The values of the signals at the true state, in the order of their names.
    fn signals(&self, _time_s: f64, _truth: &T, _values: &mut [f64]) {}

    /// The largest fraction of the prescribed bounds on its error that the true state uses, 1 at the edge;
    /// `None` without such bounds.
    fn funnel_ratio(&self, _time_s: f64, _truth: &T) -> Option<f64> {
        None
    }

    /// What the trigger watches over its threshold at the true state, 1 where it should fire; `None`
    /// where that is not watched.
    fn threshold_ratio(&self, _time_s: f64, _truth: &T) -> Option<f64> {
        None
    }

    /// How often the actuators were switched; `None` for a controller that never turns them off.
    fn switch_count(&self) -> Option<SwitchCount> {
        None
    }
}

/// What is done with a controller whose type is chosen at run time: the rest of the program is compiled once
/// for each type, so that the closed loop calls it without indirection.
pub trait Use<T, const M: usize> {
    /// The outcome.
    type Output;

    /// Takes the controller.
    fn with<C: Controller<T, M>>(self, controller: C) -> Self::Output;
}
