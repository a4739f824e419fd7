//! Modes that no input reaches: an exact refutation without a solver and without a bound.
//!
//! Every problem asks for Q > 0 and Y with `A Q + Q A' + B Y + Y'B' + 2 alpha Q < 0` at the vertices, hence at every
//! point A of their hull. Let the columns of N, n x k, be a basis of the orthogonal complement of the smallest subspace
//! that contains Im B and is invariant under A. Then `N'B = 0` and `N'A = R N'` with R, k x k: the modes that no input
//! reaches. Multiplied by N' and N the condition is `R S + S R' + 2 alpha S < 0` with `S = N'Q N > 0`, which has a
//! solution only if `R + alpha I` is Hurwitz (Lyapunov). If it is not, no Q and Y exist, whatever their size.
//!
//! N is found modulo a prime, where numbers do not grow, and lifted to rationals. The refutation does not depend on how:
//! N has full column rank by its form, and both identities and the Routh-Hurwitz criterion are checked in integers and
//! rationals, from the doubles of the file without rounding.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use super::checked::Problem;
use super::integers::{cleared, hurwitz, product, scaled, sum, Integers, Rationals};
use crate::conditions::state_feedback::VertexPlant;
use verified::exact::without_denominators;

/// At most this many points of the hull are examined, vertices first.
const MAX_POINTS: usize = 256;

/// At most this many points times n^4, the products of a characteristic polynomial: seconds for the largest plants.
const MAX_PRODUCTS: usize = 4_000_000;

/// Exponent of the Mersenne prime `2^1279 - 1`. Numerators and denominators of N below half of its bits are found.
const PRIME_EXPONENT: usize = 1279;

/// A mode that no feedback moves and that does not decay fast enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnreachableMode {
    /// Vertices between which the plant with this mode lies, counted from 0; twice the same at a vertex.
    pub vertices: [usize; 2],
    /// True where the feedback is given: then the mode is one of its closed loop.
    pub given_gain: bool,
}

/// A point of the hull times a positive integer.
struct Point {
    vertices: [usize; 2],
    /// n x n.
    matrix: Integers,
    /// The positive integer.
    unit: BigInt,
}

impl Problem {
    /// A mode with a growth rate (real part) of at least `-alpha` [1/s] that no input reaches, at a vertex or at one of
    /// some points between two. `None` where none was found.
    pub fn unreachable_mode(&self) -> Option<UnreachableMode> {
        let rate = BigRational::from_float(self.task.decay_rate())?;
        let (vertices, unit, input) = in_integers(&self.plant)?;
        let prime = (BigInt::one() << PRIME_EXPONENT) - 1;
        let refuted = |point: &Point| {
            let modes = unreached(&point.matrix, &input, &prime);
            let shift = &rate * &point.unit;
            modes.is_some_and(|modes| !hurwitz(&shifted(modes, &shift)))
        };
        let count = (MAX_PRODUCTS / self.plant.states().pow(4)).min(MAX_POINTS);
        let found = points(&vertices, &unit).take(count).find(refuted)?;
        Some(UnreachableMode {
            vertices: found.vertices,
            given_gain: self.plant.gain.is_some(),
        })
    }
}

/// A matrix plus a multiple of the identity, times a positive integer.
fn shifted(mut matrix: Rationals, shift: &BigRational) -> Integers {
    for (index, row) in matrix.iter_mut().enumerate() {
        row[index] += shift;
    }
    without_denominators(&matrix).0
}

/// The vertices times one positive integer, which is the second, and B times another. With a given feedback F the
/// vertices are `A_i + B F`, and there is no input left (n x 0).
fn in_integers(plant: &VertexPlant) -> Option<(Vec<Integers>, BigInt, Integers)> {
    let (input, input_unit) = cleared(&plant.input)?;
    let vertices: Option<Vec<_>> = plant.vertices.iter().map(cleared).collect();
    let vertices = vertices?;
    let units = vertices.iter().map(|(_, unit)| unit.clone());
    // All are powers of two.
    let unit = units.max()?;
    let common = vertices.iter().map(|(a, own)| scaled(a, &(&unit / own)));
    let Some(gain) = &plant.gain else {
        return Some((common.collect(), unit, input));
    };
    let (gain, gain_unit) = cleared(gain)?;
    let fed_back = scaled(&product(&input, &gain), &unit);
    let further = input_unit * gain_unit;
    let closed = common.map(|a| sum(&scaled(&a, &further), &fed_back));
    let none = vec![Vec::new(); plant.states()];
    Some((closed.collect(), unit * further, none))
}

