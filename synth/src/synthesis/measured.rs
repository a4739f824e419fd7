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

/// The part of the error from which a point is carried to the whole of it, where no start has a solution.
const FIRST_PART: f64 = 0.05;

/// Factor from one part to the next; where it is too large, the part half-way on a logarithmic scale is tried.
const GROWTH: f64 = 1.6;

/// How often a part may be too large.
const SETBACKS: usize = 10;

/// Solves at one part before the next is tried, and an improvement below which that is soon enough, relative.
const SOLVES_OF_PART: usize = 5;
const SETTLED: f64 = 0.03;

/// Most solves after the first.
const ROUNDS: usize = 8;

/// An improvement below this, relative, ends the iteration.
const IMPROVEMENT: f64 = 1e-3;

/// How far the part of a limit that is kept for the measurement error lies above what it needs, relative.
const RESERVE_ALLOWANCE: f64 = 1e-2;

/// The task with the best point found, each further solver asked where those before it fail; as it is for a perfect measurement, or where no point has a solution.
pub(super) fn linearised(
    model: &Model,
    task: &Task,
    sessions: &mut [Session],
) -> Result<Task, SynthesisError> {
    let Some(error) = &task.imperfections.measurement else {
        return Ok(task.clone());
    };
    let search = PointSearch { model, task, error };
    let mut ideal = task.clone();
    ideal.imperfections.measurement = None;
    let (_, Some(start)) = search.solved(&ideal, sessions)? else {
        return Ok(task.clone());
    };
    let mut best: Option<(f64, Task)> = None;
    for share in FIRST_SHARES {
        let from = search.about_ideal(&start, share);
        let (value, found) = search.improved(from, sessions)?;
        if let Some(found) = found {
            let better = best.as_ref().is_none_or(|(least, _)| value < *least);
            if better && value.is_finite() {
                best = Some((value, found));
            }
        }
    }
    if best.is_none() {
        best = search.carried(&start, sessions)?;
    }
    let Some((mut least, mut at)) = best else {
        return Ok(task.clone());
    };
    for _ in 0..ROUNDS {
        let (value, Some(next)) = search.improved(at.clone(), sessions)? else {
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
    /// The smallest gain of a task, with its point. A point that the solver does not vouch for may do as a point of
    /// linearisation, but its gain counts for nothing.
    fn solved(
        &self,
        task: &Task,
        sessions: &mut [Session],
    ) -> Result<(f64, Option<Solved>), SynthesisError> {
        let mut first = None;
        for session in sessions {
            let solved = session.solve(scaled(task, &FIRST_UNITS), Goal::SmallestGain)?;
            if has_point(&solved.solution) {
                return Ok((solved.solution.objective, Some(solved)));
            }
            let returned = !solved.solution.values.is_empty();
            first = first.or(returned.then_some(solved));
        }
        Ok((f64::INFINITY, first))
    }

    /// The smallest gain of a task, and the task about its solution.
    fn improved(
        &self,
        task: Task,
        sessions: &mut [Session],
    ) -> Result<(f64, Option<Task>), SynthesisError> {
        let (value, solved) = self.solved(&task, sessions)?;
        let next = solved.and_then(|solved| {
            let own = solved.assembled.design.measurement.as_ref()?;
            let values = &solved.solution.values;
            let c = solved.scaling.disturbance;
            let shares = own.shares.iter();
            let shares = shares.map(|share| share.value(values)[(0, 0)] * c * c);
            self.about(&task, &solved, shares.collect())
        });
        Ok((value, next))
    }

    /// The task about an ideal solution, with the error's part of the supply relative to that of the disturbance.
    fn about_ideal(&self, solved: &Solved, share: f64) -> Task {
        let values = &solved.solution.values;
        let c = solved.scaling.disturbance;
        let xi = solved.assembled.design.disturbance_weight.value(values)[(0, 0)] / (c * c);
        let count = self.error.count();
        let each = count as f64 / (share * xi);
        let task = self.about(self.task, solved, vec![each; count]);
        task.unwrap_or_else(|| self.task.clone())
    }

    /// The gain and the task after a part of the error has grown to the whole of it.
    fn carried(
        &self,
        start: &Solved,
        sessions: &mut [Session],
    ) -> Result<Option<(f64, Task)>, SynthesisError> {
        let mut part = FIRST_PART;
        let first = self.at_part(self.about_ideal(start, FIRST_SHARES[0]), part);
        let (_, Some(mut at)) = self.settled(first, sessions)? else {
            return Ok(None);
        };
        let (mut next, mut setbacks) = (part * GROWTH, 0);
        while setbacks < SETBACKS {
            let (value, found) = self.settled(self.at_part(at.clone(), next), sessions)?;
            let Some(found) = found.filter(|_| value.is_finite()) else {
                setbacks += 1;
                next = (part * next).sqrt();
                continue;
            };
            if next == 1.0 {
                return Ok(Some((value, found)));
            }
            (part, at) = (next, found);
            next = (part * GROWTH).min(1.0);
        }
        Ok(None)
    }

    /// The task with a part of the error.
    fn at_part(&self, mut task: Task, part: f64) -> Task {
        if let Some(error) = &mut task.imperfections.measurement {
            error.sizes = &self.error.sizes * part;
        }
        task
    }

    /// Solves again about each solution until the gain hardly falls.
    fn settled(
        &self,
        task: Task,
        sessions: &mut [Session],
    ) -> Result<(f64, Option<Task>), SynthesisError> {
        let mut last = self.improved(task, sessions)?;
        for _ in 1..SOLVES_OF_PART {
            let Some(at) = last.1.clone().filter(|_| last.0.is_finite()) else {
                break;
            };
            let next = self.improved(at, sessions)?;
            if next.1.is_none() || !next.0.is_finite() {
                break;
            }
            let settled = last.0 - next.0 < SETTLED * last.0;
            last = next;
            if settled {
                break;
            }
        }
        Ok(last)
    }

    /// The task linearised about a solution.
    fn about(&self, task: &Task, solved: &Solved, shares: Vec<f64>) -> Option<Task> {
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
        let mut next = task.clone();
        if let Some(error) = &mut next.imperfections.measurement {
            error.reserve = reserve;
            error.point = Some(MeasurementPoint {
                multiplier: &d * multiplier * &d,
                shares,
            });
        }
        usable.then_some(next)
    }
}
