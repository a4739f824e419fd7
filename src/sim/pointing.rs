//! How far the state is from where it should be: settling time, error over the tail of the run, peaks.

use super::lyapunov::exceeds;

/// Error of a run. Small errors are compared through their squares; only the tail takes a square root
/// or an arc tangent.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorStatistics {
    tolerance_squared: f64,
    tail_from_s: f64,
    outside: bool,
    last_outside_s: f64,
    tail_squares: f64,
    tail_peak_square: f64,
    tail_s: f64,
}

impl ErrorStatistics {
    /// Settled means a magnitude of at most `tolerance`; the root mean square is taken from
    /// `tail_from_s` seconds on.
    pub fn new(tolerance: f64, tail_from_s: f64) -> Self {
        Self {
            tolerance_squared: tolerance * tolerance,
            tail_from_s,
            outside: true,
            last_outside_s: 0.0,
            tail_squares: 0.0,
            tail_peak_square: 0.0,
            tail_s: 0.0,
        }
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
        self.outside = exceeds(magnitude_squared, self.tolerance_squared);
        if self.outside {
            self.last_outside_s = time_s;
        }
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
        self.outside = exceeds(magnitude_squared, self.tolerance_squared);
    }

    /// The last time outside of the tolerance, s (zero when never); `None` when the run ends outside.
    pub fn settle_seconds(&self) -> Option<f64> {
        (!self.outside).then_some(self.last_outside_s)
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
    fn settling_is_the_last_time_outside() {
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
        assert_eq!(error.settle_seconds(), Some(2.0));
        let expected = ((0.04 + 0.16) / 2.0_f64).sqrt();
        assert!((error.tail_rms().unwrap() - expected).abs() < 1e-15);
        assert_eq!(error.tail_peak(), Some(0.4));
        error.record(6.0, 1.0, 9.0, || 9.0);
        assert_eq!(error.settle_seconds(), None);
        error.record(7.0, 1.0, f64::NAN, || f64::NAN);
        assert_eq!(error.settle_seconds(), None);
        assert_eq!(error.tail_rms(), None);
        assert_eq!(error.tail_peak(), None);
    }
}
