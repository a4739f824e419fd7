//! Ranges of single numbers, counts and matrices.

use nalgebra::{DMatrix, Matrix3};

use super::ModelError;
use crate::claim::Claim;
use crate::fuzzy::triangle_excess;

/// Limits that keep a mistyped file from filling the memory.
pub(super) const MAX_STATES: usize = 24;

pub(super) const MAX_VERTICES: usize = 4096;

/// The most columns of a matrix, or rows of an output.
pub const MAX_COLUMNS: usize = 24;

/// The most bounds, states or points in a list.
pub const MAX_BOUNDS: usize = 256;

pub(super) fn require(ok: bool, field: &str, value: f64, allowed: &str) -> Result<(), ModelError> {
    if ok && value.is_finite() {
        return Ok(());
    }
    Err(ModelError::range(field, value, allowed))
}

/// Refuses a version of a format that is not the one this program reads.
pub fn check_version(found: u32, expected: u32) -> Result<(), ModelError> {
    match found == expected {
        true => Ok(()),
        false => Err(ModelError::SchemaVersion { found, expected }),
    }
}

/// Refuses numbers that are not finite or so large or small that squares overflow or vanish.
pub fn finite(field: &str, value: f64) -> Result<(), ModelError> {
    let allowed = "0 or a number of magnitude 1e-30 to 1e30";
    let magnitude = value.abs();
    let ok = value == 0.0 || (1e-30..=1e30).contains(&magnitude);
    require(ok, field, value, allowed)
}

/// Refuses numbers that are not above 0, and those that [`finite`] refuses.
pub fn check_positive(field: &str, value: f64) -> Result<(), ModelError> {
    require(value > 0.0, field, value, "above 0")?;
    finite(field, value)
}

/// Refuses numbers below 0, and those that [`finite`] refuses.
pub fn check_not_negative(field: &str, value: f64) -> Result<(), ModelError> {
    require(value >= 0.0, field, value, "0 or above")?;
    finite(field, value)
}

/// Refuses what would break the lines of a report.
pub fn check_line(field: &str, text: &str) -> Result<(), ModelError> {
    match text.chars().position(char::is_control) {
        Some(position) => Err(ModelError::ControlCharacter {
            field: field.to_string(),
            position: position + 1,
            character: text.chars().nth(position).unwrap_or_default(),
        }),
        None => Ok(()),
    }
}

/// Refuses lists longer than the limit.
pub fn check_count(field: &str, what: &str, count: usize, limit: usize) -> Result<(), ModelError> {
    if count <= limit {
        return Ok(());
    }
    let expected = format!("at most {limit} {what}");
    Err(ModelError::shape(
        field,
        format!("{count} {what}"),
        expected,
    ))
}

/// So many entries, in words.
pub fn entries(count: usize) -> String {
    match count {
        1 => "1 entry".to_string(),
        count => format!("{count} entries"),
    }
}

/// Rows and columns, `None`: any number above 0.
pub type Size = (Option<usize>, Option<usize>);

fn wrong_size(field: &str, found: String, (rows, columns): Size) -> ModelError {
    let word = |size: Option<usize>| size.map_or("at least 1".to_string(), |n| n.to_string());
    ModelError::shape(field, found, format!("{} x {}", word(rows), word(columns)))
}

/// Refuses a matrix that is not of the given size.
pub fn check_shape(field: &str, matrix: &DMatrix<f64>, size: Size) -> Result<(), ModelError> {
    let fits = |found: usize, expected: Option<usize>| found == expected.unwrap_or(found.max(1));
    let (rows, columns) = matrix.shape();
    if fits(rows, size.0) && fits(columns, size.1) {
        return Ok(());
    }
    Err(wrong_size(field, format!("{rows} x {columns}"), size))
}

/// Rows of equal length, all finite, of the given size.
pub fn check_matrix(
    field: &str,
    rows: &[Vec<f64>],
    expected: Size,
) -> Result<DMatrix<f64>, ModelError> {
    let columns = expected.1.or(rows.first().map(Vec::len)).unwrap_or(0);
    if rows.is_empty() || columns == 0 || expected.0.is_some_and(|count| count != rows.len()) {
        let found = format!("{} x {columns}", rows.len());
        return Err(wrong_size(field, found, expected));
    }
    if let Some(position) = rows.iter().position(|row| row.len() != columns) {
        let length = rows[position].len();
        let found = format!("{} in row {}", entries(length), position + 1);
        return Err(wrong_size(field, found, expected));
    }
    for (r, row) in rows.iter().enumerate() {
        for (c, &value) in row.iter().enumerate() {
            finite(&format!("{field}[{r}][{c}]"), value)?;
        }
    }
    Ok(DMatrix::from_fn(rows.len(), columns, |r, c| rows[r][c]))
}

