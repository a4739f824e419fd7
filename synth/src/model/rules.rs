//! From the rules of a model file to checked numbers.

use nalgebra::{DMatrix, DVector, Matrix3, Vector4};
use runtime::local_rules::FuzzySet;

use super::file::{
    FuzzySetFile, LocalRuleFile, RulesLinear, RulesPlant, RulesSpacecraft, RulesSystem,
};
use super::ranges::{
    check_inertia, check_matrix, require, SharedMatrices, MAX_STATES, MAX_VERTICES,
};
use super::ModelError;
use crate::fuzzy::{ExactSpacecraft, RuleModel, VertexSystem};

/// What all rules share.
struct Shared {
    input: DMatrix<f64>,
    disturbance: DMatrix<f64>,
    output: DMatrix<f64>,
    input_limit: DVector<f64>,
    disturbance_bound: f64,
    inertia: Option<Matrix3<f64>>,
}

/// Checks a plant of local rules.
pub fn rule_model(file: &RulesPlant) -> Result<RuleModel, ModelError> {
    let states = file.state_bounds.len();
    let count = file.rules.len();
    if states == 0 || states > MAX_STATES {
        return Err(wrong(
            "state_bounds",
            format!("{states} entries"),
            format!("1 to {MAX_STATES} entries"),
        ));
    }
    if count == 0 || count > MAX_VERTICES {
        return Err(wrong(
            "rules",
            format!("{count} rules"),
            format!("1 to {MAX_VERTICES} rules"),
        ));
    }
    let shared = match &file.system {
        RulesSystem::Spacecraft(craft) => spacecraft(craft, states)?,
        RulesSystem::Linear(linear) => linear_system(linear, states)?,
    };
    let mut state_matrices = Vec::with_capacity(count);
    let mut frozen_at = Vec::new();
    let mut sets = Vec::with_capacity(count);
    for (index, rule) in file.rules.iter().enumerate() {
        let field = format!("plant.rules.rules[{index}]");
        sets.push(premises(&format!("{field}.if"), rule, states)?);
        match &shared.inertia {
            Some(inertia) => {
                let place = operating_point(&field, rule)?;
                state_matrices.push(frozen(inertia, &place));
                frozen_at.push(place);
            }
            None => state_matrices.push(state_matrix(&field, rule, states)?),
        }
    }
    let model = RuleModel {
        system: VertexSystem {
            state_matrices,
            input_matrix: shared.input,
            disturbance_matrix: shared.disturbance,
            output_matrix: shared.output,
            input_limit: shared.input_limit,
            disturbance_bound: shared.disturbance_bound,
            box_rows: DMatrix::identity(states, states),
            box_bounds: DVector::from_column_slice(&file.state_bounds),
        },
        sets,
        inertia: shared.inertia,
        frozen_at,
    };
    check_cover(&model)?;
    Ok(model)
}

fn wrong(field: &str, found: String, expected: String) -> ModelError {
    ModelError::shape(format!("plant.rules.{field}"), found, expected)
}

fn check_cover(model: &RuleModel) -> Result<(), ModelError> {
    let field = "plant.rules.rules".to_string();
    match model.uncovered_point() {
        Ok(None) => Ok(()),
        Ok(Some(point)) => Err(ModelError::Uncovered { field, point }),
        Err(_) => Err(ModelError::choice(
            field,
            "there are too many overlaps of fuzzy sets to check that every point of the box has a \
             rule; use fewer rules or fewer premises",
        )),
    }
}

fn spacecraft(craft: &RulesSpacecraft, states: usize) -> Result<Shared, ModelError> {
    let field = "plant.rules.system.spacecraft";
    if states != 6 {
        return Err(wrong(
            "state_bounds",
            format!("{states} entries"),
            "6 entries (3 rates, 3 vector parts)".to_string(),
        ));
    }
    let inertia = check_inertia(&format!("{field}.inertia_kg_m2"), &craft.inertia_kg_m2)?;
    let model = body(&inertia).takagi_sugeno();
    Ok(Shared {
        input: model.input,
        disturbance: model.disturbance,
        output: model.output,
        input_limit: DVector::from_column_slice(&craft.torque_limit_nm),
        disturbance_bound: craft.disturbance_bound_nm,
        inertia: Some(inertia),
    })
}

/// The spacecraft whose A(x) the rules freeze.
fn body(inertia: &Matrix3<f64>) -> ExactSpacecraft {
    ExactSpacecraft {
        inertia_uncertainty: Default::default(),
        inertia: *inertia,
        torque_limit: nalgebra::Vector3::repeat(1.0),
        disturbance_bound: 0.0,
        rate_bound: nalgebra::Vector3::repeat(1.0),
        scalar_part_min: 0.0,
        gyroscopic_form: None,
        output_weights: [1.0; 6],
        exchange: Default::default(),
        at_rest: false,
    }
}

fn frozen(inertia: &Matrix3<f64>, place: &Vector4<f64>) -> DMatrix<f64> {
    body(inertia).state_matrix(place)
}

