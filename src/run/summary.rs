//! The summary of a run: what scripts and the report read.

use std::ops::Deref;

use serde::{Deserialize, Serialize};
use synth::claim::Claim;
use synth::model::{check_version, parse, FileError, Kind};

use crate::base::number::short;
use crate::plants::SystemKind;
use crate::scenario::RequirementFile;
use crate::sim::bound_utilisation::BoundUtilisation;
use crate::sim::link::LinkOutcome;
use crate::sim::metrics::{Limit, Measured, Metric, Readings, METRICS};
use crate::sim::network::NetworkOutcome;

/// The version of the summary's format.
pub const SUMMARY_SCHEMA_VERSION: u32 = 1;

/// The answer of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunVerdict {
    /// Every requirement is met and no proved bound was broken.
    RequirementsMet,
    /// Some requirement is missed.
    RequirementsMissed,
    /// The state became infinite.
    Diverged,
    /// A bound that is proved for this run was broken: the proof or the program is wrong.
    ProofBroken,
}

impl RunVerdict {
    /// Every verdict, the worst first.
    pub const ALL: [RunVerdict; 4] = [
        RunVerdict::ProofBroken,
        RunVerdict::Diverged,
        RunVerdict::RequirementsMissed,
        RunVerdict::RequirementsMet,
    ];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            RunVerdict::RequirementsMet => "requirements_met",
            RunVerdict::RequirementsMissed => "requirements_missed",
            RunVerdict::Diverged => "diverged",
            RunVerdict::ProofBroken => "proof_broken",
        }
    }

    /// The verdict of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|known| known.name() == name)
    }

    /// Its place among all, the worst first.
    pub fn severity(self) -> usize {
        let place = Self::ALL.into_iter().position(|known| known == self);
        place.unwrap_or(0)
    }

    /// As a sentence.
    pub fn sentence(self) -> &'static str {
        match self {
            RunVerdict::RequirementsMet => "Every requirement is met.",
            RunVerdict::RequirementsMissed => "A requirement is missed.",
            RunVerdict::Diverged => "The run diverged.",
            RunVerdict::ProofBroken => {
                "A PROVED BOUND WAS BROKEN: the proof or the program is wrong. Do not use this design."
            }
        }
    }
}

/// The summary. A metric that the run does not have is null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// Name of the scenario.
    pub scenario: String,
    /// Where its numbers come from.
    pub source: String,
    /// Kind of the system.
    pub system: SystemKind,
    /// The controller as text.
    pub controller: String,
    /// The answer.
    pub verdict: RunVerdict,
    /// What was measured.
    #[serde(flatten)]
    pub measured: Measured,
    /// The requirements with their outcome.
    pub requirements: Vec<RequirementOutcome>,
    /// Samples that reached the controller.
    pub samples: u64,
    /// Integration steps.
    pub steps: u64,
    /// Shortest time between two messages, s.
    pub shortest_interval_s: Option<f64>,
    /// Mean time between two messages, s.
    pub mean_interval_s: Option<f64>,
    /// Messages sent per second of the run.
    #[serde(default)]
    pub triggers_per_s: f64,
    /// What the sampling allows: no two messages are closer, s; null when the trigger is watched
    /// continuously.
    #[serde(default)]
    pub min_inter_event_s: Option<f64>,
    /// Its inverse, 1/s.
    #[serde(default)]
    pub max_transmissions_per_s: Option<f64>,
    /// Samples that the controller could not use.
    pub held_samples: u64,
    /// The first reason for that.
    pub first_hold: Option<String>,
    /// Samples outside of the box of the controller's model, as the flight code saw them.
    pub samples_outside_box: u64,
    /// Samples later than the design allows.
    pub late_samples: u64,
    /// Largest difference of a membership from that at the sample sent last.
    pub largest_membership_mismatch: Option<f64>,
    /// What became of the design's certificate.
    pub certificate: Option<CertificateOutcome>,
    /// What the link to the actuators carried, where there is one.
    #[serde(default)]
    pub link: Option<LinkOutcome>,
    /// What the network of the controller's messages did, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<NetworkOutcome>,
    /// Use of the prescribed bounds on the error, for a controller that has them.
    #[serde(default)]
    pub funnel: Option<BoundUtilisation>,
    /// What the trigger watches over its threshold, for a controller that watches it.
    #[serde(default)]
    pub threshold: Option<BoundUtilisation>,
    /// What else is worth saying.
    pub notes: Vec<String>,
    /// Numbers the figures need.
    pub scales: Scales,
    /// What made this.
    pub provenance: RunProvenance,
}

/// A requirement and its outcome.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RequirementOutcome {
    /// The metric and the side of the limit.
    pub name: String,
    /// The metric's value; null when the run does not have it.
    pub value: Option<f64>,
    /// The limit.
    pub limit: f64,
    /// Whether it is met.
    pub met: bool,
}

