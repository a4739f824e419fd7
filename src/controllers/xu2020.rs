//! The controller of Xu and Huang 2020, with given gains.

use nalgebra::SVector;
use nalgebra::{Matrix3x6, Matrix6, Vector3, Vector6};
use runtime::attitude::AttitudeMeasurement;
use runtime::command::{Command, HoldReason};
use runtime::error::ParameterError;
use runtime::membership::{GaussianRules, Membership};
use runtime::trigger::{Adaptation, ThresholdUpdate};
use runtime::xu2020;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::{check_matrix, check_positive_definite, ModelError};

use super::law::{AttitudeLaw, Flown, LawFile, Surroundings};
use crate::base::bounded::{plain, As, BelowOne, Finite, NonNegative, Positive};
use crate::base::ranges::require;
use crate::plants::RigidBodySystem;
use crate::sim::controller::{Controller, Use};
use crate::sim::events::EventCount;

/// Law (12) and trigger (10) of Xu and Huang 2020 with given gains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct XuFile {
    /// The fuzzy rules, 1 to 8, with Gaussian memberships about their centres.
    pub rules: Vec<RuleFile>,
    /// Standard deviation of the membership functions in each state, above 0 [rad/s, then 1].
    pub widths: [Positive; 6],
    /// The trigger weight Upsilon, 6 x 6, symmetric positive definite.
    pub trigger_weight: [[f64; 6]; 6],
    /// The threshold nu.
    pub threshold: ThresholdFile,
    /// Absolute part eps_a of the trigger, in the unit of e' Upsilon e, not negative.
    #[serde(default, skip_serializing_if = "is_zero", with = "As::<NonNegative>")]
    pub trigger_floor: f64,
    /// Largest torque of each axis, above 0 [N m].
    pub torque_limit_nm: [Positive; 3],
    /// Longest sampling interval of the design, above 0 (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_interval_s: Option<Positive>,
    /// What the paper claims for these gains. It is compared with the run; it is not proved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published_claim: Option<ClaimFile>,
}

/// A fuzzy rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RuleFile {
    /// State [body rate (rad/s), vector part of the error quaternion] that the rule is about.
    pub centre: [Finite; 6],
    /// Gain F_j, 3 x 6.
    pub gain: [[Finite; 6]; 3],
}

/// The threshold of the trigger, in [0, 1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ThresholdFile {
    /// It never changes.
    Fixed {
        /// nu.
        nu: BelowOne,
    },
    /// The published update between two bounds.
    Clamped {
        /// Smallest and first threshold.
        nu_min: BelowOne,
        /// Largest threshold, not below the smallest.
        nu_max: BelowOne,
        /// mu_1, mu_2, mu_3, each not negative.
        mu: [NonNegative; 3],
    },
    /// The published update, bounded from below only.
    UnclampedAsPublished {
        /// Smallest and first threshold.
        nu_min: BelowOne,
        /// mu_1, mu_2, mu_3, each not negative.
        mu: [NonNegative; 3],
    },
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// A claim of a paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClaimFile {
    /// gamma, above 0.
    pub gain_bound: Positive,
    /// phi, above 0 [1/s].
    pub decay_rate_per_s: Positive,
    /// kappa: the largest membership mismatch that the conditions assume, above 0.
    pub membership_mismatch: Positive,
}

/// Most rules of a fuzzy controller.
pub const MAX_RULES: usize = 8;

impl LawFile for XuFile {
    type Law = XuFile;

    fn check(&self, _: &RigidBodySystem) -> Result<XuFile, ModelError> {
        let count = self.rules.len();
        if !(1..=MAX_RULES).contains(&count) {
            let expected = format!("1 to {MAX_RULES} rules");
            return Err(ModelError::shape(
                "rules",
                format!("{count} rules"),
                expected,
            ));
        }
        let field = "trigger_weight";
        let rows = self.trigger_weight.map(|row| row.to_vec());
        let weight = check_matrix(field, &rows, (Some(6), Some(6)))?;
        check_positive_definite(field, &weight)?;
        if let ThresholdFile::Clamped { nu_min, nu_max, .. } = &self.threshold {
            let field = "threshold.clamped.nu_max";
            require(nu_min <= nu_max, field, nu_max.get(), "nu_min or above")?;
        }
        Ok(self.clone())
    }
}

