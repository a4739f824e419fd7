//! The search for the weight of xi beside g with which the guaranteed gain is smallest, where starts must be contained.
//!
//! A program minimises max(g, w xi) for one weight w (s, over the squared unit of the gain), and with its optimum m the
//! guaranteed gain sqrt(g xi) is at most m/sqrt(w). The smallest of these bounds over all w is the smallest sqrt(g xi)
//! itself: max(g, w xi)/sqrt(w) is never below sqrt(g xi), and equal to it at w = g/xi. So one number is searched, and
//! every step is a convex program. Its dual solution gives the slope: d ln m/d ln w is the multiplier of w xi <= m, a
//! number from 0 to 1, so that the bound falls with w where that is below 1/2. The condition on the starts is then
//! stated about the solver's point at the best w, where it is exact, and the weight is searched again.
//!
//! Without starts there is nothing to search: every smaller set has a smaller gain, down to a set of no use.

use nalgebra::DMatrix;

use super::attempts::{Attempt, Smallest};
use super::gain::{best_objective, GainSynthesis, UnitAttempts, BACK_OFFS};
use crate::conditions::Task;
use crate::design::ProblemUnits;
use crate::programs::{DesignRequest, Session, SynthesisError};

/// The factors between weights while a minimum is bracketed: in the first round, and about a point.
const FIRST_STEP: f64 = 4.0;
const LATER_STEP: f64 = 2.0;

/// How often the condition on the starts is stated about a point.
const ROUNDS: usize = 12;

/// Steps at most until the minimum is bracketed, and inside the bracket.
const STEPS: usize = 8;
const REFINEMENTS: usize = 5;

/// The least distance of a new weight from the ends of a bracket, relative to its width.
const LEAST_MOVE: f64 = 0.05;

/// Rounds at whose best weights a design is tried, the last first: a bound is the solver's word only.
const TRIED: usize = 3;

/// An improvement by less than this, relative, is none.
const IMPROVEMENT: f64 = 1e-3;

/// The bound m(w)/sqrt(w) of the guaranteed gain at a weight.
#[derive(Clone)]
struct Sample {
    log_weight: f64,
    /// ln of the bound; infinite where the solver has none.
    log_bound: f64,
    /// Its derivative with respect to the logarithm of the weight.
    slope: f64,
    /// Uh^-1 Qh of the solver's point, in SI units: about it the condition on the starts is exact there.
    point: Option<DMatrix<f64>>,
}

/// Puts a design at a better weight in the place of the best one, where there is such a weight. Nothing happens without
/// a design, or without starts that must be contained.
pub(super) fn improve(
    request: DesignRequest,
    session: &mut Session,
    found: &mut UnitAttempts,
) -> Result<(), SynthesisError> {
    if request.task.specification.must_contain.is_empty() && request.task.containment.is_none() {
        return Ok(());
    }
    let Some(best) = &found.best else {
        return Ok(());
    };
    let units = best.file.provenance.problem.clone();
    let mut search = WeightSearch {
        request,
        units: &units,
        session,
        found,
    };
    let mut rounds: Vec<(Task, Sample)> = Vec::new();
    let mut task = request.task.clone();
    for round in 0..ROUNDS {
        let step = if round == 0 { FIRST_STEP } else { LATER_STEP };
        let Some(best) = search.best(&task, step)? else {
            break;
        };
        let last = rounds.last();
        if last.is_some_and(|(_, last)| best.log_bound > last.log_bound - IMPROVEMENT) {
            break;
        }
        let next = best.point.clone().map(|point| Task {
            gain_per_weight: best.log_weight.exp(),
            ..request.task.containing_about(point)
        });
        rounds.push((task, best));
        let Some(next) = next else { break };
        task = next;
    }
    search.design(rounds)
}

/// The smallest bound of the guaranteed gain as a function of the weight, in the units of one design.
struct WeightSearch<'a, 'b, 'c> {
    request: DesignRequest<'a>,
    units: &'a ProblemUnits,
    session: &'b mut Session<'c>,
    found: &'b mut UnitAttempts,
}

