//! The proof of positive definiteness against exact elimination.

use crate::exact::{
    is_positive_definite, quotient, rational, rational_rows, shifted, Exact, Stream,
};
use num_rational::BigRational;
use synth::certify::definite::{
    prove_positive_definite, IntervalMatrix, Margin, NotProved, Obstacle,
};
use synth::certify::interval::Interval;
use synth::certify::scalar::Scalar;

/// A symmetric matrix of doubles, row by row.
struct Dense {
    order: usize,
    entries: Vec<f64>,
}

impl Dense {
    fn from_upper(order: usize, mut entry: impl FnMut(usize, usize) -> f64) -> Self {
        let mut entries = vec![0.0; order * order];
        for row in 0..order {
            for column in row..order {
                let value = entry(row, column);
                entries[row * order + column] = value;
                entries[column * order + row] = value;
            }
        }
        Dense { order, entries }
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.order + column]
    }

    fn map(&self, mut change: impl FnMut(usize, usize, f64) -> f64) -> Self {
        Dense::from_upper(self.order, |row, column| {
            change(row, column, self.at(row, column))
        })
    }

    fn exact(&self) -> Vec<Vec<BigRational>> {
        rational_rows(self.order, &self.entries)
    }

    /// Scaled by powers of two so that the diagonal is in `[0.5, 2)`.
    fn scaled(&self) -> Self {
        let factor = |index: usize| {
            let mut factor = 1.0;
            while self.at(index, index) * factor * factor >= 2.0 {
                factor *= 0.5;
            }
            while self.at(index, index) * factor * factor < 0.5 {
                factor *= 2.0;
            }
            factor
        };
        let factors: Vec<f64> = (0..self.order).map(factor).collect();
        self.map(|row, column, value| value * factors[row] * factors[column])
    }

    fn prove(&self) -> Result<Margin, NotProved> {
        prove_positive_definite(&self.widened(|_, _| 0.0))
    }

    fn widened(&self, radius: impl Fn(usize, usize) -> f64) -> IntervalMatrix {
        IntervalMatrix::from_upper(self.order, |row, column| {
            let (middle, radius) = (self.at(row, column), radius(row, column));
            Interval::new(middle - radius, middle + radius)
        })
    }
}

/// What a solver without verification would use.
fn plain_cholesky_accepts(matrix: &Dense) -> bool {
    let order = matrix.order;
    let mut factor = matrix.entries.clone();
    for row in 0..order {
        for column in 0..=row {
            let mut sum = factor[row * order + column];
            for inner in 0..column {
                sum -= factor[row * order + inner] * factor[column * order + inner];
            }
            if column < row {
                factor[row * order + column] = sum / factor[column * order + column];
            } else if sum > 0.0 {
                factor[row * order + row] = sum.sqrt();
            } else {
                return false;
            }
        }
    }
    true
}

/// A Gram matrix of `order` vectors in one dimension less, so of deficient rank up to rounding:
/// exactly singular with small integers, singular to about `1e-16` with general doubles.
fn singular_gram(stream: &mut Stream, order: usize, integers: bool) -> Dense {
    let rank = order - 1;
    let component = |stream: &mut Stream| {
        if integers {
            stream.integer(-9, 9) as f64
        } else {
            stream.signed_unit()
        }
    };
    let vectors: Vec<f64> = (0..order * rank).map(|_| component(stream)).collect();
    let of = |index: usize| &vectors[index * rank..(index + 1) * rank];
    Dense::from_upper(order, |row, column| {
        of(row)
            .iter()
            .zip(of(column))
            .map(|(left, right)| left * right)
            .sum()
    })
}

/// Singular Gram matrices with the diagonal moved by `10^power` relative to its mean, badly
/// scaled by powers of two in every third of them.
fn near_singular(stream: &mut Stream, power: f64, sign: f64, kind: usize) -> Dense {
    let order = stream.integer(2, 36) as usize;
    let gram = singular_gram(stream, order, kind % 2 == 0);
    let mean = (0..order).map(|index| gram.at(index, index)).sum::<f64>() / order as f64;
    let shift = sign * mean * 10_f64.powf(power);
    let moved = gram.map(|row, column, value| if row == column { value + shift } else { value });
    if kind % 3 != 0 {
        return moved;
    }
    let scales: Vec<f64> = (0..order)
        .map(|_| 2_f64.powi(stream.integer(-60, 60) as i32))
        .collect();
    moved.map(|row, column, value| value * scales[row] * scales[column])
}

