//! Interval arithmetic with outward rounding.
//!
//! An operation on intervals returns an interval that contains the exact result for every choice
//! of members of its operands. Exact results are not widened; inexact bounds move outward by one
//! unit in the last place at most (see [`rounding`](crate::rounding)).
//!
//! What is not known is [`Interval::ENTIRE`]: it stands for a NaN or an infinity in the data, a
//! division by an interval that contains zero, or a root of a possibly negative number. Every
//! operation on it gives it again, even a multiplication by zero, so an invalid number cannot
//! disappear from a result.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use crate::rounding::{
    add_down, add_up, div_down, div_up, mul_down, mul_up, next_down, next_up, power_of_two,
    sqrt_down, sqrt_up, sub_up,
};

/// A closed interval of real numbers, `lo <= x <= hi`.
///
/// `lo` may be minus infinity and `hi` may be infinity; neither is ever NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

/// Arguments of the exponential beyond this magnitude get a one-sided enclosure.
const EXP_RANGE: f64 = 700.0;

/// Degree of the Taylor polynomial of the exponential on `|r| <= 0.36`; the remainder is below
/// `2 * 0.36^18 / 18! < 4e-24`.
const EXP_DEGREE: u32 = 17;

/// `ln 2 = LN_2_HIGH + low`, where the first has 32 significant bits (its product with an integer
/// of up to 21 bits is exact) and `low` lies between the neighbours of `LN_2_LOW`.
const LN_2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
const LN_2_LOW: f64 = f64::from_bits(0x3dea_39ef_3579_3c76);

/// Number of terms of the sine series; the remainder is below `|t|^27 / 27!`.
const SINE_TERMS: u32 = 13;

impl Interval {
    /// The whole real line: nothing is known.
    pub const ENTIRE: Interval = Interval::between(f64::NEG_INFINITY, f64::INFINITY);

    /// The number 0.
    pub const ZERO: Interval = Interval::between(0.0, 0.0);

    /// The number 1.
    pub const ONE: Interval = Interval::between(1.0, 1.0);

    /// The number pi, between its two neighbouring doubles.
    pub const PI: Interval = Interval::between(
        std::f64::consts::PI,
        f64::from_bits(std::f64::consts::PI.to_bits() + 1),
    );

    /// Bounds that are known to be in order.
    #[inline]
    const fn between(lo: f64, hi: f64) -> Self {
        Interval { lo, hi }
    }

    /// The interval from `lo` to `hi`, or [`Interval::ENTIRE`] if they are out of order, NaN, or
    /// an infinity on the wrong side.
    #[inline]
    pub fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY {
            Interval::between(lo, hi)
        } else {
            Interval::ENTIRE
        }
    }

    /// Lower bound.
    #[inline]
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// Upper bound.
    #[inline]
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// Whether the number `value` is a member. NaN and the infinities never are.
    #[inline]
    pub fn contains(self, value: f64) -> bool {
        value.is_finite() && self.lo <= value && value <= self.hi
    }

    /// Whether both bounds are finite.
    #[inline]
    pub fn is_bounded(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// Whether nothing is known.
    #[inline]
    pub fn is_entire(self) -> bool {
        self == Interval::ENTIRE
    }

    /// A double near the centre, the member itself if there is only one; 0 if unbounded.
    #[inline]
    pub fn midpoint(self) -> f64 {
        if !self.is_bounded() {
            0.0
        } else if self.lo == self.hi {
            self.lo
        } else {
            0.5 * self.lo + 0.5 * self.hi
        }
    }

    /// A bound of the distance from [`Self::midpoint`] to every member; infinite if unbounded.
    #[inline]
    pub fn radius(self) -> f64 {
        let middle = self.midpoint();
        sub_up(self.hi, middle).max(sub_up(middle, self.lo))
    }

    /// The greatest magnitude of a member.
    #[inline]
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The smallest interval that contains both.
    #[inline]
    pub fn hull(self, other: Self) -> Self {
        Interval::between(self.lo.min(other.lo), self.hi.max(other.hi))
    }

    /// The greater of two numbers, one from each interval.
    #[inline]
    pub fn max(self, other: Self) -> Self {
        if self.is_entire() || other.is_entire() {
            return Interval::ENTIRE;
        }
        Interval::between(self.lo.max(other.lo), self.hi.max(other.hi))
    }

    /// The square.
    #[inline]
    pub fn sqr(self) -> Self {
        if self.is_entire() {
            return self;
        }
        let greatest = self.magnitude();
        let least = if self.contains(0.0) {
            0.0
        } else {
            self.lo.abs().min(self.hi.abs())
        };
        Interval::new(mul_down(least, least), mul_up(greatest, greatest))
    }

    /// The square root, or [`Interval::ENTIRE`] if the interval has a negative member. Where a
    /// number is known to be nonnegative, take [`Interval::max`] with zero first.
    #[inline]
    pub fn sqrt(self) -> Self {
        if self.lo < 0.0 {
            return Interval::ENTIRE;
        }
        Interval::new(sqrt_down(self.lo), sqrt_up(self.hi))
    }

    /// The exponential.
    ///
    /// On `[-700, 700]` the value at one number is enclosed to about five units in the last place;
    /// below it the lower bound is 0, above it the upper bound is infinite.
    #[inline]
    pub fn exp(self) -> Self {
        if self.is_entire() {
            return self;
        }
        Interval::new(exp_of(self.lo).lo, exp_of(self.hi).hi)
    }
}

