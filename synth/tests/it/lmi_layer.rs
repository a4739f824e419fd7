//! Affine matrix expressions, conditions, their lowering and what a solver makes of it.

use crate::exact::Stream;
use crate::expressions::{lowered_value, Pair, Sdpa, World};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use synth::conditions::xu2020::Strictness;
use synth::lmi::{
    svec_index, Affine, Condition, LmiProblem, Semidefinite, SymmetricBlocks, Unknowns,
};
use synth::solve::{Accuracy, Backend, Clarabel, DenseColumns, Solution, Status};

/// Nothing is written beside the sources: a failing seed is printed.
fn cases(count: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(count)
    }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn unknowns_take_the_values_of_their_entries(seed: u64, rows in 1..5_usize, columns in 1..5_usize) {
        let mut world = World::new(seed);
        let pairs = [
            world.symmetric(rows),
            world.general(rows, columns),
            world.diagonal(columns),
            world.scalar(),
        ];
        for pair in &pairs {
            pair.check(&world.values);
        }
        let expected = rows * (rows + 1) / 2 + rows * columns + columns + 1;
        prop_assert_eq!(world.unknowns.count(), expected);
        prop_assert_eq!(world.unknowns.names().len(), expected);
    }

    #[test]
    fn sums_differences_multiples_and_constant_factors_agree_with_plain_matrices(
        seed: u64, rows in 1..5_usize, columns in 1..5_usize, inner in 1..5_usize, factor in -8..9_i32,
    ) {
        let mut world = World::new(seed);
        let (a, b) = (world.affine(rows, columns), world.affine(rows, columns));
        let (left, right) = (world.constant(inner, rows), world.constant(columns, inner));
        let factor = f64::from(factor) / 4.0;
        let check = |expression: Affine, value: DMatrix<f64>| {
            Pair { expression, value }.check(&world.values);
        };
        check(&a.expression + &b.expression, &a.value + &b.value);
        check(&a.expression - &b.expression, &a.value - &b.value);
        check(a.expression.clone() + b.expression.clone(), &a.value + &b.value);
        check(a.expression.clone() - b.expression.clone(), &a.value - &b.value);
        check(-&a.expression, -&a.value);
        check(factor * &a.expression, factor * &a.value);
        check(&left * &a.expression, &left * &a.value);
        check(&a.expression * &right, &a.value * &right);
        check(&left * a.expression.clone() * &right, &left * &a.value * &right);
        let mut sum = a.expression.clone();
        sum += &b.expression;
        check(sum, &a.value + &b.value);
        check(&a.expression - &a.expression, 0.0 * &a.value);
    }

    #[test]
    fn transposes_symmetric_parts_and_congruences_agree_with_plain_matrices(
        seed: u64, side in 1..5_usize, columns in 1..5_usize,
    ) {
        let mut world = World::new(seed);
        let wide = world.affine(side, columns);
        let square = world.affine(side, side);
        let symmetric = world.symmetric(side);
        let transform = world.constant(side, columns);
        let check = |expression: Affine, value: DMatrix<f64>| {
            Pair { expression, value }.check(&world.values);
        };
        check(wide.expression.transposed(), wide.value.transpose());
        let bracket = square.expression.symmetrised();
        prop_assert!(bracket.is_symmetric());
        check(bracket, &square.value + square.value.transpose());
        let congruence = symmetric.expression.congruence(&transform);
        prop_assert!(congruence.is_symmetric());
        check(congruence, transform.transpose() * &symmetric.value * &transform);
        prop_assert_eq!(square.expression.is_symmetric(), side == 1);
        prop_assert!(!world.affine(side, side + 1).expression.is_symmetric());
    }

    #[test]
    fn views_rows_and_multiples_of_a_constant_agree_with_plain_matrices(
        seed: u64, rows in 1..6_usize, columns in 1..6_usize,
    ) {
        let mut world = World::new(seed);
        let a = world.affine(rows, columns);
        let scalar = world.affine(1, 1);
        let pattern = world.constant(rows, columns);
        let (row, column) = (world.stream.integer(0, rows as i64 - 1) as usize, world.stream.integer(0, columns as i64 - 1) as usize);
        let (height, width) = (
            world.stream.integer(0, (rows - row) as i64) as usize,
            world.stream.integer(0, (columns - column) as i64) as usize,
        );
        let check = |expression: Affine, value: DMatrix<f64>| {
            Pair { expression, value }.check(&world.values);
        };
        check(a.expression.row(row), a.value.rows(row, 1).into_owned());
        check(
            a.expression.view(row, column, height, width),
            a.value.view((row, column), (height, width)).into_owned(),
        );
        check(scalar.expression.times_matrix(&pattern), scalar.value[(0, 0)] * &pattern);
        check(Affine::identity(rows, 2.5), 2.5 * DMatrix::identity(rows, rows));
        check(Affine::constant(&pattern), pattern.clone());
        // Where nothing is touched, the value is zero whatever the unknowns.
        for r in 0..rows {
            for c in 0..columns {
                let embedded = Affine::constant(&pattern).touches(r..r + 1, c..c + 1);
                prop_assert_eq!(embedded, pattern[(r, c)] != 0.0);
            }
        }
    }

    #[test]
    fn symmetric_blocks_mirror_what_stands_above_the_diagonal(
        seed: u64, first in 1..4_usize, second in 1..4_usize, third in 1..4_usize,
    ) {
        let mut world = World::new(seed);
        let (corner, beside, last) = (world.symmetric(first), world.affine(first, third), world.symmetric(third));
        let again = world.affine(first, third);
        let mut blocks = SymmetricBlocks::new(&[first, second, third]);
        blocks.add(0, 0, &corner.expression);
        blocks.add(0, 2, &beside.expression);
        blocks.add(0, 2, &again.expression);
        blocks.add(2, 2, &last.expression);
        let whole = blocks.finish();
        prop_assert!(whole.is_symmetric());
        let side = first + second + third;
        let mut expected = DMatrix::zeros(side, side);
        let sum = beside.value + again.value;
        expected.view_mut((0, 0), (first, first)).copy_from(&corner.value);
        expected.view_mut((0, first + second), (first, third)).copy_from(&sum);
        expected.view_mut((first + second, 0), (third, first)).copy_from(&sum.transpose());
        expected.view_mut((first + second, first + second), (third, third)).copy_from(&last.value);
        prop_assert_eq!(whole.value(&world.values), expected);
        prop_assert!(!whole.touches(first..first + second, 0..side));
    }

    #[test]
    fn margins_are_subtracted_once(seed: u64, side in 1..5_usize, quarter in 1..9_i32) {
        let mut world = World::new(seed);
        let (x, scalar) = (world.symmetric(side), world.scalar());
        let weight = world.symmetric(side).value;
        let margin = f64::from(quarter) / 4.0;
        let identity = DMatrix::identity(side, side);
        let check = |condition: Condition, value: DMatrix<f64>| {
            assert_eq!(condition.name(), "named");
            assert_eq!(condition.side(), side);
            Pair { expression: condition.expression().clone(), value }.check(&world.values);
        };
        let e = || x.expression.clone();
        check(Condition::semidefinite("named", e()), x.value.clone());
        check(Condition::positive("named", e(), margin), &x.value - margin * &identity);
        check(Condition::negative("named", e(), margin), -&x.value - margin * &identity);
        let fixed = Strictness::fixed(margin);
        check(fixed.positive("named", e()), &x.value - margin * &identity);
        check(fixed.positive_against("named", e(), &weight), &x.value - margin * &weight);
        let unknown = Strictness::unknown(0.5 * &scalar.expression);
        check(unknown.positive("named", e()), &x.value - 0.5 * scalar.value[(0, 0)] * &identity);
    }

    #[test]
    fn a_lowered_problem_and_its_sdpa_text_have_the_same_matrices_as_the_conditions(
        seed: u64, side in 1..5_usize, other in 1..5_usize,
    ) {
        let mut world = World::new(seed);
        let (x, y) = (world.symmetric(side), world.affine(other, side));
        let congruence = y.expression.transposed() * &world.constant(other, side);
        let objective = world.scalar().expression + world.affine(1, 1).expression;
        let problem = LmiProblem {
            objective,
            conditions: vec![
                Condition::positive("first", x.expression.clone(), 0.375),
                Condition::negative("second", congruence.symmetrised(), 1e-6),
                Condition::semidefinite("third", Affine::constant(&DMatrix::from_element(1, 1, 0.1))),
            ],
            unknowns: world.unknowns.clone(),
        };
        let lowered = problem.lower();
        assert_well_formed(&lowered);
        let read = Sdpa::read(&lowered.to_sdpa("a title\nof two lines"));
        prop_assert_eq!(&read.names, &["first", "second", "third"]);
        for _ in 0..3 {
            let values: Vec<f64> = world.values.iter().map(|_| world.stream.signed_unit()).collect();
            let cost: f64 = lowered.cost.iter().zip(&values).map(|(cost, value)| cost * value).sum();
            let expected = problem.objective.value(&values)[(0, 0)];
            prop_assert!((cost + lowered.offset - expected).abs() < 1e-12 * (100.0 + expected.abs()));
            prop_assert_eq!(&read.cost, &lowered.cost);
            prop_assert_eq!(read.offset, lowered.offset);
            for (index, condition) in problem.conditions.iter().enumerate() {
                let expected = condition.expression().value(&values);
                let scale = 1e-12 * (100.0 + expected.norm());
                let (lowered, read) = (lowered_value(&lowered, index, &values), read.value(index, &values));
                prop_assert!((lowered - &expected).norm() < scale);
                prop_assert!((read - &expected).norm() < scale);
            }
        }
    }
}

