//! Sizes of states from the plant itself.
//!
//! Diagonal changes of units `x = D x'`, `u = E u'` and of the unit of time turn A and B into `D^-1 A D` and `D^-1 B E`,
//! both multiplied by the unit of time. Here they make the entries as alike as they can: the squares of their logarithms
//! have the smallest sum (A. R. Curtis and J. K. Reid, "On the automatic scaling of matrices for Gaussian elimination",
//! J. Inst. Maths Applics 10 (1972) 118-124). Sizes in other units are the same sizes.

use nalgebra::{DMatrix, DVector};

/// The largest logarithm of a size that is not known.
const LARGEST_LOGARITHM: f64 = 300.0;

/// Singular values of the normal equations, whose entries are counts, below this are 0: what they belong to is free.
const FREE: f64 = 1e-10;

/// A size of each state: the known ones, and for the others those in which the entries of all A_i (n x n) and of
/// B (n x m, inputs and whatever else drives the states) are as alike as diagonal units of states, inputs and time can
/// make them. Where no size is known a common factor of all is free. A known size is above 0 and finite.
pub fn balanced(
    vertices: &[DMatrix<f64>],
    input: &DMatrix<f64>,
    known: &[Option<f64>],
) -> DVector<f64> {
    let (n, m) = input.shape();
    // Unknowns: the logarithms of the sizes of states and inputs, and of the unit of time.
    let unknowns = n + m + 1;
    let mut normal = DMatrix::<f64>::zeros(unknowns, unknowns);
    let mut right = DVector::<f64>::zeros(unknowns);
    for entry in entries(vertices, input) {
        // log|a| + log d_from - log d_to + log t should be 0.
        let mut row = vec![(n + m, 1.0)];
        let mut rest = -entry.magnitude.ln();
        for (place, sign) in entry.ends() {
            match known.get(place).copied().flatten() {
                Some(size) => rest -= sign * size.ln(),
                None => row.push((place, sign)),
            }
        }
        for &(i, x) in &row {
            right[i] += x * rest;
            for &(j, y) in &row {
                normal[(i, j)] += x * y;
            }
        }
    }
    let solved = normal.svd(true, true).solve(&right, FREE);
    let logs = solved.unwrap_or_else(|_| DVector::zeros(unknowns));
    let found = |log: f64| match log.is_finite() {
        true => log.clamp(-LARGEST_LOGARITHM, LARGEST_LOGARITHM).exp(),
        false => 1.0,
    };
    DVector::from_fn(n, |state, _| {
        known[state].unwrap_or_else(|| found(logs[state]))
    })
}

/// An entry of [A, B] that is not 0: what it leads from and to, inputs counted after the states.
struct Entry {
    from: usize,
    to: usize,
    magnitude: f64,
}

impl Entry {
    /// Where the sizes stand that multiply and divide the entry; none on the diagonal.
    fn ends(&self) -> impl Iterator<Item = (usize, f64)> {
        let ends = [(self.from, 1.0), (self.to, -1.0)];
        let diagonal = self.from == self.to;
        ends.into_iter().filter(move |_| !diagonal)
    }
}

/// The largest magnitude of every entry over the vertices.
fn entries(vertices: &[DMatrix<f64>], input: &DMatrix<f64>) -> Vec<Entry> {
    let (n, m) = input.shape();
    let largest = |row: usize, column: usize| {
        let own = vertices.iter().map(|a| a[(row, column)].abs());
        own.fold(0.0, f64::max)
    };
    let all = (0..n + m).flat_map(|from| (0..n).map(move |to| (from, to)));
    all.map(|(from, to)| Entry {
        from,
        to,
        magnitude: match from < n {
            true => largest(to, from),
            false => input[(to, from - n)].abs(),
        },
    })
    .filter(|entry| entry.magnitude > 0.0)
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plant in which every state is reached, and the same in other units of the states.
    fn in_two_units(units: &DVector<f64>) -> [(DMatrix<f64>, DMatrix<f64>); 2] {
        let a = DMatrix::from_row_slice(3, 3, &[-1.0, 2.0, 0.0, 0.5, -0.1, 1.0, 0.3, 0.0, -2.0]);
        let b = DMatrix::from_row_slice(3, 1, &[0.0, 0.0, 1.0]);
        let restated = DMatrix::from_fn(3, 3, |r, c| a[(r, c)] * units[c] / units[r]);
        let input = DMatrix::from_fn(3, 1, |r, _| b[r] / units[r]);
        [(a, b), (restated, input)]
    }

    #[test]
    fn balancing_undoes_a_change_of_units() {
        let units = DVector::from_vec(vec![1e-6, 1e3, 1.0]);
        let [before, after] = in_two_units(&units).map(|(a, b)| balanced(&[a], &b, &[None; 3]));
        let ratio = after.component_mul(&units).component_div(&before);
        for k in 1..3 {
            assert!((ratio[k] / ratio[0] - 1.0).abs() < 1e-6, "{ratio}");
        }
    }

    #[test]
    fn known_sizes_are_kept_and_the_others_are_the_same_in_any_units() {
        let units = DVector::from_vec(vec![1e-6, 1e3, 1.0]);
        let known = [None, Some(0.3), None];
        let there = known.iter().zip(&units);
        let there: Vec<_> = there
            .map(|(size, unit)| size.map(|size| size / unit))
            .collect();
        let [own, other] = in_two_units(&units);
        let own = balanced(&[own.0], &own.1, &known);
        let other = balanced(&[other.0], &other.1, &there);
        assert_eq!((own[1], other[1]), (0.3, 0.3 / 1e3));
        let ratio = other.component_mul(&units).component_div(&own);
        for k in 0..3 {
            assert!((ratio[k] - 1.0).abs() < 1e-6, "{ratio}");
        }
        // All that is known is left alone.
        let all = [Some(1.0), Some(2.0), Some(3.0)];
        let [(a, b), _] = in_two_units(&units);
        assert_eq!(
            balanced(&[a], &b, &all),
            DVector::from_vec(vec![1.0, 2.0, 3.0])
        );
    }
}
