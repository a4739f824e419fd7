//! Positive definiteness of a symmetric interval matrix, proved in floating point.
//!
//! The matrix is scaled by powers of two to a diagonal near 1 (a congruence, which preserves
//! definiteness), split into midpoint `A` and radius, and proved by Corollary 2.4 of S. M. Rump,
//! "Verification of positive definiteness", BIT 46 (2006) 433-452: with `u = 2^-53`,
//! `eta = 2^-1074`, `4 (n+1) u < 1`, `a_ii >= 0` and
//!
//! ```text
//! c >= (n+1) u / (1 - 2 (n+1) u) * trace(A) + 4 eta n (2 (n+1) + max a_ii),
//! ```
//!
//! if the round-to-nearest Cholesky factorisation of `A` with its diagonal lowered by at least `c`
//! runs to the end with positive finite pivots, then `A` is positive definite. For all symmetric
//! members of the interval matrix the diagonal is lowered by the row sums of the radius as well:
//! a symmetric perturbation within the radius plus the diagonal matrix of those row sums is
//! diagonally dominant, hence positive semidefinite.
//!
//! The theorem needs f64 with gradual underflow and no fused multiply-add, so the factorisation
//! is written as plain loops here and no library is called.

use thiserror::Error;

use crate::interval::Interval;
use crate::rounding::{
    add_up, binary_exponent, div_up, mul_up, power_of_two, sub_down, SMALLEST_POSITIVE,
    UNIT_ROUNDOFF,
};

/// Steps of the search for the margin and their split into the search for the binade of the
/// margin and the refinement inside it.
const BINADE_STEPS: u32 = 6;
const REFINEMENT_STEPS: u32 = 14;

/// Steps of the bisection that estimates the smallest eigenvalue.
const ESTIMATE_STEPS: u32 = 64;

/// A symmetric matrix of intervals, stored row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct IntervalMatrix {
    order: usize,
    entries: Vec<Interval>,
}

/// The number of entries is not the square of the order.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("a matrix of order {order} cannot have {count} entries")]
pub struct WrongEntryCount {
    /// Requested number of rows.
    pub order: usize,
    /// Number of entries given.
    pub count: usize,
}

impl IntervalMatrix {
    /// The matrix with the entries `entry(row, column)` for `row <= column`, mirrored below the
    /// diagonal.
    pub fn from_upper(order: usize, mut entry: impl FnMut(usize, usize) -> Interval) -> Self {
        let mut entries = vec![Interval::ZERO; order * order];
        for row in 0..order {
            for column in row..order {
                let value = entry(row, column);
                entries[row * order + column] = value;
                entries[column * order + row] = value;
            }
        }
        IntervalMatrix { order, entries }
    }

    /// The matrix with all `order * order` entries given row by row.
    ///
    /// Two entries that mirror each other are both replaced by their hull. It contains the entry
    /// of the symmetric part of every member, so a proof holds for the quadratic form even when
    /// the matrix given is not symmetric.
    pub fn from_entries(order: usize, entries: &[Interval]) -> Result<Self, WrongEntryCount> {
        let count = entries.len();
        if order.checked_mul(order) != Some(count) {
            return Err(WrongEntryCount { order, count });
        }
        Ok(Self::from_upper(order, |row, column| {
            entries[row * order + column].hull(entries[column * order + row])
        }))
    }

    /// Number of rows.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The entry in the given row and column, or `None` outside the matrix.
    pub fn entry(&self, row: usize, column: usize) -> Option<Interval> {
        (row < self.order && column < self.order).then(|| self.at(row, column))
    }

    fn at(&self, row: usize, column: usize) -> Interval {
        self.entries[row * self.order + column]
    }

