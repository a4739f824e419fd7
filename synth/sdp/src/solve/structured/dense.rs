//! Kernels for small dense matrices, column-major, side n in slices of n * n.
//!
//! Plain loops over columns: the blocks have sides of about 6 to 36, where calling a general library costs more
//! than the arithmetic. The order of every sum is fixed, so results do not depend on the machine's
//! vector width: products and sums are fused everywhere, one rounding for both.

/// Entries that one instruction of a common processor works on.
pub const LANES: usize = 4;

/// Runs loops compiled for the processor's vector unit. The same sums in the same order: only faster.
#[inline]
pub fn vectorised<R>(loops: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(loops)
}

/// The leading whole lanes of a vector, and the rest.
#[inline(always)]
fn lanes(x: &[f64]) -> (&[[f64; LANES]], &[f64]) {
    pulp::as_arrays::<LANES, _>(x)
}

/// `y += sum_k a[k] x[k]`, or, where `fresh`, `y = sum_k a[k] x[k]`; all vectors have y's length.
#[inline(always)]
pub fn add_vectors<const N: usize>(a: [f64; N], x: [&[f64]; N], fresh: bool, y: &mut [f64]) {
    let length = y.len();
    let x = x.map(|x| lanes(&x[..length]));
    let (y_lanes, y_rest) = pulp::as_arrays_mut::<LANES, _>(y);
    for (at, y) in y_lanes.iter_mut().enumerate() {
        let mut sum = if fresh { [0.0; LANES] } else { *y };
        for k in 0..N {
            let x = x[k].0[at];
            for i in 0..LANES {
                sum[i] = a[k].mul_add(x[i], sum[i]);
            }
        }
        *y = sum;
    }
    for (at, y) in y_rest.iter_mut().enumerate() {
        let mut sum = if fresh { 0.0 } else { *y };
        for k in 0..N {
            sum = a[k].mul_add(x[k].1[at], sum);
        }
        *y = sum;
    }
}

/// `y += a x`.
#[inline(always)]
fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    add_vectors([a], [x], false, y);
}

/// `y += sum_k weight(k) column(k)` for k in the range; `columns` is column-major with n rows, of which
/// those from `top` on count.
#[inline(always)]
fn combine(
    columns: &[f64],
    n: usize,
    top: usize,
    range: std::ops::Range<usize>,
    weight: impl Fn(usize) -> f64,
    y: &mut [f64],
) {
    let column = |k: usize| &columns[k * n + top..(k + 1) * n];
    let mut k = range.start;
    while k + 4 <= range.end {
        add_vectors(
            [weight(k), weight(k + 1), weight(k + 2), weight(k + 3)],
            [column(k), column(k + 1), column(k + 2), column(k + 3)],
            false,
            y,
        );
        k += 4;
    }
    while k < range.end {
        axpy(weight(k), column(k), y);
        k += 1;
    }
}

/// The sum of the entrywise products, summed in lanes.
#[inline(always)]
fn dot_in_lanes(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (lanes(a), lanes(b));
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for i in 0..LANES {
            sums[i] = a[i].mul_add(b[i], sums[i]);
        }
    }
    let mut rest = 0.0;
    for (a, b) in a_rest.iter().zip(b_rest) {
        rest = a.mul_add(*b, rest);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// The sum of the entrywise products.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    vectorised(
        #[inline(always)]
        || dot_in_lanes(a, b),
    )
}

/// Factors `A = L L'` in place: the lower triangle becomes L, the upper one zero. `false` when a pivot is
/// not positive and finite.
#[must_use]
#[inline(always)]
pub fn cholesky(a: &mut [f64], n: usize) -> bool {
    for j in 0..n {
        let (factor, rest) = a.split_at_mut(j * n);
        let column = &mut rest[..n];
        combine(factor, n, j, 0..j, |k| -factor[k * n + j], &mut column[j..]);
        let pivot = column[j];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        let root = pivot.sqrt();
        let inverse = 1.0 / root;
        column[..j].fill(0.0);
        column[j] = root;
        column[j + 1..]
            .iter_mut()
            .for_each(|entry| *entry *= inverse);
    }
    true
}

/// `out = L^-1`, lower triangular.
#[inline(always)]
pub fn invert_lower(l: &[f64], out: &mut [f64], n: usize) {
    // Column j of the inverse solves L x = e_j: forward substitution by columns.
    out.fill(0.0);
    for j in 0..n {
        let x = &mut out[j * n..(j + 1) * n];
        x[j] = 1.0;
        for k in j..n {
            let value = x[k] / l[k * n + k];
            x[k] = value;
            axpy(-value, &l[k * n + k + 1..(k + 1) * n], &mut x[k + 1..]);
        }
    }
}