#[test]
fn near_singular_matrices_are_never_proved_falsely_where_plain_cholesky_is() {
    let mut stream = Stream(20060433);
    let (mut definite, mut proved, mut false_proofs, mut false_plain) = (0, 0, 0, 0);
    let count = 480;
    for index in 0..count {
        let power = -17.0 + 6.0 * (index as f64 / count as f64);
        let sign = if stream.integer(0, 1) == 0 { -1.0 } else { 1.0 };
        let matrix = near_singular(&mut stream, power, sign, index);
        let truth = is_positive_definite(&matrix.exact());
        let verdict = matrix.prove();
        definite += usize::from(truth);
        proved += usize::from(verdict.is_ok());
        false_proofs += usize::from(verdict.is_ok() && !truth);
        false_plain += usize::from(plain_cholesky_accepts(&matrix) && !truth);
        if let Err(refusal) = verdict {
            assert!(refusal.estimate < 1e-10, "matrix {index}: {refusal}");
        }
    }
    println!(
        "{count} matrices: {definite} positive definite, {proved} proved, \
         {false_proofs} falsely; plain Cholesky falsely accepts {false_plain}"
    );
    assert_eq!(false_proofs, 0);
    assert!(
        false_plain > 0,
        "the matrices are too easy for this test to mean anything"
    );
    assert!(proved > count / 8 && definite < 7 * count / 8);
}

#[test]
fn every_matrix_with_a_scaled_margin_of_one_billionth_is_proved() {
    let mut stream = Stream(7);
    let mut proved = 0;
    for index in 0..120 {
        let power = -9.5 + 4.0 * (index as f64 / 120.0);
        let matrix = near_singular(&mut stream, power, 1.0, index);
        let scaled = matrix.scaled().exact();
        let margin = quotient(1, 1_000_000_000);
        if !is_positive_definite(&shifted(&scaled, &margin)) {
            continue;
        }
        let verdict = matrix
            .prove()
            .expect("a matrix with a margin of 1e-9 is proved");
        assert!(verdict.proved >= 0.999e-9, "matrix {index}: {verdict:?}");
        // What is claimed is true, and little is given away.
        assert!(is_positive_definite(&shifted(
            &scaled,
            &rational(verdict.proved)
        )));
        assert!(!is_positive_definite(&shifted(
            &scaled,
            &rational(1.001 * verdict.proved)
        )));
        proved += 1;
    }
    assert!(proved >= 60, "only {proved} matrices had the margin");
}

#[test]
fn the_margin_claimed_for_a_barely_definite_matrix_is_true() {
    let mut stream = Stream(99);
    let mut examined = 0;
    for index in 0..160 {
        let matrix = near_singular(&mut stream, -13.5, 1.0, index);
        let Ok(margin) = matrix.prove() else { continue };
        let claimed = shifted(&matrix.scaled().exact(), &rational(margin.proved));
        assert!(is_positive_definite(&claimed), "matrix {index}: {margin:?}");
        examined += usize::from(margin.proved > 0.0);
    }
    assert!(examined >= 40, "only {examined} margins");
}

#[test]
fn the_estimate_of_an_indefinite_matrix_is_its_smallest_eigenvalue() {
    let mut stream = Stream(5);
    for index in 0..24 {
        let matrix = near_singular(&mut stream, -3.0, -1.0, index);
        let refusal = matrix.prove().expect_err("an indefinite matrix is refused");
        assert_eq!(refusal.obstacle, Obstacle::SmallestEigenvalue);
        assert!(refusal.estimate < 0.0);
        let scaled = matrix.scaled().exact();
        let slightly = |factor: f64| rational(refusal.estimate * factor);
        assert!(is_positive_definite(&shifted(
            &scaled,
            &slightly(1.0 + 1e-6)
        )));
        assert!(!is_positive_definite(&shifted(
            &scaled,
            &slightly(1.0 - 1e-6)
        )));
    }
}

