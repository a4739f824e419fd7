use core::ffi::c_int;

use super::matrices::{assert_matches, in_triangle, Padded, Random, FORBIDDEN, SIDES};
use super::symbols::{gemm, gemv, symv, syr2k, syrk};

/// Pairs of `alpha` and `beta`.
const FACTORS: [(f64, f64); 6] = [
    (1.0, 0.0),
    (1.0, 1.0),
    (0.5, 0.0),
    (-0.7, 0.4),
    (0.0, 0.5),
    (0.0, 0.0),
];

/// `beta C`, where `beta = 0` does not read `C`.
fn scaled(beta: f64, before: f64) -> f64 {
    if beta == 0.0 {
        0.0
    } else {
        beta * before
    }
}

#[test]
fn a_product_agrees_with_the_triple_loop() {
    let mut random = Random(1);
    let shapes = [
        (1, 1, 1),
        (2, 3, 4),
        (6, 6, 6),
        (7, 1, 5),
        (1, 9, 3),
        (4, 5, 0),
        (12, 12, 12),
        (36, 36, 36),
        (70, 33, 81),
    ];
    for (m, n, k) in shapes {
        for (trans_a, trans_b) in [(b'N', b'n'), (b'T', b'N'), (b'N', b'c'), (b't', b'C')] {
            let (ta, tb) = (
                !trans_a.eq_ignore_ascii_case(&b'n'),
                !trans_b.eq_ignore_ascii_case(&b'n'),
            );
            for (alpha, beta) in FACTORS {
                let a = if ta {
                    Padded::random(k, m, &mut random)
                } else {
                    Padded::random(m, k, &mut random)
                };
                let b = if tb {
                    Padded::random(n, k, &mut random)
                } else {
                    Padded::random(k, n, &mut random)
                };
                let before = if beta == 0.0 {
                    Padded::unset(m, n)
                } else {
                    Padded::random(m, n, &mut random)
                };
                let mut c = before.clone();
                gemm((trans_a, trans_b), k, alpha, &a, &b, beta, &mut c);
                assert_matches(&c, "dgemm", |i, j| {
                    let sum: f64 = (0..k).map(|l| a.op(ta, i, l) * b.op(tb, l, j)).sum();
                    alpha * sum + scaled(beta, before.at(i, j))
                });
            }
        }
    }
}

/// `C` before an update of one triangle.
fn symmetric_before(n: usize, uplo: u8, beta: f64, random: &mut Random) -> Padded {
    let before = if beta == 0.0 {
        Padded::unset(n, n)
    } else {
        Padded::random(n, n, random)
    };
    before.only_triangle(uplo)
}

fn check_symmetric_updates(
    n: usize,
    k: usize,
    options: (u8, u8),
    factors: (f64, f64),
    random: &mut Random,
) {
    let ((uplo, trans), (alpha, beta)) = (options, factors);
    let t = trans == b'T';
    let (rows, cols) = if t { (k, n) } else { (n, k) };
    let (a, b) = (
        Padded::random(rows, cols, random),
        Padded::random(rows, cols, random),
    );
    let before = symmetric_before(n, uplo, beta, random);
    let expected = |product: f64, i, j| {
        if in_triangle(uplo, i, j) {
            alpha * product + scaled(beta, before.at(i, j))
        } else {
            FORBIDDEN
        }
    };
    let mut c = before.clone();
    syrk(uplo, trans, k, alpha, &a, beta, &mut c);
    assert_matches(&c, "dsyrk", |i, j| {
        expected((0..k).map(|l| a.op(t, i, l) * a.op(t, j, l)).sum(), i, j)
    });
    let mut c = before.clone();
    syr2k(options, k, alpha, &a, &b, beta, &mut c);
    assert_matches(&c, "dsyr2k", |i, j| {
        let term = |l| a.op(t, i, l) * b.op(t, j, l) + b.op(t, i, l) * a.op(t, j, l);
        expected((0..k).map(term).sum(), i, j)
    });
}

#[test]
fn symmetric_updates_write_one_triangle_and_agree_with_the_triple_loop() {
    let mut random = Random(2);
    for n in SIDES {
        for k in [0, 1, 5, n] {
            for options in [(b'L', b'N'), (b'L', b'T'), (b'U', b'N'), (b'U', b'T')] {
                for factors in FACTORS {
                    check_symmetric_updates(n, k, options, factors, &mut random);
                }
            }
        }
    }
}