/// Enclosure of `e^x`: with `x = k ln 2 + r` and `|r| <= 0.36`, the Taylor polynomial of `e^r`
/// and its remainder, times `2^k`.
#[inline]
fn exp_of(exponent: f64) -> Interval {
    if exponent == 0.0 {
        return Interval::ONE;
    }
    if exponent < -EXP_RANGE {
        return Interval::new(0.0, exp_of(-EXP_RANGE).hi);
    }
    if exponent > EXP_RANGE {
        return Interval::new(exp_of(EXP_RANGE).lo, f64::INFINITY);
    }
    let binades = (exponent * std::f64::consts::LOG2_E).round();
    let low = Interval::new(next_down(LN_2_LOW), next_up(LN_2_LOW));
    let high_part = Interval::from(exponent) - Interval::from(binades) * Interval::from(LN_2_HIGH);
    let reduced = high_part - Interval::from(binades) * low;
    exp_of_reduced(reduced) * Interval::from(power_of_two(binades as i32))
}

#[inline]
fn exp_of_reduced(reduced: Interval) -> Interval {
    let mut sum = Interval::ONE;
    let mut remainder = Interval::from(reduced.magnitude());
    for degree in (1..=EXP_DEGREE).rev() {
        let (this, next) = (f64::from(degree), f64::from(degree + 1));
        sum = Interval::ONE + reduced * sum / Interval::from(this);
        remainder = remainder * Interval::from(reduced.magnitude()) / Interval::from(next);
    }
    // Lagrange's form: |r|^(n+1) / (n+1)! times e^|r|, and e^0.36 < 2.
    let bound = mul_up(2.0, remainder.hi);
    sum + Interval::new(-bound, bound)
}

/// Enclosure of `sin^2(theta / 2)` for an angle in radians.
///
/// Meant for angles between two attitudes, in `[0, pi]`, where the enclosure of the value at one
/// angle has a relative width of a few `1e-15`; a result for any other angle is a valid enclosure
/// inside `[0, 1]`.
#[inline]
pub fn half_angle_sine_squared(theta: impl Into<Interval>) -> Interval {
    let theta = theta.into();
    let unit = Interval::between(0.0, 1.0);
    if theta.is_entire() {
        return theta;
    }
    if theta.lo < 0.0 || theta.hi > 4.0 {
        return unit;
    }
    // The function rises up to pi and falls beyond it.
    let first = half_angle_sine_squared_of(theta.lo);
    let last = half_angle_sine_squared_of(theta.hi);
    let greatest = if theta.hi <= Interval::PI.lo {
        last.hi
    } else {
        1.0
    };
    Interval::new(first.lo.min(last.lo).max(0.0), greatest.min(1.0))
}

/// `sin t = t (1 - t^2/(2 3) (1 - t^2/(4 5) (...)))` with `t = theta / 2` at most 2, and the
/// remainder, which is bounded by the first omitted term because derivatives are bounded by 1.
#[inline]
fn half_angle_sine_squared_of(theta: f64) -> Interval {
    let half = Interval::from(theta) * Interval::from(0.5);
    let square = half.sqr();
    let mut series = Interval::ONE;
    let mut remainder = half.magnitude();
    for term in (1..SINE_TERMS).rev() {
        let factors = f64::from(2 * term * (2 * term + 1));
        series = Interval::ONE - square * series / Interval::from(factors);
    }
    for term in 1..=SINE_TERMS {
        let factors = f64::from(2 * term * (2 * term + 1));
        remainder = div_up(mul_up(remainder, square.hi), factors);
    }
    (half * series + Interval::new(-remainder, remainder)).sqr()
}

