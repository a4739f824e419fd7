use std::f64::consts::PI;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// Maximizes the sum over the cones of `t` with `C - t I >= 0`, `C` being `min(i, j)` of each cone's side.
fn sum_of_smallest_eigenvalues(sides: &[usize]) -> f64 {
    let (mut rhs, mut rows, mut values, mut starts) = (vec![], vec![], vec![], vec![0]);
    for &side in sides {
        for j in 0..side {
            for i in 0..=j {
                let weight = if i == j { 1.0 } else { 2f64.sqrt() };
                rows.push(rhs.len());
                rhs.push(weight * (i + 1) as f64);
                values.push(if i == j { 1.0 } else { 0.0 });
            }
        }
        starts.push(rows.len());
    }
    let cones: Vec<_> = sides
        .iter()
        .map(|&side| SupportedConeT::PSDTriangleConeT(side))
        .collect();
    let unknowns = sides.len();
    let constraints = CscMatrix::new(rhs.len(), unknowns, starts, rows, values);
    let settings = DefaultSettings {
        verbose: false,
        ..Default::default()
    };
    let (quadratic, linear) = (CscMatrix::zeros((unknowns, unknowns)), vec![-1.0; unknowns]);
    let mut solver =
        DefaultSolver::new(&quadratic, &linear, &constraints, &rhs, &cones, settings).unwrap();
    solver.solve();
    assert_eq!(solver.solution.status, SolverStatus::Solved);
    -solver.solution.obj_val
}

#[test]
fn a_semidefinite_program_is_solved_through_the_symbols() {
    for sides in [&[4][..], &[12], &[4, 12], &[36]] {
        // The inverse of `min(i, j)` is the second difference with one free end.
        let smallest = |side: usize| {
            0.25 / (PI * (side as f64 - 0.5) / (2.0 * side as f64 + 1.0))
                .sin()
                .powi(2)
        };
        let wanted: f64 = sides.iter().map(|&side| smallest(side)).sum();
        let found = sum_of_smallest_eigenvalues(sides);
        assert!((found - wanted).abs() < 1e-6, "{sides:?}: {found} {wanted}");
    }
}
