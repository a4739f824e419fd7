//! The metrics that a requirement may be about.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What can be required. A metric that a run does not have (such as the settling time of a run that
/// does not settle) misses its requirement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Messages sent.
    Triggers,
    /// Changes of the torque that acts.
    Updates,
    /// Bits sent.
    Bits,
    /// Bytes sent.
    Bytes,
    /// Time from which on the error stays within the tolerance (s).
    SettleSeconds,
    /// Attitude error at the end (deg).
    FinalErrorDeg,
    /// Root mean square of the attitude error over the tail (deg).
    RmsErrorDeg,
    /// Largest attitude error over the tail (deg).
    TailErrorDeg,
    /// Norm of the state at the end.
    FinalStateNorm,
    /// Root mean square of the norm of the state over the tail.
    RmsStateNorm,
    /// Largest norm of the body rate [rad/s].
    MaxRate,
    /// Largest torque of any axis [N m].
    MaxTorque,
    /// Integral of the magnitudes of all axes' torques [N m s].
    Impulse,
    /// Steps at which a claim of the controller's certificate was broken or its error was outside of its
    /// prescribed bounds.
    Violations,
    /// Shortest time between two messages (s).
    ShortestIntervalS,
    /// Mean time between two messages (s).
    MeanIntervalS,
    /// Largest x'Ux over its bound, for a design.
    LyapunovRatio,
    /// Largest share of the prescribed bounds on the error, for a controller that has them; 1 is at the
    /// edge.
    FunnelRatio,
    /// Largest ratio of what the trigger watches to its threshold, for a controller that watches it.
    ThresholdRatio,
    /// Messages on the link to the actuators.
    LinkMessages,
    /// Words on the link to the actuators: one for each axis that is sent something.
    LinkWords,
    /// Bits on the link to the actuators.
    LinkBits,
    /// Longest time for which the two ends of the link held different torques (s).
    LinkLongestDisagreementS,
    /// Times the actuators were turned on, for a controller that turns them off.
    TurnOns,
    /// Times they were turned off.
    TurnOffs,
    /// Share of the run in which a torque acts.
    OnTimeShare,
}

/// The name of a metric as files have it.
pub fn metric_name(metric: Metric) -> String {
    let value = serde_json::to_value(metric).ok();
    let name = value.as_ref().and_then(|value| value.as_str());
    name.unwrap_or_default().to_string()
}