/// Where entry `i` of a vector of length `len` and stride `inc` lies.
fn position(i: usize, len: usize, inc: c_int) -> usize {
    let steps = if inc > 0 { i } else { len - 1 - i };
    steps * inc.unsigned_abs() as usize
}

/// `kind` is a transposition for `dgemv_`, a triangle for `dsymv_`.
fn check_product_with_vector(
    kind: u8,
    m: usize,
    n: usize,
    inc: (c_int, c_int),
    factors: (f64, f64),
    random: &mut Random,
) {
    let ((incx, incy), (alpha, beta)) = (inc, factors);
    let symmetric = kind == b'L' || kind == b'U';
    let a = Padded::random(m, n, random);
    let a = if symmetric { a.only_triangle(kind) } else { a };
    let (leny, lenx) = if kind == b'T' { (n, m) } else { (m, n) };
    let x: Vec<f64> = (0..lenx * 3).map(|_| random.next()).collect();
    let mut before = vec![FORBIDDEN; leny * 3];
    for i in 0..leny {
        before[position(i, leny, incy)] = if beta == 0.0 { f64::NAN } else { random.next() };
    }
    let mut y = before.clone();
    if symmetric {
        symv(kind, alpha, &a, (&x, incx), beta, &mut y, incy);
    } else {
        gemv(kind, alpha, &a, (&x, incx), beta, &mut y, incy);
    }
    let entry = |i, j| match kind {
        b'N' => a.at(i, j),
        b'T' => a.at(j, i),
        _ => a.op(!in_triangle(kind, i, j), i, j),
    };
    for i in 0..leny {
        let at = position(i, leny, incy);
        let sum: f64 = (0..lenx)
            .map(|j| entry(i, j) * x[position(j, lenx, incx)])
            .sum();
        let wanted = alpha * sum + scaled(beta, before[at]);
        assert!(
            (y[at] - wanted).abs() < 1e-13,
            "{} at {i}: {} {wanted}",
            kind as char,
            y[at]
        );
        y[at] = FORBIDDEN;
    }
    assert!(
        y.iter().all(|&entry| entry == FORBIDDEN),
        "written between the entries"
    );
}

#[test]
fn products_with_a_vector_agree_with_the_double_loop_for_every_stride() {
    let mut random = Random(3);
    for (m, n) in [(1, 1), (4, 4), (5, 3), (2, 9), (36, 36)] {
        for inc in [(1, 1), (2, 1), (-1, 3), (-2, -3)] {
            for factors in FACTORS {
                for kind in [b'N', b'T'] {
                    check_product_with_vector(kind, m, n, inc, factors, &mut random);
                }
                for kind in [b'L', b'U'] {
                    check_product_with_vector(kind, m, m, inc, factors, &mut random);
                }
            }
        }
    }
}

#[test]
fn an_illegal_argument_leaves_the_product_as_it_was() {
    let a = Padded::from_fn(5, 5, |i, j| (i + j) as f64);
    let before = Padded::from_fn(5, 5, |i, j| (i * j) as f64);
    let mut c = before.clone();
    gemm((b'X', b'N'), 5, 1.0, &a, &a, 0.0, &mut c);
    gemm(
        (b'N', b'T'),
        9,
        1.0,
        &a,
        &Padded::from_fn(1, 9, |_, _| 1.0),
        0.0,
        &mut c,
    );
    syrk(b'Q', b'N', 5, 1.0, &a, 0.0, &mut c);
    syr2k((b'L', b'?'), 5, 1.0, &a, &a, 0.0, &mut c);
    assert_eq!(c.data, before.data);
    let mut y = [3.0; 5];
    gemv(b'N', 1.0, &a, (&[1.0; 5], 0), 0.0, &mut y, 1);
    symv(b'L', 1.0, &a, (&[1.0; 5], 1), 0.0, &mut y, 0);
    assert_eq!(y, [3.0; 5]);
}

#[test]
fn values_that_are_not_numbers_pass_through_products() {
    let mut a = Padded::from_fn(6, 6, |_, _| 1.0);
    let at = a.index(2, 3);
    a.data[at] = f64::NAN;
    let mut c = Padded::from_fn(6, 6, |_, _| 0.0);
    gemm(
        (b'N', b'N'),
        6,
        1.0,
        &a,
        &Padded::from_fn(6, 6, |_, _| 1.0),
        1.0,
        &mut c,
    );
    assert!((0..6).all(|j| c.at(2, j).is_nan() && c.at(1, j) == 6.0));
}
