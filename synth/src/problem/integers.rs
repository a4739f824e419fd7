//! Matrices of integers and rationals of any size, and an exact test of stability.

use std::iter::Sum;
use std::ops::Mul;

use nalgebra::DMatrix;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use verified::exact::without_denominators;

/// Rows of integers.
pub(super) type Integers = Vec<Vec<BigInt>>;

/// Rows of rationals.
pub(super) type Rationals = Vec<Vec<BigRational>>;

/// A matrix of doubles times the returned power of two that makes it integer. `None` unless all entries are finite.
pub(super) fn cleared(matrix: &DMatrix<f64>) -> Option<(Integers, BigInt)> {
    let exact = |row| (0..matrix.ncols()).map(move |c| BigRational::from_float(matrix[(row, c)]));
    let rows = (0..matrix.nrows()).map(|row| exact(row).collect());
    let rows = rows.collect::<Option<Rationals>>()?;
    Some(without_denominators(&rows))
}

/// A multiple of a matrix.
pub(super) fn scaled(matrix: &Integers, factor: &BigInt) -> Integers {
    let rows = matrix.iter();
    rows.map(|row| row.iter().map(|entry| entry * factor).collect())
        .collect()
}

/// The sum of two matrices of one shape.
pub(super) fn sum(a: &Integers, b: &Integers) -> Integers {
    let rows = a.iter().zip(b);
    rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a + b).collect())
        .collect()
}

/// A matrix, k x n, times another, n x p; its entries are integers or rationals.
pub(super) fn product<T>(a: &[Vec<T>], b: &Integers) -> Vec<Vec<T>>
where
    T: Sum,
    for<'a> &'a T: Mul<&'a BigInt, Output = T>,
{
    let columns = b.first().map_or(0, Vec::len);
    let entry = |row: &[T], c: usize| row.iter().zip(b).map(|(x, b)| x * &b[c]).sum();
    let rows = a.iter();
    rows.map(|row| (0..columns).map(|c| entry(row, c)).collect())
        .collect()
}

/// True when every eigenvalue has a negative real part.
pub(super) fn hurwitz(matrix: &Integers) -> bool {
    routh(&characteristic(matrix))
}

/// Coefficients of det(s I - A), that of s^k first (Faddeev and LeVerrier; the divisions leave no remainder).
fn characteristic(a: &Integers) -> Vec<BigInt> {
    let side = a.len();
    let mut coefficients = vec![BigInt::one()];
    let mut image = vec![vec![BigInt::zero(); side]; side];
    for step in 1..=side {
        for (index, row) in image.iter_mut().enumerate() {
            row[index] += &coefficients[step - 1];
        }
        image = product(a, &image);
        let trace: BigInt = (0..side).map(|index| &image[index][index]).sum();
        coefficients.push(-trace / BigInt::from(step));
    }
    coefficients
}

/// The Routh-Hurwitz criterion for coefficients of which the first is 1: true when every root has a negative real part.
/// The first entries of the rows are Hurwitz' determinants (R. Jeltsch, 1979: an optimal fraction free Routh array).
fn routh(coefficients: &[BigInt]) -> bool {
    let every_second = |first| {
        coefficients
            .iter()
            .skip(first)
            .step_by(2)
            .cloned()
            .collect()
    };
    let mut above: Vec<BigInt> = every_second(0);
    let mut row: Vec<BigInt> = every_second(1);
    let mut divisor = BigInt::one();
    let after = |row: &[BigInt], j: usize| row.get(j + 1).cloned().unwrap_or_default();
    while let Some(first) = row.first() {
        if !first.is_positive() {
            return false;
        }
        let entry = |j| (first * after(&above, j) - &above[0] * after(&row, j)) / &divisor;
        let next = (0..above.len() - 1).map(entry).collect();
        divisor.clone_from(&above[0]);
        above = std::mem::replace(&mut row, next);
    }
    true
}
