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
mod natural;
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
use natural::NaturalModel;
use plan::{outside_every_box, Plan};
use progress::SearchProgress;

use crate::claim::Claim;
use crate::design::SolverRun;
use crate::model::Model;
use crate::programs::{
    is_structured, Decision, LimitingFactors, Outcome, Session, Solvers, SynthesisError,
};
use crate::scaling::Scaling;
use sdp::solve::{Backend, Observer, Structured};

/// Shares of the largest xi that are tried at the start of a search for the smallest gain.
const WEIGHT_SHARES: [f64; 4] = [1.0, 1e-1, 1e-2, 1e-3];

/// Scale at which the required sets count as contained, with an allowance for the next step.
const CONTAINED: f64 = 1.02;

/// Searches once, and makes the design with the first solver; with the second one too where that proves nothing: the
/// better of the two outcomes is returned, with the runs of both. Only the check decides whether the design is proved.
///
/// A spacecraft is searched again in natural units, where that applies and the first search went wrong, and the better
/// design is kept.
pub fn synthesize(
    model: &Model,
    model_text: &str,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    let plan = Plan::of(model);
    let natural = NaturalModel::of(model, &plan);
    let own = in_units_of_model((model, model_text), plan, solvers, observer.clone())?;
    let Some(natural) = natural.filter(|natural| natural.is_worth_trying(&own)) else {
        return Ok(own);
    };
    let plan = Plan::of(&natural.model);
    let other = in_units_of_model((&natural.model, model_text), plan, solvers, observer)?;
    Ok(match natural.restated(other) {
        Some(other) if is_better(&other, &own) => other.after(&own),
        Some(other) => own.after(&other),
        None => own,
    })
}

/// Whether a proved design has a smaller guaranteed gain than another outcome, or the other is none.
fn is_better(design: &Outcome, other: &Outcome) -> bool {
    let gain = |outcome: &Outcome| match outcome {
        Outcome::Solved(design) if design.is_proved() => design.file.certificate.guaranteed_gain,
        _ => f64::INFINITY,
    };
    gain(design) < gain(other)
}

/// The search in the units of a model.
fn in_units_of_model(
    (model, model_text): (&Model, &str),
    plan: Plan,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Outcome, SynthesisError> {
    let progress = SearchProgress::new(observer.clone());
    // Two points at a time, each on one thread.
    let mut own = Structured::default();
    own.threads = 1;
    let given = solvers.for_searches();
    let backend: &(dyn Backend + Sync) = match is_structured(given) {
        true => &own,
        false => given,
    };
    let searched = |scaling: &Scaling, observer: Option<Observer>| {
        let evaluator = Evaluator {
            space: &plan.space,
            aim: &plan.aim,
            contained: &plan.contained,
            scaling,
            backend,
            progress: &progress,
        };
        let session = Session::new(solvers, observer);
        in_units((model, model_text), &plan, &evaluator, session)
    };
    if let Some(reason) = outside_every_box(model, &plan) {
        return Ok(without_design(reason, &[]));
    }
    let system = model.task().system;
    let one_unit = searched(&Scaling::of_size(&system, plan.unit), observer.clone())?;
    if one_unit.is_proved() || plan.unit_fraction.is_none() {
        return Ok(one_unit);
    }
    // Where one unit suits no start or leaves nothing proved, each state has its own.
    let fraction = plan.unit_fraction.unwrap_or(1.0);
    let own_units = searched(&Scaling::automatic(&system, fraction), observer)?;
    Ok(match own_units.rank() > one_unit.rank() {
        true => own_units.after(&one_unit),
        false => one_unit.after(&own_units),
    })
}

/// The record of a search without a design.
fn without_design(reason: String, runs: &[SolverRun]) -> Outcome {
    let factors = LimitingFactors::unknown(reason);
    Outcome::Undecided(Decision::of_search(factors, Vec::new(), runs))
}

/// The search in the evaluator's units and the design at its optimum.
fn in_units(
    (model, model_text): (&Model, &str),
    plan: &Plan,
    evaluator: &Evaluator<'_>,
    mut session: Session,
) -> Result<Outcome, SynthesisError> {
    let own = evaluator.backend.solver();
    let asked = session.solvers().iter();
    let others = asked.filter(|(backend, _)| backend.solver() != own);
    let search = ParameterSearch {
        plan,
        evaluator: *evaluator,
        others: others
            .map(|&(backend, _)| backend as &(dyn Backend + Sync))
            .collect(),
    };
    let points = match search.best(model)? {
        Ok(points) => points,
        Err(reason) => return Ok(without_design(reason, &[])),
    };
    let finish = Finish {
        model,
        model_text,
        plan,
        evaluator,
    };
    let progress = evaluator.progress;
    let solved = progress.count();
    let first = finish.outcome(&points, &mut session)?;
    if first.is_proved() {
        return Ok(first);
    }
    // Each design records the programs that led to it.
    progress.restart(solved);
    let second = session.with_other(|session| finish.outcome(&points, session))?;
    Ok(match second {
        Some(second) if second.rank() > first.rank() => second.after(&first),
        Some(second) => first.after(&second),
        None => first,
    })
}

/// The search from the first start to the optimum.
struct ParameterSearch<'a> {
    plan: &'a Plan,
    /// For the aim of the plan.
    evaluator: Evaluator<'a>,
    /// Solvers that are asked where the evaluator's finds no start.
    others: Vec<&'a (dyn Backend + Sync)>,
}

