//! From a model file to checked numbers.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::file::{
    ExactPlant, GainForm, LinearBound, Mismatch, ModelFile, PlantFile, Specs, VerticesPlant,
    MODEL_SCHEMA_VERSION,
};
use super::inertia::{check_set, inertia_uncertainty};
use super::outer::check_outer;
use super::rules::rule_model;
use super::search::check_search;
use super::{parse, FileError, Kind, ModelError, Plant};
use crate::conditions::{GainPlan, Specification, Task};
use crate::fuzzy::{ExactSpacecraft, VertexSystem};

/// Limits that keep a mistyped file from filling the memory.
pub(super) const MAX_STATES: usize = 24;
pub(super) const MAX_VERTICES: usize = 4096;
/// The most columns of a matrix, or rows of an output.
pub const MAX_COLUMNS: usize = 24;
/// The most bounds, states or points in a list.
pub const MAX_BOUNDS: usize = 256;

/// A checked model.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// The file it came from, unchanged.
    pub file: ModelFile,
    /// The plant.
    pub plant: Plant,
}

impl Model {
    /// Reads and checks the text of a model file.
    pub fn from_json(text: &str) -> Result<Self, FileError> {
        Ok(Model::new(parse(text, Kind::Model)?)?)
    }

    /// Checks every value of a model file.
    pub fn new(file: ModelFile) -> Result<Self, ModelError> {
        if file.schema_version != MODEL_SCHEMA_VERSION {
            return Err(ModelError::SchemaVersion {
                found: file.schema_version,
                expected: MODEL_SCHEMA_VERSION,
            });
        }
        check_line("name", &file.name)?;
        let plant = match &file.plant {
            PlantFile::Exact(exact) => Plant::Spacecraft(spacecraft(exact)?),
            PlantFile::Vertices(vertices) => Plant::Vertices(vertex_system(vertices)?),
            PlantFile::Rules(rules) => Plant::Rules(rule_model(rules)?),
        };
        check_gain_form(&file, &plant)?;
        check_specs(&file.specs, plant.sizes().0)?;
        check_outer(&file)?;
        check_search(&file)?;
        Ok(Model { file, plant })
    }

    /// Shortest sampling interval (s).
    pub fn sampling_interval_min(&self) -> f64 {
        let specs = &self.file.specs;
        specs.hmin_s.unwrap_or(specs.hbar_s / 100.0)
    }

    /// The synthesis task in SI units.
    pub fn task(&self) -> Task {
        let specs = &self.file.specs;
        let must_contain = specs.must_contain.iter();
        let mut task = Task::new(
            self.plant.takagi_sugeno(),
            Specification {
                decay_rate: specs.phi_per_s,
                sampling_interval_max: specs.hbar_s,
                trigger_threshold: specs.nu,
                multiplier_weights: specs.eps,
                disturbance_weight_max: specs.xi_max,
                must_contain: must_contain
                    .map(|state| DVector::from_column_slice(state))
                    .collect(),
                containment_weight: 1.0,
                margin: specs.margin,
            },
        );
        if let (GainForm::Scheduled, Mismatch::Kappa(kappa)) = (self.file.gains, self.file.mismatch)
        {
            task.gains = GainPlan {
                count: task.system.vertices.len(),
                mismatch: Some(kappa),
                given: None,
            };
        }
        task
    }
}

/// Largest number of rules with a gain each.
pub const MAX_SCHEDULED_RULES: usize = 16;

/// Gains and mismatch must go together, and scheduling needs memberships.
fn check_gain_form(file: &ModelFile, plant: &Plant) -> Result<(), ModelError> {
    let refuse = |field: &str, reason: String| {
        let field = field.to_string();
        Err(ModelError::Choice { field, reason })
    };
    match (file.gains, file.mismatch) {
        (GainForm::Constant, Mismatch::None) => return Ok(()),
        (GainForm::Constant, Mismatch::Kappa(_)) => {
            let reason = "a constant gain has no memberships to mismatch; it must be \"none\"";
            return refuse("mismatch", reason.to_string());
        }
        (GainForm::Scheduled, Mismatch::None) => {
            let reason =
                "scheduled gains without a bound on the mismatch can never beat a constant \
                          gain; use {\"kappa\": ..} here, or constant gains";
            return refuse("mismatch", reason.to_string());
        }
        (GainForm::Scheduled, Mismatch::Kappa(kappa)) => {
            require(
                (0.0..=1.0).contains(&kappa),
                "mismatch.kappa",
                kappa,
                "in [0, 1]",
            )?;
        }
    }
    if plant.has_uncertain_inertia() {
        let reason = "scheduled gains are designed for a known inertia only; with \
                      plant.exact.inertia_uncertainty use \"constant\"";
        return refuse("gains", reason.to_string());
    }
    match plant.membership_count() {
        None => {
            let reason =
                "a 'vertices' plant says nothing about its memberships; scheduled gains need \
                          'exact' or 'rules'";
            refuse("gains", reason.to_string())
        }
        Some(count) if count > MAX_SCHEDULED_RULES => {
            let reason = format!(
                "the plant has {count} rules; at most {MAX_SCHEDULED_RULES} can have a gain each"
            );
            refuse("gains", reason)
        }
        Some(_) => Ok(()),
    }
}

