use std::f64::consts::PI;

use super::matrices::{assert_matches, assert_orthonormal, Padded, Random, SIDES};
use super::symbols::{singular, syevr, Eigen, Routine, Singular, Workspace};

#[test]
fn eigenvalues_are_ascending_and_reproduce_the_matrix() {
    let mut random = Random(10);
    for n in SIDES.into_iter().chain([140]) {
        for (uplo, scale) in [(b'L', 1.0), (b'U', 1.0), (b'L', 1e-300), (b'U', 1e300)] {
            for workspace in Workspace::LEGAL {
                let full = Padded::symmetric(n, &mut random);
                let stored =
                    Padded::from_fn(n, n, |i, j| scale * full.at(i, j)).only_triangle(uplo);
                let Eigen {
                    values,
                    vectors,
                    info,
                } = syevr([b'V', b'A', uplo], &stored, workspace);
                assert_eq!(info, 0);
                assert!(values.windows(2).all(|pair| pair[0] <= pair[1]));
                assert_orthonormal(&vectors, false, n);
                let term = |i, j, l| vectors.at(i, l) * (values[l] / scale) * vectors.at(j, l);
                let rebuilt = Padded::from_fn(n, n, |i, j| (0..n).map(|l| term(i, j, l)).sum());
                assert_matches(&rebuilt, "dsyevr", |i, j| full.at(i, j));
                let only_values = syevr([b'n', b'a', uplo], &stored, workspace);
                assert_eq!(only_values.info, 0);
                assert!((0..n * n).all(|at| only_values.vectors.at(at % n, at / n).is_nan()));
                for (one, other) in values.iter().zip(&only_values.values) {
                    assert!(
                        (one - other).abs() <= 1e-13 * n as f64 * scale,
                        "{one} {other}"
                    );
                }
            }
        }
    }
}

#[test]
fn known_spectra_are_found() {
    let second_difference = Padded::from_fn(12, 12, |i, j| match i.abs_diff(j) {
        0 => 2.0,
        1 => -1.0,
        _ => 0.0,
    });
    let values = syevr([b'N', b'A', b'U'], &second_difference, Workspace::Queried).values;
    for (k, value) in values.iter().enumerate() {
        assert!((value - 2.0 + 2.0 * (PI * (k + 1) as f64 / 13.0).cos()).abs() < 1e-14);
    }
    for (n, diagonal) in [(1, -3.0), (2, 0.0), (6, 0.0), (6, 1.0), (36, 1.0)] {
        let multiple = Padded::from_fn(n, n, |i, j| if i == j { diagonal } else { 0.0 });
        let found = syevr([b'V', b'A', b'L'], &multiple, Workspace::Queried);
        assert_eq!((found.info, found.values), (0, vec![diagonal; n]));
        assert_orthonormal(&found.vectors, false, n);
    }
}

#[test]
fn eigenvalues_do_not_depend_on_whether_vectors_are_wanted() {
    let mut random = Random(15);
    for n in [2, 4, 12, 36, 64, 65] {
        let vector = Padded::random(n, 1, &mut random);
        let rank_one = Padded::from_fn(n, n, |i, j| vector.at(i, 0) * vector.at(j, 0));
        let graded = Padded::from_fn(n, n, |i, j| {
            10f64.powi(-((i + j) as i32)) * if i == j { 3.0 } else { 1.0 }
        });
        let reversed = Padded::from_fn(n, n, |i, j| graded.at(n - 1 - i, n - 1 - j));
        let exchange = Padded::from_fn(n, n, |i, j| if i + j + 1 == n { 1.0 } else { 0.0 });
        let diagonal = Padded::from_fn(n, n, |i, j| if i == j { vector.at(i, 0) } else { 0.0 });
        let zero = Padded::from_fn(n, n, |_, _| 0.0);
        for a in [rank_one, graded, reversed, exchange, diagonal, zero] {
            let with = syevr([b'V', b'A', b'U'], &a, Workspace::Queried);
            let without = syevr([b'N', b'A', b'U'], &a, Workspace::Queried);
            assert_eq!((with.info, without.info), (0, 0));
            for (one, other) in with.values.iter().zip(&without.values) {
                assert!((one - other).abs() <= 1e-14 * n as f64, "{one} {other}");
            }
        }
    }
}