impl RequirementOutcome {
    /// The requirement and the value, with its unit.
    pub fn as_text(&self) -> String {
        let value = self.value_as_text();
        let text = format!("{} {}: {value} {}", self.name, self.limit, self.unit());
        text.trim_end().to_string()
    }

    /// Unit of the value; empty without one or without a value.
    fn unit(&self) -> &'static str {
        let key = self.name.split(' ').next().unwrap_or_default();
        let entry = METRICS.iter().find(|entry| entry.key == key);
        let entry = entry.filter(|_| self.value.is_some());
        entry.map_or("", |entry| entry.unit)
    }

    /// The value, or `none`, rounded towards the limit. Rounding never puts it on the limit or on its other side.
    pub fn value_as_text(&self) -> String {
        let Some(value) = self.value else {
            return "none".to_string();
        };
        let (up, down) = (Claim::AtMost(value), Claim::AtLeast(value));
        let (safe, other) = match value < self.limit {
            true => (up, down),
            false => (down, up),
        };
        let safe = safe.to_string();
        let same_side =
            |shown: f64| shown.partial_cmp(&self.limit) == value.partial_cmp(&self.limit);
        match safe.parse().is_ok_and(same_side) {
            true => safe,
            false => other.to_string(),
        }
    }
}

/// What became of the design's certificate in the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CertificateOutcome {
    /// Whether the design is proved, checked from its numbers before the run.
    pub proved: bool,
    /// The condition with the smallest margin.
    pub worst_condition: Option<String>,
    /// Its margin.
    pub worst_margin: Option<f64>,
    /// Whether the proof covers this run.
    pub covers_run: bool,
    /// Why it does not.
    pub not_covered: Vec<String>,
    /// What of the run's imperfections lies within the bounds that were proved, each with both numbers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub covered: Vec<String>,
    /// x'Ux at the start; the certified set is x'Ux <= 1.
    pub start_level: f64,
    /// Largest x'Ux over its bound e^(-phi t) V(0) + (1 - e^(-phi t)) r / phi.
    pub largest_lyapunov_ratio: f64,
    /// When that was, s.
    pub largest_lyapunov_ratio_at_s: f64,
    /// Steps above the bound.
    pub bound_broken_steps: u64,
    /// Steps above the invariant level k2 or outside of the box.
    pub outside_steps: u64,
    /// First time above the invariant level k2, s.
    pub left_invariant_set_s: Option<f64>,
    /// First time outside of the box of the model, s.
    pub left_box_s: Option<f64>,
    /// sup|y|, in units of the output.
    pub peak_output: f64,
    /// sup|tau|, N m.
    pub peak_disturbance: f64,
    /// sup|y| / sup|tau|; a lower bound of the gain when the run starts at rest in the origin.
    pub peak_ratio: Option<f64>,
    /// Whether the run starts in the origin, so that the ratio must stay below the gain bounds.
    pub from_rest_in_origin: bool,
    /// gamma of the design; null where it is not proved.
    pub gamma: Option<f64>,
    /// The design's sharper bound; null where it is not proved.
    pub guaranteed_gain: Option<f64>,
    /// r / phi: xi taubar^2 / phi for an ideal loop.
    pub ultimate_level: f64,
    /// What is proved of sup|y| from rest.
    #[serde(default, skip_serializing_if = "OutputBound::is_gain")]
    pub output_bound: OutputBound,
    /// What became of the inner certificate, for a design with two. The claims above are then those of
    /// the outer one; gamma and the guaranteed gain are the inner one's, which holds at the origin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inner: Option<InnerOutcome>,
}

/// What is proved of sup|y| of a run from rest.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OutputBound {
    /// It is at most the guaranteed gain times sup|tau|.
    #[default]
    Gain,
    /// It is at most this: not only the disturbance moves the state.
    Peak(f64),
    /// Nothing.
    None,
}

impl OutputBound {
    fn is_gain(&self) -> bool {
        *self == OutputBound::Gain
    }
}