fn assert_well_formed(lowered: &Semidefinite) {
    for cone in &lowered.cones {
        let unknowns: Vec<usize> = cone
            .coefficients
            .iter()
            .map(|(unknown, _)| *unknown)
            .collect();
        assert!(
            unknowns.windows(2).all(|pair| pair[0] < pair[1]),
            "ascending"
        );
        assert!(unknowns.iter().all(|unknown| *unknown < lowered.cost.len()));
        let lists = cone.coefficients.iter().map(|(_, entries)| entries);
        for entries in lists.chain([&cone.constant]) {
            let mut places: Vec<usize> = entries
                .iter()
                .map(|e| svec_index(e.row, e.column))
                .collect();
            assert!(entries
                .iter()
                .all(|e| e.row <= e.column && e.column < cone.side));
            assert!(
                entries.iter().all(|e| e.value != 0.0),
                "zeros are not stored"
            );
            places.sort_unstable();
            places.dedup();
            assert_eq!(places.len(), entries.len(), "an entry appears twice");
        }
        assert!(cone
            .coefficients
            .iter()
            .all(|(_, entries)| !entries.is_empty()));
    }
}

#[test]
#[should_panic(expected = "a diagonal block must be symmetric")]
fn a_diagonal_block_that_is_not_symmetric_panics() {
    let mut unknowns = Unknowns::new();
    SymmetricBlocks::new(&[2, 1]).add(0, 0, &unknowns.general("Q", 2, 2));
}