/// Length of the `l`-th left vector times `A`, or of `A` times the `l`-th right vector.
fn image_length(a: &Padded, vectors: &Padded, left: bool, l: usize) -> f64 {
    let (outer, inner) = if left {
        (a.cols, a.rows)
    } else {
        (a.rows, a.cols)
    };
    let image = |at| {
        (0..inner)
            .map(|i| a.op(left, at, i) * vectors.op(!left, i, l))
            .sum::<f64>()
    };
    (0..outer).map(|at| image(at).powi(2)).sum::<f64>().sqrt()
}

fn check_singular(routine: Routine, jobs: (u8, u8), a: &Padded, workspace: Workspace) {
    let size = a.rows.min(a.cols);
    let Singular {
        values,
        left,
        right,
        info,
    } = singular(routine, jobs, a, workspace);
    assert_eq!(info, 0);
    assert!(values.iter().all(|&value| value >= 0.0));
    assert!(values.windows(2).all(|pair| pair[0] >= pair[1]));
    let count = |job, full| match job {
        b'S' => size,
        b'A' => full,
        _ => 0,
    };
    let (lefts, rights) = (count(jobs.0, a.rows), count(jobs.1, a.cols));
    assert_orthonormal(&left, false, lefts);
    assert_orthonormal(&right, true, rights);
    for j in lefts..a.rows {
        assert!(
            (0..a.rows).all(|i| left.at(i, j).is_nan()),
            "left vector {j} written"
        );
    }
    let tolerance = 1e-13 * values.first().copied().unwrap_or(0.0).max(1.0);
    for (l, &value) in values.iter().enumerate() {
        assert!(lefts == 0 || (image_length(a, &left, true, l) - value).abs() < tolerance);
        assert!(rights == 0 || (image_length(a, &right, false, l) - value).abs() < tolerance);
    }
    if lefts > 0 && rights > 0 {
        let term = |i, j, l| left.at(i, l) * values[l] * right.at(l, j);
        let rebuilt = Padded::from_fn(a.rows, a.cols, |i, j| {
            (0..size).map(|l| term(i, j, l)).sum()
        });
        assert_matches(&rebuilt, "singular vectors", |i, j| a.at(i, j));
    }
    let entries = (0..a.cols).flat_map(|j| (0..a.rows).map(move |i| a.at(i, j)));
    let squares: f64 = entries.map(|entry| entry * entry).sum();
    let found: f64 = values.iter().map(|value| value * value).sum();
    assert!((found - squares).abs() <= 1e-12 * squares.max(1.0));
}

#[test]
fn singular_vectors_reproduce_the_matrix_for_every_job() {
    let mut random = Random(11);
    let shapes = [
        (1, 1),
        (1, 4),
        (5, 1),
        (2, 2),
        (4, 4),
        (6, 6),
        (7, 5),
        (5, 9),
        (3, 20),
        (30, 4),
        (36, 36),
        (140, 135),
    ];
    for (m, n) in shapes {
        let a = Padded::random(m, n, &mut random);
        for workspace in Workspace::LEGAL {
            for left in [b'S', b'A', b'N'] {
                check_singular(Routine::Gesdd, (left, left), &a, workspace);
                for right in [b'S', b'A', b'N'] {
                    check_singular(Routine::Gesvd, (left, right), &a, workspace);
                }
            }
        }
    }
}

#[test]
fn deficient_and_graded_matrices_have_singular_vectors() {
    let mut random = Random(12);
    let check = |a: &Padded| check_singular(Routine::Gesdd, (b'S', b'S'), a, Workspace::Queried);
    for n in [4, 12, 36] {
        check(&Padded::from_fn(n, n, |_, _| 0.0));
        check(&Padded::from_fn(
            n,
            n,
            |i, j| if i == j { 1.0 } else { 0.0 },
        ));
        check(&Padded::from_fn(
            n,
            n,
            |i, j| if i + 1 == j { 1.0 } else { 0.0 },
        ));
        let column = Padded::random(n, 2, &mut random);
        check(&Padded::from_fn(n, n, |i, j| {
            column.at(i, 0) * column.at(j, 1)
        }));
        let decay = |i: usize, j: usize| 10f64.powi(-((i + j) as i32));
        check(&Padded::from_fn(n, n, |i, j| {
            column.at(i, 0) * decay(i, j) + if i == j { 1e-8 } else { 0.0 }
        }));
    }
}