fn out_of_range(field: &str, value: f64, allowed: &str) -> ModelError {
    ModelError::OutOfRange {
        field: field.to_string(),
        value,
        allowed: allowed.to_string(),
    }
}

pub(super) fn require(ok: bool, field: &str, value: f64, allowed: &str) -> Result<(), ModelError> {
    if ok && value.is_finite() {
        Ok(())
    } else {
        Err(out_of_range(field, value, allowed))
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
    Err(ModelError::WrongShape {
        field: field.to_string(),
        found: format!("{count} {what}"),
        expected: format!("at most {limit} {what}"),
    })
}

/// Rows of equal length, all finite, of the given size (`None`: any above 0).
pub fn check_matrix(
    field: &str,
    rows: &[Vec<f64>],
    expected: (Option<usize>, Option<usize>),
) -> Result<DMatrix<f64>, ModelError> {
    let columns = expected.1.or(rows.first().map(Vec::len)).unwrap_or(0);
    let wrong = |found: String| ModelError::WrongShape {
        field: field.to_string(),
        found,
        expected: format!("{} x {}", size_word(expected.0), size_word(expected.1)),
    };
    if rows.is_empty() || columns == 0 || expected.0.is_some_and(|count| count != rows.len()) {
        return Err(wrong(format!("{} x {columns}", rows.len())));
    }
    if let Some(position) = rows.iter().position(|row| row.len() != columns) {
        let length = rows[position].len();
        return Err(wrong(format!("{length} entries in row {}", position + 1)));
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

fn size_word(size: Option<usize>) -> String {
    size.map_or("at least 1".to_string(), |size| size.to_string())
}

fn spacecraft(exact: &ExactPlant) -> Result<ExactSpacecraft, ModelError> {
    let inertia = check_inertia("plant.exact.inertia_kg_m2", &exact.inertia_kg_m2)?;
    for axis in 0..3 {
        let torque = format!("plant.exact.torque_limit_nm[{axis}]");
        check_positive(&torque, exact.torque_limit_nm[axis])?;
        let rate = format!("plant.exact.rate_rad_s[{axis}]");
        check_positive(&rate, exact.rate_rad_s[axis])?;
    }
    let disturbance = "plant.exact.disturbance_bound_nm";
    check_not_negative(disturbance, exact.disturbance_bound_nm)?;
    let q0 = exact.q0_min;
    require(q0 > 0.0 && q0 <= 1.0, "plant.exact.q0_min", q0, "in (0, 1]")?;
    let inertia_uncertainty = match &exact.inertia_uncertainty {
        Some(file) => inertia_uncertainty(file, &inertia)?,
        None => Default::default(),
    };
    let craft = ExactSpacecraft {
        inertia,
        inertia_uncertainty,
        torque_limit: Vector3::from(exact.torque_limit_nm),
        disturbance_bound: exact.disturbance_bound_nm,
        rate_bound: Vector3::from(exact.rate_rad_s),
        scalar_part_min: q0,
    };
    check_set(&craft)?;
    Ok(craft)
}

pub(super) fn check_inertia(field: &str, rows: &[[f64; 3]; 3]) -> Result<Matrix3<f64>, ModelError> {
    let rows_as_lists: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
    let inertia = check_matrix(field, &rows_as_lists, (Some(3), Some(3)))?;
    check_positive_definite(field, &inertia)?;
    Ok(Matrix3::from_fn(|r, c| rows[r][c]))
}

/// The state matrices of a plant given by vertices: at least one, all square and of one size.
pub fn check_state_matrices(matrices: &[Vec<Vec<f64>>]) -> Result<Vec<DMatrix<f64>>, ModelError> {
    let count = matrices.len();
    let states = matrices.first().map_or(0, Vec::len);
    let wrong = |field: &str, found: String, expected: String| ModelError::WrongShape {
        field: format!("plant.vertices.{field}"),
        found,
        expected,
    };
    if count == 0 || count > MAX_VERTICES {
        let expected = format!("1 to {MAX_VERTICES} matrices");
        return Err(wrong(
            "state_matrices",
            format!("{count} matrices"),
            expected,
        ));
    }
    if states == 0 || states > MAX_STATES {
        let expected = format!("1 to {MAX_STATES} states");
        return Err(wrong(
            "state_matrices[0]",
            format!("{states} rows"),
            expected,
        ));
    }
    let square = (Some(states), Some(states));
    let checked = matrices.iter().enumerate().map(|(i, rows)| {
        check_matrix(&format!("plant.vertices.state_matrices[{i}]"), rows, square)
    });
    checked.collect()
}

fn vertex_system(file: &VerticesPlant) -> Result<VertexSystem, ModelError> {
    let wrong = |field: &str, found: String, expected: String| ModelError::WrongShape {
        field: format!("plant.vertices.{field}"),
        found,
        expected,
    };
    let state_matrices = check_state_matrices(&file.state_matrices)?;
    let states = file.state_matrices[0].len();
    let tall = (Some(states), None);
    let input = check_matrix("plant.vertices.input_matrix", &file.input_matrix, tall)?;
    let disturbance = match &file.disturbance_matrix {
        Some(rows) => check_matrix("plant.vertices.disturbance_matrix", rows, tall)?,
        None => input.clone(),
    };
    let output = match &file.output_matrix {
        Some(rows) => check_matrix("plant.vertices.output_matrix", rows, (None, Some(states)))?,
        None => DMatrix::identity(states, states),
    };
    for (field, count) in [
        ("plant.vertices.input_matrix", input.ncols()),
        ("plant.vertices.disturbance_matrix", disturbance.ncols()),
    ] {
        check_count(field, "columns", count, MAX_COLUMNS)?;
    }
    check_count(
        "plant.vertices.output_matrix",
        "rows",
        output.nrows(),
        MAX_COLUMNS,
    )?;
    if file.input_limit.len() != input.ncols() {
        let found = format!("{} entries", file.input_limit.len());
        return Err(wrong(
            "input_limit",
            found,
            format!("{} entries", input.ncols()),
        ));
    }
    for (i, &limit) in file.input_limit.iter().enumerate() {
        check_positive(&format!("plant.vertices.input_limit[{i}]"), limit)?;
    }
    check_not_negative("plant.vertices.disturbance_bound", file.disturbance_bound)?;
    let (box_rows, box_bounds) = check_bounds("plant.vertices.box", &file.region, states)?;
    Ok(VertexSystem {
        state_matrices,
        input_matrix: input,
        disturbance_matrix: disturbance,
        output_matrix: output,
        input_limit: DVector::from_column_slice(&file.input_limit),
        disturbance_bound: file.disturbance_bound,
        box_rows,
        box_bounds,
    })
}

/// The rows and bounds of a box, under the name of their field.
pub fn check_bounds(
    field: &str,
    region: &[LinearBound],
    states: usize,
) -> Result<(DMatrix<f64>, DVector<f64>), ModelError> {
    let count = region.len();
    check_count(field, "bounds", count, MAX_BOUNDS)?;
    let mut rows = DMatrix::zeros(count, states);
    let mut bounds = DVector::zeros(count);
    for (i, bound) in region.iter().enumerate() {
        let field = format!("{field}[{i}]");
        let row = std::slice::from_ref(&bound.row);
        let row = check_matrix(&format!("{field}.row"), row, (Some(1), Some(states)))?;
        check_positive(&format!("{field}.bound"), bound.bound)?;
        rows.row_mut(i).copy_from(&row.row(0));
        bounds[i] = bound.bound;
    }
    Ok((rows, bounds))
}

fn check_specs(specs: &Specs, states: usize) -> Result<(), ModelError> {
    check_positive("specs.phi_per_s", specs.phi_per_s)?;
    check_positive("specs.hbar_s", specs.hbar_s)?;
    let growth = specs.phi_per_s * specs.hbar_s;
    require(
        growth <= 100.0,
        "specs.hbar_s",
        specs.hbar_s,
        "at most 100 / phi_per_s",
    )?;
    if let Some(hmin) = specs.hmin_s {
        let allowed = "above 0 and at most hbar_s";
        require(
            hmin > 0.0 && hmin <= specs.hbar_s,
            "specs.hmin_s",
            hmin,
            allowed,
        )?;
    }
    require(
        (0.0..1.0).contains(&specs.nu),
        "specs.nu",
        specs.nu,
        "in [0, 1)",
    )?;
    if let Some(nu_min) = specs.nu_min {
        let ok = (0.0..=specs.nu).contains(&nu_min);
        require(ok, "specs.nu_min", nu_min, "in [0, nu]")?;
    }
    if let Some(update) = &specs.threshold_update {
        for (i, &mu) in update.mu.iter().enumerate() {
            check_not_negative(&format!("specs.threshold_update.mu[{i}]"), mu)?;
        }
    }
    for (i, &weight) in specs.eps.iter().enumerate() {
        finite(&format!("specs.eps[{i}]"), weight)?;
    }
    check_positive("specs.eps[1]", specs.eps[1])?;
    check_positive("specs.xi_max", specs.xi_max)?;
    let margin = specs.margin;
    require(
        margin > 0.0 && margin <= 0.01,
        "specs.margin",
        margin,
        "in (0, 0.01]",
    )?;
    check_count(
        "specs.must_contain",
        "states",
        specs.must_contain.len(),
        MAX_BOUNDS,
    )?;
    for (i, state) in specs.must_contain.iter().enumerate() {
        let field = format!("specs.must_contain[{i}]");
        check_matrix(&field, std::slice::from_ref(state), (Some(1), Some(states)))?;
    }
    Ok(())
}