#[test]
#[should_panic(expected = "give the blocks on and above the diagonal")]
fn a_block_below_the_diagonal_panics() {
    SymmetricBlocks::new(&[2, 1]).add(1, 0, &Affine::zeros(1, 2));
}

#[test]
#[should_panic(expected = "a matrix inequality needs a symmetric matrix")]
fn a_condition_that_is_not_symmetric_panics() {
    let mut unknowns = Unknowns::new();
    Condition::positive("Q", unknowns.general("Q", 2, 2), 0.0);
}

#[test]
#[should_panic(expected = "the shapes of a sum must agree")]
fn a_sum_of_different_shapes_panics() {
    let _ = Affine::zeros(2, 3) + Affine::zeros(3, 2);
}

#[test]
fn the_stacked_upper_triangle_is_read_by_columns() {
    let places = |side: usize| {
        let entries = (0..side).flat_map(|column| (0..=column).map(move |row| (row, column)));
        entries
            .map(|(row, column)| svec_index(row, column))
            .collect::<Vec<_>>()
    };
    assert_eq!(places(4), (0..10).collect::<Vec<_>>());
    assert_eq!(places(5), (0..15).collect::<Vec<_>>());
    let some = [
        (0, 0),
        (0, 1),
        (1, 1),
        (0, 3),
        (2, 3),
        (3, 3),
        (0, 4),
        (3, 4),
        (4, 4),
    ];
    let expected = [0, 1, 2, 6, 8, 9, 10, 13, 14];
    assert_eq!(some.map(|(row, column)| svec_index(row, column)), expected);
}

