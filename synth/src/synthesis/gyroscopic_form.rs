//! The form of the gyroscopic torque with the smallest gain; where no form has a design, the one that comes closest.

use super::attempts::{Smallest, Synthesis};
use super::gain::GainSynthesis;
use crate::conditions::GainPlan;
use crate::model::{GyroscopicForm, Model};
use crate::programs::{
    best_form, in_form, slack_in, DesignRequest, Form, Parameter, Session, Solvers, SynthesisError,
    FIRST_UNITS,
};
use sdp::solve::Observer;

/// The parts of the first candidate, from which other searches start.
pub(super) fn first_parts() -> [(Parameter, f64); 2] {
    let first = GyroscopicForm::CANDIDATES[0];
    [
        (Parameter::FormMean, first.mean),
        (Parameter::FormDeviation, first.deviation),
    ]
}

/// The model with the form of the smallest gain, where its form is free; where none has a solution, with the form in which
/// the conditions hold with the smallest slack.
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
    let asked = (solvers.for_searches(), Form::VertexRelaxed);
    let mut session = Session::alone(asked, observer);
    let mut gain = |form| gain_in(form, model, gains, &mut session);
    let (mut form, smallest) = best_form(&mut gain, f64::NEG_INFINITY)?;
    if smallest.is_infinite() {
        let mut slack = |form| slack_in(form, model, gains, &mut session);
        form = best_form(&mut slack, 0.0)?.0;
    }
    Ok(model.with_form(form).unwrap_or_else(|| model.clone()))
}

/// The smallest gain that the solver reports with a form; infinite without one.
fn gain_in(
    form: GyroscopicForm,
    model: &Model,
    gains: &GainPlan,
    session: &mut Session,
) -> Result<f64, SynthesisError> {
    let Some((model, task)) = in_form(form, model, gains) else {
        return Ok(f64::INFINITY);
    };
    let request = DesignRequest::of_model(&model, "", &task, session.form);
    let mut synthesis = GainSynthesis::new(request, None, session);
    Ok(match synthesis.smallest(&FIRST_UNITS)? {
        Smallest::Bound { bound, .. } => bound,
        _ => f64::INFINITY,
    })
}
