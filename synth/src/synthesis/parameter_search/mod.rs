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
mod parameters;
mod plan;
mod progress;
mod sensitivities;
mod start;
mod undecided;

pub use finish::reached;

use ascent::{ascend, Effort};
use evaluator::{Aim, Evaluator, SearchPoint};
use finish::Finish;
use plan::{outside_every_box, Plan};
use progress::SearchProgress;
use undecided::no_design;

use crate::model::Model;
use crate::programs::{Form, Outcome, Session, SynthesisError};
use crate::scaling::Scaling;
use sdp::solve::{Backend, Observer, Structured};

/// Whether a model requests a search.
pub fn wanted(model: &Model) -> bool {
    Plan::wanted(model)
}

/// Relative increase of the objective in one round below which another round is not worth it.
const SMALL_INCREASE: f64 = 2e-3;

/// Scale at which the required sets count as contained, with an allowance for the next step.
const CONTAINED: f64 = 1.02;

/// Searches and makes the design. Only the check decides whether it is proved.
pub fn search(
    model: &Model,
    model_text: &str,
    form: Form,
    backend: &dyn Backend,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    let plan = Plan::of(model);
    let mut runs = Session::new(form, backend, observer.clone());
    if let Some(reason) = outside_every_box(model, &plan) {
        return Ok(no_design(reason, &runs));
    }
    let progress = SearchProgress::new(observer);
    // Two points at a time, each on one thread.
    let mut own = Structured::default();
    own.threads = 1;
    let system = model.task().system;
    let smallest = Scaling::automatic(&system, 1.0).state.min();
    let scaling = Scaling::automatic(&system, plan.unit / smallest);
    let whole = ParameterSearch {
        plan: &plan,
        scaling: &scaling,
        backend: &own,
        progress: &progress,
    };
    let points = match whole.best(model)? {
        SearchResult::Points(points) => points,
        SearchResult::Nothing(reason) => return Ok(no_design(reason, &runs)),
    };
    let evaluator = whole.evaluator(&plan.aim, &plan.contained);
    let finish = Finish {
        model,
        model_text,
        form,
        plan: &plan,
        evaluator: &evaluator,
    };
    finish.outcome(&points, &mut runs)
}

/// The search from the first start to the optimum.
struct ParameterSearch<'a> {
    plan: &'a Plan,
    scaling: &'a Scaling,
    backend: &'a Structured,
    progress: &'a SearchProgress,
}

/// The result of a search.
enum SearchResult {
    /// The iterates, the optimum last.
    Points(Vec<SearchPoint>),
    /// The search found no design; the reason.
    Nothing(String),
}

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

    fn best(&self, model: &Model) -> Result<SearchResult, SynthesisError> {
        let evaluator = self.evaluator(&self.plan.aim, &self.plan.contained);
        let begun = match self.plan.contained.is_empty() {
            true => start::first(&evaluator)?,
            false => match self.covering(model)? {
                Ok(point) => start::again(&evaluator, &point)?,
                Err(reason) => return Ok(SearchResult::Nothing(reason)),
            },
        };
        let Some(begun) = begun else {
            return Ok(SearchResult::Nothing(self.no_start(model)?));
        };
        let mut iterates = vec![begun.clone()];
        // Every increase is reported, so that the last iterate is the optimum.
        self.ascend(&evaluator, begun, f64::INFINITY, &mut |point| {
            iterates.push(point.clone());
        })?;
        Ok(SearchResult::Points(iterates))
    }

    /// A point at which all required sets are contained.
    fn covering(&self, model: &Model) -> Result<Result<SearchPoint, String>, SynthesisError> {
        let (gamma_max, gain_max) = match self.plan.aim {
            Aim::Reach {
                gamma_max,
                gain_max,
                ..
            } => (gamma_max, gain_max),
            Aim::Gain => (None, None),
        };
        let scaled = self.plan.contained.clone();
        let aim = Aim::Reach {
            scaled,
            gamma_max,
            gain_max,
        };
        let evaluator = self.evaluator(&aim, &[]);
        let Some(begun) = start::first(&evaluator)? else {
            return Ok(Err(self.no_start(model)?));
        };
        let end = self.ascend(&evaluator, begun, CONTAINED.ln(), &mut |_| {})?;
        if end.value.objective >= 0.0 {
            return Ok(Ok(end));
        }
        let mut reason = format!(
            "what must be covered could be covered up to the fraction {:.4} only",
            end.value.objective.exp()
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
        let effort = Effort {
            rounds: self.plan.limits.rounds as usize,
            increase: SMALL_INCREASE,
        };
        let mut last = begun.value.objective;
        ascend(evaluator, begun, effort, &mut |point| {
            let objective = point.value.objective;
            let value = match evaluator.aim {
                Aim::Reach { .. } => objective.exp(),
                Aim::Gain => (-objective).exp(),
            };
            self.progress.reached(value, objective - last);
            last = objective;
            passed(point);
            objective < enough
        })
    }

    /// Why no start has a solution.
    fn no_start(&self, model: &Model) -> Result<String, SynthesisError> {
        let bounds = match self.plan.aim {
            Aim::Reach {
                gamma_max,
                gain_max,
                ..
            } => gamma_max.or(gain_max),
            Aim::Gain => None,
        };
        let none = "the search found no design at any of its starts, whatever set is asked for; `feasibility` says more";
        let Some(bound) = bounds else {
            return Ok(none.to_string());
        };
        let plan = &self.plan.without_bounds(model);
        let free = ParameterSearch { plan, ..*self };
        let evaluator = free.evaluator(&Aim::Gain, &[]);
        let Some(begun) = start::first(&evaluator)? else {
            return Ok(none.to_string());
        };
        let end = free.ascend(&evaluator, begun, f64::INFINITY, &mut |_| {})?;
        let gain = (-end.value.objective).exp();
        Ok(format!(
            "no design meets the bound {bound} on the gain; the smallest guaranteed gain found, whatever its set, is {gain:.5}"
        ))
    }
}