/// What a search found, or why it found nothing.
type Found<T> = Result<Result<T, String>, SynthesisError>;

impl ParameterSearch<'_> {
    /// The iterates, the optimum last.
    fn best(&self, model: &Model) -> Found<Vec<SearchPoint>> {
        let evaluator = &self.evaluator;
        let begun = match self.plan.contained.is_empty() {
            true => start::first(evaluator)?,
            false => match self.covering(model)? {
                Ok(points) => self.first_solved(&points)?,
                Err(reason) => return Ok(Err(reason)),
            },
        };
        let Some(begun) = begun else {
            return Ok(Err(self.no_start(model)?));
        };
        let mut iterates = vec![begun.clone()];
        // Every increase is reported, so that the last iterate is the optimum.
        self.ascend(evaluator, begun, f64::INFINITY, &mut |point| {
            iterates.push(point.clone());
        })?;
        Ok(Ok(iterates))
    }

    /// The solution at the first of some points that has one, with the largest xi there or a smaller one: with a large
    /// xi the smallest g asks for a small set and large gains.
    fn first_solved(&self, points: &[SearchPoint]) -> Result<Option<SearchPoint>, SynthesisError> {
        let others = self.others.iter().map(|&backend| Evaluator {
            backend,
            ..self.evaluator
        });
        for evaluator in std::iter::once(self.evaluator).chain(others) {
            for share in WEIGHT_SHARES {
                for point in points {
                    let space = &self.plan.space;
                    let smaller = |coordinate: f64| coordinate + share.ln();
                    let coordinates = space.with_weight(&point.coordinates, smaller);
                    let solved = evaluator.solve(&coordinates, &point.linearisation)?;
                    if solved.is_some() {
                        return Ok(solved);
                    }
                }
            }
        }
        Ok(None)
    }

    /// Points at which all required sets are contained, the last one first.
    fn covering(&self, model: &Model) -> Found<Vec<SearchPoint>> {
        let aim = Aim::Reach {
            scaled: self.plan.contained.clone(),
            bounds: self.plan.aim.bounds(),
        };
        let evaluator = Evaluator {
            aim: &aim,
            contained: &[],
            ..self.evaluator
        };
        let Some(begun) = start::first(&evaluator)? else {
            return Ok(Err(self.no_start(model)?));
        };
        let mut passed = vec![begun.clone()];
        let end = self.ascend(&evaluator, begun, CONTAINED.ln(), &mut |point| {
            passed.push(point.clone());
        })?;
        if end.objective >= 0.0 {
            passed.retain(|point| point.objective >= 0.0);
            passed.reverse();
            return Ok(Ok(passed));
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
            evaluator.progress.reached(value, objective - last);
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
        let evaluator = Evaluator {
            space: &plan.space,
            aim: &Aim::Gain,
            contained: &[],
            ..self.evaluator
        };
        let free = ParameterSearch {
            plan,
            evaluator,
            others: Vec::new(),
        };
        let Some(begun) = start::first(&evaluator)? else {
            return Ok(none.to_string());
        };
        let end = free.ascend(&evaluator, begun, f64::INFINITY, &mut |_| {})?;
        let gain = Claim::AtMost(Aim::Gain.value(end.objective));
        Ok(format!(
            "no design meets the bound {bound} on the gain; the smallest guaranteed gain found, whatever its set, is {gain}"
        ))
    }
}
