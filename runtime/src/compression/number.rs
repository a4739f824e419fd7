//! Torques written as numbers, and words that are refused.

use thiserror::Error;

use super::word::Word;
use crate::error::{AllowedRange, Field, ParameterError};

/// How a torque is written into a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberFormat {
    /// One of 2^bits - 1 torques, evenly spaced from minus the limit to the limit; zero is one of
    /// them.
    Quantised {
        /// Bits, 2 to 32.
        bits: u32,
    },
    /// IEEE 754 single precision.
    Single,
    /// IEEE 754 double precision.
    Double,
}

/// Why a received word was not used.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Refusal {
    /// No word of this scheme has this length.
    #[error("no word has {bits} bits")]
    Length {
        /// Its length in bits.
        bits: u32,
    },
    /// No word of this scheme has this value.
    #[error("no word has the value {value}")]
    Unknown {
        /// Its value.
        value: u64,
    },
    /// The number in it is not finite or beyond the limit.
    #[error("the word says {torque} N m, beyond the limit")]
    OutOfLimits {
        /// The number, N m.
        torque: f64,
    },
}

impl NumberFormat {
    /// Bits of a word.
    pub const fn bits(&self) -> u32 {
        match self {
            Self::Quantised { bits } => *bits,
            Self::Single => 32,
            Self::Double => 64,
        }
    }

    pub(super) fn check(&self, axis: usize) -> Result<(), ParameterError> {
        match self {
            Self::Quantised { bits } => AllowedRange::closed(2.0, 32.0)
                .check(Field::component("bits", axis), f64::from(*bits)),
            Self::Single | Self::Double => Ok(()),
        }
    }

    /// Steps of a quantised torque from zero to the limit.
    fn steps(bits: u32) -> u32 {
        u32::MAX
            .checked_shr(33_u32.saturating_sub(bits))
            .unwrap_or(0)
            .max(1)
    }

    /// The word of a torque in N m that is finite and within the limit.
    pub fn encode(&self, torque: f64, limit: f64) -> Word {
        match *self {
            Self::Quantised { bits } => {
                let steps = f64::from(Self::steps(bits));
                // Both summands are whole and at most 2^31 - 1 in magnitude.
                let code = libm::round(torque / limit * steps) + steps;
                Word::of(code as u64, bits)
            }
            Self::Single => {
                let rounded = torque as f32;
                // Rounding must not pass the limit.
                let inside = if f64::from(rounded).abs() > limit {
                    f32::from_bits(rounded.to_bits().saturating_sub(1))
                } else {
                    rounded
                };
                Word::of(u64::from(inside.to_bits()), 32)
            }
            Self::Double => Word::of(torque.to_bits(), 64),
        }
    }

    /// The torque of a word, N m.
    ///
    /// # Errors
    /// A word that no torque within the limit has.
    pub fn decode(&self, word: &Word, limit: f64) -> Result<f64, Refusal> {
        if word.bits() != self.bits() {
            return Err(Refusal::Length { bits: word.bits() });
        }
        let value = word.value();
        let torque = match *self {
            Self::Quantised { bits } => {
                let steps = Self::steps(bits);
                if value > 2 * u64::from(steps) {
                    return Err(Refusal::Unknown { value });
                }
                (value as f64 - f64::from(steps)) / f64::from(steps) * limit
            }
            Self::Single => f64::from(f32::from_bits(value as u32)),
            Self::Double => f64::from_bits(value),
        };
        if torque.abs() <= limit {
            Ok(torque)
        } else {
            Err(Refusal::OutOfLimits { torque })
        }
    }
}
