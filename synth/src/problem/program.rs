//! A design problem as a semidefinite program.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::checked::Problem;
use super::scaled::Scaled;
use super::{with_problem, DesignTask};
use crate::conditions::state_feedback::{DesignProblem, Inequality, Transformed, VertexPlant};
use crate::conditions::units::Sizes;
use sdp::lmi::{self, Affine, Condition, Semidefinite, SymmetricBlocks, Unknowns};
use sdp::solve::Accuracy;

/// Margin of every strict inequality in the first solve, relative to the condition's own scale.
const MARGIN: f64 = 1e-8;

/// Unit of the relative margin that the second solve maximises.
const MARGIN_UNIT: f64 = 1e-3;

/// The largest relative margin that is looked for.
const MARGIN_LIMIT: f64 = 0.5;

/// While the margin is maximised, Q stays below this, in units in which it is about 1.
const LARGEST_INVERSE: f64 = 1e4;

/// The largest objective, in units in which it is about 1, where any is good enough.
const LARGEST_OBJECTIVE: f64 = 1e8;

/// The smallest weight of a condition's row, relative to its largest.
const SMALLEST_WEIGHT: f64 = 1e-4;

/// Margin in the program for the smallest slack, in scaled units.
pub(super) const SLACK_MARGIN: f64 = 1e-2;

/// The optimum that a program is solved for. Objectives are in scaled units.
#[derive(Clone, Copy)]
pub(super) enum ProblemGoal {
    SmallestObjective,
    /// The largest relative margin at an objective.
    LargestMargin {
        objective: f64,
    },
    /// The largest relative margin whatever the objective.
    AnyObjective,
    /// The smallest gains at an objective with a relative margin, in the unit of the largest one.
    SmallestEffort {
        objective: f64,
        margin: f64,
    },
    SmallestSlack,
    /// No optimum: the conditions with this margin.
    Margin(f64),
}

impl ProblemGoal {
    pub(super) fn name(self) -> &'static str {
        match self {
            ProblemGoal::SmallestObjective => "smallest objective",
            ProblemGoal::LargestMargin { .. } => "largest margin",
            ProblemGoal::AnyObjective => "largest margin, any objective",
            ProblemGoal::SmallestEffort { .. } => "smallest gains",
            ProblemGoal::SmallestSlack => "smallest slack",
            ProblemGoal::Margin(_) => "margin",
        }
    }

    /// The margin of the strict inequalities at a point with this objective.
    pub(super) fn margin(self, objective: f64) -> f64 {
        match self {
            ProblemGoal::SmallestObjective => MARGIN,
            ProblemGoal::LargestMargin { .. } | ProblemGoal::AnyObjective => {
                -MARGIN_UNIT * objective
            }
            ProblemGoal::SmallestEffort { margin, .. } => MARGIN_UNIT * margin,
            ProblemGoal::SmallestSlack => SLACK_MARGIN - objective,
            ProblemGoal::Margin(margin) => margin,
        }
    }

    pub(super) fn accuracy(self) -> Accuracy {
        let (relative_gap, objective_unit) = match self {
            ProblemGoal::SmallestObjective => (1e-8, 1e-3),
            ProblemGoal::LargestMargin { .. } | ProblemGoal::AnyObjective => (1e-2, 1.0),
            ProblemGoal::SmallestEffort { .. } => (1e-1, 1e-2),
            ProblemGoal::SmallestSlack | ProblemGoal::Margin(_) => (1e-6, SLACK_MARGIN),
        };
        Accuracy {
            relative_gap,
            objective_unit,
        }
    }
}

/// A problem for a solver, with handles on its unknowns.
pub(super) struct Program {
    pub(super) problem: lmi::LmiProblem,
    pub(super) transformed: Transformed,
    /// The conditions without their margins.
    pub(super) stated: Vec<Inequality>,
}