#[test]
fn every_examined_member_of_a_proved_interval_matrix_is_definite() {
    let mut stream = Stream(31);
    let (mut proved, mut refused) = (0, 0);
    for index in 0..40 {
        let centre = near_singular(&mut stream, -6.0, 1.0, 2 * index + 1 - index % 2);
        let diagonal = |row: usize| centre.at(row, row).sqrt();
        let relative = 10_f64.powf(-9.5 + 0.1 * index as f64);
        // Radii that scale as the entries do, with exact zeros among them.
        let radii = Dense::from_upper(centre.order, |row, column| {
            let present = stream.integer(0, 2) > 0;
            f64::from(u8::from(present)) * relative * diagonal(row) * diagonal(column)
        });
        let matrix = centre.widened(|row, column| radii.at(row, column));
        if prove_positive_definite(&matrix).is_err() {
            refused += 1;
            continue;
        }
        proved += 1;
        for _ in 0..4 {
            let member = random_member(&mut stream, &matrix);
            assert!(is_positive_definite(&member.exact()), "matrix {index}");
        }
    }
    println!("{proved} interval matrices proved, {refused} refused");
    assert!(proved >= 5 && refused >= 5);
}

/// A member with every entry at one of its bounds or in between.
fn random_member(stream: &mut Stream, matrix: &IntervalMatrix) -> Dense {
    Dense::from_upper(matrix.order(), |row, column| {
        let entry = matrix.entry(row, column).unwrap();
        match stream.integer(0, 4) {
            0 | 1 => entry.lo(),
            2 | 3 => entry.hi(),
            _ => entry.midpoint(),
        }
    })
}

/// `n I - 1 1^T + s I` has the smallest eigenvalue `s`, at the vector of ones, and its worst
/// member within the radius `rho` has `s - n rho`.
#[test]
fn the_radius_that_is_allowed_is_the_radius_that_is_harmful() {
    for (order, smallest) in [(2, 0.5), (9, 2_f64.powi(-10)), (36, 2_f64.powi(-20))] {
        let size = order as f64;
        let centre = Dense::from_upper(order, |row, column| {
            if row == column {
                size - 1.0 + smallest
            } else {
                -1.0
            }
        });
        for (fraction, expected) in [(0.999, true), (1.001, false)] {
            let radius = fraction * smallest / size;
            let matrix = centre.widened(|_, _| radius);
            let worst =
                Dense::from_upper(order, |row, column| matrix.entry(row, column).unwrap().lo());
            assert_eq!(is_positive_definite(&worst.exact()), expected);
            let verdict = prove_positive_definite(&matrix);
            assert_eq!(verdict.is_ok(), expected, "order {order}: {verdict:?}");
        }
    }
}

#[test]
fn an_assembly_over_intervals_is_proved_when_the_exact_one_is_definite() {
    /// `[[e^(a/3), b/3], [b/3, max(a, b)/7]]`.
    fn assemble<T: Scalar>(a: f64, b: f64) -> Vec<T> {
        let (a, b) = (T::from_f64(a), T::from_f64(b));
        let third = T::one() / T::from_f64(3.0);
        let corner = (a.clone() * third.clone()).exp_upper();
        let side = b.clone() * third;
        vec![corner, side.clone(), side, a.max(b) / T::from_f64(7.0)]
    }
    let mut stream = Stream(64);
    let (mut agreed, mut indefinite) = (0, 0);
    for _ in 0..200 {
        let (a, b) = (3.0 * stream.signed_unit(), 3.0 * stream.signed_unit());
        let exact: Vec<Exact> = assemble(a, b);
        let truth = is_positive_definite(&[exact[..2].to_vec(), exact[2..].to_vec()]);
        let matrix = IntervalMatrix::from_entries(2, &assemble(a, b)).unwrap();
        assert_eq!(prove_positive_definite(&matrix).is_ok(), truth, "{a} {b}");
        agreed += usize::from(truth);
        indefinite += usize::from(!truth);
    }
    assert!(agreed > 20 && indefinite > 20);
}

