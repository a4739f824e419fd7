//! Searches over what the certificate depends on: the box, the multiplier's weights, xi and, where the
//! engineer leaves room, decay rate and threshold.
//!
//! At every point a semidefinite program is solved, whose multipliers say how its optimum changes with all
//! parameters at once; a quasi-Newton method follows them uphill. Containment is linearised about the last
//! point, which loses nothing there, so that no weight rho has to be chosen. What the search finds is a
//! candidate: the design is made by the solver of choice at the point found, and only the check proves it.

mod climb;
mod denial;
mod finish;
mod inner;
mod parameters;
mod plan;
mod progress;
mod shortfall;
mod start;

pub use finish::reached;

use climb::{climb, Effort};
use denial::denied;
use finish::Finish;
use inner::{Aim, Inner, SearchPoint};
use plan::{outside_every_box, Plan};
use progress::SearchProgress;

use crate::model::Model;
use crate::programs::{Form, Outcome, Session, SynthesisError};
use crate::scaling::Scaling;
use sdp::solve::{Backend, Observer, Structured};

/// Whether a model asks for a search.
pub fn wanted(model: &Model) -> bool {
    Plan::wanted(model)
}

/// A rise of the height per round, relative, that is not worth another one.
const SMALL_RISE: f64 = 2e-3;

/// Scale at which sets that must be covered are, with room for the next step.
const COVERED: f64 = 1.02;

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
        return Ok(denied(reason, &runs));
    }
    let watch = SearchProgress::new(observer);
    // Two points at a time, each on one thread.
    let mut own = Structured::default();
    own.threads = 1;
    let system = model.task().system;
    let smallest = Scaling::automatic(&system, 1.0).state.min();
    let scaling = Scaling::automatic(&system, plan.unit / smallest);
    let whole = Whole {
        plan: &plan,
        scaling: &scaling,
        backend: &own,
        watch: &watch,
    };
    let points = match whole.best(model)? {
        SearchResult::Points(points) => points,
        SearchResult::Nothing(reason) => return Ok(denied(reason, &runs)),
    };
    let inner = whole.inner(&plan.aim, &plan.covered);
    let finish = Finish {
        model,
        model_text,
        form,
        plan: &plan,
        inner: &inner,
    };
    finish.outcome(&points, &mut runs)
}

/// The search from the first start to the summit.
struct Whole<'a> {
    plan: &'a Plan,
    scaling: &'a Scaling,
    backend: &'a Structured,
    watch: &'a SearchProgress,
}

/// What a search came to.
enum SearchResult {
    /// The points passed on the way, the summit last.
    Points(Vec<SearchPoint>),
    /// There is no design, as far as the search can tell.
    Nothing(String),
}

impl<'a> Whole<'a> {
    fn inner(&self, aim: &'a Aim, covered: &'a [nalgebra::DMatrix<f64>]) -> Inner<'a> {
        Inner {
            space: &self.plan.space,
            aim,
            covered,
            scaling: self.scaling,
            backend: self.backend,
            watch: self.watch,
        }
    }

    fn best(&self, model: &Model) -> Result<SearchResult, SynthesisError> {
        let inner = self.inner(&self.plan.aim, &self.plan.covered);
        let begun = match self.plan.covered.is_empty() {
            true => start::first(&inner)?,
            false => match self.covering(model)? {
                Ok(point) => start::again(&inner, &point)?,
                Err(reason) => return Ok(SearchResult::Nothing(reason)),
            },
        };
        let Some(begun) = begun else {
            return Ok(SearchResult::Nothing(self.no_start(model)?));
        };
        let mut trail = vec![begun.clone()];
        // Every rise is told, so that the last point of the trail is the summit.
        self.climb(&inner, begun, f64::INFINITY, &mut |point| {
            trail.push(point.clone());
        })?;
        Ok(SearchResult::Points(trail))
    }

    /// A point at which all that must be covered is covered.
    fn covering(&self, model: &Model) -> Result<Result<SearchPoint, String>, SynthesisError> {
        let (gamma_max, gain_max) = match self.plan.aim {
            Aim::Reach {
                gamma_max,
                gain_max,
                ..
            } => (gamma_max, gain_max),
            Aim::Gain => (None, None),
        };
        let grown = self.plan.covered.clone();
        let aim = Aim::Reach {
            grown,
            gamma_max,
            gain_max,
        };
        let inner = self.inner(&aim, &[]);
        let Some(begun) = start::first(&inner)? else {
            return Ok(Err(self.no_start(model)?));
        };
        let end = self.climb(&inner, begun, COVERED.ln(), &mut |_| {})?;
        if end.value.height >= 0.0 {
            return Ok(Ok(end));
        }
        let mut reason = format!(
            "what must be covered could be covered up to the fraction {:.4} only",
            end.value.height.exp()
        );
        if let Some(limit) = shortfall::sensitivities(&inner, &end)?.first() {
            let (what, value, per_cent) = (&limit.what, limit.value, limit.per_cent);
            reason += &format!("; most depends on: {what}, now {value:.4}: 1 % more changes the fraction by {per_cent:+.2} %");
        }
        Ok(Err(reason))
    }

    /// Climbs until it is high enough; `passed` is told of every rise.
    fn climb(
        &self,
        inner: &Inner<'_>,
        begun: SearchPoint,
        enough: f64,
        passed: &mut dyn FnMut(&SearchPoint),
    ) -> Result<SearchPoint, SynthesisError> {
        let effort = Effort {
            rounds: self.plan.limits.rounds as usize,
            rise: SMALL_RISE,
        };
        let mut last = begun.value.height;
        climb(inner, begun, effort, &mut |point| {
            let height = point.value.height;
            let value = match inner.aim {
                Aim::Reach { .. } => height.exp(),
                Aim::Gain => (-height).exp(),
            };
            self.watch.reached(value, height - last);
            last = height;
            passed(point);
            height < enough
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
        let free = Whole { plan, ..*self };
        let inner = free.inner(&Aim::Gain, &[]);
        let Some(begun) = start::first(&inner)? else {
            return Ok(none.to_string());
        };
        let end = free.climb(&inner, begun, f64::INFINITY, &mut |_| {})?;
        let gain = (-end.value.height).exp();
        Ok(format!(
            "no design meets the bound {bound} on the gain; the smallest guaranteed gain found, whatever its set, is {gain:.5}"
        ))
    }
}
