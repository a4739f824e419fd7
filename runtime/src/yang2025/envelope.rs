//! The resilient envelope of one axis: (10) to (12).

use super::performance::{Level, Performance, PerformanceFunction};
use crate::error::{AllowedRange, ParameterError};

/// The adhesive terms (12): the envelope starts around the initial error, wherever that is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adhesion {
    /// lambda, dimensionless, at least 1: the half width at the start is lambda / 2 times the width
    /// of the envelope without adhesion.
    pub width: f64,
    /// nu, dimensionless, positive: the terms vanish as `(1 - t / span)^(1 / nu)`. Below 1/2 they do
    /// so with a continuous curvature.
    pub exponent: f64,
    /// Time after which they are zero (t_f in (12)), s, positive.
    pub span_s: f64,
}

/// The resilient correction (11): the envelope widens while the estimated fault is beyond what the
/// actuators can balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resilience {
    /// delta_1, 1/(N m s), positive: gain on the torque that is missing.
    pub fault_gain: f64,
    /// delta_2, dimensionless, not negative: gain on the rate of the error while torque is missing.
    pub rate_gain: f64,
    /// delta_3, 1/s, positive: decay.
    pub decay_per_s: f64,
    /// delta_4, dimensionless, positive: size at which the decay turns from exponential to linear.
    pub decay_size: f64,
    /// kappa_1, not negative: how far the bound on the side away from the fault moves outwards.
    pub away_width: f64,
    /// kappa_2, not negative: how far the bound on the side the fault pushes to moves outwards.
    pub toward_width: f64,
}

/// The parameters of one axis. The error is a component of the quaternion's vector part, without unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvelopeParameters {
    /// rho(t).
    pub performance: Performance,
    /// a in (10), dimensionless, positive.
    pub shape: f64,
    /// True for (10): the side of the initial error is wide and the other narrow, which bounds the
    /// overshoot. False for the usual envelope between -a rho and a rho.
    pub one_sided: bool,
    /// The adhesive terms; `None` leaves them out.
    pub adhesion: Option<Adhesion>,
    /// The resilient correction; `None` leaves it out.
    pub resilience: Option<Resilience>,
}

/// The bounds of the error at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// rho_d.
    pub lower: Level,
    /// rho_u.
    pub upper: Level,
}

impl Bounds {
    /// Where `error` is between the bounds: -1 on the lower one, 1 on the upper one, 0 half way.
    pub fn position(&self, error: f64) -> f64 {
        let (lower, upper) = (self.lower.value, self.upper.value);
        (2.0 * error - upper - lower) / (upper - lower)
    }
}

/// The integrator of the resilient correction: mu in (11), dimensionless.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Correction {
    /// mu.
    pub value: f64,
    /// Its time derivative, 1/s.
    pub slope: f64,
    drive: f64,
}

/// A checked envelope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope {
    performance: PerformanceFunction,
    parameters: EnvelopeParameters,
}

impl Envelope {
    /// Checks the parameters.
    ///
    /// # Errors
    /// The first parameter that is not finite or out of its range.
    pub fn new(parameters: EnvelopeParameters) -> Result<Self, ParameterError> {
        let positive = |name, value| AllowedRange::POSITIVE.check_scalar(name, value);
        let not_negative = |name, value| AllowedRange::NON_NEGATIVE.check_scalar(name, value);
        let performance = PerformanceFunction::new(parameters.performance)?;
        positive("shape", parameters.shape)?;
        if let Some(adhesion) = &parameters.adhesion {
            AllowedRange::half_open(1.0, f64::INFINITY).check_scalar("width", adhesion.width)?;
            positive("exponent", adhesion.exponent)?;
            positive("span_s", adhesion.span_s)?;
        }
        if let Some(resilience) = &parameters.resilience {
            positive("fault_gain", resilience.fault_gain)?;
            not_negative("rate_gain", resilience.rate_gain)?;
            positive("decay_per_s", resilience.decay_per_s)?;
            positive("decay_size", resilience.decay_size)?;
            not_negative("away_width", resilience.away_width)?;
            not_negative("toward_width", resilience.toward_width)?;
        }
        Ok(Self {
            performance,
            parameters,
        })
    }

    /// rho(t).
    pub fn performance(&self) -> &PerformanceFunction {
        &self.performance
    }

