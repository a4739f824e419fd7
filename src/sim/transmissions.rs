//! How close two transmissions can be.
//!
//! The trigger is evaluated at samples only, so two transmissions are never closer than two samples.
//! Nothing longer holds for every run: near rest the threshold, which is relative to the state sent last,
//! vanishes with it, and a disturbance can make every sample trigger.

use serde::Serialize;
use synth::claim::Claim;
use synth::model::Model;

use super::sampling::Instants;

/// The bound that the sampling of a design gives.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TransmissionBound {
    /// No two transmissions are closer than this, s.
    pub min_inter_event_s: f64,
    /// Its inverse: at most this many transmissions per second in the long run. In any T seconds there
    /// are at most 1 + T times as many.
    pub max_transmissions_per_s: f64,
}

impl TransmissionBound {
    /// The bound for a shortest sampling interval, above 0 (s).
    pub fn new(shortest_s: f64) -> Self {
        TransmissionBound {
            min_inter_event_s: shortest_s,
            max_transmissions_per_s: 1.0 / shortest_s,
        }
    }

    /// The bound of a model's sampling; `None` when the model gives no shortest interval.
    pub fn of_model(model: &Model) -> Option<Self> {
        model.sampling_interval_min().map(Self::new)
    }

    /// The bound of a scenario's sampling; `None` when the trigger is watched continuously.
    pub fn of_instants(instants: &Instants) -> Option<Self> {
        let shortest = match *instants {
            Instants::Periodic {
                interval_s,
                jitter_s,
            } => interval_s - 2.0 * jitter_s,
            Instants::Aperiodic { shortest_s, .. } => shortest_s,
            Instants::Continuous { .. } => return None,
        };
        (shortest > 0.0).then(|| Self::new(shortest))
    }

    /// As a sentence.
    pub fn describe(&self) -> String {
        format!(
            "transmissions: at least {} s apart, so at most {} per second (the shortest sampling interval)",
            Claim::AtLeast(self.min_inter_event_s),
            Claim::AtMost(self.max_transmissions_per_s)
        )
    }
}
