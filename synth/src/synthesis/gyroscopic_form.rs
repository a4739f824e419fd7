//! A short search for the form of the gyroscopic torque.
//!
//! -(omega^x J - K omega^x) omega is the same torque for every K, and the conditions depend on K: the form with the
//! smallest gain is taken. What is proved does not depend on how K was found.

use super::attempts::{Smallest, Synthesis};
use super::gain::GainSynthesis;
use crate::conditions::GainPlan;
use crate::model::{GyroscopicForm, Model};
use crate::programs::{
    DesignRequest, Form, Parameter, Session, Solvers, SynthesisError, FIRST_UNITS,
};
use sdp::solve::Observer;

/// Steps of the two numbers about the best candidate.
const STEP: f64 = 0.2;

/// Rounds of steps along both numbers, each half as long as the one before.
const ROUNDS: usize = 2;

/// An improvement below this, relative, ends the search.
const IMPROVEMENT: f64 = 1e-3;

/// The parts of the first candidate, from which other searches start.
pub(super) fn first_parts() -> [(Parameter, f64); 2] {
    let first = GyroscopicForm::CANDIDATES[0];
    [
        (Parameter::FormMean, first.mean),
        (Parameter::FormDeviation, first.deviation),
    ]
}

/// The model with the form of the smallest gain, where its form is free; the first candidate where none has a solution.
///
/// # Errors
/// Stopped by the observer; a problem that the solver refuses.
pub fn with_chosen_form(
    model: &Model,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Model, SynthesisError> {
    chosen(model, &GainPlan::constant(), solvers, observer)
}

/// The same for these gains.
pub(super) fn chosen(
    model: &Model,
    gains: &GainPlan,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Model, SynthesisError> {
    if !model.has_free_form() {
        return Ok(model.clone());
    }
    let mut search = FormSearch {
        model,
        gains,
        session: Session::alone((solvers.for_searches(), Form::VertexRelaxed), observer),
    };
    let form = search.best()?;
    Ok(model.with_form(form).unwrap_or_else(|| model.clone()))
}

struct FormSearch<'a> {
    model: &'a Model,
    gains: &'a GainPlan,
    session: Session<'a>,
}

impl FormSearch<'_> {
    fn best(&mut self) -> Result<GyroscopicForm, SynthesisError> {
        let mut best = (GyroscopicForm::CANDIDATES[0], f64::INFINITY);
        for candidate in GyroscopicForm::CANDIDATES {
            let value = self.value(candidate)?;
            if value < best.1 {
                best = (candidate, value);
            }
        }
        if best.1.is_infinite() {
            return Ok(best.0);
        }
        let mut step = STEP;
        for _ in 0..ROUNDS {
            let before = best.1;
            for along in [along_mean, along_deviation] {
                best = self.line(best, along, step)?;
            }
            if before - best.1 < IMPROVEMENT * before {
                break;
            }
            step *= 0.5;
        }
        Ok(best.0)
    }

    /// The better of a point and the vertex of the parabola through it and its neighbours.
    fn line(
        &mut self,
        best: (GyroscopicForm, f64),
        along: fn(GyroscopicForm, f64) -> GyroscopicForm,
        step: f64,
    ) -> Result<(GyroscopicForm, f64), SynthesisError> {
        let (at, here) = best;
        let (back, ahead) = (along(at, -step), along(at, step));
        let (behind, beyond) = (self.value(back)?, self.value(ahead)?);
        let mut found = [best, (back, behind), (ahead, beyond)];
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut best = found[0];
        let curvature = behind + beyond - 2.0 * here;
        if curvature > 0.0 && curvature.is_finite() {
            let shift = 0.5 * (behind - beyond) / curvature;
            let vertex = along(at, step * shift.clamp(-2.0, 2.0));
            let value = self.value(vertex)?;
            if value < best.1 {
                best = (vertex, value);
            }
        }
        Ok(best)
    }

    /// The smallest gain that the solver reports with a form; infinite without one.
    fn value(&mut self, form: GyroscopicForm) -> Result<f64, SynthesisError> {
        let Some(mut model) = self.model.with_form(form) else {
            return Ok(f64::INFINITY);
        };
        // A set of inertias has many vertices; the nominal one shows which form is good.
        model.plant = model.plant.relaxed();
        let mut task = model.task();
        task.gains = self.gains.clone();
        let request = DesignRequest::of_model(&model, "", &task, self.session.form);
        let mut synthesis = GainSynthesis::new(request, None, &mut self.session);
        Ok(match synthesis.smallest(&FIRST_UNITS)? {
            Smallest::Bound { bound, .. } => bound,
            _ => f64::INFINITY,
        })
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