#[test]
fn singular_values_scale_with_the_matrix_to_the_ends_of_the_range() {
    let mut random = Random(13);
    for n in [4, 12, 36, 140] {
        let a = Padded::random(n, n, &mut random);
        let reference = singular(Routine::Gesdd, (b'N', b'N'), &a, Workspace::Queried).values;
        for scale in [1e-300, 1e300] {
            let scaled = Padded::from_fn(n, n, |i, j| scale * a.at(i, j));
            let found = singular(Routine::Gesdd, (b'S', b'S'), &scaled, Workspace::Queried);
            assert_eq!(found.info, 0);
            for (value, wanted) in found.values.iter().zip(&reference) {
                assert!((value / scale - wanted).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn a_value_that_is_not_finite_is_refused() {
    let mut random = Random(14);
    for n in [1, 2, 4, 36] {
        for value in [f64::NAN, f64::INFINITY] {
            for (row, col) in [(0, 0), (n - 1, 0), (n - 1, n - 1)] {
                let mut a = Padded::symmetric(n, &mut random);
                let at = a.index(row, col);
                a.data[at] = value;
                for job in [b'N', b'V'] {
                    assert_eq!(syevr([job, b'A', b'L'], &a, Workspace::Queried).info, -5);
                }
                assert_eq!(
                    singular(Routine::Gesdd, (b'S', b'S'), &a, Workspace::Queried).info,
                    -4
                );
                assert_eq!(
                    singular(Routine::Gesvd, (b'S', b'N'), &a, Workspace::Queried).info,
                    -5
                );
            }
        }
    }
}

#[test]
fn illegal_and_unsupported_arguments_are_named_by_position() {
    let a = Padded::from_fn(5, 5, |i, j| (i + j) as f64);
    let eigen = |options: &[u8; 3], workspace| syevr(*options, &a, workspace).info;
    assert_eq!(eigen(b"OAL", Workspace::Queried), -1);
    assert_eq!(eigen(b"VIL", Workspace::Queried), -2);
    assert_eq!(eigen(b"NVL", Workspace::Queried), -2);
    assert_eq!(eigen(b"VAX", Workspace::Queried), -3);
    assert_eq!(eigen(b"VAL", Workspace::TooSmall), -18);
    let svd = |routine, jobs, workspace| singular(routine, jobs, &a, workspace).info;
    assert_eq!(svd(Routine::Gesdd, (b'O', b'O'), Workspace::Queried), -1);
    assert_eq!(svd(Routine::Gesdd, (b'S', b'S'), Workspace::TooSmall), -12);
    assert_eq!(svd(Routine::Gesvd, (b'O', b'S'), Workspace::Queried), -1);
    assert_eq!(svd(Routine::Gesvd, (b'S', b'O'), Workspace::Queried), -2);
    assert_eq!(svd(Routine::Gesvd, (b'S', b'S'), Workspace::TooSmall), -13);
}

#[test]
fn empty_matrices_are_accepted() {
    let nothing = Padded::from_fn(0, 0, |_, _| 0.0);
    assert_eq!(
        syevr([b'V', b'A', b'L'], &nothing, Workspace::Queried).info,
        0
    );
    for (m, n) in [(3, 0), (0, 4)] {
        let found = singular(
            Routine::Gesdd,
            (b'A', b'A'),
            &Padded::from_fn(m, n, |_, _| 0.0),
            Workspace::Queried,
        );
        assert_eq!(found.info, 0);
        assert_orthonormal(&found.left, false, m);
        assert_orthonormal(&found.right, true, n);
    }
}