#[test]
fn a_number_that_is_not_finite_is_refused() {
    for invalid in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (row, column) in [(0, 0), (1, 2), (2, 2)] {
            let matrix = IntervalMatrix::from_upper(3, |i, j| {
                let valid = if i == j { 1.0 } else { 0.1 };
                Interval::from(if (i, j) == (row, column) {
                    invalid
                } else {
                    valid
                })
            });
            let refusal = prove_positive_definite(&matrix).unwrap_err();
            assert_eq!(refusal.obstacle, Obstacle::NotFinite { row, column });
            assert_eq!(refusal.estimate, f64::NEG_INFINITY);
        }
    }
    let half_line = IntervalMatrix::from_upper(1, |_, _| Interval::new(1.0, f64::INFINITY));
    assert!(prove_positive_definite(&half_line).is_err());
}

#[test]
fn a_diagonal_entry_that_is_not_positive_is_refused() {
    for (entry, low, high) in [(0.0, -3.0, 0.0), (-0.0, -3.0, 0.0), (-2.5, -1e3, -0.5)] {
        let matrix = Dense::from_upper(4, |i, j| {
            if i != j {
                0.5
            } else {
                [1.0, 8.0, entry, 2.0][i]
            }
        });
        let refusal = matrix.prove().unwrap_err();
        assert!(matches!(
            refusal.obstacle,
            Obstacle::DiagonalNotPositive { index: 2, .. }
        ));
        assert!(
            low < refusal.estimate && refusal.estimate < high,
            "{refusal}"
        );
    }
    let zeros = Dense::from_upper(3, |_, _| 0.0).prove().unwrap_err();
    assert_eq!(zeros.estimate, 0.0);
    let wide = IntervalMatrix::from_upper(2, |i, j| {
        let one = if i == j { 1.0 } else { 0.0 };
        if (i, j) == (1, 1) {
            Interval::new(0.0, 2.0)
        } else {
            Interval::from(one)
        }
    });
    let refusal = prove_positive_definite(&wide).unwrap_err();
    assert!(matches!(
        refusal.obstacle,
        Obstacle::DiagonalNotPositive { index: 1, .. }
    ));
    assert!(refusal.to_string().contains("diagonal entry 1"));
}

#[test]
fn extreme_scales_do_not_matter() {
    let scales = [1e-150, 1e150, 1.0, 1e-100, 1e120];
    let well_conditioned = |i: usize, j: usize| if i == j { 2.0 } else { 0.4 };
    let matrix = Dense::from_upper(5, |i, j| well_conditioned(i, j) * scales[i] * scales[j]);
    let proved = matrix
        .prove()
        .expect("diagonals of 1e-300 and 1e300")
        .proved;
    assert!(proved > 0.3 && proved < 2.0, "{proved}");
    let bad = Dense::from_upper(5, |i, j| {
        (if i == j { 2.0 } else { -0.6 }) * scales[i] * scales[j]
    });
    assert!(!is_positive_definite(&bad.exact()));
    assert!(bad.prove().unwrap_err().estimate < -0.01);
    let overflowing = Dense::from_upper(2, |i, j| if i == j { 1e-300 } else { 1e300 });
    let refusal = overflowing.prove().unwrap_err();
    assert_eq!(refusal.obstacle, Obstacle::SmallestEigenvalue);
    assert_eq!(refusal.estimate, f64::NEG_INFINITY);
    let underflowing = Dense::from_upper(2, |i, j| if i == j { 1e300 } else { 1e-300 });
    assert!(underflowing.prove().is_ok());
}

