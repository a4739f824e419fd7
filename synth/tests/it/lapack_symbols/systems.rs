use super::matrices::{assert_matches, in_triangle, Padded, Random, FORBIDDEN, SIDES};
use super::symbols::{gesv, potrf, potrs};

#[test]
fn a_cholesky_factor_reproduces_its_matrix_and_writes_one_triangle() {
    let mut random = Random(4);
    for n in SIDES {
        for uplo in [b'L', b'U'] {
            let full = Padded::positive_definite(n, &mut random);
            let mut factored = full.only_triangle(uplo);
            assert_eq!(potrf(uplo, &mut factored), 0);
            assert_matches(&factored, "dpotrf", |i, j| {
                if in_triangle(uplo, i, j) {
                    factored.at(i, j)
                } else {
                    FORBIDDEN
                }
            });
            let lower = |i, l| factored.op(uplo == b'U', i, l);
            let rebuilt = Padded::from_fn(n, n, |i, j| {
                (0..=i.min(j)).map(|l| lower(i, l) * lower(j, l)).sum()
            });
            assert_matches(&rebuilt, "dpotrf", |i, j| full.at(i, j));
        }
    }
}

#[test]
fn a_cholesky_solve_recovers_the_solution() {
    let mut random = Random(5);
    for n in SIDES {
        for (uplo, nrhs) in [(b'l', 1), (b'L', 3), (b'u', 40), (b'U', 1), (b'U', 0)] {
            let full = Padded::positive_definite(n, &mut random);
            let mut factored = full.only_triangle(uplo.to_ascii_uppercase());
            assert_eq!(potrf(uplo, &mut factored), 0);
            let x = Padded::random(n, nrhs, &mut random);
            let mut b = Padded::from_fn(n, nrhs, |i, j| {
                (0..n).map(|l| full.at(i, l) * x.at(l, j)).sum()
            });
            assert_eq!(potrs(uplo, &factored, &mut b), 0);
            assert!(b.padding_is_untouched());
            // The least eigenvalue is above 0.5, so that errors grow at most as the norm of the matrix.
            let relative = Padded::from_fn(n, nrhs, |i, j| (b.at(i, j) - x.at(i, j)) / n as f64);
            assert_matches(&relative, "dpotrs", |_, _| 0.0);
        }
    }
}

#[test]
fn the_first_pivot_that_is_not_positive_is_reported() {
    let mut random = Random(6);
    for n in SIDES.into_iter().chain([150]) {
        for uplo in [b'L', b'U'] {
            for bad in [0, n / 2, n - 1] {
                for value in [-1.0, f64::NAN, f64::NEG_INFINITY] {
                    let mut a = Padded::positive_definite(n, &mut random).only_triangle(uplo);
                    let at = a.index(bad, bad);
                    a.data[at] = value;
                    assert_eq!(
                        potrf(uplo, &mut a),
                        bad as i32 + 1,
                        "order {n}, pivot {value}"
                    );
                }
            }
            assert_eq!(potrf(uplo, &mut Padded::from_fn(n, n, |_, _| 0.0)), 1);
            assert_eq!(potrf(uplo, &mut Padded::unset(n, n)), 1);
        }
    }
}

#[test]
fn a_value_off_the_diagonal_that_is_not_a_number_fails_the_factorization() {
    let mut random = Random(7);
    for n in [2, 4, 12, 36, 70] {
        let mut a = Padded::positive_definite(n, &mut random).only_triangle(b'L');
        let at = a.index(n - 1, 0);
        a.data[at] = f64::NAN;
        assert_eq!(potrf(b'L', &mut a), n as i32);
    }
}

#[test]
fn an_lu_solve_recovers_the_solution_and_its_row_swaps() {
    let mut random = Random(8);
    for n in SIDES {
        for nrhs in [0, 1, 5] {
            let a = Padded::random(n, n, &mut random);
            let x = Padded::random(n, nrhs, &mut random);
            let mut b = Padded::from_fn(n, nrhs, |i, j| {
                (0..n).map(|l| a.at(i, l) * x.at(l, j)).sum()
            });
            let (mut factored, mut pivots) = (a.clone(), vec![-1; n]);
            assert_eq!(gesv(&mut factored, &mut pivots, &mut b), 0);
            let mut order: Vec<usize> = (0..n).collect();
            for (k, &pivot) in pivots.iter().enumerate() {
                assert!(pivot as usize > k && pivot as usize <= n);
                order.swap(k, pivot as usize - 1);
            }
            let lower = |i, l| if i == l { 1.0 } else { factored.at(i, l) };
            let rebuilt = Padded::from_fn(n, n, |i, j| {
                (0..=i.min(j))
                    .map(|l| lower(i, l) * factored.at(l, j))
                    .sum()
            });
            assert_matches(&rebuilt, "dgesv factors", |i, j| a.at(order[i], j));
            assert!(b.padding_is_untouched());
            let residual = Padded::from_fn(n, nrhs, |i, j| {
                (0..n)
                    .map(|l| a.at(i, l) * (b.at(l, j) - x.at(l, j)))
                    .sum::<f64>()
                    / n as f64
            });
            assert_matches(&residual, "dgesv", |_, _| 0.0);
        }
    }
}

#[test]
fn a_singular_matrix_is_reported_and_leaves_the_right_hand_side() {
    let columns = [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [1.0, 0.0, 5.0]];
    for (first, wanted) in [(1.0, 2), (f64::NAN, 1)] {
        let mut a = Padded::from_fn(3, 3, |i, j| {
            if (i, j) == (0, 0) {
                first
            } else {
                columns[j][i]
            }
        });
        let mut b = Padded::from_fn(3, 1, |i, _| i as f64);
        assert_eq!(gesv(&mut a, &mut [0; 3], &mut b), wanted);
        assert_matches(&b, "right-hand side", |i, _| i as f64);
    }
}

#[test]
fn illegal_arguments_are_named_by_position() {
    let mut random = Random(9);
    let mut a = Padded::positive_definite(5, &mut random);
    let before = a.data.clone();
    assert_eq!(potrf(b'X', &mut a), -1);
    assert_eq!(potrs(b'X', &a.clone(), &mut a), -1);
    let mut flat = Padded::from_fn(1, 5, |_, _| 1.0);
    assert_eq!(
        potrs(b'L', &Padded::positive_definite(7, &mut random), &mut flat),
        -7
    );
    assert_eq!(gesv(&mut a, &mut [0; 5], &mut flat), -7);
    assert_eq!(a.data, before);
    let mut nothing = Padded::from_fn(0, 0, |_, _| 0.0);
    assert_eq!(potrf(b'L', &mut nothing), 0);
    assert_eq!(gesv(&mut nothing.clone(), &mut [], &mut nothing), 0);
}