impl From<f64> for Interval {
    /// The number itself; NaN and the infinities give [`Interval::ENTIRE`].
    #[inline]
    fn from(value: f64) -> Self {
        if value.is_finite() {
            Interval::between(value, value)
        } else {
            Interval::ENTIRE
        }
    }
}

impl Neg for Interval {
    type Output = Interval;

    #[inline]
    fn neg(self) -> Interval {
        Interval::between(-self.hi, -self.lo)
    }
}

impl Add for Interval {
    type Output = Interval;

    #[inline]
    fn add(self, other: Interval) -> Interval {
        Interval::new(add_down(self.lo, other.lo), add_up(self.hi, other.hi))
    }
}

impl Sub for Interval {
    type Output = Interval;

    #[inline]
    fn sub(self, other: Interval) -> Interval {
        self + -other
    }
}

impl AddAssign for Interval {
    #[inline]
    fn add_assign(&mut self, other: Interval) {
        *self = *self + other;
    }
}

impl SubAssign for Interval {
    #[inline]
    fn sub_assign(&mut self, other: Interval) {
        *self = *self - other;
    }
}

impl Sum for Interval {
    #[inline]
    fn sum<I: Iterator<Item = Interval>>(terms: I) -> Interval {
        terms.fold(Interval::ZERO, Add::add)
    }
}

/// The least lower and the greatest upper bound of an operation over the four corners.
#[inline]
fn over_corners(
    left: Interval,
    right: Interval,
    lower: fn(f64, f64) -> f64,
    upper: fn(f64, f64) -> f64,
) -> Interval {
    let (a, b) = (left, right);
    let corners = [(a.lo, b.lo), (a.lo, b.hi), (a.hi, b.lo), (a.hi, b.hi)];
    let lo = corners.map(|(x, y)| lower(x, y));
    let hi = corners.map(|(x, y)| upper(x, y));
    Interval::new(
        lo.into_iter().fold(f64::INFINITY, f64::min),
        hi.into_iter().fold(f64::NEG_INFINITY, f64::max),
    )
}

impl Mul for Interval {
    type Output = Interval;

    #[inline]
    fn mul(self, other: Interval) -> Interval {
        if self.is_entire() || other.is_entire() {
            return Interval::ENTIRE;
        }
        if self.lo == self.hi && other.lo == other.hi {
            return Interval::new(mul_down(self.lo, other.lo), mul_up(self.lo, other.lo));
        }
        over_corners(self, other, mul_down, mul_up)
    }
}

impl Div for Interval {
    type Output = Interval;

    #[inline]
    fn div(self, other: Interval) -> Interval {
        if self.is_entire() || other.is_entire() || other.contains(0.0) {
            return Interval::ENTIRE;
        }
        over_corners(self, other, div_down, div_up)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fractional bits of the fixed-point numbers below.
    const BITS: i32 = 120;

    /// A nonnegative double below 2 with no bit beyond the fraction.
    fn fixed_point(value: f64) -> u128 {
        let scaled = value * power_of_two(BITS);
        assert_eq!(scaled.fract(), 0.0);
        scaled as u128
    }

    #[test]
    fn the_logarithm_of_two_lies_between_the_neighbours_of_its_split() {
        // ln 2 = sum of 1 / (k 2^k): each term is rounded down, and the tail is below one unit.
        let terms = 120_u32;
        let lower: u128 = (1..=terms)
            .map(|k| (1_u128 << (120 - k)) / u128::from(k))
            .sum();
        let upper = lower + u128::from(terms) + 1;
        let high = fixed_point(LN_2_HIGH);
        assert!(high + fixed_point(next_down(LN_2_LOW)) < lower);
        assert!(upper < high + fixed_point(next_up(LN_2_LOW)));
    }

    #[test]
    fn products_of_binades_with_the_high_part_are_exact() {
        for binades in [-1010.0, -333.0, 1.0, 999.0, 1010.0] {
            let product = Interval::from(binades) * Interval::from(LN_2_HIGH);
            assert_eq!(product.lo, product.hi);
        }
    }
}