/// Weights that are not far below the largest; all 1 where they are no numbers.
fn bounded_below(weights: DVector<f64>) -> DVector<f64> {
    let largest = weights.max();
    match largest.is_finite() && largest > 0.0 {
        true => weights.map(|weight| weight.max(SMALLEST_WEIGHT * largest)),
        false => weights.map(|_| 1.0),
    }
}

/// The strict conditions at a point, by name.
fn matrices<P: DesignProblem>(
    scaled: &Scaled<P>,
    inverse: &DMatrix<f64>,
    gain: Option<&DMatrix<f64>>,
    objective: f64,
) -> BTreeMap<String, DMatrix<f64>> {
    let (plant, eliminated) = (&scaled.plant, scaled.eliminated);
    let point = Transformed::at::<P>(plant, inverse, gain, objective, eliminated);
    let stated = scaled.problem.conditions(plant, &point).into_iter();
    let strict = stated.filter(|stated| stated.strict);
    strict
        .map(|stated| (stated.name, stated.matrix.value(&[])))
        .collect()
}

/// The scale of every strict condition at a point: the rows of its matrix. Without feedback, whose size says nothing:
/// it may be large for no reason.
pub(super) fn weights<P: DesignProblem>(
    scaled: &Scaled<P>,
    inverse: &DMatrix<f64>,
    objective: f64,
) -> BTreeMap<String, DVector<f64>> {
    let weight = |matrix: DMatrix<f64>| {
        let rows = matrix.row_iter().map(|row| row.abs().sum());
        bounded_below(DVector::from_iterator(matrix.nrows(), rows))
    };
    let matrices = matrices(scaled, inverse, None, objective).into_iter();
    matrices
        .map(|(name, matrix)| (name, weight(matrix)))
        .collect()
}

/// The same units with the feedback as an unknown, and the scales of the conditions at Q.
pub(super) fn with_feedback<P: DesignProblem>(
    scaled: &Scaled<P>,
    inverse: &DMatrix<f64>,
    objective: f64,
) -> Scaled<P> {
    let mut out = scaled.clone();
    if out.eliminated {
        out.eliminated = false;
        out.weights = weights(&out, inverse, objective);
    }
    out
}

/// The relative margin of a point, in the unit of the largest one.
pub(super) fn margin_at<P: DesignProblem>(
    scaled: &Scaled<P>,
    inverse: &DMatrix<f64>,
    gain: &DMatrix<f64>,
    objective: f64,
) -> f64 {
    let smallest = |(name, matrix): (String, DMatrix<f64>)| {
        let scale = scaled
            .weights
            .get(&name)
            .map(|weights| weights.map(|w| 1.0 / w.sqrt()));
        let scale = scale.unwrap_or_else(|| DVector::from_element(matrix.nrows(), 1.0));
        let relative = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
            matrix[(r, c)] * scale[r] * scale[c]
        });
        relative.symmetric_eigenvalues().min()
    };
    let matrices = matrices(scaled, inverse, Some(gain), objective).into_iter();
    matrices.map(smallest).fold(MARGIN_LIMIT, f64::min) / MARGIN_UNIT
}

/// `[ Q, Y' ; *, r I ] >= 0`: F Q F' <= r, so that x'Px <= 1 implies |u|^2 <= r.
fn effort_bounded(transformed: &Transformed, effort: &Affine) -> Condition {
    let m = transformed.gain.nrows();
    let bound = effort.times_matrix(&DMatrix::identity(m, m));
    let beside = transformed.gain.transposed();
    let matrix = SymmetricBlocks::of(&[&[&transformed.inverse, &beside], &[&bound]]);
    Condition::semidefinite("effort", matrix)
}

