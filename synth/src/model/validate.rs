//! From a model file to checked numbers.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::bounded::within_ranges;
use super::file::{
    ExactPlant, GainForm, LinearBound, Mismatch, ModelFile, PlantFile, Specs, VerticesPlant,
    MODEL_SCHEMA_VERSION,
};
use super::final_set::{self, check_command_trigger};
use super::inertia::{check_set, inertia_uncertainty};
use super::large_set::{self, check_large_set};
use super::loop_bounds::{check_imperfections, loop_imperfections};
use super::objective::{Objective, OutputWeights};
use super::ranges::{
    check_count, check_inertia, check_line, check_matrix, check_positive, check_version, require,
    SharedMatrices, MAX_BOUNDS, MAX_STATES, MAX_VERTICES,
};
use super::rules::rule_model;
use super::search::check_search;
use super::{parse, readable, FileError, Kind, ModelError, Plant};
use crate::conditions::{GainPlan, Specification, Task};
use crate::fuzzy::{ExactSpacecraft, MomentumExchange, VertexSystem};
use crate::scaling::natural_gain_per_weight;

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
        Ok(Model::of_ranges(parse(text, Kind::Model)?)?)
    }

    /// Checks every value of a model file.
    pub fn new(file: ModelFile) -> Result<Self, ModelError> {
        Model::of_ranges(within_ranges(&file)?)
    }

    /// Checks what the ranges of single numbers leave open.
    fn of_ranges(file: ModelFile) -> Result<Self, ModelError> {
        check_version(file.schema_version, MODEL_SCHEMA_VERSION)?;
        check_line("name", &file.name)?;
        let mut plant = Plant::of_ranges(&file.plant)?;
        if let Plant::Spacecraft(craft) = &mut plant {
            craft.exchange = file.imperfections.momentum_exchange();
            if let PlantFile::Exact(exact) = &file.plant {
                craft.output_weights =
                    OutputWeights::of(exact.output_weights, file.specs.objective)?.each();
            }
            let weighted =
                file.gains == GainForm::Scheduled || matches!(file.mismatch, Mismatch::Kappa(_));
            if weighted {
                // Memberships are those of the sixteen vertices of one form.
                craft.gyroscopic_form.get_or_insert_with(Matrix3::zeros);
            }
        }
        if file.specs.objective == Objective::Pointing && !matches!(plant, Plant::Spacecraft(_)) {
            let reason = "'pointing' needs an 'exact' plant";
            return Err(ModelError::choice("specs.objective", reason));
        }
        check_gain_form(&file, &plant)?;
        check_specs(&file.specs, plant.sizes().0)?;
        check_weight_limit(&file.specs, &plant)?;
        check_imperfections(&file, &plant)?;
        check_large_set(&file)?;
        check_command_trigger(&file)?;
        check_search(&file)?;
        Ok(Model { file, plant })
    }

    /// Shortest sampling interval (s), where the file gives one.
    pub fn sampling_interval_min(&self) -> Option<f64> {
        self.file.specs.hmin_s
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
                disturbance_weight_max: f64::INFINITY,
                must_contain: must_contain
                    .map(|state| DVector::from_column_slice(state))
                    .collect(),
                containment_weight: 1.0,
                margin: specs.margin,
            },
        );
        task.imperfections = loop_imperfections(&self.file, &task.system);
        let largest = specs.xi_max.min(task.largest_useful_weight());
        task.specification.disturbance_weight_max = largest;
        if specs.objective.is_guaranteed_gain() && specs.search.is_none() {
            task.gain_per_weight = natural_gain_per_weight(&task.system);
        }
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

    /// The model of the large-set certificate: the same plant on the box of the large set, with its decay rate, weight
    /// bound and start states.
    ///
    /// # Errors
    /// No `specs.outer`, or a plant that is not `exact`.
    pub fn large_set(&self) -> Result<Model, ModelError> {
        let Some(specs) = &self.file.specs.outer else {
            let reason =
                "is missing: a design with two certificates needs the outer one's decay rate, \
                          box, xi_max and must_contain there";
            return Err(large_set::choice(reason));
        };
        Model::new(large_set::derived(&self.file, specs)?)
    }

    /// The model of the final set of `specs.command_trigger`; `None` where there is none.
    ///
    /// # Errors
    /// A plant that is not `exact`.
    pub fn final_set(&self) -> Result<Option<Model>, ModelError> {
        let specs = self.file.specs.command_trigger.as_ref();
        let Some(last) = specs.and_then(|specs| specs.last.as_ref()) else {
            return Ok(None);
        };
        Model::new(final_set::derived(&self.file, last)?).map(Some)
    }
}

impl Model {
    /// Whether no design exists for this model when none exists for an ideal loop: every imperfection may also be absent.
    /// Actuators whose effectiveness is never 1 are none that could be ideal.
    pub fn is_refuted_by_ideal_loop(&self) -> bool {
        let imperfections = &self.file.imperfections;
        (0..self.plant.sizes().1).all(|input| {
            let [lowest, highest] = imperfections.effectiveness_of(input);
            lowest <= 1.0 && 1.0 <= highest
        })
    }
}

impl Plant {
    /// Checks every value of a plant alone; errors are those of a model file.
    ///
    /// # Errors
    /// The first value that is not allowed.
    pub fn new(file: &PlantFile) -> Result<Self, ModelError> {
        Plant::of_ranges(&within_ranges(file).map_err(|error| error.within("plant"))?)
    }