impl WeightSearch<'_, '_, '_> {
    /// Designs at the best weights of the last rounds, until one is proved.
    fn design(&mut self, rounds: Vec<(Task, Sample)>) -> Result<(), SynthesisError> {
        let before = best_objective(self.found).ln();
        for (task, sample) in rounds.iter().rev().take(TRIED) {
            if sample.log_bound > before - IMPROVEMENT {
                break;
            }
            let bounds = [(self.units.clone(), sample.log_bound.exp())];
            let attempt = self.with_weight(task, sample.log_weight, |synthesis, found| {
                found.back_off(synthesis, &bounds, &BACK_OFFS)
            })?;
            if attempt == Attempt::Proved {
                break;
            }
        }
        Ok(())
    }

    /// The sample with the smallest bound, from the task's weight on: steps down the slope to where it rises, then inside
    /// that bracket. `None` where the solver has no bound.
    fn best(&mut self, task: &Task, step: f64) -> Result<Option<Sample>, SynthesisError> {
        let mut near = self.at(task, task.gain_per_weight.ln())?;
        if near.log_bound.is_infinite() {
            return Ok(None);
        }
        let mut best = near.clone();
        let step = -step.ln() * near.slope.signum();
        let mut bracket = None;
        for _ in 0..STEPS {
            let next = self.at(task, near.log_weight + step)?;
            best = best.or_better(&next);
            if next.log_bound.is_infinite() || next.slope * step > 0.0 {
                bracket = Some((near, next));
                break;
            }
            near = next;
        }
        let Some((mut down, mut up)) = bracket else {
            return Ok(Some(best));
        };
        for _ in 0..REFINEMENTS {
            let Some(log_weight) = between(&down, &up, best.log_bound) else {
                break;
            };
            let next = self.at(task, log_weight)?;
            best = best.or_better(&next);
            match next.log_bound.is_finite() && next.slope * step <= 0.0 {
                true => down = next,
                false => up = next,
            }
        }
        Ok(Some(best))
    }

    /// The bound at a weight.
    fn at(&mut self, task: &Task, log_weight: f64) -> Result<Sample, SynthesisError> {
        let units = self.units.clone();
        self.with_weight(task, log_weight, |synthesis, found| {
            let bound = match found.smallest(synthesis, &units)? {
                Smallest::Bound { bound, .. } => bound,
                _ => f64::INFINITY,
            };
            Ok(Sample {
                log_weight,
                log_bound: bound.ln(),
                slope: synthesis.weight_share - 0.5,
                point: synthesis.linearisation.take(),
            })
        })
    }

    fn with_weight<T>(
        &mut self,
        task: &Task,
        log_weight: f64,
        run: impl FnOnce(&mut GainSynthesis, &mut UnitAttempts) -> Result<T, SynthesisError>,
    ) -> Result<T, SynthesisError> {
        let task = Task {
            gain_per_weight: log_weight.exp(),
            ..task.clone()
        };
        let request = DesignRequest {
            task: &task,
            ..self.request
        };
        let mut synthesis = GainSynthesis::new(request, None, self.session);
        run(&mut synthesis, self.found)
    }
}

impl Sample {
    fn or_better(self, other: &Sample) -> Sample {
        match other.log_bound < self.log_bound {
            true => other.clone(),
            false => self,
        }
    }
}

/// Where the tangents at the ends of a bracket meet, away from its ends; the middle where one end has no bound. `None`
/// where they promise no improvement of the best.
fn between(down: &Sample, up: &Sample, best: f64) -> Option<f64> {
    let width = up.log_weight - down.log_weight;
    if up.log_bound.is_infinite() {
        return (width.abs() > IMPROVEMENT).then_some(down.log_weight + 0.5 * width);
    }
    let rise = up.log_bound - down.log_bound - up.slope * width;
    let share = rise / (width * (down.slope - up.slope));
    let promised = down.log_bound + down.slope * share * width;
    let share = share.clamp(LEAST_MOVE, 1.0 - LEAST_MOVE);
    let worth = promised < best - IMPROVEMENT && share.is_finite();
    worth.then_some(down.log_weight + share * width)
}