fn linear_system(linear: &RulesLinear, states: usize) -> Result<Shared, ModelError> {
    let shared = SharedMatrices {
        input: &linear.input_matrix,
        disturbance: linear.disturbance_matrix.as_deref(),
        output: linear.output_matrix.as_deref(),
        input_limit: &linear.input_limit,
    };
    let [input, disturbance, output] = shared.checked("plant.rules.system.linear", states)?;
    Ok(Shared {
        input,
        disturbance,
        output,
        input_limit: DVector::from_column_slice(&linear.input_limit),
        disturbance_bound: linear.disturbance_bound,
        inertia: None,
    })
}

fn premises(field: &str, rule: &LocalRuleFile, states: usize) -> Result<Vec<FuzzySet>, ModelError> {
    let mut sets = vec![FuzzySet::Any; states];
    for (index, premise) in rule.premises.iter().enumerate() {
        let field = format!("{field}[{index}]");
        let number = premise.state;
        let known = number.checked_sub(1).and_then(|k| sets.get_mut(k));
        let Some(set) = known else {
            let allowed = format!("a state from 1 to {states}");
            return Err(ModelError::range(
                format!("{field}.state"),
                number as f64,
                allowed,
            ));
        };
        if *set != FuzzySet::Any {
            return Err(ModelError::choice(
                format!("{field}.state"),
                "the rule has a premise for this state already; one for each state is allowed",
            ));
        }
        *set = fuzzy_set(&format!("{field}.is"), &premise.is)?;
    }
    Ok(sets)
}

/// A fuzzy set whose corners are in order and not all equal.
fn fuzzy_set(field: &str, file: &FuzzySetFile) -> Result<FuzzySet, ModelError> {
    let ordered = |name: &str, corners: &[(&str, f64)]| -> Result<(), ModelError> {
        let path = |key: &str| format!("{field}.{name}.{key}");
        for pair in corners.windows(2) {
            let [(_, left), (key, value)] = [pair[0], pair[1]];
            let allowed = format!("{left} or above, its left neighbour");
            require(value >= left, &path(key), value, &allowed)?;
        }
        let ((_, first), (key, last)) = (corners[0], corners[corners.len() - 1]);
        require(last > first, &path(key), last, &format!("above {first}"))
    };
    Ok(match *file {
        FuzzySetFile::Triangular { left, peak, right } => {
            let corners = [("left", left), ("peak", peak), ("right", right)];
            ordered("triangular", &corners)?;
            FuzzySet::Triangular { left, peak, right }
        }
        FuzzySetFile::Trapezoidal {
            left,
            left_top,
            right_top,
            right,
        } => {
            let tops = [("left_top", left_top), ("right_top", right_top)];
            let corners = [("left", left), tops[0], tops[1], ("right", right)];
            ordered("trapezoidal", &corners)?;
            FuzzySet::Trapezoidal {
                left,
                left_top,
                right_top,
                right,
            }
        }
        FuzzySetFile::Gaussian { centre, width } => FuzzySet::Gaussian { centre, width },
    })
}

/// (omega, q0) of an operating point; q0 is the double that `sqrt(1 - |q|^2)` gives, and that double is
/// what the model means.
fn operating_point(field: &str, rule: &LocalRuleFile) -> Result<Vector4<f64>, ModelError> {
    if rule.state_matrix.is_some() {
        return Err(ModelError::choice(
            format!("{field}.state_matrix"),
            "the system is a spacecraft; its rules have an 'operating_point' instead",
        ));
    }
    let Some(point) = &rule.operating_point else {
        return Err(ModelError::choice(
            field.to_string(),
            "the system is a spacecraft; each rule needs an 'operating_point' of 6 numbers",
        ));
    };
    let path = format!("{field}.operating_point");
    let point = check_matrix(&path, std::slice::from_ref(point), (Some(1), Some(6)))?;
    let square: f64 = (3..6).map(|k| point[(0, k)] * point[(0, k)]).sum();
    let allowed = "a vector part of norm at most 1";
    require(square <= 1.0, &path, square.sqrt(), allowed)?;
    let scalar = (1.0 - square).sqrt();
    Ok(Vector4::new(
        point[(0, 0)],
        point[(0, 1)],
        point[(0, 2)],
        scalar,
    ))
}

fn state_matrix(
    field: &str,
    rule: &LocalRuleFile,
    states: usize,
) -> Result<DMatrix<f64>, ModelError> {
    if rule.operating_point.is_some() {
        return Err(ModelError::choice(
            format!("{field}.operating_point"),
            "the system is linear; its rules have a 'state_matrix' instead",
        ));
    }
    let Some(rows) = &rule.state_matrix else {
        return Err(ModelError::choice(
            field.to_string(),
            "the system is linear; each rule needs a 'state_matrix'",
        ));
    };
    let square = (Some(states), Some(states));
    check_matrix(&format!("{field}.state_matrix"), rows, square)
}