impl AttitudeLaw for XuFile {
    fn name(&self) -> String {
        "Xu and Huang 2020, law (12) and trigger (10) with given gains".to_string()
    }

    fn torque_limit(&self) -> Vector3<f64> {
        plain(&self.torque_limit_nm).into()
    }

    fn build<U: Use<AttitudeMeasurement, 3>>(
        &self,
        _: &Surroundings,
        then: U,
    ) -> Result<U::Output, ParameterError> {
        match self.rules.len() {
            1 => self.with_rules::<1, U>(then),
            2 => self.with_rules::<2, U>(then),
            3 => self.with_rules::<3, U>(then),
            4 => self.with_rules::<4, U>(then),
            5 => self.with_rules::<5, U>(then),
            6 => self.with_rules::<6, U>(then),
            7 => self.with_rules::<7, U>(then),
            _ => self.with_rules::<MAX_RULES, U>(then),
        }
    }

    fn notes(&self, flown: &Flown) -> Vec<String> {
        notes(self, flown.start.rigid_body_state().norm(), flown.events)
    }
}

impl XuFile {
    /// Hands on the controller with exactly `R` rules; the caller has counted them.
    fn with_rules<const R: usize, U: Use<AttitudeMeasurement, 3>>(
        &self,
        then: U,
    ) -> Result<U::Output, ParameterError> {
        let gain = |rule: &RuleFile| Matrix3x6::from_fn(|r, c| rule.gain[r][c].get());
        let centres = std::array::from_fn(|rule| plain(&self.rules[rule].centre).into());
        let controller = xu2020::Controller::new(xu2020::Parameters {
            gains: std::array::from_fn::<_, R, _>(|rule| gain(&self.rules[rule])),
            membership: GaussianRules::new(centres, plain(&self.widths).into())?,
            trigger_weight: Matrix6::from_fn(|r, c| self.trigger_weight[r][c]),
            threshold_update: self.threshold.update(),
            torque_limit: self.torque_limit(),
            trigger_floor: self.trigger_floor,
            longest_interval_s: self.longest_interval_s.map(Positive::get),
        })?;
        Ok(then.with(XuInLoop::new(controller, 6)))
    }
}

/// What is to be said of gains that come from a paper.
fn notes(choice: &XuFile, start_norm: f64, events: &EventCount) -> Vec<String> {
    let mut notes = vec![
        "The gains and the trigger weight are given, not synthesized: nothing is proved for this run."
            .to_string(),
    ];
    if matches!(choice.threshold, ThresholdFile::UnclampedAsPublished { .. }) {
        notes.push(
            "The trigger's threshold is not clamped: no certificate can cover it.".to_string(),
        );
    }
    let Some(claim) = &choice.published_claim else {
        return notes;
    };
    // (20) with C = I: U >= I / (gamma phi), so |x|^2 <= gamma phi x'Ux.
    let radius = (claim.gain_bound.get() * claim.decay_rate_per_s.get()).sqrt();
    let place = if start_norm > radius {
        "is not in the certified set"
    } else {
        "may be in the certified set"
    };
    notes.push(format!(
        "The start {place}: |x| is {start_norm:.4}, and (20) with the claimed gamma = {} and \
         phi = {} /s confines the set to |x| <= {radius:.4}.",
        claim.gain_bound, claim.decay_rate_per_s
    ));
    notes.push(format!(
        "The claimed gamma = {} is not confirmed: the conditions as printed do not prove it, and a run \
         cannot.",
        claim.gain_bound
    ));
    if let Some(mismatch) = events.largest_mismatch {
        let relation = if mismatch > claim.membership_mismatch.get() {
            "does not hold"
        } else {
            "holds"
        };
        notes.push(format!(
            "The assumption |zeta_i - zeta_ik| <= {} {relation} in this run: the largest difference is \
             {mismatch:.4}.",
            claim.membership_mismatch
        ));
    }
    notes
}

