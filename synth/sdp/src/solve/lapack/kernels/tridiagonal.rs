//! Eigenvalues of small symmetric matrices by reduction to tridiagonal form and implicit QL steps.
//!
//! At the sides of typical cones this takes a third of the time of the blocked kernel, which is made for large
//! matrices. Methods: Golub and Van Loan, Matrix Computations, 4th ed., algorithms 8.3.1 and 8.3.3, the
//! latter run from the other end, as in EISPACK's `tred1` and `imtql1`.

/// Squared lengths below this count as zero: the matrix is scaled to have entries far above its root.
const NEGLIGIBLE: f64 = 1e-280;

/// Implicit QL steps allowed for one eigenvalue; two are usual.
const MAX_STEPS: usize = 60;

/// Overwrites `diagonal` with the ascending eigenvalues of a symmetric matrix of order `n = diagonal.len()`.
///
/// `a` holds the lower triangle by columns of length `n` and is destroyed; `off_diagonal` is scratch of length
/// `n`. `false`: the iteration did not converge.
pub fn eigenvalues(a: &mut [f64], diagonal: &mut [f64], off_diagonal: &mut [f64]) -> bool {
    tridiagonalize(a, diagonal, off_diagonal);
    if !(0..diagonal.len()).all(|first| isolate(first, diagonal, off_diagonal)) {
        return false;
    }
    diagonal.sort_unstable_by(f64::total_cmp);
    true
}

/// Reduces the matrix to tridiagonal form with Householder reflections `I - weight v v'`.
fn tridiagonalize(a: &mut [f64], diagonal: &mut [f64], off_diagonal: &mut [f64]) {
    let n = diagonal.len();
    for k in 0..n {
        let (column, rest) = a[k * n..].split_at_mut(n);
        diagonal[k] = column[k];
        let (done, product) = off_diagonal.split_at_mut(k + 1);
        let v = &mut column[k + 1..];
        done[k] = v.first().copied().unwrap_or(0.0);
        if let Some(reflection) = reflect(v) {
            done[k] = reflection.image;
            apply_on_both_sides(rest, n, v, reflection.weight, product);
        }
    }
}

struct Reflection {
    /// First entry of the reflected vector; its other entries are zero.
    image: f64,
    weight: f64,
}

/// Replaces a vector by the one whose reflection maps it to a multiple of the first unit vector.
fn reflect(v: &mut [f64]) -> Option<Reflection> {
    let (first, others) = v.split_first_mut()?;
    let tail: f64 = others.iter().map(|x| x * x).sum();
    if tail <= NEGLIGIBLE {
        return None;
    }
    let image = -(*first * *first + tail).sqrt().copysign(*first);
    let weight = 1.0 / (image * (image - *first));
    *first -= image;
    Some(Reflection { image, weight })
}

/// `A <- (I - w v v') A (I - w v v')` on the lower triangle of the trailing block of `rest`.
fn apply_on_both_sides(rest: &mut [f64], n: usize, v: &[f64], weight: f64, product: &mut [f64]) {
    let order = v.len();
    let offset = n - order;
    product.fill(0.0);
    for j in 0..order {
        let column = &rest[j * n + offset + j..(j + 1) * n];
        let mut sum = column[0] * v[j];
        let below = product[j + 1..].iter_mut().zip(&v[j + 1..]);
        for (x, (p, y)) in column[1..].iter().zip(below) {
            sum += x * y;
            *p += x * v[j];
        }
        product[j] += sum;
    }
    let dot: f64 = product.iter().zip(v).map(|(p, x)| p * x).sum();
    for (p, x) in product.iter_mut().zip(v) {
        *p = weight * (*p - 0.5 * weight * dot * x);
    }
    for j in 0..order {
        let column = &mut rest[j * n + offset + j..(j + 1) * n];
        for (x, (y, p)) in column.iter_mut().zip(v[j..].iter().zip(&product[j..])) {
            *x -= y * product[j] + p * v[j];
        }
    }
}

/// Runs implicit QL steps until the off-diagonal entry after `first` is negligible.
fn isolate(first: usize, diagonal: &mut [f64], off_diagonal: &mut [f64]) -> bool {
    for _ in 0..MAX_STEPS {
        let mut last = first;
        while last + 1 < diagonal.len() {
            let neighbours = diagonal[last].abs() + diagonal[last + 1].abs();
            if off_diagonal[last].abs() <= f64::EPSILON * neighbours {
                break;
            }
            last += 1;
        }
        if last == first {
            return true;
        }
        step(first, last, diagonal, off_diagonal);
    }
    false
}

/// One implicit QL step with Wilkinson's shift on the unreduced block `first..=last`.
fn step(first: usize, last: usize, diagonal: &mut [f64], off_diagonal: &mut [f64]) {
    let slope = (diagonal[first + 1] - diagonal[first]) / (2.0 * off_diagonal[first]);
    let shift = off_diagonal[first] / (slope + slope.hypot(1.0).copysign(slope));
    let mut bulge = diagonal[last] - diagonal[first] + shift;
    let (mut sine, mut cosine, mut change) = (1.0, 1.0, 0.0);
    for i in (first..last).rev() {
        let (f, b) = (sine * off_diagonal[i], cosine * off_diagonal[i]);
        let length = (f * f + bulge * bulge).sqrt();
        off_diagonal[i + 1] = length;
        if length == 0.0 {
            diagonal[i + 1] -= change;
            off_diagonal[last] = 0.0;
            return;
        }
        (sine, cosine) = (f / length, bulge / length);
        bulge = diagonal[i + 1] - change;
        let turn = (diagonal[i] - bulge) * sine + 2.0 * cosine * b;
        change = sine * turn;
        diagonal[i + 1] = bulge + change;
        bulge = cosine * turn - b;
    }
    diagonal[first] -= change;
    off_diagonal[first] = bulge;
    off_diagonal[last] = 0.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_without_a_tail_need_no_reflection() {
        for (n, tiny) in [(1, 0.0), (2, 0.0), (5, 0.0), (5, 1e-160), (5, 1e-320)] {
            let mut a = vec![tiny; n * n];
            for i in 0..n {
                a[i + i * n] = (n - i) as f64;
            }
            let (mut diagonal, mut off_diagonal) = (vec![0.0; n], vec![0.0; n]);
            assert!(eigenvalues(&mut a, &mut diagonal, &mut off_diagonal));
            for (i, value) in diagonal.iter().enumerate() {
                assert!((value - (i + 1) as f64).abs() < 1e-14);
            }
            let mut zero = vec![0.0; n * n];
            assert!(eigenvalues(&mut zero, &mut diagonal, &mut off_diagonal));
            assert_eq!(diagonal, vec![0.0; n]);
        }
    }

    #[test]
    fn a_value_that_is_not_a_number_ends_the_iteration() {
        let mut a = vec![f64::NAN; 16];
        assert!(!eigenvalues(&mut a, &mut [0.0; 4], &mut [0.0; 4]));
    }
}
