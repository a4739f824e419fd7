//! Watches the inner certificate of a design with two.
//!
//! It holds from the first sample on at which the state and the state sent last both lie in the inner
//! set: the functional equals x'Ux at a sample, and the command held there is bounded through the state
//! sent last. Where the design proves a hand-over it holds from the first sample on at which x'Ux of the outer set is at
//! most the hand-over level, whatever was sent last; and that sample comes in time.

use nalgebra::{SMatrix, SVector};

use super::summary::InnerOutcome;
use crate::sim::lyapunov::{Claims, LyapunovMonitor, ROUNDING};

/// A proved hand-over from the outer set to the inner one.
#[derive(Clone, Debug, PartialEq)]
pub struct HandOverClaim<const N: usize> {
    /// U of the outer set; `None` where messages may be late or lost, so that the functional is never x'Ux alone and the claims
    /// begin when the time has come.
    pub lyapunov: Option<SMatrix<f64, N, N>>,
    /// x'Ux of the outer set at which the inner certificate holds.
    pub level: f64,
    /// Time by which every certified start has come there (s).
    pub latest_s: f64,
}

/// What a run did with the inner certificate's claims.
#[derive(Clone, Debug, PartialEq)]
pub struct InnerMonitor<const N: usize> {
    /// The claims from the entry on; before it, of no meaning but x'Ux.
    pub monitor: LyapunovMonitor<N>,
    /// When the claims began to hold, s.
    pub entered_s: Option<f64>,
    hand_over: Option<HandOverClaim<N>>,
    /// The last sample, s.
    last_s: f64,
    sent_level: f64,
    disturbance_squared: f64,
}

impl<const N: usize> InnerMonitor<N> {
    /// Monitor before the start.
    pub fn new(claims: Claims<N>, hand_over: Option<HandOverClaim<N>>) -> Self {
        Self {
            monitor: LyapunovMonitor::new(claims),
            entered_s: None,
            hand_over,
            last_s: 0.0,
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
        self.last_s = time_s;
        let level = self.monitor.claims().level(state);
        if sent {
            self.sent_level = level;
        }
        let networked = self.monitor.claims().networked;
        let in_small = !networked && level <= 1.0 && self.sent_level <= 1.0;
        let handed_over = self.hand_over.as_ref();
        let handed_over = handed_over.is_some_and(|claim| match claim.lyapunov {
            Some(outer) => (state.transpose() * outer * state)[(0, 0)] <= claim.level,
            None => time_s >= claim.latest_s,
        });
        if in_small || handed_over {
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

    /// Whether the entry came later than the hand-over allows, or is missing although it was due.
    fn is_late(&self) -> bool {
        let claim = self.hand_over.as_ref();
        let claim = claim.filter(|claim| claim.lyapunov.is_some());
        let came = self.entered_s.unwrap_or(self.last_s);
        claim.is_some_and(|claim| came > claim.latest_s * (1.0 + ROUNDING))
    }

    /// What is to be said of the run; `covered` when the proof covers it but for its start, and whether it covers that too;
    /// `gains` are gamma and the guaranteed gain, where they are proved.
    pub fn outcome(
        &self,
        [covered, from_start]: [bool; 2],
        gains: [Option<f64>; 2],
    ) -> InnerOutcome {
        let monitor = &self.monitor;
        let [gamma, guaranteed_gain] = gains;
        InnerOutcome {
            entered_s: self.entered_s,
            hand_over_s: self.hand_over.as_ref().map(|claim| claim.latest_s),
            late: from_start && self.is_late(),
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
        self.late || self.covered && self.violations() > 0
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
        let mut monitor = InnerMonitor::new(claims(), None);
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
        assert_eq!(monitor.outcome([true; 2], [Some(1.0); 2]).violations(), 0);
        monitor.step(3.1, 0.1, &at(0.8), 0.0);
        assert_eq!(monitor.outcome([true; 2], [Some(1.0); 2]).violations(), 1);
        assert!(monitor.outcome([true; 2], [Some(1.0); 2]).broken());
        assert!(!monitor.outcome([false; 2], [Some(1.0); 2]).broken());
    }

    #[test]
    fn a_hand_over_starts_the_claims_with_whatever_was_sent_and_has_to_come_in_time() {
        let hand_over = HandOverClaim {
            lyapunov: Some(Matrix1::new(0.01)),
            level: 0.005,
            latest_s: 1.5,
        };
        let at = |x: f64| Vector1::new(x);
        let mut monitor = InnerMonitor::new(claims(), Some(hand_over.clone()));
        monitor.start(&at(2.0), 0.0);
        monitor.sample(0.0, &at(2.0), true);
        monitor.step(1.0, 1.0, &at(0.9), 0.0);
        assert_eq!(monitor.entered_s, None);
        // 0.01 0.7^2 is below the level; the command is still that of the state outside.
        monitor.sample(1.0, &at(0.7), false);
        assert_eq!(monitor.entered_s, Some(1.0));
        assert!(!monitor.outcome([true; 2], [None; 2]).broken());

        let mut late = InnerMonitor::new(claims(), Some(hand_over));
        late.start(&at(2.0), 0.0);
        late.sample(1.6, &at(2.0), true);
        assert!(late.outcome([true; 2], [None; 2]).broken());
        assert!(!late.outcome([true, false], [None; 2]).late);
    }
}
