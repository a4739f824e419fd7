//! How far a search came, and what stops it there.

use serde::Serialize;
use synth::synthesis::{LimitingFactors, Sensitivity};

use super::blocking::titled;

/// What a search reached where that is not what was requested.
#[derive(Debug, Serialize)]
pub struct ShortfallReport<'a> {
    /// Why, in one sentence with its numbers.
    pub reason: &'a str,
    /// The largest scale s so that s times every requested state is in a set that is proved.
    scale: Option<f64>,
    /// The angle there (deg).
    angle_deg: Option<f64>,
    /// What would change the outcome most, largest first.
    limits: Vec<LimitingFactor<'a>>,
}

/// How the outcome depends on a number of the model.
#[derive(Debug, Serialize)]
struct LimitingFactor<'a> {
    /// The number, with its unit.
    what: &'a str,
    /// Its value.
    value: f64,
    /// By how much per cent the outcome gets better when the number grows by 1 %.
    percent_per_percent: f64,
}

impl<'a> ShortfallReport<'a> {
    /// From the outcome of a search.
    pub fn new(shortfall: &'a LimitingFactors) -> Self {
        let limit = |limit: &'a Sensitivity| LimitingFactor {
            what: &limit.what,
            value: limit.value,
            percent_per_percent: limit.per_cent,
        };
        ShortfallReport {
            reason: &shortfall.reason,
            scale: shortfall.scale,
            angle_deg: shortfall.angle_deg,
            limits: shortfall.limits.iter().map(limit).collect(),
        }
    }

    /// The limiting factors in words.
    pub fn lines(&self) -> Vec<String> {
        let title = "what holds it back (1 % more of the number changes the outcome by so much):";
        let limits = self.limits.iter().map(|limit| {
            format!(
                "  {:+.3} %  {}, now {}",
                limit.percent_per_percent, limit.what, limit.value
            )
        });
        titled(title, limits)
    }
}
