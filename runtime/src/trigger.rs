//! Event trigger on aperiodically sampled states: Xu and Huang 2020, (10).

use core::f64::consts::PI;

use nalgebra::{SMatrix, SVector};

use crate::error::{require_positive_definite, AllowedRange, Field, ParameterError};

pub use crate::error::SYMMETRY_TOLERANCE;

/// Adaptation of the threshold at every trigger, Xu and Huang 2020, below (10): with d the norm of
/// the step from the last sent state to the new one, the threshold is multiplied by
/// `1 - (2 amplitude / pi) atan(slope (d - dead_band))`. Steps smaller than `dead_band` raise it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptation {
    /// mu1, dimensionless, not negative.
    pub amplitude: f64,
    /// mu2, in units of one over the norm of the state, not negative.
    pub slope: f64,
    /// mu3, in units of the norm of the state, not negative.
    pub dead_band: f64,
}

impl Adaptation {
    fn check(&self) -> Result<(), ParameterError> {
        let allowed = AllowedRange::NON_NEGATIVE;
        allowed.check_scalar("amplitude", self.amplitude)?;
        allowed.check_scalar("slope", self.slope)?;
        allowed.check_scalar("dead_band", self.dead_band)
    }

    fn factor(&self, step: f64) -> f64 {
        1.0 - (2.0 * self.amplitude / PI) * libm::atan(self.slope * (step - self.dead_band))
    }
}

/// How the threshold nu(t_k) of the trigger evolves. Thresholds are dimensionless, in `[0, 1)`; at
/// zero every sample is sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThresholdUpdate {
    /// The threshold never changes. Covered by a certificate made for this threshold or a larger one.
    Fixed {
        /// The threshold.
        threshold: f64,
    },
    /// The published update, clamped to `[minimum, maximum]`, starting at the minimum. Covered by a
    /// certificate made for `maximum` or a larger threshold.
    Clamped {
        /// Rule of change.
        adaptation: Adaptation,
        /// Smallest and first threshold.
        minimum: f64,
        /// Largest threshold.
        maximum: f64,
    },
    /// The update as printed, bounded only from below. UNCERTIFIED: the stability proof needs the
    /// threshold to stay below that of the design, and near rest this update lets it grow without
    /// bound (with the published constants by up to 12.7 % at every trigger). For
    /// reproducing the paper only.
    UnclampedAsPublished {
        /// Rule of change.
        adaptation: Adaptation,
        /// Smallest and first threshold.
        minimum: f64,
    },
}

impl ThresholdUpdate {
    /// Largest threshold this update can reach; `None` when there is no bound, and therefore no
    /// certificate.
    pub fn certifiable_maximum(&self) -> Option<f64> {
        let (_, _, maximum) = self.parts();
        maximum
    }

    /// Rule of change, if any, smallest and first threshold, and largest one, if any.
    fn parts(&self) -> (Option<Adaptation>, f64, Option<f64>) {
        match *self {
            Self::Fixed { threshold } => (None, threshold, Some(threshold)),
            Self::Clamped {
                adaptation,
                minimum,
                maximum,
            } => (Some(adaptation), minimum, Some(maximum)),
            Self::UnclampedAsPublished {
                adaptation,
                minimum,
            } => (Some(adaptation), minimum, None),
        }
    }

    /// Threshold before the first update.
    pub fn initial(&self) -> f64 {
        let (_, first, _) = self.parts();
        first
    }