    /// The bounds `time_s` seconds after the start, for the error at the start and the correction now.
    pub fn at(&self, time_s: f64, initial_error: f64, correction: &Correction) -> Bounds {
        let side = if self.parameters.one_sided {
            sign(initial_error)
        } else {
            0.0
        };
        let mut bounds = self.basic(&self.performance.at(time_s), side);
        if let Some(adhesion) = &self.parameters.adhesion {
            let start = Level {
                value: self.performance.initial_level(),
                slope: 0.0,
            };
            adhesion.apply(
                time_s,
                initial_error,
                &self.basic(&start, side),
                &mut bounds,
            );
        }
        if let Some(resilience) = &self.parameters.resilience {
            resilience.apply(correction, &mut bounds);
        }
        bounds
    }

    /// (10) without its corrections: -r1 and r2 with r1 = (a - s) rho + s rho_inf and
    /// r2 = (a + s) rho - s rho_inf.
    fn basic(&self, rho: &Level, side: f64) -> Bounds {
        let (shape, settled) = (self.parameters.shape, side * self.performance.final_level());
        Bounds {
            lower: Level {
                value: -(shape - side) * rho.value - settled,
                slope: -(shape - side) * rho.slope,
            },
            upper: Level {
                value: (shape + side) * rho.value - settled,
                slope: (shape + side) * rho.slope,
            },
        }
    }

    /// The correction after `interval_s` seconds under what [`Self::drive`] set.
    pub fn advance(&self, correction: &Correction, interval_s: f64) -> Correction {
        let Some(resilience) = &self.parameters.resilience else {
            return *correction;
        };
        // The decay is taken at the end of the interval, so that it is stable for intervals of any length.
        let decay = resilience.decay_per_s / (correction.value.abs() + resilience.decay_size);
        let value = (correction.value + interval_s * correction.drive) / (1.0 + interval_s * decay);
        Correction {
            value,
            ..*correction
        }
    }

    /// Sets what drives the correction until the next sample: the estimated fault of the axis beyond
    /// its `authority` (both N m) and the rate of the error (1/s).
    pub fn drive(&self, correction: &mut Correction, fault: f64, authority: f64, rate: f64) {
        let Some(resilience) = &self.parameters.resilience else {
            return;
        };
        let excess = fault.abs() - authority;
        correction.drive = if excess > 0.0 {
            resilience.fault_gain * sign(fault) * excess + resilience.rate_gain * rate
        } else {
            0.0
        };
        let size = correction.value.abs() + resilience.decay_size;
        correction.slope = correction.drive - resilience.decay_per_s * correction.value / size;
    }
}

impl Adhesion {
    /// (12): phi_1 widens the lower side and phi_2 the upper side.
    fn apply(&self, time_s: f64, initial_error: f64, start: &Bounds, bounds: &mut Bounds) {
        if time_s >= self.span_s {
            return;
        }
        let (r1, r2) = (-start.lower.value, start.upper.value);
        let lower = initial_error - 0.5 * (self.width * r2 + (self.width - 2.0) * r1);
        let upper = initial_error + 0.5 * ((self.width - 2.0) * r2 + self.width * r1);
        let left = 1.0 - time_s / self.span_s;
        let share = libm::pow(left, 1.0 / self.exponent);
        let slope = -share / (left * self.exponent * self.span_s);
        bounds.lower.value += lower * share;
        bounds.lower.slope += lower * slope;
        bounds.upper.value += upper * share;
        bounds.upper.slope += upper * slope;
    }
}

impl Resilience {
    /// (11), outwards: taken literally it shifts both bounds the same way, and the one that comes
    /// closer is hit. A positive correction moves the upper bound up by kappa_2 tanh mu and the lower
    /// bound down by kappa_1 tanh mu; a negative one swaps the sides.
    fn apply(&self, correction: &Correction, bounds: &mut Bounds) {
        let tangent = libm::tanh(correction.value);
        let size = tangent.abs();
        let slope = (1.0 - tangent * tangent) * correction.slope * sign(tangent);
        let (upper, lower) = if tangent >= 0.0 {
            (self.toward_width, self.away_width)
        } else {
            (self.away_width, self.toward_width)
        };
        bounds.upper.value += upper * size;
        bounds.upper.slope += upper * slope;
        bounds.lower.value -= lower * size;
        bounds.lower.slope -= lower * slope;
    }
}

/// -1, 0 or 1.
pub(super) fn sign(value: f64) -> f64 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
}
