//! The semidefinite programs of one certificate.

use nalgebra::{DMatrix, DVector};

use super::scaled::ScaledTask;
use crate::conditions::held_command::HeldCommandUnknowns;
use crate::conditions::state_feedback::Inequality;
use sdp::lmi::{Affine, Condition, LmiProblem, SymmetricBlocks, Unknowns};
use sdp::solve::Accuracy;

/// What a certificate is to do best.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aim {
    /// Every attitude at rest up to the largest angle.
    LargestAngle,
    /// The smallest bound on the vector part in the end.
    SmallestPointing,
}

/// What beside its own conditions ties a certificate to another one.
#[derive(Debug, Clone)]
pub(super) enum Tie {
    /// None.
    Alone,
    /// A command decided upon where x'Ux <= level stays within the bound, in the units of the task.
    HandsOver { level: f64, bound: f64 },
    /// x'U0 x <= level lies in the set, U0 in the units of the task.
    TakesOver { lyapunov: DMatrix<f64>, level: f64 },
}

/// A certificate's conditions with what is aimed at.
pub(super) struct Stated {
    unknowns: Unknowns,
    pub own: HeldCommandUnknowns,
    conditions: Vec<Inequality>,
    /// The number that is minimised; see [`Stated::state`].
    objective: Affine,
}

/// Unit of the relative margin that the second solve maximises.
const MARGIN_UNIT: f64 = 1e-3;

/// The largest relative margin that is looked for, in its unit.
const MARGIN_LIMIT: f64 = 300.0;

/// Smallest weight of a row, relative to the largest of its condition.
const SMALLEST_WEIGHT: f64 = 1e-9;

/// The rows of a condition's matrix at a point give the scale of its margin.
pub(super) type Weights = Vec<DVector<f64>>;

impl Stated {
    /// States the conditions. Aiming at the angle, t with U_qq <= t I is minimised, 1/t being the square of the vector part
    /// that the set reaches; aiming at the pointing, -w with U >= w P'P.
    pub fn state(scaled: &ScaledTask, aim: Aim, tie: &Tie) -> Self {
        let task = &scaled.task;
        let mut unknowns = Unknowns::new();
        let own = task.unknowns(&mut unknowns);
        let mut conditions = task.conditions(&mut unknowns, &own);
        match tie {
            Tie::Alone => {}
            Tie::HandsOver { level, bound } => {
                conditions.push(task.held_within(&own, *level, *bound));
            }
            Tie::TakesOver { lyapunov, level } => {
                conditions.push(task.contains(&own, lyapunov, *level));
            }
        }
        let number = unknowns.scalar("objective");
        let objective = match aim {
            Aim::LargestAngle => {
                let attitude = own.lyapunov.view(3, 3, 3, 3);
                let room = number.times_matrix(&DMatrix::identity(3, 3)) - attitude;
                conditions.push(Inequality::weak("certified attitudes", room));
                number
            }
            Aim::SmallestPointing => {
                let attitude = DMatrix::from_fn(6, 6, |r, c| f64::from(u8::from(r == c && r >= 3)));
                let room = own.lyapunov.clone() - number.times_matrix(&attitude);
                conditions.push(Inequality::weak("final attitude", room));
                -number
            }
        };
        Stated {
            unknowns,
            own,
            conditions,
            objective,
        }
    }

    /// The best objective.
    pub fn best(&self) -> LmiProblem {
        let conditions = self.conditions.iter();
        let condition = |one: &Inequality| Condition::semidefinite(&one.name, one.matrix.clone());
        LmiProblem {
            unknowns: self.unknowns.clone(),
            objective: self.objective.clone(),
            conditions: conditions.map(condition).collect(),
        }
    }

    /// The accuracy of [`Stated::best`].
    pub const BEST: Accuracy = Accuracy {
        relative_gap: 1e-6,
        objective_unit: 1e-2,
    };

    /// The accuracy of [`Stated::centred`].
    pub const CENTRED: Accuracy = Accuracy {
        relative_gap: 1e-2,
        objective_unit: 1.0,
    };

    /// The scales of the conditions at a point; those of the vertices are the decrease condition's.
    pub fn weights(&self, values: &[f64]) -> Weights {
        let mut decrease = DVector::zeros(0);
        let mut out = Weights::new();
        for one in &self.conditions {
            let own = one.matrix.value(values).diagonal().abs();
            let own = match one.name.contains(" vertex ") {
                true => decrease.rows(0, own.len()).into_owned(),
                false => own,
            };
            let least = SMALLEST_WEIGHT * own.max();
            let own = own.map(|weight| weight.max(least));
            if one.name.starts_with("decrease r=") && !one.name.contains(" vertex ") {
                decrease.clone_from(&own);
            }
            out.push(own);
        }
        out
    }

    /// The largest relative margin at an objective.
    pub fn centred(&self, objective: f64, weights: &Weights) -> LmiProblem {
        let mut unknowns = self.unknowns.clone();
        let margin = unknowns.scalar("margin");
        let scaled = MARGIN_UNIT * &margin;
        let with_margin = |(one, weights): (&Inequality, &DVector<f64>)| {
            let matrix = match one.strict {
                true => &one.matrix - &scaled.times_matrix(&DMatrix::from_diagonal(weights)),
                false => one.matrix.clone(),
            };
            Condition::semidefinite(&one.name, matrix)
        };
        let mut conditions: Vec<_> = self
            .conditions
            .iter()
            .zip(weights)
            .map(with_margin)
            .collect();
        let single = |name: &str, room: Affine| {
            Condition::semidefinite(name, SymmetricBlocks::of(&[&[&room]]))
        };
        let room = Affine::identity(1, objective) - self.objective.clone();
        conditions.push(single("objective", room));
        let room = Affine::identity(1, MARGIN_LIMIT) - margin.clone();
        conditions.push(single("largest margin", room));
        LmiProblem {
            unknowns,
            objective: -margin,
            conditions,
        }
    }
}
