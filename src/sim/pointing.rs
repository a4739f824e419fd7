//! How far the state is from where it should be: settling time, error over the tail of the run, peaks.

use super::lyapunov::exceeds;

/// Error of a run. Small errors are compared through their squares; only the tail takes a square root
/// or an arc tangent.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorStatistics {
    tolerance_squared: f64,
    tail_from_s: f64,
    jumps_s: Vec<f64>,
    /// Square of the magnitude at the end of the last step.
    last_square: f64,
    settled: Option<Settled>,
    tail_squares: f64,
    tail_peak_square: f64,
    tail_s: f64,
}

/// When the error came within its tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Settled {
    /// End of the step in which it did, s.
    from_s: f64,
    /// The root in that step, s.
    crossing_s: f64,
}

impl ErrorStatistics {
    /// Settled means a magnitude of at most `tolerance`; the root mean square is taken from
    /// `tail_from_s` seconds on.
    pub fn new(tolerance: f64, tail_from_s: f64) -> Self {
        Self {
            tolerance_squared: tolerance * tolerance,
            tail_from_s,
            jumps_s: Vec::new(),
            last_square: f64::INFINITY,
            settled: None,
            tail_squares: 0.0,
            tail_peak_square: 0.0,
            tail_s: 0.0,
        }
    }

    /// With the times at which the error jumps, s: it has no root there.
    pub fn with_jumps(self, jumps_s: Vec<f64>) -> Self {
        Self { jumps_s, ..self }
    }

    /// Takes the squared magnitude at the end of a step of `step_s`, and for the tail the squared
    /// error in the unit of the root mean square.
    #[inline]
    pub fn record(
        &mut self,
        time_s: f64,
        step_s: f64,
        magnitude_squared: f64,
        tail_square: impl FnOnce() -> f64,
    ) {
        // A magnitude that is not a number counts as outside.
        if exceeds(magnitude_squared, self.tolerance_squared) {
            self.settled = None;
        } else if self.settled.is_none() {
            self.settled = Some(self.settled_in(time_s, step_s, magnitude_squared));
        }
        self.last_square = magnitude_squared;
        if time_s > self.tail_from_s {
            let square = tail_square();
            self.tail_squares += step_s * square;
            if exceeds(square, self.tail_peak_square) {
                self.tail_peak_square = square;
            }
            self.tail_s += step_s;
        }
    }

    /// Whether the initial magnitude is settled already.
    pub fn start(&mut self, magnitude_squared: f64) {
        let inside = !exceeds(magnitude_squared, self.tolerance_squared);
        self.settled = inside.then_some(Settled {
            from_s: 0.0,
            crossing_s: 0.0,
        });
        self.last_square = magnitude_squared;
    }

    /// The step that ends at `time_s` within the tolerance and begins outside.
    fn settled_in(&self, time_s: f64, step_s: f64, magnitude_squared: f64) -> Settled {
        let [before, tolerance, after] =
            [self.last_square, self.tolerance_squared, magnitude_squared].map(f64::sqrt);
        // Over one step of the integration the magnitude is a line up to the step's square.
        let rest = (tolerance - after) / (before - after);
        let smooth = rest.is_finite() && !self.jumps_s.contains(&time_s);
        Settled {
            from_s: time_s,
            crossing_s: match smooth {
                true => time_s - step_s * rest,
                false => time_s,
            },
        }
    }

    /// End of the first step from which on every step ends within the tolerance, s (zero when the start is and no step
    /// ends outside); `None` when the run ends outside.
    pub fn settle_seconds(&self) -> Option<f64> {
        self.settled.map(|settled| settled.from_s)
    }

    /// When the magnitude came within the tolerance for good, s, by linear interpolation between the ends of a step.
    pub fn settle_crossing_s(&self) -> Option<f64> {
        self.settled.map(|settled| settled.crossing_s)
    }

    /// Largest error over the tail, in the unit of the root mean square.
    pub fn tail_peak(&self) -> Option<f64> {
        let peak = self.tail_peak_square.sqrt();
        (self.tail_s > 0.0 && peak.is_finite()).then_some(peak)
    }

    /// Root mean square over the tail, weighted by time.
    pub fn tail_rms(&self) -> Option<f64> {
        let mean = self.tail_squares / self.tail_s;
        (self.tail_s > 0.0 && mean.is_finite()).then(|| mean.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settling_is_the_first_time_inside_for_good() {
        let mut error = ErrorStatistics::new(1.0, 3.0);
        error.start(4.0);
        for (time, magnitude) in [
            (1.0, 0.5_f64),
            (2.0, 1.5),
            (3.0, 0.9),
            (4.0, 0.2),
            (5.0, 0.4),
        ] {
            error.record(time, 1.0, magnitude * magnitude, || magnitude * magnitude);
        }
        assert_eq!(error.settle_seconds(), Some(3.0));
        // From 1.5 at 2 s to 0.9 at 3 s.
        let crossing = error.settle_crossing_s().unwrap();
        assert!((crossing - (2.0 + 0.5 / 0.6)).abs() < 1e-12, "{crossing}");
        let expected = ((0.04 + 0.16) / 2.0_f64).sqrt();
        assert!((error.tail_rms().unwrap() - expected).abs() < 1e-15);
        assert_eq!(error.tail_peak(), Some(0.4));
        error.record(6.0, 1.0, 9.0, || 9.0);
        assert_eq!(error.settle_seconds(), None);
        assert_eq!(error.settle_crossing_s(), None);
        error.record(7.0, 1.0, f64::NAN, || f64::NAN);
        assert_eq!(error.settle_seconds(), None);
        assert_eq!(error.tail_rms(), None);
        assert_eq!(error.tail_peak(), None);
    }
    #[test]
    fn a_jump_into_the_tolerance_is_where_it_settles() {
        let settled = |jumps_s: Vec<f64>| {
            let mut error = ErrorStatistics::new(1.0, 3.0).with_jumps(jumps_s);
            error.start(9.0);
            error.record(2.0, 2.0, 0.25, || 0.25);
            error.settle_crossing_s()
        };
        // From 3 to 0.5 over 2 s.
        assert_eq!(settled(vec![1.0]), Some(1.6));
        assert_eq!(settled(vec![1.0, 2.0]), Some(2.0));
    }

    #[test]
    fn a_start_inside_is_settled_from_zero_on() {
        let mut error = ErrorStatistics::new(1.0, 3.0);
        error.start(0.25);
        error.record(1.0, 1.0, 0.5, || 0.5);
        assert_eq!(error.settle_seconds(), Some(0.0));
        assert_eq!(error.settle_crossing_s(), Some(0.0));
    }
}
