//! The metrics of a run, as data: requirements, the summary, the tables and the pages read this list.
//!
//! A new metric is a row of [`METRICS`], and what it reads is set where it is measured.

use schemars::JsonSchema;
use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};
use synth::claim::Claim;

use super::bound_utilisation::BoundUtilisation;
use super::effort::Effort;
use super::events::EventCount;
use super::link::LinkOutcome;
use crate::base::number::short_or_none;

/// What a run measured, under the keys of its summary. `None`: the run does not have it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Messages sent.
    pub triggers: u64,
    /// Changes of the torque that acts.
    pub updates: u64,
    /// Bits sent.
    pub bits: u64,
    /// Bytes sent, each message rounded up to whole bytes.
    pub bytes: u64,
    /// First instant of the integration from which on the error stays within the tolerance, s: never before it does.
    pub settle_seconds: Option<f64>,
    /// When the error came within the tolerance for good, s: between two instants of the integration, as the root of the
    /// error's interpolation there; at the jump where the reference jumps.
    #[serde(default)]
    pub settle_crossing_s: Option<f64>,
    /// Attitude error at the end, deg.
    pub final_error_deg: Option<f64>,
    /// Root mean square of the attitude error over the tail, deg.
    pub rms_error_deg: Option<f64>,
    /// Largest attitude error over the tail, deg.
    #[serde(default)]
    pub tail_error_deg: Option<f64>,
    /// Norm of the state at the end, for a plant other than a spacecraft.
    pub final_state_norm: Option<f64>,
    /// Root mean square of the norm of the state over the tail, for a plant other than a spacecraft.
    pub rms_state_norm: Option<f64>,
    /// Largest norm of the body rate, rad/s.
    pub max_rate: Option<f64>,
    /// Largest torque of any axis, N m.
    pub max_torque: f64,
    /// Integral over time of the magnitudes of all axes' torques, N m s.
    pub impulse: f64,
    /// Fraction of the run in which a torque acted.
    #[serde(default)]
    pub on_time_share: f64,
    /// Times the actuators were turned on, for a controller that turns them off.
    #[serde(default)]
    pub turn_ons: Option<u64>,
    /// Times they were turned off.
    #[serde(default)]
    pub turn_offs: Option<u64>,
    /// Steps at which a claim of the controller's certificate was broken or its error was outside of its
    /// prescribed bounds; zero without either.
    pub violations: u64,
}

impl Measured {
    /// What every plant measures in a run of `duration_s` seconds; the rest is `None`.
    pub fn of<const M: usize>(events: &EventCount, effort: &Effort<M>, duration_s: f64) -> Self {
        Self {
            triggers: events.triggers,
            updates: effort.updates,
            bits: events.bits,
            bytes: events.bytes,
            max_torque: effort.max_torque,
            impulse: effort.impulse,
            on_time_share: effort.on_s / duration_s,
            ..Self::default()
        }
    }
}

/// All that a metric may read.
#[derive(Debug, Clone, Copy)]
pub struct Readings<'a> {
    /// What the run measured.
    pub measured: &'a Measured,
    /// Shortest and mean time between two messages, s.
    pub intervals_s: [Option<f64>; 2],
    /// Largest x'Ux over its bound, for a design.
    pub lyapunov_ratio: Option<f64>,
    /// Use of the prescribed bounds on the error.
    pub funnel: Option<&'a BoundUtilisation>,
    /// What the trigger watches over its threshold.
    pub threshold: Option<&'a BoundUtilisation>,
    /// The link to the actuators.
    pub link: Option<&'a LinkOutcome>,
}

/// What a metric is about; a comparison lists metrics in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MetricKind {
    /// When the error settles.
    Settling,
    /// The attitude error.
    Pointing,
    /// The state of another plant than a spacecraft.
    State,
    /// The motion of the body.
    Motion,
    /// The torque; the input of another plant, with units of its own.
    Effort,
    /// How often what acts changes.
    Switching,
    /// What is sent.
    Messages,
    /// Use of what is prescribed or proved.
    Usage,
    /// The link to the actuators.
    Link,
}

/// A metric as data.
#[derive(Debug)]
pub struct MetricEntry {
    /// Which.
    pub metric: Metric,
    /// Its key in every file.
    pub key: &'static str,
    /// Its unit, that of a spacecraft; empty for none.
    pub unit: &'static str,
    /// What it is, as text.
    pub label: &'static str,
    /// What it is about.
    pub kind: MetricKind,
    /// Whether it is a whole number.
    pub whole: bool,
    /// Whether pages and text list it among the numbers of a run of its plant.
    pub listed: bool,
    /// Whether a comparison has it.
    pub compared: bool,
    /// Its value; `None` when the run does not have it.
    pub read: fn(&Readings) -> Option<f64>,
}