/// Refuses a square matrix that does not equal its transpose exactly.
pub fn check_symmetric(field: &str, matrix: &DMatrix<f64>) -> Result<(), ModelError> {
    for row in 0..matrix.nrows() {
        for column in row + 1..matrix.ncols() {
            let (value, mirrored) = (matrix[(row, column)], matrix[(column, row)]);
            if value != mirrored {
                return Err(ModelError::NotSymmetric {
                    field: field.to_string(),
                    row: row + 1,
                    column: column + 1,
                    value,
                    mirrored,
                });
            }
        }
    }
    Ok(())
}

/// Refuses a square matrix that is not symmetric or whose smallest eigenvalue is not clearly above 0.
pub fn check_positive_definite(field: &str, matrix: &DMatrix<f64>) -> Result<(), ModelError> {
    check_symmetric(field, matrix)?;
    let eigenvalues = matrix.symmetric_eigenvalues();
    let smallest = eigenvalues.min();
    if smallest <= 1e-12 * eigenvalues.max().abs() {
        return Err(ModelError::NotPositiveDefinite {
            field: field.to_string(),
            smallest,
        });
    }
    Ok(())
}

/// Fraction of the sum of the principal moments by which rounding may break the triangle inequality.
const TRIANGLE_ROUNDING: f64 = 1e-9;

/// An inertia matrix [kg m^2]: 3 x 3, symmetric positive definite, and that of a rigid body: no principal moment is
/// above the sum of the other two.
pub fn check_inertia(field: &str, rows: &[[f64; 3]; 3]) -> Result<Matrix3<f64>, ModelError> {
    let rows_as_lists: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
    let inertia = check_matrix(field, &rows_as_lists, (Some(3), Some(3)))?;
    check_positive_definite(field, &inertia)?;
    let inertia = Matrix3::from_fn(|r, c| rows[r][c]);
    if triangle_excess(&inertia) <= TRIANGLE_ROUNDING * inertia.trace() {
        return Ok(inertia);
    }
    let moments = inertia.symmetric_eigenvalues();
    let (largest, others) = (moments.max(), moments.sum() - moments.max());
    Err(ModelError::choice(
        field,
        format!(
            "no rigid body has this inertia: its largest principal moment is {} kg m^2 and must be at most the sum of \
             the other two, {} kg m^2",
            Claim::AtMost(largest),
            Claim::AtLeast(others)
        ),
    ))
}

/// Refuses an output that is 0 whatever happens: these matrices, all that lead to it, have no other entry.
pub fn check_seen(field: &str, matrices: &[&DMatrix<f64>]) -> Result<(), ModelError> {
    let mut entries = matrices.iter().flat_map(|matrix| matrix.iter());
    match entries.all(|entry| *entry == 0.0) {
        false => Ok(()),
        true => Err(ModelError::choice(
            field,
            "every entry is 0, so that the output is 0 and there is no gain to bound; give it the states that matter",
        )),
    }
}

/// What all vertices, or all rules, have in common.
pub(super) struct SharedMatrices<'a> {
    pub input: &'a [Vec<f64>],
    pub disturbance: Option<&'a [Vec<f64>]>,
    pub output: Option<&'a [Vec<f64>]>,
    pub input_limit: &'a [f64],
}

impl SharedMatrices<'_> {
    /// B, B_w (B when left out) and C (the identity when left out), under the name of their parent.
    pub fn checked(&self, parent: &str, states: usize) -> Result<[DMatrix<f64>; 3], ModelError> {
        let field = |key: &str| format!("{parent}.{key}");
        let tall = (Some(states), None);
        let input = check_matrix(&field("input_matrix"), self.input, tall)?;
        let disturbance = match self.disturbance {
            Some(rows) => check_matrix(&field("disturbance_matrix"), rows, tall)?,
            None => input.clone(),
        };
        let output = match self.output {
            Some(rows) => check_matrix(&field("output_matrix"), rows, (None, Some(states)))?,
            None => DMatrix::identity(states, states),
        };
        for (key, what, count) in [
            ("input_matrix", "columns", input.ncols()),
            ("disturbance_matrix", "columns", disturbance.ncols()),
            ("output_matrix", "rows", output.nrows()),
        ] {
            check_count(&field(key), what, count, MAX_COLUMNS)?;
        }
        check_seen(&field("output_matrix"), &[&output])?;
        let (found, expected) = (self.input_limit.len(), input.ncols());
        if found != expected {
            let [found, expected] = [found, expected].map(entries);
            return Err(ModelError::shape(field("input_limit"), found, expected));
        }
        Ok([input, disturbance, output])
    }
}
