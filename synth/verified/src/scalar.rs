//! The arithmetic that a condition needs in order to be written once and evaluated either with
//! verified rounding or exactly.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::interval::Interval;

/// A number type over which the matrix of a certificate condition can be assembled.
///
/// [`Interval`] is the instance that the check uses; an exact rational instance serves as an
/// oracle in tests. An implementation must enclose the exact result of every operation: an
/// assembly over it then encloses the exact matrix.
pub trait Scalar:
    Clone
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The double itself, without rounding.
    fn from_f64(value: f64) -> Self;

    /// A number that is not below `e^x` for any `x` in `self`. It is one number (for an interval:
    /// of width zero), so using it twice does not lose that both occurrences are equal.
    fn exp_upper(self) -> Self;

    /// The greater of two numbers.
    fn max(self, other: Self) -> Self;

    /// A double near the number. It encloses nothing: it serves to choose numbers that are then shown to suffice.
    fn approximate(&self) -> f64;

    /// The number 0.
    #[inline]
    fn zero() -> Self {
        Self::from_f64(0.0)
    }

    /// The number 1.
    #[inline]
    fn one() -> Self {
        Self::from_f64(1.0)
    }
}

impl Scalar for Interval {
    #[inline]
    fn from_f64(value: f64) -> Self {
        Interval::from(value)
    }

    #[inline]
    fn exp_upper(self) -> Self {
        Interval::from(self.exp().hi())
    }

    #[inline]
    fn max(self, other: Self) -> Self {
        Interval::max(self, other)
    }

    #[inline]
    fn approximate(&self) -> f64 {
        self.midpoint()
    }
}