/// `x <- L^-1 x`.
#[inline(always)]
pub fn solve_lower(l: &[f64], x: &mut [f64], n: usize) {
    let mut j = 0;
    while j < n {
        // Four columns at a time: the triangle first, then all rows below it.
        let next = (j + LANES).min(n);
        for k in j..next {
            let value = x[k] / l[k * n + k];
            x[k] = value;
            axpy(-value, &l[k * n + k + 1..k * n + next], &mut x[k + 1..next]);
        }
        let (known, below) = x.split_at_mut(next);
        combine(l, n, next, j..next, |k| -known[k], below);
        j = next;
    }
}

/// `x <- L^-T x`.
#[inline(always)]
pub fn solve_lower_transposed(l: &[f64], x: &mut [f64], n: usize) {
    for k in (0..n).rev() {
        let (value, below) = x[k..].split_at_mut(1);
        value[0] = (value[0] - dot_in_lanes(&l[k * n + k + 1..(k + 1) * n], below)) / l[k * n + k];
    }
}

/// `out = A' A` for a lower triangular A: the inverse of `L L'` from A = L^-1.
#[inline(always)]
pub fn gram_of_lower(a: &[f64], out: &mut [f64], n: usize) {
    for j in 0..n {
        for i in 0..=j {
            // Column j of a lower triangle begins at row j, which is not above row i.
            let value = dot_in_lanes(&a[i * n + j..(i + 1) * n], &a[j * n + j..(j + 1) * n]);
            out[j * n + i] = value;
            out[i * n + j] = value;
        }
    }
}

/// `out = A B`.
#[inline(always)]
pub fn product(a: &[f64], b: &[f64], out: &mut [f64], n: usize) {
    for j in 0..n {
        let column = &mut out[j * n..(j + 1) * n];
        column.fill(0.0);
        let weights = &b[j * n..(j + 1) * n];
        combine(a, n, 0, 0..n, |k| weights[k], column);
    }
}

/// `out = A' B`.
#[inline(always)]
pub fn transposed_product(a: &[f64], b: &[f64], out: &mut [f64], n: usize) {
    for j in 0..n {
        for i in 0..n {
            out[j * n + i] = dot_in_lanes(&a[i * n..(i + 1) * n], &b[j * n..(j + 1) * n]);
        }
    }
}

/// `out = L A L'` for a lower triangular L and a symmetric A; `work` has n * n entries.
#[inline(always)]
pub fn congruence_by_lower(l: &[f64], a: &[f64], work: &mut [f64], out: &mut [f64], n: usize) {
    // work = L A: only columns 0..=i of L reach row i, so column k adds from row k on.
    for j in 0..n {
        let column = &mut work[j * n..(j + 1) * n];
        column.fill(0.0);
        for k in 0..n {
            axpy(a[j * n + k], &l[k * n + k..(k + 1) * n], &mut column[k..]);
        }
    }
    // out = work L': column j of it is the sum over k <= j of work's column k times L[j, k].
    for j in 0..n {
        let column = &mut out[j * n + j..(j + 1) * n];
        column.fill(0.0);
        combine(work, n, j, 0..j + 1, |k| l[k * n + j], column);
    }
    mirror(out, n, |_, lower| lower);
}

/// Puts in the place of each entry above the diagonal, and of its mirror image below, what is made of both.
#[inline(always)]
pub fn mirror(a: &mut [f64], n: usize, made_of: impl Fn(f64, f64) -> f64) {
    for j in 0..n {
        for i in 0..j {
            let value = made_of(a[j * n + i], a[i * n + j]);
            a[j * n + i] = value;
            a[i * n + j] = value;
        }
    }
}