    /// Threshold after a trigger at which the sent state moved by `step` (Euclidean norm). It stays
    /// finite: the unclamped update ends at the largest representable number.
    pub fn next(&self, threshold: f64, step: f64) -> f64 {
        match self.parts() {
            (None, fixed, _) => fixed,
            (Some(adaptation), minimum, maximum) => (threshold * adaptation.factor(step))
                .max(minimum)
                .min(maximum.unwrap_or(f64::MAX)),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        let allowed = AllowedRange::half_open(0.0, 1.0);
        let (Some(adaptation), minimum, maximum) = self.parts() else {
            return allowed.check_scalar("threshold", self.initial());
        };
        adaptation.check()?;
        allowed.check_scalar("minimum", minimum)?;
        let Some(maximum) = maximum else {
            return Ok(());
        };
        allowed.check_scalar("maximum", maximum)?;
        if minimum <= maximum {
            Ok(())
        } else {
            Err(ParameterError::EmptyInterval {
                field: Field::scalar("minimum"),
                lower: minimum,
                upper: maximum,
            })
        }
    }
}

/// The sensor side of the loop: decides at each sample whether the state is sent.
///
/// A sample x is sent when it is the first, or when `e' W e >= nu z' W z + floor` with z the state sent last,
/// e = x - z, W the trigger weight (Upsilon) and nu the threshold.
///
/// The threshold is relative, so near rest it vanishes and sensor noise alone makes most samples trigger; the absolute
/// floor, 0 by default, prevents that. A certificate covers it when it was made for this floor or a larger one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AperiodicTrigger<const N: usize> {
    weight: SMatrix<f64, N, N>,
    update: ThresholdUpdate,
    floor: f64,
    threshold: f64,
    sent: Option<Sent<N>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Sent<const N: usize> {
    state: SVector<f64, N>,
    quadratic_form: f64,
}

impl<const N: usize> AperiodicTrigger<N> {
    /// Trigger with the weight Upsilon (N x N, symmetric positive definite, in units that make the
    /// quadratic form meaningful) and the evolution of its threshold.
    ///
    /// # Errors
    /// A weight that is not finite, symmetric up to [`SYMMETRY_TOLERANCE`] and positive definite; a
    /// constant of the update out of range.
    pub fn new(
        weight: SMatrix<f64, N, N>,
        update: ThresholdUpdate,
    ) -> Result<Self, ParameterError> {
        require_positive_definite("trigger_weight", &weight)?;
        update.check()?;
        Ok(Self {
            weight,
            update,
            floor: 0.0,
            threshold: update.initial(),
            sent: None,
        })
    }

    /// The same trigger with an absolute floor, in the unit of the quadratic form, not negative.
    ///
    /// # Errors
    /// A floor that is not finite or negative.
    pub fn with_floor(self, floor: f64) -> Result<Self, ParameterError> {
        AllowedRange::NON_NEGATIVE.check_scalar("trigger_floor", floor)?;
        Ok(Self { floor, ..self })
    }

    /// The absolute floor.
    pub fn floor(&self) -> f64 {
        self.floor
    }

    /// The threshold nu(t_k) now in force.
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// How the threshold evolves.
    pub fn update(&self) -> &ThresholdUpdate {
        &self.update
    }

    /// The state sent last, x(t_k); `None` before the first.
    pub fn sent(&self) -> Option<&SVector<f64, N>> {
        self.sent.as_ref().map(|sent| &sent.state)
    }

    /// Whether `state` must be sent; `None` when that cannot be computed, because the state is not
    /// finite or its quadratic form overflows.
    pub fn fires(&self, state: &SVector<f64, N>) -> Option<bool> {
        let Some(sent) = &self.sent else {
            return self.quadratic_form(state).map(|_| true);
        };
        let error = self.quadratic_form(&(state - sent.state))?;
        Some(error >= self.threshold * sent.quadratic_form + self.floor)
    }

    /// Records that `state` was sent and moves the threshold. A state for which [`Self::fires`] has
    /// no answer is not recorded.
    pub fn record_sent(&mut self, state: &SVector<f64, N>) {
        let Some(quadratic_form) = self.quadratic_form(state) else {
            return;
        };
        if let Some(previous) = &self.sent {
            let step = state - previous.state;
            self.threshold = self
                .update
                .next(self.threshold, libm::sqrt(step.dot(&step)));
        }
        self.sent = Some(Sent {
            state: *state,
            quadratic_form,
        });
    }

    /// Back to the state before the first sample.
    pub fn reset(&mut self) {
        self.threshold = self.update.initial();
        self.sent = None;
    }

    fn quadratic_form(&self, vector: &SVector<f64, N>) -> Option<f64> {
        let product = self.weight * vector;
        // In the order of the states: a state padded with zeros has the same bits.
        let terms = product.iter().zip(vector.iter());
        let value = terms.fold(0.0, |sum, (left, right)| sum + left * right);
        value.is_finite().then_some(value)
    }
}
