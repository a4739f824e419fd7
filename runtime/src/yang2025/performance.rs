//! Performance functions: how the allowed error shrinks in time.

use core::f64::consts::FRAC_PI_2;

use crate::error::{AllowedRange, ParameterError};

/// Allowed values of the offset b in (8).
const OFFSET: AllowedRange = AllowedRange::closed(1e-3, 50.0);
/// Allowed values of k t_f: below, (9) loses its digits; above, nothing of the hyperbolic term is left.
const TURNS: AllowedRange = AllowedRange::closed(1e-2, 500.0);

/// Parameters of a performance function. Levels have the unit of the error they bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Performance {
    /// (8): reaches the final level at the appointed time and stays there.
    AppointedTime {
        /// rho_0, above `final_level`.
        initial_level: f64,
        /// rho_inf, positive.
        final_level: f64,
        /// t_f, s, positive.
        appointed_time_s: f64,
        /// k, 1/s, positive; its product with the appointed time is in [0.01, 500].
        rate_per_s: f64,
        /// b, dimensionless, in [0.001, 50].
        offset: f64,
    },
    /// The usual `(rho_0 - rho_inf) exp(-k t) + rho_inf`, which never quite reaches its final level.
    Exponential {
        /// rho_0, above `final_level`.
        initial_level: f64,
        /// rho_inf, positive.
        final_level: f64,
        /// k, 1/s, positive.
        rate_per_s: f64,
    },
}

/// A level and its slope.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    /// The level, in the unit of the error.
    pub value: f64,
    /// Its time derivative, 1/s times that unit.
    pub slope: f64,
}

/// A checked performance function rho(t).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerformanceFunction {
    initial: f64,
    settled: f64,
    rate: f64,
    appointed: Option<Appointed>,
}

/// What (8) has beyond an exponential.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Appointed {
    coefficients: [f64; 4],
    time_s: f64,
    offset: f64,
}

impl PerformanceFunction {
    /// Checks the parameters and solves for the coefficients.
    ///
    /// # Errors
    /// The first parameter that is not finite or out of its range.
    pub fn new(performance: Performance) -> Result<Self, ParameterError> {
        let (initial, settled, rate, appointed) = match performance {
            Performance::AppointedTime {
                initial_level,
                final_level,
                appointed_time_s,
                rate_per_s,
                offset,
            } => {
                let appointed = Some((appointed_time_s, offset));
                (initial_level, final_level, rate_per_s, appointed)
            }
            Performance::Exponential {
                initial_level,
                final_level,
                rate_per_s,
            } => (initial_level, final_level, rate_per_s, None),
        };
        let positive = AllowedRange::POSITIVE;
        positive.check_scalar("final_level", settled)?;
        AllowedRange::open(settled, f64::INFINITY).check_scalar("initial_level", initial)?;
        positive.check_scalar("rate_per_s", rate)?;
        if let Some((time_s, offset)) = appointed {
            positive.check_scalar("appointed_time_s", time_s)?;
            OFFSET.check_scalar("offset", offset)?;
            TURNS.check_scalar("rate_per_s * appointed_time_s", rate * time_s)?;
        }
        Ok(Self {
            initial,
            settled,
            rate,
            appointed: appointed.map(|(time_s, offset)| Appointed {
                coefficients: coefficients(initial, settled, rate * time_s, offset),
                time_s,
                offset,
            }),
        })
    }

    /// The coefficients z1 to z4 of (8); `None` for an exponential.
    pub fn coefficients(&self) -> Option<&[f64; 4]> {
        self.appointed.as_ref().map(|known| &known.coefficients)
    }

    /// rho at time zero.
    pub fn initial_level(&self) -> f64 {
        self.initial
    }

    /// rho_inf.
    pub fn final_level(&self) -> f64 {
        self.settled
    }

    /// rho(t) and its slope, `time_s` seconds after the start.
    pub fn at(&self, time_s: f64) -> Level {
        match &self.appointed {
            Some(appointed) if time_s >= appointed.time_s => Level {
                value: self.settled,
                slope: 0.0,
            },
            Some(appointed) => {
                let [z1, z2, z3, z4] = appointed.coefficients;
                let pace = FRAC_PI_2 / appointed.time_s;
                let (sine, cosine) = libm::sincos(pace * time_s);
                let argument = self.rate * time_s + appointed.offset;
                let cosecant = 1.0 / libm::sinh(argument);
                let cotangent = 1.0 / libm::tanh(argument);
                Level {
                    value: z1 + z2 * sine + z3 * cosine + z4 * cosecant,
                    slope: pace * (z2 * cosine - z3 * sine) - z4 * self.rate * cotangent * cosecant,
                }
            }
            None => {
                let share = (self.initial - self.settled) * libm::exp(-self.rate * time_s);
                Level {
                    value: share + self.settled,
                    slope: -self.rate * share,
                }
            }
        }
    }
}

/// z1 to z4: (9) with `+ 1` in the denominator of z4 replaced by `+ gamma^2 alpha^4`, which is what
/// the four boundary conditions `rho(0) = rho_0`, `rho(t_f) = rho_inf`, `rho'(t_f) = rho''(t_f) = 0`
/// give. Every fraction is divided by alpha^4 gamma^2 first, so that nothing overflows.
fn coefficients(initial: f64, settled: f64, turns: f64, offset: f64) -> [f64; 4] {
    // k / gamma, and the hyperbolic cosecant and cotangent of k t_f + b.
    let ratio = turns / FRAC_PI_2;
    let cosecant = 1.0 / libm::sinh(turns + offset);
    let cotangent = 1.0 / libm::tanh(turns + offset);
    let start = libm::sinh(offset);
    let cosine = ratio * cotangent * cosecant;
    let sine = ratio * ratio * (2.0 * cotangent * cotangent - 1.0) * cosecant;
    let z4 = (initial - settled) * start / (1.0 - start * (sine + cosine + cosecant));
    let (z2, z3) = (sine * z4, -cosine * z4);
    [initial - z4 / start - z3, z2, z3, z4]
}
