//! Watches the inner certificate of a design with two.
//!
//! It holds from the first sample on at which the state and the state sent last both lie in the inner
//! set: the functional equals x'Ux at a sample, and the command held there is bounded through the state
//! sent last.

use nalgebra::SVector;

use super::summary::InnerOutcome;
use crate::sim::lyapunov::{Claims, LyapunovMonitor};

/// What a run did with the inner certificate's claims.
#[derive(Clone, Debug, PartialEq)]
pub struct InnerMonitor<const N: usize> {
    /// The claims from the entry on; before it, of no meaning but x'Ux.
    pub monitor: LyapunovMonitor<N>,
    /// When the claims began to hold, s.
    pub entered_s: Option<f64>,
    sent_level: f64,
    disturbance_squared: f64,
}

impl<const N: usize> InnerMonitor<N> {
    /// Monitor before the start.
    pub fn new(claims: Claims<N>) -> Self {
        Self {
            monitor: LyapunovMonitor::new(claims),
            entered_s: None,
            sent_level: f64::INFINITY,
            disturbance_squared: 0.0,
        }
    }

    /// The initial state.
    pub fn start(&mut self, state: &SVector<f64, N>, disturbance_squared: f64) {
        self.monitor.level = self.monitor.claims().level(state);
        self.disturbance_squared = disturbance_squared;
    }

    /// A sample that reached the controller, and whether it was sent.
    pub fn sample(&mut self, time_s: f64, state: &SVector<f64, N>, sent: bool) {
        if self.entered_s.is_some() {
            return;
        }
        let level = self.monitor.claims().level(state);
        if sent {
            self.sent_level = level;
        }
        if level <= 1.0 && self.sent_level <= 1.0 {
            self.entered_s = Some(time_s);
            self.monitor.start(state, self.disturbance_squared);
        }
    }

    /// The state at the end of a step.
    #[inline]
    pub fn step(
        &mut self,
        time_s: f64,
        step_s: f64,
        state: &SVector<f64, N>,
        disturbance_squared: f64,
    ) {
        self.disturbance_squared = disturbance_squared;
        match self.entered_s {
            Some(_) => self
                .monitor
                .step(time_s, step_s, state, disturbance_squared),
            None => self.monitor.level = self.monitor.claims().level(state),
        }
    }

    /// x'Ux now, and its bound: not a number before the entry.
    pub fn columns(&self) -> [f64; 2] {
        let bound = match self.entered_s {
            Some(_) => self.monitor.bound(),
            None => f64::NAN,
        };
        [self.monitor.level, bound]
    }

    /// What is to be said of the run; `covered` when the proof covers it but for its start; `gains` are gamma and the
    /// guaranteed gain, where they are proved.
    pub fn outcome(&self, covered: bool, gains: [Option<f64>; 2]) -> InnerOutcome {
        let monitor = &self.monitor;
        let [gamma, guaranteed_gain] = gains;
        InnerOutcome {
            entered_s: self.entered_s,
            covered,
            level_at_entry: self.entered_s.map(|_| monitor.start_level),
            largest_lyapunov_ratio: monitor.largest_ratio,
            largest_lyapunov_ratio_at_s: monitor.largest_ratio_s,
            bound_broken_steps: monitor.bound_broken,
            outside_steps: monitor.outside,
            peak_output: monitor.output_squared.sqrt(),
            ultimate_level: monitor.claims().ultimate_level,
            gamma,
            guaranteed_gain,
        }
    }
}

impl InnerOutcome {
    /// True when the proof covers the run from the entry on and the run broke it.
    pub fn broken(&self) -> bool {
        self.covered && self.violations() > 0
    }

    /// Steps at which a claim was broken.
    pub fn violations(&self) -> u64 {
        self.bound_broken_steps.max(self.outside_steps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix1, Vector1};

    fn claims() -> Claims<1> {
        Claims {
            lyapunov: Matrix1::new(1.0),
            decay_rate: 0.5,
            ultimate_level: 0.2,
            start_level: 1.0,
            networked: false,
            disturbance_bound: 1.0,
            bounds: Vec::new(),
            component_bounds: Vector1::repeat(f64::INFINITY),
            vector_part_bound: None,
            output: None,
        }
    }

    #[test]
    fn the_claims_begin_when_the_state_and_the_one_sent_last_are_in_the_set() {
        let mut monitor = InnerMonitor::new(claims());
        let at = |x: f64| Vector1::new(x);
        monitor.start(&at(2.0), 0.0);
        monitor.sample(0.0, &at(2.0), true);
        monitor.step(1.0, 1.0, &at(0.9), 0.0);
        // The command still comes from the state outside.
        monitor.sample(1.0, &at(0.9), false);
        assert_eq!(monitor.entered_s, None);
        assert!(monitor.columns()[1].is_nan());
        monitor.step(2.0, 1.0, &at(0.8), 0.0);
        monitor.sample(2.0, &at(0.8), true);
        assert_eq!(monitor.entered_s, Some(2.0));
        // 0.64 e^(-t/2) + 0.2 (1 - e^(-t/2)) one second later.
        monitor.step(3.0, 1.0, &at(0.6), 0.0);
        let bound = 0.2 + 0.44 * (-0.5_f64).exp();
        assert!((monitor.columns()[1] - bound).abs() < 1e-12);
        assert_eq!(monitor.outcome(true, [Some(1.0); 2]).violations(), 0);
        monitor.step(3.1, 0.1, &at(0.8), 0.0);
        assert_eq!(monitor.outcome(true, [Some(1.0); 2]).violations(), 1);
        assert!(monitor.outcome(true, [Some(1.0); 2]).broken());
        assert!(!monitor.outcome(false, [Some(1.0); 2]).broken());
    }
}
