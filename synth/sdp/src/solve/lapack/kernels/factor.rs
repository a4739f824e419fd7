//! Cholesky and LU factorizations and the solves that use them.

use faer::linalg::cholesky::llt::factor::{
    cholesky_in_place, cholesky_in_place_scratch, LltError, LltRegularization,
};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::linalg::{temp_mat_scratch, temp_mat_zeroed};
use faer::mat::AsMatMut;
use faer::perm::swap_rows_idx;
use faer::reborrow::*;
use faer::{unzip, zip, ColMut, ColRef, MatMut, MatRef, Par};

use super::{with_stack, Failure};

/// Up to this order, a factorization by columns is faster than the blocked kernel and its copy.
const SMALL_ORDER: usize = 64;

/// Factors `A = L L'` in place; only the lower triangle is read or written.
///
/// A pivot that is not positive, or not finite, is reported.
pub fn cholesky(a: MatMut<'_, f64>) -> Result<(), Failure> {
    if a.nrows() <= SMALL_ORDER && a.row_stride() == 1 {
        small_cholesky(a)
    } else {
        blocked_cholesky(a)
    }
}

fn small_cholesky(mut a: MatMut<'_, f64>) -> Result<(), Failure> {
    let n = a.nrows();
    for j in 0..n {
        let (factor, rest) = a.rb_mut().split_at_col_mut(j);
        let mut column = rest.col_mut(0).subrows_mut(j, n - j);
        for earlier in factor.rb().subrows(j, n - j).col_iter() {
            eliminate(earlier, column.rb_mut());
        }
        let pivot = column[0];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return Err(Failure::Pivot(j + 1));
        }
        let root = pivot.sqrt();
        column.rb_mut().iter_mut().for_each(|entry| *entry /= root);
        column[0] = root;
    }
    Ok(())
}

/// Subtracts from a column what an earlier column of the factor contributes to it.
fn eliminate(earlier: ColRef<'_, f64>, column: ColMut<'_, f64>) {
    let weight = earlier[0];
    zip!(column, earlier).for_each(|unzip!(entry, factor)| *entry -= weight * factor);
}

/// The kernel writes above the diagonal too, hence the copy.
fn blocked_cholesky(mut a: MatMut<'_, f64>) -> Result<(), Failure> {
    let n = a.nrows();
    let scratch = cholesky_in_place_scratch::<f64>(n, Par::Seq, Default::default())
        .and(temp_mat_scratch::<f64>(n, n));
    let outcome = with_stack(scratch, &mut [], |stack| {
        let (mut copy, stack) = temp_mat_zeroed::<f64, _, _>(n, n, stack);
        let mut copy = copy.as_mat_mut();
        copy.copy_from_triangular_lower(a.rb());
        let outcome = cholesky_in_place(
            copy.rb_mut(),
            LltRegularization::default(),
            Par::Seq,
            stack,
            Default::default(),
        );
        a.copy_from_triangular_lower(copy);
        outcome
    })?;
    match outcome {
        Ok(_) => Ok(()),
        Err(LltError::NonPositivePivot { index }) => Err(Failure::Pivot(index + 1)),
    }
}

/// Solves `L L' X = B` in place of `B`.
pub fn solve_with_cholesky(l: MatRef<'_, f64>, mut b: MatMut<'_, f64>) {
    solve_lower_triangular_in_place(l, b.rb_mut(), Par::Seq);
    solve_upper_triangular_in_place(l.transpose(), b, Par::Seq);
}

/// Factors `P A = L U` in place with partial pivoting; `pivots[k]` is the row swapped with row `k`, from 1.
///
/// A pivot that is exactly zero, or not finite, is reported; the factorization stops there.
pub fn lu(mut a: MatMut<'_, f64>, pivots: &mut [i32]) -> Result<(), Failure> {
    let n = a.nrows();
    for k in 0..n {
        let pivot = (k..n).fold(k, |best, i| {
            if a[(i, k)].abs() > a[(best, k)].abs() {
                i
            } else {
                best
            }
        });
        pivots[k] = pivot as i32 + 1;
        swap_rows_idx(a.rb_mut(), k, pivot);
        let diagonal = a[(k, k)];
        if diagonal == 0.0 || !diagonal.is_finite() {
            return Err(Failure::Pivot(k + 1));
        }
        for i in k + 1..n {
            a[(i, k)] /= diagonal;
        }
        for j in k + 1..n {
            let weight = a[(k, j)];
            for i in k + 1..n {
                let factor = a[(i, k)];
                a[(i, j)] -= factor * weight;
            }
        }
    }
    Ok(())
}

/// Solves `A X = B` in place of `B` with the factors left by [`lu`].
pub fn solve_with_lu(factors: MatRef<'_, f64>, pivots: &[i32], mut b: MatMut<'_, f64>) {
    let n = factors.nrows();
    for (k, &pivot) in pivots.iter().enumerate() {
        swap_rows_idx(b.rb_mut(), k, pivot as usize - 1);
    }
    for j in 0..b.ncols() {
        for k in 0..n {
            for i in k + 1..n {
                let known = b[(k, j)];
                b[(i, j)] -= factors[(i, k)] * known;
            }
        }
    }
    solve_upper_triangular_in_place(factors, b, Par::Seq);
}