/// The vertices; then, between every two of them, the middle and the points where an entry changes its sign.
fn points<'a>(vertices: &'a [Integers], unit: &'a BigInt) -> impl Iterator<Item = Point> + 'a {
    let corners = vertices.iter().enumerate().map(|(index, matrix)| Point {
        vertices: [index, index],
        matrix: matrix.clone(),
        unit: unit.clone(),
    });
    let pairs = (0..vertices.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
    let between = pairs.flat_map(move |[i, j]| {
        let (a, b) = (&vertices[i], &vertices[j]);
        let entries = a.iter().flatten().zip(b.iter().flatten());
        let opposite = entries.filter(|(a, b)| (*a * *b).is_negative());
        let crossings = opposite.map(|(a, b)| (b.abs(), a.abs()));
        let middle = std::iter::once((BigInt::one(), BigInt::one()));
        middle.chain(crossings).map(move |(of_a, of_b)| Point {
            vertices: [i, j],
            matrix: sum(&scaled(a, &of_a), &scaled(b, &of_b)),
            unit: unit * (of_a + of_b),
        })
    });
    corners.chain(between)
}

/// R of the modes that no column of B reaches, k x k, in the unit of A. `None` where every mode is reached or N is not
/// found.
fn unreached(a: &Integers, b: &Integers, prime: &BigInt) -> Option<Rationals> {
    let n = a.len();
    let reached = Echelon::reached(a, b, prime);
    let is_free = |column: &usize| reached.rows.iter().all(|(pivot, _)| pivot != column);
    let free: Vec<usize> = (0..n).filter(is_free).collect();
    if free.is_empty() {
        return None;
    }
    // N', k x n: the identity in the free columns, so of full rank.
    let mut left = vec![vec![BigRational::zero(); n]; free.len()];
    for (row, &column) in left.iter_mut().zip(&free) {
        row[column] = BigRational::one();
        for (pivot, basis) in &reached.rows {
            row[*pivot] = -lifted(&basis[column], prime)?;
        }
    }
    let annihilates = product(&left, b).iter().flatten().all(Zero::is_zero);
    let image = product(&left, a);
    let modes: Rationals = image
        .iter()
        .map(|row| free.iter().map(|&column| row[column].clone()).collect())
        .collect();
    let entry = |row: &[BigRational], c: usize| -> BigRational {
        row.iter().zip(&left).map(|(x, left)| x * &left[c]).sum()
    };
    let mut rows = modes.iter().zip(&image);
    let invariant = rows.all(|(modes, image)| (0..n).all(|c| entry(modes, c) == image[c]));
    (annihilates && invariant).then_some(modes)
}

/// A subspace modulo a prime: rows with 1 at their pivot, where all others have 0.
struct Echelon<'a> {
    prime: &'a BigInt,
    rows: Vec<(usize, Vec<BigInt>)>,
}

impl<'a> Echelon<'a> {
    /// The smallest subspace that contains the columns of B and is invariant under A. Where it is the whole space modulo
    /// the prime, it is the whole space.
    fn reached(a: &Integers, b: &Integers, prime: &'a BigInt) -> Self {
        let rows = Vec::new();
        let mut reached = Echelon { prime, rows };
        let inputs = b.first().map_or(0, Vec::len);
        let column = |c: usize| b.iter().map(|row| reduced(&row[c], prime)).collect();
        let mut open: Vec<Vec<BigInt>> = (0..inputs).map(column).collect();
        while let Some(vector) = open.pop() {
            let entry = |row: &Vec<BigInt>| row.iter().zip(&vector).map(|(a, x)| a * x).sum();
            let image = a.iter().map(|row| reduced(&entry(row), prime)).collect();
            if reached.insert(vector) {
                open.push(image);
            }
        }
        reached
    }

    /// Adds a vector; false where it is in the subspace already.
    fn insert(&mut self, mut vector: Vec<BigInt>) -> bool {
        for (pivot, basis) in &self.rows {
            eliminate(&mut vector, *pivot, basis, self.prime);
        }
        let Some(pivot) = vector.iter().position(|entry| !entry.is_zero()) else {
            return false;
        };
        let Some(inverse) = vector[pivot].modinv(self.prime) else {
            return false;
        };
        let normal = vector.iter().map(|entry| entry * &inverse % self.prime);
        let normal: Vec<BigInt> = normal.collect();
        for (_, basis) in &mut self.rows {
            eliminate(basis, pivot, &normal, self.prime);
        }
        self.rows.push((pivot, normal));
        true
    }
}

/// The remainder in [0, prime).
fn reduced(value: &BigInt, prime: &BigInt) -> BigInt {
    let remainder = value % prime;
    match remainder.is_negative() {
        true => remainder + prime,
        false => remainder,
    }
}

/// Makes the entry at the pivot 0 with a row that has 1 there.
fn eliminate(vector: &mut [BigInt], pivot: usize, row: &[BigInt], prime: &BigInt) {
    let factor = vector[pivot].clone();
    if factor.is_zero() {
        return;
    }
    for (entry, of_row) in vector.iter_mut().zip(row) {
        *entry = reduced(&(&*entry - &factor * of_row), prime);
    }
}

/// The fraction with numerator and denominator below the root of half the prime that is `value` modulo the prime
/// (P. S. Wang, Proc. SYMSAC 1981: Euclid's algorithm, stopped midway).
fn lifted(value: &BigInt, prime: &BigInt) -> Option<BigRational> {
    let bound = (prime / 2_u8).sqrt();
    let (mut before, mut now) = (prime.clone(), value.clone());
    let (mut factor_before, mut factor) = (BigInt::zero(), BigInt::one());
    while now > bound {
        let quotient = &before / &now;
        let next = &before - &quotient * &now;
        before = std::mem::replace(&mut now, next);
        let next = &factor_before - &quotient * &factor;
        factor_before = std::mem::replace(&mut factor, next);
    }
    (factor.abs() <= bound).then(|| BigRational::new(now, factor))
}