    /// `D A D` with `D` the diagonal matrix of the given powers of two.
    fn scaled(&self, exponents: &[i32]) -> Self {
        Self::from_upper(self.order, |row, column| {
            let total = exponents[row] + exponents[column];
            // Both factors act in the same direction, so none of the two under- or overflows
            // where the product does not.
            let half = power_of_two(total / 2);
            let rest = power_of_two(total - total / 2);
            self.at(row, column) * Interval::from(half) * Interval::from(rest)
        })
    }
}

/// A proof that every symmetric member of an interval matrix is positive definite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// A proved lower bound of the smallest eigenvalue of every member after scaling its
    /// diagonal into `[0.5, 2)`. It is 0 if only definiteness itself could be proved, and
    /// infinite for the empty matrix.
    pub proved: f64,
    /// Bound of the 2-norm of the distance from the midpoint to any member, after scaling.
    pub uncertainty: f64,
}

/// Why a matrix was not proved positive definite. It may be positive definite all the same.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum Obstacle {
    /// An entry is NaN, infinite, or unbounded.
    #[error("entry ({row}, {column}) is not a finite number")]
    NotFinite {
        /// Row of the entry.
        row: usize,
        /// Column of the entry, not less than the row.
        column: usize,
    },
    /// A diagonal entry has a member that is zero or negative.
    #[error("diagonal entry {index} may be as low as {lower_bound:e}")]
    DiagonalNotPositive {
        /// Row of the entry.
        index: usize,
        /// Lower bound of the entry, before scaling.
        lower_bound: f64,
    },
    /// The smallest eigenvalue is negative or too small to be distinguished from zero.
    #[error("the smallest eigenvalue is not provably positive")]
    SmallestEigenvalue,
}

/// The matrix could not be proved positive definite.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error(
    "not proved positive definite: {obstacle} \
     (estimated smallest scaled eigenvalue {estimate:e}, uncertainty {uncertainty:e})"
)]
pub struct NotProved {
    /// Estimate, not proved, of the smallest eigenvalue of the scaled midpoint matrix: negative or
    /// tiny, or else not above the uncertainty. Minus infinity if the matrix, or the matrix after
    /// scaling, is not finite.
    pub estimate: f64,
    /// Bound of the 2-norm of the distance from the midpoint to any member, after scaling;
    /// infinite where the estimate is.
    pub uncertainty: f64,
    /// The reason.
    pub obstacle: Obstacle,
}

/// Proves that every symmetric member of the interval matrix is positive definite.
///
/// # Errors
///
/// [`NotProved`] if a member is not positive definite, or if the matrix is too close to a
/// singular one to be distinguished (relative to a unit diagonal, about `n^2 * 1.1e-16`), or if an
/// entry is not finite.
pub fn prove_positive_definite(matrix: &IntervalMatrix) -> Result<Margin, NotProved> {
    if let Some(obstacle) = unbounded_entry(matrix) {
        return Err(unknown(obstacle));
    }
    let scaled = matrix.scaled(&scaling_exponents(matrix));
    if unbounded_entry(&scaled).is_some() {
        // An entry that overflows here is far greater than its two diagonal entries allow.
        return Err(unknown(Obstacle::SmallestEigenvalue));
    }
    let split = MidpointRadius::of(&scaled);
    let mut diagonal = (0..matrix.order).map(|index| (index, matrix.at(index, index).lo()));
    let obstacle = match diagonal.find(|(_, lower_bound)| *lower_bound <= 0.0) {
        Some((index, lower_bound)) => Obstacle::DiagonalNotPositive { index, lower_bound },
        None if split.eigenvalues_exceed(0.0) => {
            return Ok(Margin {
                proved: split.margin(),
                uncertainty: split.uncertainty(),
            });
        }
        None => Obstacle::SmallestEigenvalue,
    };
    Err(NotProved {
        estimate: split.estimated_smallest_eigenvalue(),
        uncertainty: split.uncertainty(),
        obstacle,
    })
}

fn unknown(obstacle: Obstacle) -> NotProved {
    NotProved {
        estimate: f64::NEG_INFINITY,
        uncertainty: f64::INFINITY,
        obstacle,
    }
}

