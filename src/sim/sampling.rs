//! When the sensor is sampled.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::random::{Purpose, Random};
use crate::base::bounded::{As, NonNegative, Positive, Resolution};

/// When the sensor is sampled: the first time at time zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Instants {
    /// At multiples of an interval, each shifted by a uniform jitter.
    Periodic {
        /// Interval, above 0 (s).
        #[serde(with = "As::<Positive>")]
        interval_s: f64,
        /// Largest shift of an instant either way, below half of the interval (s).
        #[serde(default, with = "As::<NonNegative>")]
        jitter_s: f64,
    },
    /// At random intervals, uniform between two bounds: Xu and Huang 2020, (9).
    Aperiodic {
        /// Shortest interval, above 0 (s).
        #[serde(with = "As::<Positive>")]
        shortest_s: f64,
        /// Longest interval, not below the shortest (s).
        #[serde(with = "As::<Positive>")]
        longest_s: f64,
    },
    /// No sampling: the trigger is watched continuously, and a sample is taken where it fires, found as a
    /// root. Needs exact sensors and the fixed-step integrator.
    Continuous {
        /// Width of the interval of time in which an event is known to lie, at least 1e-9 (s).
        #[serde(with = "As::<Resolution>")]
        resolution_s: f64,
    },
}

impl Instants {
    /// Number of samples expected in `duration_s` seconds; `None` when the trigger is watched continuously.
    pub fn expected_samples(&self, duration_s: f64) -> Option<f64> {
        let mean_s = match *self {
            Instants::Periodic { interval_s, .. } => interval_s,
            Instants::Aperiodic {
                shortest_s,
                longest_s,
            } => 0.5 * (shortest_s + longest_s),
            Instants::Continuous { .. } => return None,
        };
        Some(duration_s / mean_s)
    }

    /// Longest interval between two samples that are not lost; `None` when there is no bound.
    pub fn longest_interval_s(&self) -> Option<f64> {
        match *self {
            Instants::Periodic {
                interval_s,
                jitter_s,
            } => Some(interval_s + 2.0 * jitter_s),
            Instants::Aperiodic { longest_s, .. } => Some(longest_s),
            Instants::Continuous { .. } => None,
        }
    }
}

/// Sampling instants and lost samples of one run.
#[derive(Clone, Debug)]
pub struct Sampling {
    instants: Instants,
    dropout_probability: f64,
    index: u64,
    instants_random: Random,
    dropout_random: Random,
}

impl Sampling {
    /// The sequence for a scenario's seed. The probability that a sample is lost is in [0, 1).
    pub fn new(instants: Instants, dropout_probability: f64, seed: u64) -> Self {
        Self {
            instants,
            dropout_probability,
            index: 0,
            instants_random: Random::new(seed, Purpose::Sampling),
            dropout_random: Random::new(seed, Purpose::Dropout),
        }
    }

    /// The rule.
    pub fn instants(&self) -> &Instants {
        &self.instants
    }

    /// The instant after the one at `time_s`, s; infinite when the trigger is watched continuously.
    #[inline]
    pub fn after(&mut self, time_s: f64) -> f64 {
        self.index += 1;
        match self.instants {
            Instants::Periodic {
                interval_s,
                jitter_s,
            } => {
                let shift = if jitter_s > 0.0 {
                    jitter_s * (2.0 * self.instants_random.uniform() - 1.0)
                } else {
                    0.0
                };
                self.index as f64 * interval_s + shift
            }
            Instants::Aperiodic {
                shortest_s,
                longest_s,
            } => time_s + shortest_s + (longest_s - shortest_s) * self.instants_random.uniform(),
            Instants::Continuous { .. } => f64::INFINITY,
        }
    }

    /// Whether the sample at hand is lost.
    #[inline]
    pub fn lost(&mut self) -> bool {
        self.dropout_probability > 0.0 && self.dropout_random.uniform() < self.dropout_probability
    }
}