/// What became of the inner certificate of a design with two.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InnerOutcome {
    /// First sample at which the state and the state sent last were in the inner set x'Ux <= 1, or the outer set's x'Ux at
    /// most a proved hand-over level, s; the inner claims hold from there on.
    pub entered_s: Option<f64>,
    /// Time by which the design proves that; null where it does not.
    #[serde(default)]
    pub hand_over_s: Option<f64>,
    /// Whether the run came there later than is proved, the proof covering it from its start.
    #[serde(default)]
    pub late: bool,
    /// Whether the proof covers the run from there on.
    pub covered: bool,
    /// x'Ux there.
    pub level_at_entry: Option<f64>,
    /// Largest x'Ux over its bound from there on.
    pub largest_lyapunov_ratio: f64,
    /// When that was, s.
    pub largest_lyapunov_ratio_at_s: f64,
    /// Steps above the bound.
    pub bound_broken_steps: u64,
    /// Steps above the invariant level or outside of the inner box.
    pub outside_steps: u64,
    /// sup|y| from there on.
    pub peak_output: f64,
    /// r / phi: xi taubar^2 / phi for an ideal loop.
    pub ultimate_level: f64,
    /// gamma of the inner certificate; null where it is not proved.
    pub gamma: Option<f64>,
    /// Its sharper bound; null where it is not proved.
    pub guaranteed_gain: Option<f64>,
}

/// Numbers the figures need.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// Length of the run, s.
    pub duration_s: f64,
    /// Torque limits, N m.
    pub torque_limit: Vec<f64>,
    /// Settling tolerance, deg (norm of the state for another plant).
    pub settle_tolerance: f64,
    /// Settling tolerance of the components of the error quaternion's vector part, where it is on them.
    #[serde(default)]
    pub settle_tolerance_component: Option<f64>,
    /// Length of the tail, s.
    pub tail_s: f64,
}

/// What made a summary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunProvenance {
    /// Program and version.
    pub generator: String,
    /// SHA-256 of the scenario file.
    pub scenario_sha256: String,
    /// SHA-256 of the design file.
    pub design_sha256: Option<String>,
    /// Generator of random numbers.
    pub random_generator: String,
    /// Its seed.
    pub seed: u64,
    /// Integrator as text.
    pub integrator: String,
}

/// What was measured reads as the summary's own, as it does in its file.
impl Deref for Summary {
    type Target = Measured;

    fn deref(&self) -> &Measured {
        &self.measured
    }
}

impl Summary {
    /// Reads the text of a summary.
    ///
    /// # Errors
    /// A text that is no summary, or one of another version.
    pub fn from_json(text: &str) -> Result<Self, FileError> {
        let summary: Self = parse(text, Kind::Summary)?;
        check_version(summary.schema_version, SUMMARY_SCHEMA_VERSION)?;
        Ok(summary)
    }

    /// The value of a metric; `None` when the run does not have it.
    pub fn metric(&self, metric: Metric) -> Option<f64> {
        let certificate = self.certificate.as_ref();
        (metric.entry().read)(&Readings {
            measured: &self.measured,
            intervals_s: [self.shortest_interval_s, self.mean_interval_s],
            lyapunov_ratio: certificate.map(|outcome| outcome.largest_lyapunov_ratio),
            funnel: self.funnel.as_ref(),
            threshold: self.threshold.as_ref(),
            link: self.link.as_ref(),
        })
    }

    /// That the run did not settle although no requirement is missed for it, in a sentence; `None` where it did or
    /// where a requirement says so.
    pub fn unsettled(&self) -> Option<String> {
        if self.settle_seconds.is_some() || self.verdict != RunVerdict::RequirementsMet {
            return None;
        }
        let tolerance = match self.scales.settle_tolerance_component {
            Some(tolerance) => format!("{tolerance} in every component"),
            None if self.system == SystemKind::RigidBody => {
                format!("{} deg", short(self.scales.settle_tolerance))
            }
            None => short(self.scales.settle_tolerance),
        };
        let largest = self.tail_error_deg.map(Claim::AtMost);
        let largest = largest.map_or(String::new(), |error| {
            format!(
                ", the largest error of its last {} s is {error} deg",
                self.scales.tail_s
            )
        });
        Some(format!(
            "The run did not settle within {tolerance}{largest}; no requirement asks for it."
        ))
    }

    /// Judges the requirements and then the run. `broken`: a proved bound was broken.
    pub fn judge(&mut self, requirements: &[RequirementFile], diverged: bool, broken: bool) {
        self.requirements = requirements
            .iter()
            .map(|requirement| self.outcome(requirement))
            .collect();
        self.verdict = if broken {
            RunVerdict::ProofBroken
        } else if diverged {
            RunVerdict::Diverged
        } else if self.requirements.iter().all(|outcome| outcome.met) {
            RunVerdict::RequirementsMet
        } else {
            RunVerdict::RequirementsMissed
        };
    }

    fn outcome(&self, requirement: &RequirementFile) -> RequirementOutcome {
        let value = self.metric(requirement.metric);
        let required = requirement.limit();
        let (side, limit) = required.unwrap_or(Limit::AtMost(f64::INFINITY)).parts();
        RequirementOutcome {
            name: format!("{} {side}", requirement.metric.key()),
            value,
            limit,
            met: required.is_none_or(|limit| limit.is_met(value)),
        }
    }
}
