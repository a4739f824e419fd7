//! A point of linearisation for the condition on a measurement error.
//!
//! The condition is linear in the unknowns once `Qh Lam Qh'` is bounded from below about a point; at the last solution the
//! bound is exact, so that the gain falls with every solve until it stays.

use nalgebra::DVector;

use crate::conditions::{MeasurementError, MeasurementPoint, Task};
use crate::model::Model;
use crate::programs::{has_point, scaled, Goal, Session, Solved, SynthesisError, FIRST_UNITS};

/// First parts of the measurement error in the supply, relative to that of the disturbance.
const FIRST_SHARES: [f64; 3] = [0.1, 0.5, 2.0];

/// Most solves after the first.
const ROUNDS: usize = 8;

/// An improvement below this, relative, ends the iteration.
const IMPROVEMENT: f64 = 1e-3;

/// How far the part of a limit that is kept for the measurement error lies above what it needs, relative.
const RESERVE_ALLOWANCE: f64 = 1e-2;

/// The task with the best point found; as it is for a perfect measurement, or where no point has a solution.
pub(super) fn linearised(
    model: &Model,
    task: &Task,
    session: &mut Session,
) -> Result<Task, SynthesisError> {
    let Some(error) = &task.imperfections.measurement else {
        return Ok(task.clone());
    };
    let search = PointSearch { model, task, error };
    let mut ideal = task.clone();
    ideal.imperfections.measurement = None;
    let (_, Some(start)) = search.solved(&ideal, session)? else {
        return Ok(task.clone());
    };
    let mut best: Option<(f64, Task)> = None;
    for share in FIRST_SHARES {
        let from = search.from_ideal(&start, share);
        let (value, found) = search.improved(from, session)?;
        if let Some(found) = found {
            if best.as_ref().is_none_or(|(least, _)| value < *least) {
                best = Some((value, found));
            }
        }
    }
    let Some((mut least, mut at)) = best else {
        return Ok(task.clone());
    };
    for _ in 0..ROUNDS {
        let (value, Some(next)) = search.improved(at.clone(), session)? else {
            break;
        };
        let settled = least - value < IMPROVEMENT * least;
        if value < least {
            (least, at) = (value, next);
        }
        if settled {
            break;
        }
    }
    Ok(at)
}

struct PointSearch<'a> {
    model: &'a Model,
    task: &'a Task,
    error: &'a MeasurementError,
}

impl PointSearch<'_> {
    /// The smallest gain of a task, with its point where the solver returned one.
    fn solved(
        &self,
        task: &Task,
        session: &mut Session,
    ) -> Result<(f64, Option<Solved>), SynthesisError> {
        let solved = session.solve(scaled(task, &FIRST_UNITS), Goal::SmallestGain)?;
        let value = solved.solution.objective;
        let usable = has_point(&solved.solution) && value.is_finite();
        Ok((value, usable.then_some(solved)))
    }

    /// The smallest gain of a task, and the task about its solution.
    fn improved(
        &self,
        task: Task,
        session: &mut Session,
    ) -> Result<(f64, Option<Task>), SynthesisError> {
        let (value, solved) = self.solved(&task, session)?;
        let next = solved.and_then(|solved| {
            let own = solved.assembled.design.measurement.as_ref()?;
            let values = &solved.solution.values;
            let c = solved.scaling.disturbance;
            let shares = own.shares.iter();
            let shares = shares.map(|share| share.value(values)[(0, 0)] * c * c);
            self.about(&solved, shares.collect())
        });
        Ok((value, next))
    }

    /// The task about an ideal solution, with the error's part of the supply relative to that of the disturbance.
    fn from_ideal(&self, solved: &Solved, share: f64) -> Task {
        let values = &solved.solution.values;
        let c = solved.scaling.disturbance;
        let xi = solved.assembled.design.disturbance_weight.value(values)[(0, 0)] / (c * c);
        let count = self.error.count();
        let each = count as f64 / (share * xi);
        let task = self.about(solved, vec![each; count]);
        task.unwrap_or_else(|| self.task.clone())
    }

    /// The task linearised about a solution.
    fn about(&self, solved: &Solved, shares: Vec<f64>) -> Option<Task> {
        let values = &solved.solution.values;
        let d = nalgebra::DMatrix::from_diagonal(&solved.scaling.state);
        let multiplier = solved.assembled.design.multiplier.value(values);
        let certificate = solved.recover(self.model)?;
        let taubar = self.task.system.disturbance_bound;
        let reserve = certificate.gain - &certificate.anti_windup;
        let reserve = DVector::from_fn(reserve.nrows(), |input, _| {
            let row = reserve.row(input);
            let of_ball = |ball: usize| {
                let own = (0..row.len()).filter(|&state| self.error.balls[state] == ball);
                let squares = own.map(|state| (row[state] * self.error.sizes[state]).powi(2));
                squares.sum::<f64>().sqrt()
            };
            let sum: f64 = (0..self.error.count()).map(of_ball).sum();
            taubar * sum * (1.0 + RESERVE_ALLOWANCE)
        });
        let usable = shares.iter().all(|share| *share > 0.0 && share.is_finite());
        let mut task = self.task.clone();
        task.imperfections.measurement = Some(MeasurementError {
            point: Some(MeasurementPoint {
                multiplier: &d * multiplier * &d,
                shares,
            }),
            reserve,
            ..self.error.clone()
        });
        usable.then_some(task)
    }
}
