//! A design problem as a semidefinite program.

use super::checked::Problem;
use super::{with_problem, DesignTask};
use crate::conditions::state_feedback::{DesignProblem, Transformed, VertexPlant};
use sdp::lmi::{self, Affine, Semidefinite, Strictness, Unknowns};
use sdp::solve::Accuracy;

/// Margin of every strict inequality in the first solve, in scaled units.
const MARGIN: f64 = 1e-6;

/// Unit of the margin that the second solve maximises.
const MARGIN_UNIT: f64 = 1e-3;

/// Margin in the program for the smallest slack, in scaled units.
pub(super) const SLACK_MARGIN: f64 = 1e-2;

/// The optimum that a program is solved for.
#[derive(Clone, Copy)]
pub(super) enum ProblemGoal {
    SmallestObjective,
    LargestMargin {
        objective: f64,
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
            ProblemGoal::SmallestSlack => "smallest slack",
            ProblemGoal::Margin(_) => "margin",
        }
    }

    pub(super) fn accuracy(self) -> Accuracy {
        let (relative_gap, objective_unit) = match self {
            ProblemGoal::SmallestObjective => (1e-8, 1e-3),
            ProblemGoal::LargestMargin { .. } => (1e-2, 1.0),
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
}

/// States a problem in the units of `plant`.
pub(super) fn program<P: DesignProblem>(
    requested: &P,
    plant: &VertexPlant,
    goal: ProblemGoal,
) -> Program {
    let mut unknowns = Unknowns::new();
    let mut transformed = Transformed::new::<P>(&mut unknowns, plant);
    let (strictness, objective) = match goal {
        ProblemGoal::SmallestObjective => {
            (Strictness::fixed(MARGIN), transformed.objective.clone())
        }
        ProblemGoal::Margin(margin) => (Strictness::fixed(margin), transformed.objective.clone()),
        ProblemGoal::LargestMargin { objective } => {
            let margin = unknowns.scalar("margin");
            transformed.objective = Affine::identity(1, objective);
            (Strictness::unknown(MARGIN_UNIT * &margin), -margin)
        }
        ProblemGoal::SmallestSlack => {
            let slack = unknowns.scalar("slack");
            let margin = Affine::identity(1, SLACK_MARGIN) - slack.clone();
            (Strictness::unknown(margin), slack)
        }
    };
    let conditions = requested.conditions(plant, &transformed, &strictness);
    Program {
        problem: lmi::LmiProblem {
            unknowns,
            objective,
            conditions,
        },
        transformed,
    }
}

/// The first problem that is solved, lowered, in its scaled units.
pub fn first_program(problem: &Problem) -> Semidefinite {
    fn lowered<P: DesignProblem>(requested: &P, plant: &VertexPlant) -> Semidefinite {
        let units = requested.units(plant);
        let (requested, plant) = (requested.in_units(&units), plant.in_units(&units));
        program(&requested, &plant, ProblemGoal::SmallestObjective)
            .problem
            .lower()
    }
    with_problem!(&problem.task, requested => lowered(requested, &problem.plant))
}