const TIGHT: Accuracy = Accuracy {
    relative_gap: 1e-10,
    objective_unit: 1.0,
};

fn solve(problem: &LmiProblem) -> Solution {
    let solutions = [DenseColumns::None, DenseColumns::FromSide(2)].map(|dense_columns| {
        let solution = Clarabel { dense_columns }.solve(&problem.lower(), TIGHT, None);
        solution.expect("a problem with finite numbers")
    });
    let [plain, padded] = solutions;
    assert_eq!(plain.status, Status::Solved, "{}", plain.status_text);
    assert!((plain.objective - padded.objective).abs() <= 1e-7 * (1.0 + plain.objective.abs()));
    plain
}

/// The ends of `{ t : C + t D >= 0 }` for C > 0 and an indefinite D, from the eigenvalues of D relative
/// to C. Any other order of the entries, or a missing sqrt(2), is another pencil with other ends.
#[test]
fn the_solver_sees_every_entry_of_the_matrices_at_its_place() {
    let mut stream = Stream(15);
    for side in [1, 4, 5] {
        for _ in 0..4 {
            let root = DMatrix::from_fn(side, side, |_, _| stream.signed_unit());
            let c = &root * root.transpose() + DMatrix::identity(side, side) * 0.2;
            let mut d = DMatrix::from_fn(side, side, |_, _| stream.signed_unit());
            d = &d + d.transpose();
            let half = c.clone().cholesky().expect("positive definite").l();
            let inverse = half.try_inverse().expect("positive definite");
            let relative = (&inverse * &d * inverse.transpose()).symmetric_eigenvalues();
            for (sign, extreme) in [(1.0, relative.max()), (-1.0, relative.min())] {
                if sign * extreme <= 0.05 {
                    continue;
                }
                let mut unknowns = Unknowns::new();
                let t = unknowns.scalar("t");
                let pencil = Affine::constant(&c) + t.times_matrix(&d);
                let problem = LmiProblem {
                    unknowns,
                    objective: sign * &t,
                    conditions: vec![Condition::semidefinite("pencil", pencil)],
                };
                let solution = solve(&problem);
                let end = -1.0 / extreme;
                let found = solution.values[0];
                assert!(
                    (found - end).abs() <= 1e-6 * (1.0 + end.abs()),
                    "{found} is not {end}"
                );
                assert!((solution.objective - sign * end).abs() <= 1e-6 * (1.0 + end.abs()));
                check_dual(&solution.duals[0], &c, &d, end, sign);
            }
        }
    }
}

