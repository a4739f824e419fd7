//! How much of a bound a run uses.

use serde::{Deserialize, Serialize};

use super::lyapunov::exceeds;

/// The largest fraction of a bound that was used, and when the bound was left.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoundUtilisation {
    /// Largest fraction; 1 is at the bound, more is outside.
    pub largest_ratio: f64,
    /// When that was, s.
    pub largest_ratio_at_s: f64,
    /// Steps outside of the bound.
    pub outside_steps: u64,
    /// First time outside, s.
    pub first_outside_s: Option<f64>,
}

impl Default for BoundUtilisation {
    fn default() -> Self {
        Self {
            largest_ratio: f64::NEG_INFINITY,
            largest_ratio_at_s: 0.0,
            outside_steps: 0,
            first_outside_s: None,
        }
    }
}

impl BoundUtilisation {
    /// Takes the fraction at `time_s`, where there is one. A share that is not a number is outside.
    #[inline]
    pub fn record(usage: &mut Option<Self>, time_s: f64, ratio: Option<f64>) {
        let Some(ratio) = ratio else {
            return;
        };
        let usage = usage.get_or_insert_with(Self::default);
        if exceeds(ratio, 1.0) {
            usage.outside_steps += 1;
            usage.first_outside_s.get_or_insert(time_s);
        }
        if exceeds(ratio, usage.largest_ratio) {
            // A summary holds finite numbers only.
            usage.largest_ratio = if ratio.is_finite() { ratio } else { f64::MAX };
            usage.largest_ratio_at_s = time_s;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_share_and_the_first_exit_are_kept() {
        let mut usage = None;
        BoundUtilisation::record(&mut usage, 0.0, None);
        assert_eq!(usage, None);
        for (time, ratio) in [(1.0, 0.5), (2.0, 1.5), (3.0, 1.2), (4.0, 1.0)] {
            BoundUtilisation::record(&mut usage, time, Some(ratio));
        }
        let expected = BoundUtilisation {
            largest_ratio: 1.5,
            largest_ratio_at_s: 2.0,
            outside_steps: 2,
            first_outside_s: Some(2.0),
        };
        assert_eq!(usage, Some(expected));
    }

    #[test]
    fn a_share_that_is_no_number_is_outside() {
        let mut usage = None;
        BoundUtilisation::record(&mut usage, 1.0, Some(f64::NAN));
        let usage = usage.unwrap();
        assert_eq!((usage.outside_steps, usage.largest_ratio), (1, f64::MAX));
    }
}
