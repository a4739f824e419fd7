//! Exact rational arithmetic: the oracle against which verified floating point is tested.
//!
//! The number type and the decision of definiteness are the ones of `verify --exact`.
#![allow(dead_code)]

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
pub use synth::certify::exact::{exp_bounds, is_positive_definite, quotient, rational, Exact};

/// The matrix `rows - shift I`.
pub fn shifted(rows: &[Vec<BigRational>], shift: &BigRational) -> Vec<Vec<BigRational>> {
    let mut result = rows.to_vec();
    for (index, row) in result.iter_mut().enumerate() {
        row[index] -= shift;
    }
    result
}

/// The exact matrix of a row-major square matrix of doubles.
pub fn rational_rows(order: usize, entries: &[f64]) -> Vec<Vec<BigRational>> {
    let row = |index: usize| entries[index * order..(index + 1) * order].iter();
    (0..order)
        .map(|index| row(index).map(|&value| rational(value)).collect())
        .collect()
}

/// Lower and upper bound of the sine of an angle in `[0, 2]` radians: two consecutive partial sums
/// of its alternating series.
pub fn sine_bounds(angle: &BigRational) -> (BigRational, BigRational) {
    let square = angle * angle;
    let mut term = angle.clone();
    let mut sums = (BigRational::zero(), term.clone());
    for index in 1..=18_i64 {
        term = -term * &square / BigInt::from(2 * index * (2 * index + 1));
        sums = (sums.1.clone(), sums.1 + &term);
    }
    if sums.0 <= sums.1 {
        sums
    } else {
        (sums.1, sums.0)
    }
}

/// Lower and upper bound of pi by Machin's formula `16 atan(1/5) - 4 atan(1/239)`.
pub fn pi_bounds() -> (BigRational, BigRational) {
    let (first_low, first_high) = arctangent_of_reciprocal(5);
    let (second_low, second_high) = arctangent_of_reciprocal(239);
    let combine = |first: BigRational, second: BigRational| {
        first * BigInt::from(16) - second * BigInt::from(4)
    };
    (
        combine(first_low, second_high),
        combine(first_high, second_low),
    )
}

fn arctangent_of_reciprocal(argument: i64) -> (BigRational, BigRational) {
    let mut power = quotient(1, argument);
    let mut sums = (BigRational::zero(), power.clone());
    for index in 1..=40_i64 {
        power = -power / BigInt::from(argument * argument);
        sums = (
            sums.1.clone(),
            sums.1 + &power / BigInt::from(2 * index + 1),
        );
    }
    if sums.0 <= sums.1 {
        sums
    } else {
        (sums.1, sums.0)
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): a reproducible stream of test data.
pub struct Stream(pub u64);

impl Stream {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// An integer in `least..=greatest`.
    pub fn integer(&mut self, least: i64, greatest: i64) -> i64 {
        least + (self.bits() % (greatest - least + 1) as u64) as i64
    }

    /// A double in `[-1, 1)`.
    pub fn signed_unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
