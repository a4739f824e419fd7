//! Exact rational arithmetic: every double is a rational number, and definiteness is decided, not bounded.
//!
//! Slow, and without rounding: what [`Interval`](crate::interval::Interval) proves can be decided once more, and tests
//! have an oracle.

use std::borrow::Borrow;
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

use crate::matrix::Matrix;
use crate::scalar::Scalar;

/// Fractional bits of the fixed-point evaluation of the exponential.
const EXP_BITS: usize = 320;

/// The number that a double represents.
///
/// # Panics
/// On NaN and the infinities.
pub fn rational(value: f64) -> BigRational {
    BigRational::from_float(value).expect("only finite doubles stand in checked files")
}

/// A quotient of two integers.
pub fn quotient(numerator: i64, denominator: i64) -> BigRational {
    BigRational::new(BigInt::from(numerator), BigInt::from(denominator))
}

/// The rational instance of the arithmetic of certificate conditions.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd)]
pub struct Exact(pub BigRational);

impl Borrow<BigRational> for Exact {
    fn borrow(&self) -> &BigRational {
        &self.0
    }
}

impl Add for Exact {
    type Output = Exact;

    fn add(self, other: Exact) -> Exact {
        Exact(self.0 + other.0)
    }
}

impl Sub for Exact {
    type Output = Exact;

    fn sub(self, other: Exact) -> Exact {
        Exact(self.0 - other.0)
    }
}

impl Mul for Exact {
    type Output = Exact;

    fn mul(self, other: Exact) -> Exact {
        Exact(self.0 * other.0)
    }
}

impl Div for Exact {
    type Output = Exact;

    fn div(self, other: Exact) -> Exact {
        Exact(self.0 / other.0)
    }
}

impl Neg for Exact {
    type Output = Exact;

    fn neg(self) -> Exact {
        Exact(-self.0)
    }
}

impl Scalar for Exact {
    fn from_f64(value: f64) -> Self {
        Exact(rational(value))
    }

    /// Within `1e-40` of the exponential, relative.
    fn exp_upper(self) -> Self {
        Exact(exp_bounds(&self.0).1)
    }

    fn max(self, other: Self) -> Self {
        if self < other {
            other
        } else {
            self
        }
    }

    fn approximate(&self) -> f64 {
        self.0.to_f64().unwrap_or(f64::NAN)
    }
}

/// Whether a symmetric rational matrix is positive definite: Sylvester's criterion, the leading
/// minors by fraction-free elimination (E. H. Bareiss, Math. Comp. 22 (1968) 565-578).
///
/// # Panics
/// When the rows are not those of a symmetric matrix.
pub fn is_positive_definite<T: Borrow<BigRational>>(rows: &[Vec<T>]) -> bool {
    let mut matrix = cleared_of_denominators(rows);
    let order = matrix.len();
    let mut previous = BigInt::one();
    for step in 0..order {
        // The leading minor of order step + 1.
        let pivot = matrix[step][step].clone();
        if !pivot.is_positive() {
            return false;
        }
        for row in step + 1..order {
            for column in row..order {
                let updated = (&pivot * &matrix[row][column]
                    - &matrix[step][row] * &matrix[step][column])
                    / &previous;
                matrix[row][column] = updated;
            }
        }
        previous = pivot;
    }
    true
}

/// Whether a condition's matrix, assembled exactly, is positive definite; its upper triangle is read.
pub fn holds(matrix: &Matrix<Exact>) -> bool {
    let side = matrix.nrows();
    let row = |r: usize| -> Vec<Exact> {
        (0..side)
            .map(|c| matrix.at(r.min(c), r.max(c)).clone())
            .collect()
    };
    let rows: Vec<Vec<Exact>> = (0..side).map(row).collect();
    is_positive_definite(&rows)
}

/// The symmetric matrix times the least common denominator.
fn cleared_of_denominators<T: Borrow<BigRational>>(rows: &[Vec<T>]) -> Vec<Vec<BigInt>> {
    let order = rows.len();
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(row.len(), order, "the matrix is not square");
        for (column, entry) in row.iter().enumerate() {
            assert!(
                entry.borrow() == rows[column][index].borrow(),
                "the matrix is not symmetric"
            );
        }
    }
    without_denominators(rows).0
}

/// A rational matrix of any shape times its least common denominator, which is returned too; 1 for an empty one.
pub fn without_denominators<T: Borrow<BigRational>>(rows: &[Vec<T>]) -> (Vec<Vec<BigInt>>, BigInt) {
    let entries = rows.iter().flatten().map(T::borrow);
    let unit = entries.fold(BigInt::one(), |unit, entry| {
        // Dyadic denominators: the common one is the greatest of them.
        if (&unit % entry.denom()).is_zero() {
            return unit;
        }
        let further = BigRational::new(unit.clone(), entry.denom().clone());
        unit * further.denom()
    });
    let scaled = |entry: &BigRational| entry.numer() * (&unit / entry.denom());
    let rows = rows.iter();
    let rows = rows.map(|row| row.iter().map(|entry| scaled(entry.borrow())).collect());
    (rows.collect(), unit)
}

/// Lower and upper bound of `e^x`, within `1e-40` relative of each other for `|x| <= 1e4`.
pub fn exp_bounds(exponent: &BigRational) -> (BigRational, BigRational) {
    if exponent.is_negative() {
        let (lower, upper) = exp_bounds(&-exponent);
        return (upper.recip(), lower.recip());
    }
    if exponent.is_zero() {
        return (BigRational::one(), BigRational::one());
    }
    let mut halvings = 0;
    let mut reduced = exponent.clone();
    while reduced > quotient(1, 2) {
        reduced /= BigInt::from(2);
        halvings += 1;
    }
    let unit = BigInt::one() << EXP_BITS;
    let scaled = reduced * &unit;
    let mut lower = exp_series(&scaled.floor().to_integer());
    // The series is too small by less than two units per term, truncation included.
    let mut upper = exp_series(&scaled.ceil().to_integer()) + BigInt::from(2 * EXP_TERMS);
    for _ in 0..halvings {
        lower = (&lower * &lower) >> EXP_BITS;
        upper = ((&upper * &upper) >> EXP_BITS) + 1;
    }
    (
        BigRational::new(lower, unit.clone()),
        BigRational::new(upper, unit),
    )
}

/// Terms of the exponential series at an argument of at most 1/2: the truncation error is below
/// `2 * 0.5^70 / 70! < 2^-400`.
const EXP_TERMS: u32 = 70;

/// The truncated series in fixed point, each term rounded down. A term is too small by less than
/// 1.5 units: one from its own rounding, the rest inherited, divided by at least 4 from the second.
fn exp_series(argument: &BigInt) -> BigInt {
    let mut term = BigInt::one() << EXP_BITS;
    let mut sum = term.clone();
    for degree in 1..EXP_TERMS {
        term = ((&term * argument) >> EXP_BITS) / degree;
        sum += &term;
    }
    sum
}
