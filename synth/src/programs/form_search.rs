//! A short search for the form of the gyroscopic torque that makes a number smallest: candidates, then steps along the two
//! numbers of a form about the best of them.
//!
//! -(omega^x J - K omega^x) omega is the same torque for every K, and the conditions depend on K. What is proved does
//! not depend on how K was found.

use super::{has_point, scaled, Goal, Session, SynthesisError, FIRST_UNITS};
use crate::conditions::{GainPlan, Task};
use crate::model::{GyroscopicForm, Model};

/// Steps of the two numbers about the best candidate.
const STEP: f64 = 0.2;

/// Rounds of steps along both numbers, each half as long as the one before.
const ROUNDS: usize = 2;

/// The two numbers are multiples of this, so that the last digits of a solver do not move them.
const GRAIN: f64 = 0.01;

/// An improvement below this, relative, ends the search.
const IMPROVEMENT: f64 = 1e-3;

/// A number of a form; infinite where it has none.
pub(crate) type Valued<'a> = &'a mut dyn FnMut(GyroscopicForm) -> Result<f64, SynthesisError>;

/// The form with the smallest number that is found, or the first whose number is at most `enough`; the first candidate,
/// with an infinite number, where none has one.
pub(crate) fn best_form(
    value: Valued,
    enough: f64,
) -> Result<(GyroscopicForm, f64), SynthesisError> {
    let mut search = FormSearch {
        value,
        best: (GyroscopicForm::CANDIDATES[0], f64::INFINITY),
    };
    for candidate in GyroscopicForm::CANDIDATES {
        search.at(candidate)?;
        if search.best.1 <= enough {
            return Ok(search.best);
        }
    }
    let mut step = STEP;
    for _ in 0..ROUNDS {
        let before = search.best.1;
        if before.is_infinite() {
            break;
        }
        for along in [along_mean, along_deviation] {
            search.line(along, step)?;
            if search.best.1 <= enough {
                return Ok(search.best);
            }
        }
        if before - search.best.1 < IMPROVEMENT * before.abs() {
            break;
        }
        step *= 0.5;
    }
    Ok(search.best)
}

/// The smallest slack with which a model's conditions hold in a form, as the solver reports it; infinite without one.
///
/// # Errors
/// Stopped by the observer; a problem that the solver refuses.
pub(crate) fn slack_in(
    form: GyroscopicForm,
    model: &Model,
    gains: &GainPlan,
    session: &mut Session,
) -> Result<f64, SynthesisError> {
    let Some((_, task)) = in_form(form, model, gains) else {
        return Ok(f64::INFINITY);
    };
    let solved = session.solve(scaled(&task, &FIRST_UNITS), Goal::SmallestSlack)?;
    Ok(match has_point(&solved.solution) {
        true => solved.solution.objective,
        false => f64::INFINITY,
    })
}

/// A model in a form, with its task for these gains; `None` for a plant without one. A set of inertias has many vertices;
/// the nominal one shows which form is good.
pub(crate) fn in_form(
    form: GyroscopicForm,
    model: &Model,
    gains: &GainPlan,
) -> Option<(Model, Task)> {
    let mut model = model.with_form(form)?;
    model.plant = model.plant.relaxed();
    let task = Task {
        gains: gains.clone(),
        ..model.task()
    };
    Some((model, task))
}

struct FormSearch<'a> {
    value: Valued<'a>,
    best: (GyroscopicForm, f64),
}

impl FormSearch<'_> {
    /// The number at a form, which becomes the best where it is.
    fn at(&mut self, form: GyroscopicForm) -> Result<f64, SynthesisError> {
        let value = (self.value)(form)?;
        if value < self.best.1 {
            self.best = (form, value);
        }
        Ok(value)
    }

    /// The best form's neighbours along one number, and the vertex of the parabola through the three.
    fn line(
        &mut self,
        along: fn(GyroscopicForm, f64) -> GyroscopicForm,
        step: f64,
    ) -> Result<(), SynthesisError> {
        let (from, here) = self.best;
        let behind = self.at(along(from, -step))?;
        let ahead = self.at(along(from, step))?;
        let curvature = behind + ahead - 2.0 * here;
        if curvature > 0.0 && curvature.is_finite() {
            let shift = 0.5 * (behind - ahead) / curvature;
            let grains = (step * shift.clamp(-2.0, 2.0) / GRAIN).round();
            // The best form itself is known.
            if grains != 0.0 {
                self.at(along(from, grains * GRAIN))?;
            }
        }
        Ok(())
    }
}

fn along_mean(form: GyroscopicForm, step: f64) -> GyroscopicForm {
    GyroscopicForm {
        mean: form.mean + step,
        ..form
    }
}

fn along_deviation(form: GyroscopicForm, step: f64) -> GyroscopicForm {
    GyroscopicForm {
        deviation: form.deviation + step,
        ..form
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_of_a_paraboloid_near_a_candidate_is_found() {
        let mut asked = 0;
        let mut value = |form: GyroscopicForm| {
            asked += 1;
            Ok((form.mean - 0.614).powi(2) + (form.deviation + 0.7).powi(2) + 1.0)
        };
        let (form, least) = best_form(&mut value, f64::NEG_INFINITY).expect("a form");
        assert!(least < 1.0 + 2e-5, "{least} at {form:?}");
        assert!(asked <= 15, "{asked}");
    }

    #[test]
    fn the_search_ends_where_the_number_is_small_enough_or_where_no_candidate_has_one() {
        let mut asked = 0;
        let mut value = |_| {
            asked += 1;
            Ok(-1.0)
        };
        assert_eq!(best_form(&mut value, 0.0).expect("a form").1, -1.0);
        let mut none = |_| {
            asked += 1;
            Ok(f64::INFINITY)
        };
        assert!(best_form(&mut none, 0.0).expect("a form").1.is_infinite());
        assert_eq!(asked, 4);
    }
}
