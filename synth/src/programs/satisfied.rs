//! Whether a solver's point counts: an objective is no evidence of an optimum where its point violates the conditions.

use sdp::lmi::Affine;
use sdp::solve::Solution;

use super::session::has_point;
use crate::riccati::positive;

/// What a matrix inequality may miss at a point that counts, relative to the terms of its diagonal.
const VIOLATION: f64 = 1e-6;

/// True where a solver's point satisfies every inequality `matrix >= 0` but for rounding, each relative to the sizes of
/// the terms that its diagonal is the sum of.
pub(crate) fn satisfied<'a>(
    solution: &Solution,
    matrices: impl IntoIterator<Item = &'a Affine>,
) -> bool {
    has_point(solution)
        && matrices.into_iter().all(|expression| {
            let mut matrix = expression.value(&solution.values);
            let terms = expression.magnitudes(&solution.values).diagonal();
            let least = VIOLATION * terms.max();
            for k in 0..terms.len() {
                matrix[(k, k)] += VIOLATION * (terms[k] + least);
            }
            positive(&matrix)
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;
    use sdp::lmi::Unknowns;
    use sdp::solve::Status;

    /// `[ 1, y; y, x ] >= 0` and `1e6 x - 1e6 >= 0` at (x, y).
    fn holds(x: f64, y: f64, status: Status) -> bool {
        let mut unknowns = Unknowns::new();
        let (first, second) = (unknowns.scalar("x"), unknowns.scalar("y"));
        let at = |row: usize, column: usize| {
            let mut entry = DMatrix::zeros(2, 2);
            entry[(row, column)] = 1.0;
            entry[(column, row)] = 1.0;
            entry
        };
        let pair = Affine::constant(&at(0, 0)) + second.times_matrix(&at(0, 1));
        let pair = pair + first.times_matrix(&at(1, 1));
        let active = 1e6 * first - Affine::identity(1, 1e6);
        let solution = Solution {
            status,
            status_text: String::new(),
            values: vec![x, y],
            duals: Vec::new(),
            objective: 0.0,
            iterations: 0,
            seconds: 0.0,
        };
        satisfied(&solution, [&pair, &active])
    }

    #[test]
    fn a_point_counts_up_to_rounding_relative_to_the_terms() {
        assert!(holds(1.0, 0.5, Status::Solved));
        // Both inequalities are active, and missed by less than their terms are known to.
        assert!(holds(1.0 - 1e-9, 1.0, Status::Inaccurate));
        assert!(!holds(1.0 - 1e-4, 0.5, Status::Solved));
        assert!(!holds(1.0, 1.001, Status::Solved));
    }

    #[test]
    fn nothing_counts_without_a_point_or_with_numbers_that_are_none() {
        assert!(!holds(1.0, 0.5, Status::Infeasible));
        assert!(!holds(1.0, f64::NAN, Status::Solved));
    }
}