fn unbounded_entry(matrix: &IntervalMatrix) -> Option<Obstacle> {
    let order = matrix.order;
    (0..order)
        .flat_map(|row| (row..order).map(move |column| (row, column)))
        .find(|&(row, column)| !matrix.at(row, column).is_bounded())
        .map(|(row, column)| Obstacle::NotFinite { row, column })
}

/// Exponents `e` that bring the magnitude of every diagonal entry times `4^e` into `[0.5, 2)`.
///
/// A row whose diagonal entry is zero, which can only be refused, is scaled by its greatest
/// entry instead.
fn scaling_exponents(matrix: &IntervalMatrix) -> Vec<i32> {
    let magnitude = |row: usize| {
        let diagonal = matrix.at(row, row).midpoint().abs();
        if diagonal > 0.0 {
            return diagonal;
        }
        let off_diagonal = (0..matrix.order).map(|column| matrix.at(row, column).magnitude());
        off_diagonal.fold(0.0, f64::max)
    };
    (0..matrix.order)
        .map(|row| match magnitude(row) {
            value if value > 0.0 => -(binary_exponent(value) + 1).div_euclid(2),
            _ => 0,
        })
        .collect()
}

/// A midpoint matrix, row by row, with the row sums of the radius rounded up.
struct MidpointRadius {
    order: usize,
    midpoint: Vec<f64>,
    radius_sums: Vec<f64>,
}

impl MidpointRadius {
    fn of(matrix: &IntervalMatrix) -> Self {
        let order = matrix.order;
        let row_sum = |row: usize| {
            (0..order)
                .map(|column| matrix.at(row, column).radius())
                .fold(0.0, add_up)
        };
        let midpoint = matrix.entries.iter().map(|entry| entry.midpoint());
        MidpointRadius {
            order,
            midpoint: midpoint.collect(),
            radius_sums: (0..order).map(row_sum).collect(),
        }
    }

    /// The greatest row sum of the radius: its infinity norm, which bounds its 2-norm.
    fn uncertainty(&self) -> f64 {
        self.radius_sums.iter().copied().fold(0.0, f64::max)
    }

    fn diagonal(&self, index: usize) -> f64 {
        self.midpoint[index * self.order + index]
    }

    /// Whether all eigenvalues of all members are proved to be greater than `shift >= 0`.
    fn eigenvalues_exceed(&self, shift: f64) -> bool {
        let Some(guard) = factorisation_guard(self.order, |index| self.diagonal(index)) else {
            return false;
        };
        let lowered = |index: usize| {
            let certain = sub_down(self.diagonal(index), self.radius_sums[index]);
            sub_down(sub_down(certain, shift), guard)
        };
        self.factorises(lowered)
    }

    /// Whether the factorisation of the midpoint with another diagonal runs to the end.
    fn factorises(&self, diagonal: impl Fn(usize) -> f64) -> bool {
        let mut matrix = self.midpoint.clone();
        for index in 0..self.order {
            matrix[index * self.order + index] = diagonal(index);
        }
        cholesky_succeeds(self.order, &mut matrix)
    }

    /// The least diagonal entry of the midpoint, infinite without any: no eigenvalue of it is greater.
    fn least_diagonal(&self) -> f64 {
        let diagonal = (0..self.order).map(|index| self.diagonal(index));
        diagonal.fold(f64::INFINITY, f64::min)
    }

