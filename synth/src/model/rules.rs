//! From the rules of a model file to checked numbers.

use nalgebra::{DMatrix, DVector, Matrix3, Vector4};
use runtime::local_rules::FuzzySet;

use super::file::{
    FuzzySetFile, LocalRuleFile, RulesLinear, RulesPlant, RulesSpacecraft, RulesSystem,
};
use super::ranges::{
    check_count, check_inertia, check_matrix, check_not_negative, check_positive, finite, require,
    MAX_COLUMNS, MAX_STATES, MAX_VERTICES,
};
use super::ModelError;
use crate::fuzzy::{ExactSpacecraft, RuleModel, VertexSystem};

/// The matrices that all rules share.
struct SharedMatrices {
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
    for (k, &bound) in file.state_bounds.iter().enumerate() {
        check_positive(&format!("plant.rules.state_bounds[{k}]"), bound)?;
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
    ModelError::WrongShape {
        field: format!("plant.rules.{field}"),
        found,
        expected,
    }
}

fn choice(field: String, reason: &str) -> ModelError {
    ModelError::Choice {
        field,
        reason: reason.to_string(),
    }
}

fn check_cover(model: &RuleModel) -> Result<(), ModelError> {
    let field = "plant.rules.rules".to_string();
    match model.uncovered_point() {
        Ok(None) => Ok(()),
        Ok(Some(point)) => Err(ModelError::Uncovered { field, point }),
        Err(_) => Err(choice(
            field,
            "there are too many overlaps of fuzzy sets to check that every point of the box has a \
             rule; use fewer rules or fewer premises",
        )),
    }
}

fn spacecraft(craft: &RulesSpacecraft, states: usize) -> Result<SharedMatrices, ModelError> {
    let field = "plant.rules.system.spacecraft";
    if states != 6 {
        return Err(wrong(
            "state_bounds",
            format!("{states} entries"),
            "6 entries (3 rates, 3 vector parts)".to_string(),
        ));
    }
    let inertia = check_inertia(&format!("{field}.inertia_kg_m2"), &craft.inertia_kg_m2)?;
    for (axis, &limit) in craft.torque_limit_nm.iter().enumerate() {
        check_positive(&format!("{field}.torque_limit_nm[{axis}]"), limit)?;
    }
    let bound = craft.disturbance_bound_nm;
    check_not_negative(&format!("{field}.disturbance_bound_nm"), bound)?;
    let model = body(&inertia).takagi_sugeno();
    Ok(SharedMatrices {
        input: model.input,
        disturbance: model.disturbance,
        output: model.output,
        input_limit: DVector::from_column_slice(&craft.torque_limit_nm),
        disturbance_bound: bound,
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
    }
}

fn frozen(inertia: &Matrix3<f64>, place: &Vector4<f64>) -> DMatrix<f64> {
    body(inertia).state_matrix(place)
}

fn linear_system(linear: &RulesLinear, states: usize) -> Result<SharedMatrices, ModelError> {
    let field = "plant.rules.system.linear";
    let tall = (Some(states), None);
    let input_field = format!("{field}.input_matrix");
    let input = check_matrix(&input_field, &linear.input_matrix, tall)?;
    let disturbance_field = format!("{field}.disturbance_matrix");
    let disturbance = match &linear.disturbance_matrix {
        Some(rows) => check_matrix(&disturbance_field, rows, tall)?,
        None => input.clone(),
    };
    let output_field = format!("{field}.output_matrix");
    let output = match &linear.output_matrix {
        Some(rows) => check_matrix(&output_field, rows, (None, Some(states)))?,
        None => DMatrix::identity(states, states),
    };
    check_count(&input_field, "columns", input.ncols(), MAX_COLUMNS)?;
    check_count(
        &disturbance_field,
        "columns",
        disturbance.ncols(),
        MAX_COLUMNS,
    )?;
    check_count(&output_field, "rows", output.nrows(), MAX_COLUMNS)?;
    if linear.input_limit.len() != input.ncols() {
        return Err(wrong(
            "system.linear.input_limit",
            format!("{} entries", linear.input_limit.len()),
            format!("{} entries", input.ncols()),
        ));
    }
    for (i, &limit) in linear.input_limit.iter().enumerate() {
        check_positive(&format!("{field}.input_limit[{i}]"), limit)?;
    }
    check_not_negative(
        &format!("{field}.disturbance_bound"),
        linear.disturbance_bound,
    )?;
    Ok(SharedMatrices {
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
            return Err(ModelError::OutOfRange {
                field: format!("{field}.state"),
                value: number as f64,
                allowed: format!("a state from 1 to {states}"),
            });
        };
        if *set != FuzzySet::Any {
            return Err(choice(
                format!("{field}.state"),
                "the rule has a premise for this state already; one for each state is allowed",
            ));
        }
        *set = fuzzy_set(&format!("{field}.is"), &premise.is)?;
    }
    Ok(sets)
}

fn fuzzy_set(field: &str, file: &FuzzySetFile) -> Result<FuzzySet, ModelError> {
    let ordered = |name: &str, corners: &[(&str, f64)]| -> Result<(), ModelError> {
        for (key, value) in corners {
            finite(&format!("{field}.{name}.{key}"), *value)?;
        }
        for pair in corners.windows(2) {
            let (key, value) = pair[1];
            let allowed = format!("{} or above, its left neighbour", pair[0].1);
            let path = format!("{field}.{name}.{key}");
            require(value >= pair[0].1, &path, value, &allowed)?;
        }
        let (first, last) = (corners[0], corners[corners.len() - 1]);
        let path = format!("{field}.{name}.{}", last.0);
        require(
            last.1 > first.1,
            &path,
            last.1,
            &format!("above {}", first.1),
        )
    };
    match file {
        FuzzySetFile::Triangular(set) => {
            let corners = [("left", set.left), ("peak", set.peak), ("right", set.right)];
            ordered("triangular", &corners)?;
            Ok(FuzzySet::Triangular {
                left: set.left,
                peak: set.peak,
                right: set.right,
            })
        }
        FuzzySetFile::Trapezoidal(set) => {
            let corners = [
                ("left", set.left),
                ("left_top", set.left_top),
                ("right_top", set.right_top),
                ("right", set.right),
            ];
            ordered("trapezoidal", &corners)?;
            Ok(FuzzySet::Trapezoidal {
                left: set.left,
                left_top: set.left_top,
                right_top: set.right_top,
                right: set.right,
            })
        }
        FuzzySetFile::Gaussian(set) => {
            finite(&format!("{field}.gaussian.centre"), set.centre)?;
            check_positive(&format!("{field}.gaussian.width"), set.width)?;
            Ok(FuzzySet::Gaussian {
                centre: set.centre,
                width: set.width,
            })
        }
    }
}

/// (omega, q0) of an operating point; q0 is the double that `sqrt(1 - |q|^2)` gives, and that double is
/// what the model means.
fn operating_point(field: &str, rule: &LocalRuleFile) -> Result<Vector4<f64>, ModelError> {
    if rule.state_matrix.is_some() {
        return Err(choice(
            format!("{field}.state_matrix"),
            "the system is a spacecraft; its rules have an 'operating_point' instead",
        ));
    }
    let Some(point) = &rule.operating_point else {
        return Err(choice(
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
        return Err(choice(
            format!("{field}.operating_point"),
            "the system is linear; its rules have a 'state_matrix' instead",
        ));
    }
    let Some(rows) = &rule.state_matrix else {
        return Err(choice(
            field.to_string(),
            "the system is linear; each rule needs a 'state_matrix'",
        ));
    };
    let square = (Some(states), Some(states));
    check_matrix(&format!("{field}.state_matrix"), rows, square)
}