/// States a problem in its units.
pub(super) fn program<P: DesignProblem>(scaled: &Scaled<P>, goal: ProblemGoal) -> Program {
    let plant = &scaled.plant;
    let mut unknowns = Unknowns::new();
    let mut transformed = Transformed::new::<P>(&mut unknowns, plant, scaled.eliminated);
    let identity = DMatrix::identity(plant.states(), plant.states());
    let known = match scaled.weights.is_empty() {
        true => weights(scaled, &identity, 1.0),
        false => scaled.weights.clone(),
    };
    let mut stated = scaled.problem.conditions(plant, &transformed);
    if let Some(floor) = scaled.floor {
        let least = Affine::identity(1, floor.objective);
        stated.push(Inequality::weak(
            floor.name,
            &transformed.objective - &least,
        ));
    }
    let absolute = matches!(goal, ProblemGoal::SmallestSlack | ProblemGoal::Margin(_));
    let weight = |condition: &Inequality| {
        let known = known.get(&condition.name).filter(|_| !absolute).cloned();
        known.unwrap_or_else(|| DVector::from_element(condition.matrix.nrows(), 1.0))
    };
    let weights: Vec<_> = stated.iter().map(weight).collect();
    let mut further = Vec::new();
    let (margin, objective) = match goal {
        ProblemGoal::SmallestObjective => {
            (Affine::identity(1, MARGIN), transformed.objective.clone())
        }
        ProblemGoal::Margin(margin) => (Affine::identity(1, margin), transformed.objective.clone()),
        ProblemGoal::LargestMargin { .. } | ProblemGoal::AnyObjective => {
            let margin = unknowns.scalar("margin");
            let limit = Affine::identity(1, MARGIN_LIMIT / MARGIN_UNIT);
            further.push(Condition::semidefinite(
                "largest margin",
                limit - margin.clone(),
            ));
            let largest = Affine::identity(plant.states(), LARGEST_INVERSE);
            let room = &largest - &transformed.inverse;
            further.push(Condition::semidefinite("largest inverse", room));
            (MARGIN_UNIT * &margin, -margin)
        }
        ProblemGoal::SmallestEffort { margin, .. } => {
            let effort = unknowns.scalar("effort");
            further.push(effort_bounded(&transformed, &effort));
            (Affine::identity(1, MARGIN_UNIT * margin), effort)
        }
        ProblemGoal::SmallestSlack => {
            let slack = unknowns.scalar("slack");
            (Affine::identity(1, SLACK_MARGIN) - slack.clone(), slack)
        }
    };
    match goal {
        ProblemGoal::LargestMargin { objective }
        | ProblemGoal::SmallestEffort { objective, .. } => {
            transformed.objective = Affine::identity(1, objective);
            stated = scaled.problem.conditions(plant, &transformed);
        }
        ProblemGoal::AnyObjective => {
            let largest = Affine::identity(1, LARGEST_OBJECTIVE);
            let room = &largest - &transformed.objective;
            further.push(Condition::semidefinite("largest objective", room));
        }
        _ => {}
    }
    let with_margin = |(condition, weight): (&Inequality, &DVector<f64>)| {
        let matrix = match condition.strict {
            true => &condition.matrix - &margin.times_matrix(&DMatrix::from_diagonal(weight)),
            false => condition.matrix.clone(),
        };
        Condition::semidefinite(condition.name.clone(), matrix)
    };
    let mut conditions: Vec<_> = stated.iter().zip(&weights).map(with_margin).collect();
    conditions.append(&mut further);
    Program {
        problem: lmi::LmiProblem {
            unknowns,
            objective,
            conditions,
        },
        transformed,
        stated,
    }
}

/// The first problem that is solved, lowered, in its scaled units; its objective is in the file's.
pub fn first_program(problem: &Problem) -> Semidefinite {
    fn lowered<P: DesignProblem>(requested: &P, plant: &VertexPlant) -> Semidefinite {
        let sizes = Sizes::of(plant, requested.decay_rate());
        let scaled = Scaled::new(requested, plant, &sizes, requested.floor(plant));
        let mut stated = program(&scaled, ProblemGoal::SmallestObjective).problem;
        stated.objective = scaled.units.objective * stated.objective;
        stated.lower()
    }
    with_problem!(&problem.task, requested => lowered(requested, &problem.plant))
}