impl MetricEntry {
    /// Its label as the head of a line: capitalised, with the unit.
    pub fn title(&self) -> String {
        let mut letters = self.label.chars();
        let first = letters.next().map(|letter| letter.to_ascii_uppercase());
        let title: String = first.into_iter().chain(letters).collect();
        match self.unit {
            "" => title,
            unit => format!("{title} ({unit})"),
        }
    }

    /// A value as text, `none` without one. The time from which on a run is settled is rounded up.
    pub fn text(&self, value: Option<f64>) -> String {
        match (value, self.kind) {
            (Some(count), _) if self.whole => count.to_string(),
            (Some(seconds), MetricKind::Settling) => Claim::AtMost(seconds).to_string(),
            (value, _) => short_or_none(value),
        }
    }
}

fn count(value: u64) -> Option<f64> {
    Some(value as f64)
}

/// Makes the enum of the metrics and their list, both in the order of the rows. A row: the words for
/// the schema, the name, the key, the unit, the label, the kind, attributes (`whole`, `listed`,
/// `compared`) and how it is read.
macro_rules! metrics {
    ($($(#[doc = $doc:literal])+
        $name:ident $key:literal [$unit:literal] $label:literal $kind:ident
        { $($attribute:ident),* } $read:expr;)+) => {
        /// What can be required. A metric that a run does not have (such as the settling time of a run that
        /// does not settle) misses its requirement.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
        pub enum Metric {
            $($(#[doc = $doc])+ #[serde(rename = $key)] $name,)+
        }

        /// Every metric, in the order of the columns of a campaign.
        pub const METRICS: &[MetricEntry] = &[
            $(MetricEntry {
                $($attribute: true,)*
                ..MetricEntry {
                    metric: Metric::$name,
                    key: $key,
                    unit: $unit,
                    label: $label,
                    kind: MetricKind::$kind,
                    whole: false,
                    listed: false,
                    compared: false,
                    read: $read,
                }
            },)+
        ];
    };
}

metrics! {
    /// Messages sent.
    Triggers "triggers" [""] "messages" Messages { whole, compared } |r| count(r.measured.triggers);
    /// Changes of the torque that acts.
    Updates "updates" [""] "torque updates" Switching { whole, compared } |r| count(r.measured.updates);
    /// Bits sent.
    Bits "bits" [""] "bits sent" Messages { whole, compared } |r| count(r.measured.bits);
    /// Bytes sent.
    Bytes "bytes" [""] "bytes sent" Messages { whole, compared } |r| count(r.measured.bytes);
    /// Time from which on the error stays within the tolerance (s).
    SettleSeconds "settle_seconds" ["s"] "settled from" Settling { compared }
        |r| r.measured.settle_seconds;
    /// Attitude error at the end (deg).
    FinalErrorDeg "final_error_deg" ["deg"] "final error" Pointing { listed, compared }
        |r| r.measured.final_error_deg;
    /// Root mean square of the attitude error over the tail (deg).
    RmsErrorDeg "rms_error_deg" ["deg"] "rms error over the tail" Pointing { listed, compared }
        |r| r.measured.rms_error_deg;
    /// Largest attitude error over the tail (deg).
    TailErrorDeg "tail_error_deg" ["deg"] "largest error over the tail" Pointing {}
        |r| r.measured.tail_error_deg;
    /// Norm of the state at the end.
    FinalStateNorm "final_state_norm" [""] "norm of the final state" State { listed }
        |r| r.measured.final_state_norm;
    /// Root mean square of the norm of the state over the tail.
    RmsStateNorm "rms_state_norm" [""] "rms norm over the tail" State { listed }
        |r| r.measured.rms_state_norm;
    /// Largest norm of the body rate [rad/s].
    MaxRate "max_rate" ["rad/s"] "largest rate" Motion { listed, compared } |r| r.measured.max_rate;
    /// Largest torque of any axis [N m].
    MaxTorque "max_torque" ["N m"] "largest torque" Effort { listed, compared }
        |r| Some(r.measured.max_torque);
    /// Integral of the magnitudes of all axes' torques [N m s].
    Impulse "impulse" ["N m s"] "impulse" Effort { listed, compared } |r| Some(r.measured.impulse);
    /// Steps at which a claim of the controller's certificate was broken or its error was outside of its
    /// prescribed bounds.
    Violations "violations" [""] "steps outside of a bound" Usage { whole }
        |r| count(r.measured.violations);
    /// Shortest time between two messages (s).
    ShortestIntervalS "shortest_interval_s" ["s"] "shortest time between messages" Messages { compared }
        |r| r.intervals_s[0];
    /// Mean time between two messages (s).
    MeanIntervalS "mean_interval_s" ["s"] "mean time between messages" Messages { compared }
        |r| r.intervals_s[1];
    /// Largest x'Ux over its bound, for a design.
    LyapunovRatio "lyapunov_ratio" [""] "largest x'Ux over its bound" Usage {} |r| r.lyapunov_ratio;
    /// Largest share of the prescribed bounds on the error, for a controller that has them; 1 is at the
    /// edge.
    FunnelRatio "funnel_ratio" [""] "largest share of prescribed bounds" Usage { compared }
        |r| Some(r.funnel?.largest_ratio);
    /// Largest ratio of what the trigger watches to its threshold, for a controller that watches it.
    ThresholdRatio "threshold_ratio" [""] "largest trigger over its threshold" Usage {}
        |r| Some(r.threshold?.largest_ratio);
    /// Messages on the link to the actuators.
    LinkMessages "link_messages" [""] "messages on the link" Link { whole } |r| count(r.link?.messages);
    /// Words on the link to the actuators: one for each axis that is sent something.
    LinkWords "link_words" [""] "words on the link" Link { whole } |r| count(r.link?.words);
    /// Bits on the link to the actuators.
    LinkBits "link_bits" [""] "bits on the link" Link { whole } |r| count(r.link?.bits);
    /// Longest time for which the two ends of the link held different torques (s).
    LinkLongestDisagreementS "link_longest_disagreement_s" ["s"] "longest disagreement of the link's ends" Link {}
        |r| Some(r.link?.longest_disagreement_s);
    /// Times the actuators were turned on, for a controller that turns them off.
    TurnOns "turn_ons" [""] "times turned on" Switching { whole } |r| count(r.measured.turn_ons?);
    /// Times they were turned off.
    TurnOffs "turn_offs" [""] "times turned off" Switching { whole } |r| count(r.measured.turn_offs?);
    /// Share of the run in which a torque acts.
    OnTimeShare "on_time_share" [""] "share of the time with a torque" Switching {}
        |r| Some(r.measured.on_time_share);
}

impl Metric {
    /// Its row of [`METRICS`], which has the metrics in their order.
    pub fn entry(self) -> &'static MetricEntry {
        &METRICS[self as usize]
    }

    /// Its name as files have it.
    pub fn key(self) -> &'static str {
        self.entry().key
    }
}

/// A metric with the value that a run has.
pub type MetricValue = (Metric, Option<f64>);

/// Writes metrics as a map by their keys, whole numbers as such.
///
/// # Errors
/// Those of the serializer.
pub fn by_key<S: Serializer>(metrics: &[MetricValue], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(metrics.len()))?;
    for (metric, value) in metrics {
        match value {
            Some(value) if metric.entry().whole => {
                map.serialize_entry(metric.key(), &(*value as u64))?
            }
            value => map.serialize_entry(metric.key(), value)?,
        }
    }
    map.end()
}