    /// Checks what the ranges of single numbers leave open.
    fn of_ranges(file: &PlantFile) -> Result<Self, ModelError> {
        Ok(match file {
            PlantFile::Exact(exact) => Plant::Spacecraft(spacecraft(exact)?),
            PlantFile::Vertices(vertices) => Plant::Vertices(vertex_system(vertices)?),
            PlantFile::Rules(rules) => Plant::Rules(rule_model(rules)?),
        })
    }
}

/// Largest number of rules with a gain each.
pub const MAX_SCHEDULED_RULES: usize = 16;

/// Gains and mismatch must go together, and scheduling needs memberships.
fn check_gain_form(file: &ModelFile, plant: &Plant) -> Result<(), ModelError> {
    let refuse = |field: &str, reason: String| Err(ModelError::choice(field, reason));
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
        (GainForm::Scheduled, Mismatch::Kappa(_)) => {}
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

/// The plant of an exact spacecraft; fields are named from `plant.exact` on.
pub fn spacecraft(exact: &ExactPlant) -> Result<ExactSpacecraft, ModelError> {
    let inertia = check_inertia("plant.exact.inertia_kg_m2", &exact.inertia_kg_m2)?;
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
        scalar_part_min: exact.q0_min,
        gyroscopic_form: gyroscopic_form(exact),
        output_weights: OutputWeights::of(exact.output_weights, Objective::Gain)?.each(),
        exchange: MomentumExchange::default(),
        at_rest: false,
    };
    check_set(&craft)?;
    Ok(craft)
}

/// K of the gyroscopic torque's form, where the file gives it.
fn gyroscopic_form(exact: &ExactPlant) -> Option<Matrix3<f64>> {
    let rows = exact.gyroscopic_form_kg_m2.as_ref()?;
    Some(Matrix3::from_fn(|r, c| rows[r][c]))
}

/// The state matrices of a plant given by vertices: at least one, all square and of one size.
pub fn check_state_matrices(matrices: &[Vec<Vec<f64>>]) -> Result<Vec<DMatrix<f64>>, ModelError> {
    let count = matrices.len();
    let states = matrices.first().map_or(0, Vec::len);
    let field = "plant.vertices.state_matrices";
    if count == 0 || count > MAX_VERTICES {
        let expected = format!("1 to {MAX_VERTICES} matrices");
        return Err(ModelError::shape(
            field,
            format!("{count} matrices"),
            expected,
        ));
    }
    if states == 0 || states > MAX_STATES {
        let (field, expected) = (format!("{field}[0]"), format!("1 to {MAX_STATES} states"));
        return Err(ModelError::shape(field, format!("{states} rows"), expected));
    }
    let square = (Some(states), Some(states));
    let checked = matrices.iter().enumerate();
    let checked = checked.map(|(i, rows)| check_matrix(&format!("{field}[{i}]"), rows, square));
    checked.collect()
}

/// The plant given by its vertices; fields are named from `plant.vertices` on.
pub fn vertex_system(file: &VerticesPlant) -> Result<VertexSystem, ModelError> {
    let state_matrices = check_state_matrices(&file.state_matrices)?;
    let states = file.state_matrices[0].len();
    let shared = SharedMatrices {
        input: &file.input_matrix,
        disturbance: file.disturbance_matrix.as_deref(),
        output: file.output_matrix.as_deref(),
        input_limit: &file.input_limit,
    };
    let [input_matrix, disturbance_matrix, output_matrix] =
        shared.checked("plant.vertices", states)?;
    let (box_rows, box_bounds) = check_bounds("plant.vertices.box", &file.region, states)?;
    Ok(VertexSystem {
        state_matrices,
        input_matrix,
        disturbance_matrix,
        output_matrix,
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
        rows.row_mut(i).copy_from(&row.row(0));
        bounds[i] = bound.bound;
    }
    Ok((rows, bounds))
}

/// Without a disturbance nothing else bounds xi.
fn check_weight_limit(specs: &Specs, plant: &Plant) -> Result<(), ModelError> {
    let disturbed = plant.takagi_sugeno().disturbance_bound > 0.0;
    match disturbed || specs.xi_max.is_finite() {
        true => Ok(()),
        false => Err(ModelError::choice(
            "specs.xi_max",
            "is missing: without a disturbance bound above 0 nothing else bounds xi",
        )),
    }
}

/// Largest product of the decay rate and the longest sampling interval.
const MAX_DECAY: f64 = 100.0;

/// What must hold between the numbers of the specifications.
fn check_specs(specs: &Specs, states: usize) -> Result<(), ModelError> {
    let decay = specs.phi_per_s * specs.hbar_s;
    if decay.is_nan() || decay > MAX_DECAY {
        let reason = format!(
            "times specs.phi_per_s it is {}, the decay over one interval; it must be at most {MAX_DECAY}",
            readable(decay)
        );
        return Err(ModelError::choice("specs.hbar_s", reason));
    }
    if let Some(hmin) = specs.hmin_s {
        let allowed = "above 0 and at most hbar_s";
        require(hmin <= specs.hbar_s, "specs.hmin_s", hmin, allowed)?;
    }
    if let Some(nu_min) = specs.nu_min {
        let ok = nu_min <= specs.nu;
        require(ok, "specs.nu_min", nu_min, "in [0, nu]")?;
    }
    check_positive("specs.eps[1]", specs.eps[1])?;
    let count = specs.must_contain.len();
    check_count("specs.must_contain", "states", count, MAX_BOUNDS)?;
    for (i, state) in specs.must_contain.iter().enumerate() {
        let field = format!("specs.must_contain[{i}]");
        check_matrix(&field, std::slice::from_ref(state), (Some(1), Some(states)))?;
    }
    Ok(())
}