/// Reduces a symmetric A (destroyed; its lower triangle is read) to tridiagonal form with the same eigenvalues, by
/// Householder reflections. `off[0]` is unused; `off[k]` couples k - 1 and k.
#[inline(always)]
pub fn tridiagonalise(a: &mut [f64], n: usize, diagonal: &mut [f64], off: &mut [f64]) {
    let mut product = vec![0.0; n];
    let mut reflector = vec![0.0; n];
    for k in 0..n.saturating_sub(2) {
        diagonal[k] = a[k * n + k];
        let below = &a[k * n + k + 1..(k + 1) * n];
        let tail: f64 = dot_in_lanes(&below[1..], &below[1..]);
        let head = below[0];
        if tail == 0.0 {
            off[k + 1] = head;
            continue;
        }
        let norm = (head * head + tail).sqrt();
        let alpha = if head > 0.0 { -norm } else { norm };
        off[k + 1] = alpha;
        let v = &mut reflector[k + 1..n];
        v.copy_from_slice(below);
        v[0] -= alpha;
        // H = I - beta v v' with beta = 2 / v'v.
        let beta = 2.0 / dot_in_lanes(v, v);
        let p = &mut product[k + 1..n];
        symmetric_product(a, n, k + 1, v, p);
        p.iter_mut().for_each(|entry| *entry *= beta);
        let shift = 0.5 * beta * dot_in_lanes(p, v);
        axpy(-shift, v, p);
        for j in k + 1..n {
            let (vj, pj) = (v[j - k - 1], p[j - k - 1]);
            let column = &mut a[j * n + j..(j + 1) * n];
            let (v_rest, p_rest) = (&v[j - k - 1..], &p[j - k - 1..]);
            for ((entry, &vi), &pi) in column.iter_mut().zip(v_rest).zip(p_rest) {
                *entry -= vi * pj + pi * vj;
            }
        }
    }
    if n >= 2 {
        diagonal[n - 2] = a[(n - 2) * n + n - 2];
        off[n - 1] = a[(n - 2) * n + n - 1];
    }
    if n >= 1 {
        diagonal[n - 1] = a[(n - 1) * n + n - 1];
    }
}

/// `out = A[top.., top..] v` from the lower triangle of A.
#[inline(always)]
pub fn symmetric_product(a: &[f64], n: usize, top: usize, v: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    for j in top..n {
        let column = &a[j * n + j..(j + 1) * n];
        let at = j - top;
        out[at] += dot_in_lanes(column, &v[at..]);
        axpy(v[at], &column[1..], &mut out[at + 1..]);
    }
}

/// How many eigenvalues of a tridiagonal matrix are below x (Sturm's sequence).
#[inline(always)]
fn count_below(diagonal: &[f64], off: &[f64], x: f64) -> usize {
    let mut count = 0;
    let mut pivot = 1.0_f64;
    for (k, d) in diagonal.iter().enumerate() {
        let coupling = if k == 0 { 0.0 } else { off[k] * off[k] };
        pivot = d - x - coupling / pivot;
        if pivot == 0.0 {
            pivot = f64::MIN_POSITIVE;
        }
        if pivot < 0.0 {
            count += 1;
        }
    }
    count
}

/// A lower bound of the smallest eigenvalue of a tridiagonal matrix, tight to 1e-3 of its size, or `enough` when
/// no eigenvalue lies below that.
#[inline(always)]
pub fn smallest_eigenvalue(diagonal: &[f64], off: &[f64], enough: f64) -> f64 {
    if count_below(diagonal, off, enough) == 0 {
        return enough;
    }
    let radius = |k: usize| {
        let left = if k == 0 { 0.0 } else { off[k].abs() };
        left + off.get(k + 1).map_or(0.0, |value| value.abs())
    };
    let bounds = diagonal.iter().enumerate().map(|(k, d)| d - radius(k));
    let mut low = bounds.fold(f64::INFINITY, f64::min);
    let mut high = enough;
    if !low.is_finite() {
        return f64::NEG_INFINITY;
    }
    low -= 1e-12 * low.abs();
    for _ in 0..60 {
        if high - low <= 1e-3 * low.abs().max(high.abs()) {
            break;
        }
        let middle = 0.5 * (low + high);
        if count_below(diagonal, off, middle) == 0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// `out = sum over pairs (p, q) of p q' + q p'`, the first `rows` rows of it on and above the diagonal (what else it writes is
/// of no use); `basis` holds the columns p0, q0, p1, q1, ..., `count` in all. Columns are `stride` apart, a multiple of
/// the lanes.
#[inline(always)]
pub fn sum_of_pairs(basis: &[f64], count: usize, stride: usize, rows: usize, out: &mut [f64]) {
    for c in 0..rows {
        let top = (c / LANES + 1) * LANES;
        let y = &mut out[c * stride..c * stride + top];
        let weight = |k: usize| basis[(k ^ 1) * stride + c];
        y.fill(0.0);
        // What is left of fours comes first.
        combine(basis, stride, 0, 0..count % 4, weight, y);
        combine(basis, stride, 0, count % 4..count, weight, y);
    }
}