/// The limit of a requirement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// The metric must not be above this.
    AtMost(f64),
    /// The metric must not be below this.
    AtLeast(f64),
}

impl Limit {
    /// Its side as files have it, and its value.
    pub fn parts(self) -> (&'static str, f64) {
        match self {
            Limit::AtMost(limit) => ("at most", limit),
            Limit::AtLeast(limit) => ("at least", limit),
        }
    }

    /// Whether a value is on its allowed side; a missing one is not.
    pub fn is_met(self, value: Option<f64>) -> bool {
        value.is_some_and(|value| match self {
            Limit::AtMost(limit) => value <= limit,
            Limit::AtLeast(limit) => value >= limit,
        })
    }

    /// How far a value is on the allowed side, in units of the limit where that is not 0; minus
    /// infinity for a missing one.
    pub fn margin(self, value: Option<f64>) -> f64 {
        let margin = value.map(|value| match self {
            Limit::AtMost(limit) => limit - value,
            Limit::AtLeast(limit) => value - limit,
        });
        let scale = match self.parts().1 {
            0.0 => 1.0,
            limit => limit.abs(),
        };
        let margin = margin.map(|margin| margin / scale);
        margin
            .filter(|margin| !margin.is_nan())
            .unwrap_or(f64::NEG_INFINITY)
    }
}

/// The metrics of a comparison in the order of its table.
pub fn compared() -> Vec<&'static MetricEntry> {
    let mut entries: Vec<_> = METRICS.iter().filter(|entry| entry.compared).collect();
    entries.sort_by_key(|entry| entry.kind);
    entries
}

/// The metrics that are listed for a run of a spacecraft, or of another plant.
pub fn listed(spacecraft: bool) -> impl Iterator<Item = &'static MetricEntry> {
    METRICS.iter().filter(move |entry| {
        let fits = match entry.kind {
            MetricKind::Pointing | MetricKind::Motion => spacecraft,
            MetricKind::State => !spacecraft,
            _ => true,
        };
        entry.listed && fits
    })
}