/// At the optimum <D, Z> = cost, <C + t D, Z> = 0 and Z >= 0: Z is the null vector's projector.
fn check_dual(dual: &[f64], c: &DMatrix<f64>, d: &DMatrix<f64>, t: f64, cost: f64) {
    let side = c.nrows();
    let z = DMatrix::from_fn(side, side, |r, col| {
        dual[svec_index(r.min(col), r.max(col))]
    });
    let tolerance = 1e-5 * z.norm();
    let eigen = (c + d * t).symmetric_eigen();
    let null = eigen
        .eigenvectors
        .column(eigen.eigenvalues.imin())
        .into_owned();
    let expected = &null * null.transpose() * (cost / null.dot(&(d * &null)));
    assert!((&z - &expected).norm() <= tolerance, "{z}{expected}");
}

/// The nearest positive semidefinite matrix, in the norm that counts every entry: `[I, X - C stacked;
/// *, t] >= 0`. Its solution replaces the negative eigenvalues of C by zeros.
#[test]
fn the_solver_projects_onto_the_positive_semidefinite_matrices() {
    let mut stream = Stream(16);
    for side in [4, 5] {
        let half = DMatrix::from_fn(side, side, |_, _| stream.signed_unit());
        let c = &half + half.transpose();
        let eigen = c.clone().symmetric_eigen();
        let clipped = DMatrix::from_diagonal(&eigen.eigenvalues.map(|value| value.max(0.0)));
        let expected = &eigen.eigenvectors * clipped * eigen.eigenvectors.transpose();
        let distance = (&expected - &c).norm();
        assert!(distance > 0.3, "C is not semidefinite already");

        let mut unknowns = Unknowns::new();
        let x = unknowns.symmetric("X", side);
        let t = unknowns.scalar("t");
        let difference = &x - &Affine::constant(&c);
        // All entries, both triangles, as one column.
        let count = side * side;
        let mut column = Affine::zeros(count, 1);
        for r in 0..side {
            for col in 0..side {
                let mut unit = DMatrix::zeros(count, 1);
                unit[(r * side + col, 0)] = 1.0;
                column += &(&unit * difference.view(r, col, 1, 1));
            }
        }
        let mut bordered = SymmetricBlocks::new(&[count, 1]);
        bordered.add(0, 0, &t.times_matrix(&DMatrix::identity(count, count)));
        bordered.add(0, 1, &column);
        bordered.add(1, 1, &t);
        let problem = LmiProblem {
            unknowns,
            objective: t,
            conditions: vec![
                Condition::semidefinite("X", x.clone()),
                Condition::semidefinite("distance", bordered.finish()),
            ],
        };
        let solution = solve(&problem);
        assert!(
            (solution.objective - distance).abs() < 1e-6,
            "{} {distance}",
            solution.objective
        );
        let found = x.value(&solution.values);
        assert!((&found - &expected).norm() < 1e-4, "{found}{expected}");
    }
}

#[test]
fn a_margin_moves_the_optimum_by_itself() {
    // The least p with [p, 1; 1, p] >= margin is 1 + margin.
    for margin in [0.0, 0.25, 1.5] {
        let mut unknowns = Unknowns::new();
        let p = unknowns.scalar("p");
        let exchange = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 1.0, 0.0]);
        let matrix = p.times_matrix(&DMatrix::identity(2, 2)) + Affine::constant(&exchange);
        let problem = LmiProblem {
            unknowns,
            objective: p,
            conditions: vec![Condition::positive("both", matrix, margin)],
        };
        let solution = solve(&problem);
        assert!(
            (solution.objective - 1.0 - margin).abs() < 1e-7,
            "{}",
            solution.objective
        );
    }
}

#[test]
fn a_constant_in_the_objective_is_kept() {
    let mut unknowns = Unknowns::new();
    let p = unknowns.scalar("p");
    let problem = LmiProblem {
        objective: 2.0 * &p + Affine::identity(1, 5.0),
        conditions: vec![Condition::positive("p", p, 3.0)],
        unknowns,
    };
    let solution = solve(&problem);
    assert!(
        (solution.objective - 11.0).abs() < 1e-6,
        "{}",
        solution.objective
    );
    let values = DVector::from_vec(solution.values);
    assert!((values[0] - 3.0).abs() < 1e-6);
}