#[test]
fn underflow_does_not_hide_an_indefinite_matrix() {
    // All entries at the bottom of the range, where products and roots lose their digits.
    let tiny = f64::from_bits(1);
    let singular = Dense::from_upper(2, |_, _| tiny);
    assert!(singular.prove().is_err());
    let indefinite = Dense::from_upper(2, |i, j| if i == j { tiny } else { 2.0 * tiny });
    assert!(indefinite.prove().unwrap_err().estimate < -0.1);
    let definite = Dense::from_upper(2, |i, j| if i == j { 2.0 * tiny } else { tiny });
    assert!(definite.prove().is_ok());
}

/// Two nearly singular pairs turn the great entries of the last row into infinities, and the row
/// that couples them turns those into NaN.
#[test]
fn a_factorisation_that_runs_into_nan_is_refused() {
    let pair = 1.0 - 2_f64.powi(-40);
    let matrix = Dense::from_upper(6, |i, j| match (i, j) {
        (0, 1) | (2, 3) => pair,
        (1, 4) => 1e-7,
        (3, 4) => -1e-7,
        (1, 5) | (3, 5) => 1e305,
        _ if i == j => 1.0,
        _ => 0.0,
    });
    assert!(!is_positive_definite(&matrix.exact()));
    let refusal = matrix.prove().unwrap_err();
    assert!(refusal.estimate < -1e300, "{refusal}");
}

#[test]
fn orders_zero_and_one_work() {
    assert_eq!(
        Dense::from_upper(0, |_, _| 0.0).prove().unwrap().proved,
        f64::INFINITY
    );
    for entry in [5e-324, 1e-300, 1.0, 3.0, f64::MAX] {
        let margin = Dense::from_upper(1, |_, _| entry).prove().unwrap();
        assert!(
            margin.proved > 0.499 && margin.proved < 2.0,
            "{entry:e}: {margin:?}"
        );
        assert_eq!(margin.uncertainty, 0.0);
    }
    assert!(Dense::from_upper(1, |_, _| -5e-324).prove().is_err());
}

#[test]
fn the_margin_counts_the_uncertainty() {
    let identity = Dense::from_upper(3, |i, j| if i == j { 1.0 } else { 0.0 });
    let margin = prove_positive_definite(&identity.widened(|_, _| 0.125)).unwrap();
    assert_eq!(margin.uncertainty, 0.375);
    assert!((margin.proved - 0.625).abs() < 1e-3 && margin.proved <= 0.625);
}

#[test]
fn mirrored_entries_are_both_covered() {
    // Not symmetric: the quadratic form sees the mean of 0.4 and 1.4, but the hull is used.
    let entries = [1.0, 0.4, 1.4, 1.0].map(Interval::from);
    let matrix = IntervalMatrix::from_entries(2, &entries).unwrap();
    assert_eq!(matrix.entry(0, 1), Some(Interval::new(0.4, 1.4)));
    assert_eq!(matrix.entry(1, 0), matrix.entry(0, 1));
    assert_eq!(matrix.entry(0, 2), None);
    assert!(prove_positive_definite(&matrix).is_err());
    let short = IntervalMatrix::from_entries(2, &entries[..3]).unwrap_err();
    assert_eq!((short.order, short.count), (2, 3));
}

#[test]
fn the_oracle_knows_small_matrices() {
    let small =
        |entries: &[f64]| is_positive_definite(&rational_rows(entries.len().isqrt(), entries));
    assert!(small(&[2.0, 1.0, 1.0, 2.0]));
    assert!(!small(&[1.0, 1.0, 1.0, 1.0]));
    assert!(!small(&[1.0, 2.0, 2.0, 1.0]));
    assert!(!small(&[0.0, 0.0, 0.0, 1.0]));
    assert!(!small(&[-1.0, 0.0, 0.0, -1.0]));
    assert!(small(&[]));
    let hilbert: Vec<Vec<BigRational>> = (0..14)
        .map(|i| (0..14).map(|j| quotient(1, i + j + 1)).collect())
        .collect();
    assert!(is_positive_definite(&hilbert));
    // The smallest eigenvalue of this Hilbert matrix is between 1e-20 and 1e-18.
    assert!(!is_positive_definite(&shifted(
        &hilbert,
        &quotient(1, 1_000_000_000_000_000_000)
    )));
}
