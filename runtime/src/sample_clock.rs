//! Time of the last usable sample.

use crate::command::HoldReason;

/// Refuses times that are not finite or not later than the last accepted one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SampleClock {
    last_s: Option<f64>,
}

impl SampleClock {
    /// Interval since the last accepted sample in s; `None` at the first.
    pub(crate) fn interval(&self, time_s: f64) -> Result<Option<f64>, HoldReason> {
        if !time_s.is_finite() {
            return Err(HoldReason::NonFiniteTime);
        }
        match self.last_s {
            Some(last_s) if time_s <= last_s => {
                Err(HoldReason::TimeNotIncreasing { last_s, time_s })
            }
            Some(last_s) => Ok(Some(time_s - last_s)),
            None => Ok(None),
        }
    }

    /// Time of the last accepted sample, s.
    pub(crate) fn last_s(&self) -> Option<f64> {
        self.last_s
    }

    /// Makes `time_s` the time of the last usable sample.
    pub(crate) fn accept(&mut self, time_s: f64) {
        self.last_s = Some(time_s);
    }
}