impl ThresholdFile {
    fn update(&self) -> ThresholdUpdate {
        match self {
            ThresholdFile::Fixed { nu } => ThresholdUpdate::Fixed {
                threshold: nu.get(),
            },
            ThresholdFile::Clamped { nu_min, nu_max, mu } => ThresholdUpdate::Clamped {
                adaptation: adaptation(mu),
                minimum: nu_min.get(),
                maximum: nu_max.get(),
            },
            ThresholdFile::UnclampedAsPublished { nu_min, mu } => {
                ThresholdUpdate::UnclampedAsPublished {
                    adaptation: adaptation(mu),
                    minimum: nu_min.get(),
                }
            }
        }
    }
}

fn adaptation(mu: &[NonNegative; 3]) -> Adaptation {
    let [amplitude, slope, dead_band] = plain(mu);
    Adaptation {
        amplitude,
        slope,
        dead_band,
    }
}

/// A measurement as a state of `N` numbers.
pub trait StateOf<const N: usize> {
    /// The state.
    fn state(&self) -> SVector<f64, N>;

    /// The state of a measurement that can be used, or why it cannot.
    fn checked_state(&self) -> Result<SVector<f64, N>, HoldReason> {
        Ok(self.state())
    }
}

impl StateOf<6> for AttitudeMeasurement {
    #[inline]
    fn state(&self) -> Vector6<f64> {
        self.rigid_body_state()
    }

    #[inline]
    fn checked_state(&self) -> Result<Vector6<f64>, HoldReason> {
        self.checked_state()
    }
}

impl<const N: usize> StateOf<N> for SVector<f64, N> {
    #[inline]
    fn state(&self) -> SVector<f64, N> {
        *self
    }
}

/// Xu and Huang's controller in the closed loop, on a state padded to `N` numbers.
#[derive(Clone, Copy, Debug)]
pub struct XuInLoop<S, const N: usize, const M: usize, const R: usize> {
    controller: xu2020::Controller<S, N, M, R>,
    message_bits: usize,
    sent_weights: Option<[f64; R]>,
}

impl<S: Membership<N, R>, const N: usize, const M: usize, const R: usize> XuInLoop<S, N, M, R> {
    /// The controller before its first sample, for `states` states.
    pub fn new(controller: xu2020::Controller<S, N, M, R>, states: usize) -> Self {
        Self {
            controller,
            message_bits: runtime::command::BITS_PER_NUMBER * states,
            sent_weights: None,
        }
    }

    fn weights(&self, state: &SVector<f64, N>) -> [f64; R] {
        self.controller.law().membership().weights(state)
    }
}

impl<T, S, const N: usize, const M: usize, const R: usize> Controller<T, M> for XuInLoop<S, N, M, R>
where
    T: StateOf<N>,
    S: Membership<N, R> + Copy,
{
    #[inline]
    fn step(&mut self, time_s: f64, measurement: &T) -> Command<M> {
        let state = measurement.checked_state();
        let mut command = self.controller.step_measured(time_s, state);
        if command.sent {
            command.bits = self.message_bits;
            if R > 1 {
                self.sent_weights = Some(self.weights(&measurement.state()));
            }
        }
        command
    }

    fn would_send(&self, time_s: f64, measurement: &T) -> bool {
        let mut trial = *self;
        trial.step(time_s, measurement).sent
    }

    fn membership_mismatch(&self, measurement: &T) -> Option<f64> {
        let sent = self.sent_weights?;
        let now = self.weights(&measurement.state());
        let differences = now.iter().zip(&sent).map(|(a, b)| (a - b).abs());
        Some(differences.fold(0.0, f64::max))
    }
}
