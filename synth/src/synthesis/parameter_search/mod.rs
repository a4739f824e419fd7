//! Searches over what the certificate depends on: the box, the multiplier's weights, xi and, where the
//! engineer gives a range, decay rate and threshold.
//!
//! At every point a semidefinite program is solved, whose dual solution gives the gradient of its optimum with respect
//! to all parameters at once; a quasi-Newton method maximises with it. Containment is linearised about the last
//! point, where that is exact, so that no weight rho has to be chosen. The result of the search is a candidate: the
//! design is made by the chosen solver at the optimum, and only the check proves it.

mod ascent;
mod evaluator;
mod finish;
mod plan;
mod progress;
mod sensitivities;
mod space;
mod start;

pub use finish::reached;
pub use plan::wanted;

use ascent::ascend;
use evaluator::{Aim, Evaluator, SearchPoint};
use finish::Finish;
use plan::{outside_every_box, Plan};
use progress::SearchProgress;

use crate::model::Model;
use crate::programs::{Decision, Form, LimitingFactors, Outcome, Session, SynthesisError};
use crate::scaling::Scaling;
use sdp::solve::{alternative, Backend, Observer, Structured};

/// Scale at which the required sets count as contained, with an allowance for the next step.
const CONTAINED: f64 = 1.02;

/// Searches and makes the design, with the other solver too where the given one proves nothing: the better of the two
/// outcomes is returned, with the runs of both. Only the check decides whether the design is proved.
pub fn synthesize(
    model: &Model,
    model_text: &str,
    form: Form,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    let search = |form: Form, backend: &dyn Backend| {
        let mut session = Session::new(form, backend, observer.clone());
        search(model, model_text, &mut session, observer.clone())
    };
    let first = search(form, backend)?;
    let other = alternative(backend);
    let Some(other) = other.as_deref().filter(|_| !first.is_proved()) else {
        return Ok(first);
    };
    let second = search(form.for_backend(other), other)?;
    Ok(match second.rank() > first.rank() {
        true => second.after(&first),
        false => first.after(&second),
    })
}

/// Searches, and makes the design with one solver.
fn search(
    model: &Model,
    model_text: &str,
    session: &mut Session,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    let plan = Plan::of(model);
    let progress = SearchProgress::new(observer);
    // Two points at a time, each on one thread.
    let mut own = Structured::default();
    own.threads = 1;
    let system = model.task().system;
    let smallest = Scaling::automatic(&system, 1.0).state.min();
    let whole = ParameterSearch {
        plan: &plan,
        scaling: &Scaling::automatic(&system, plan.unit / smallest),
        backend: &own,
        progress: &progress,
    };
    let points = match outside_every_box(model, &plan) {
        Some(reason) => Err(reason),
        None => whole.best(model)?,
    };
    let points = match points {
        Ok(points) => points,
        Err(reason) => {
            let limiting_factors = LimitingFactors::unknown(reason);
            let decision = Decision::of_search(limiting_factors, Vec::new(), &session.runs);
            return Ok(Outcome::Undecided(decision));
        }
    };
    let finish = Finish {
        model,
        model_text,
        plan: &plan,
        evaluator: &whole.evaluator(&plan.aim, &plan.contained),
    };
    finish.outcome(&points, session)
}

/// The search from the first start to the optimum.
struct ParameterSearch<'a> {
    plan: &'a Plan,
    scaling: &'a Scaling,
    backend: &'a Structured,
    progress: &'a SearchProgress,
}

/// What a search found, or why it found nothing.
type Found<T> = Result<Result<T, String>, SynthesisError>;

impl<'a> ParameterSearch<'a> {
    fn evaluator(&self, aim: &'a Aim, contained: &'a [nalgebra::DMatrix<f64>]) -> Evaluator<'a> {
        Evaluator {
            space: &self.plan.space,
            aim,
            contained,
            scaling: self.scaling,
            backend: self.backend,
            progress: self.progress,
        }
    }

    /// The iterates, the optimum last.
    fn best(&self, model: &Model) -> Found<Vec<SearchPoint>> {
        let evaluator = self.evaluator(&self.plan.aim, &self.plan.contained);
        let begun = match self.plan.contained.is_empty() {
            true => start::first(&evaluator)?,
            false => match self.covering(model)? {
                Ok(point) => evaluator.solve(&point.coordinates, &point.linearisation)?,
                Err(reason) => return Ok(Err(reason)),
            },
        };
        let Some(begun) = begun else {
            return Ok(Err(self.no_start(model)?));
        };
        let mut iterates = vec![begun.clone()];
        // Every increase is reported, so that the last iterate is the optimum.
        self.ascend(&evaluator, begun, f64::INFINITY, &mut |point| {
            iterates.push(point.clone());
        })?;
        Ok(Ok(iterates))
    }

    /// A point at which all required sets are contained.
    fn covering(&self, model: &Model) -> Found<SearchPoint> {
        let aim = Aim::Reach {
            scaled: self.plan.contained.clone(),
            bounds: self.plan.aim.bounds(),
        };
        let evaluator = self.evaluator(&aim, &[]);
        let Some(begun) = start::first(&evaluator)? else {
            return Ok(Err(self.no_start(model)?));
        };
        let end = self.ascend(&evaluator, begun, CONTAINED.ln(), &mut |_| {})?;
        if end.objective >= 0.0 {
            return Ok(Ok(end));
        }
        let mut reason = format!(
            "what must be covered could be covered up to the fraction {:.4} only",
            end.objective.exp()
        );
        if let Some(limit) = sensitivities::sensitivities(&evaluator, &end)?.first() {
            let (what, value, per_cent) = (&limit.what, limit.value, limit.per_cent);
            reason += &format!("; most depends on: {what}, now {value:.4}: 1 % more changes the fraction by {per_cent:+.2} %");
        }
        Ok(Err(reason))
    }

    /// Maximises until the objective reaches `enough`; `passed` is called with every improved point.
    fn ascend(
        &self,
        evaluator: &Evaluator<'_>,
        begun: SearchPoint,
        enough: f64,
        passed: &mut dyn FnMut(&SearchPoint),
    ) -> Result<SearchPoint, SynthesisError> {
        let rounds = self.plan.limits.rounds as usize;
        let mut last = begun.objective;
        ascend(evaluator, begun, rounds, &mut |point| {
            let objective = point.objective;
            let value = evaluator.aim.value(objective);
            self.progress.reached(value, objective - last);
            last = objective;
            passed(point);
            objective < enough
        })
    }

    /// Why no start has a solution.
    fn no_start(&self, model: &Model) -> Result<String, SynthesisError> {
        let bounds = self.plan.aim.bounds();
        let none = "the search found no design at any of its starts, whatever set is asked for; `feasibility` says more";
        let Some(bound) = bounds.gamma.or(bounds.gain) else {
            return Ok(none.to_string());
        };
        let plan = &self.plan.without_bounds(model);
        let free = ParameterSearch { plan, ..*self };
        let evaluator = free.evaluator(&Aim::Gain, &[]);
        let Some(begun) = start::first(&evaluator)? else {
            return Ok(none.to_string());
        };
        let end = free.ascend(&evaluator, begun, f64::INFINITY, &mut |_| {})?;
        let gain = Aim::Gain.value(end.objective);
        Ok(format!(
            "no design meets the bound {bound} on the gain; the smallest guaranteed gain found, whatever its set, is {gain:.5}"
        ))
    }
}