    /// The greatest shift, to about four digits, that [`Self::eigenvalues_exceed`].
    fn margin(&self) -> f64 {
        let greatest = self.least_diagonal();
        if greatest == f64::INFINITY {
            return greatest;
        }
        let fraction = |halvings: u32| greatest * power_of_two(-(halvings as i32));
        // The binade: 2^-1, ..., 2^-63 of the bound.
        let (mut refused, mut accepted) = (0, 1 << BINADE_STEPS);
        for _ in 0..BINADE_STEPS {
            let middle = (refused + accepted) / 2;
            if self.eigenvalues_exceed(fraction(middle)) {
                accepted = middle;
            } else {
                refused = middle;
            }
        }
        if accepted == 1 << BINADE_STEPS {
            return 0.0;
        }
        let (proved, beyond) = (fraction(accepted), fraction(refused));
        let (proved, _) = bisect(proved, beyond, REFINEMENT_STEPS, |shift| {
            self.eigenvalues_exceed(shift)
        });
        proved
    }

    /// Bisection with the plain factorisation, inside the bounds that the diagonal and
    /// Gershgorin's theorem give. Not a bound of any kind.
    fn estimated_smallest_eigenvalue(&self) -> f64 {
        let order = self.order;
        let gershgorin = |row: usize| {
            let absolute = self.midpoint[row * order..(row + 1) * order].iter();
            let sum: f64 = absolute.map(|value| value.abs()).sum();
            self.diagonal(row) - (sum - self.diagonal(row).abs())
        };
        let below = (0..order).map(gershgorin).fold(f64::INFINITY, f64::min);
        let (_, above) = bisect(below, self.least_diagonal(), ESTIMATE_STEPS, |shift| {
            self.factorises(|index| self.diagonal(index) - shift)
        });
        above
    }
}

/// Halves the interval between a number that is accepted and one that is not, so many times.
fn bisect(
    mut accepted: f64,
    mut refused: f64,
    steps: u32,
    accepts: impl Fn(f64) -> bool,
) -> (f64, f64) {
    for _ in 0..steps {
        let middle = 0.5 * accepted + 0.5 * refused;
        if accepts(middle) {
            accepted = middle;
        } else {
            refused = middle;
        }
    }
    (accepted, refused)
}

/// The number `c` of the corollary, evaluated upward; `None` if the order is too large for it or
/// a diagonal entry is negative or not finite.
fn factorisation_guard(order: usize, diagonal: impl Fn(usize) -> f64) -> Option<f64> {
    let mut trace = 0.0;
    let mut greatest: f64 = 0.0;
    for index in 0..order {
        let entry = diagonal(index);
        // Written so that NaN is refused too.
        if !(entry >= 0.0 && entry.is_finite()) {
            return None;
        }
        trace = add_up(trace, entry);
        greatest = greatest.max(entry);
    }
    // Exact up to an order of 2^50, far beyond what can be stored.
    let rows = order as f64;
    let roundings = (rows + 1.0) * UNIT_ROUNDOFF;
    if 4.0 * roundings >= 1.0 {
        return None;
    }
    let relative = div_up(roundings, sub_down(1.0, 2.0 * roundings));
    let underflow_factor = mul_up(4.0 * rows, add_up(2.0 * (rows + 1.0), greatest));
    let guard = add_up(
        mul_up(relative, trace),
        mul_up(underflow_factor, SMALLEST_POSITIVE),
    );
    guard.is_finite().then_some(guard)
}

/// Cholesky factorisation `A = R^T R` in place, in round to nearest, of the matrix in the lower
/// triangle; false as soon as a pivot is not positive and finite.
///
/// Every product is rounded before it is subtracted: the corollary does not cover fused
/// operations.
fn cholesky_succeeds(order: usize, matrix: &mut [f64]) -> bool {
    for row in 0..order {
        let (done, rest) = matrix.split_at_mut(row * order);
        let current = &mut rest[..order];
        for column in 0..row {
            let other = &done[column * order..(column + 1) * order];
            let mut sum = current[column];
            for inner in 0..column {
                sum -= current[inner] * other[inner];
            }
            current[column] = sum / other[column];
        }
        let mut pivot = current[row];
        for value in &current[..row] {
            pivot -= value * value;
        }
        // Written so that NaN is refused too.
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        current[row] = pivot.sqrt();
    }
    true
}
