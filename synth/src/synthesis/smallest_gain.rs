//! Attempts at the smallest gain bound in one system of units after the other, with one solver.

use nalgebra::DMatrix;

use super::attempts::{Attempt, Attempts, Synthesis};
use super::gain::{best_objective, GainSynthesis, UnitAttempts, BACK_OFFS};
use super::weight_search;
use crate::conditions::GainPlan;
use crate::design::ProblemUnits;
use crate::optimality::Optimality;
use crate::programs::{
    containment_weights, scaled, DesignRequest, Session, SynthesisError, STATE_UNITS,
};

/// Larger back-offs, tried in this order where no design is proved with the first: the solver's smallest bound may be
/// inaccurate, or leave no margin for a proof.
const WIDER_BACK_OFFS: [f64; 3] = [3e-2, 1e-1, 1.0];

/// Units in which the larger back-offs are tried, the last ones that gave a bound.
const WIDENED_UNITS: usize = 2;

/// How far below a bound that a solver was not sure of a design is tried first, relative; at most at once; how often; and in
/// how many units.
const FIRST_STEP: f64 = 0.01;
const LARGEST_STEP: f64 = 0.5;
const MOST_STEPS: u32 = 24;
const DESCENTS: u32 = 4;

/// Up to this many vertices an attempt takes so little time that other units may be tried for one bound after the other.
const CHEAP_VERTICES: usize = 2;

/// How far below a bound that is asked for the design is made, relative, so that its claims meet it.
const CLAIM_ROOM: f64 = 1e-5;

/// How often the containment condition is stated about the last design.
const LINEARISATIONS: usize = 8;

/// How often the point of a solver may suggest units.
const RESCALINGS: usize = 4;

/// An improvement of the best design by less than this, relative, ends the attempts.
const IMPROVEMENT: f64 = 1e-2;

impl GainSynthesis<'_, '_, '_> {
    /// Tries units under every containment weight; then larger back-offs, where nothing is proved.
    pub fn in_all_settings(&mut self) -> Result<UnitAttempts, SynthesisError> {
        let objective = self.request.model.file.specs.objective;
        let mut found = Attempts::default();
        for &containment_weight in containment_weights(self.request.task) {
            let first = self.units_of_constant_gain(containment_weight)?;
            self.try_units(containment_weight, first, &mut found)?;
            // The condition on the starts will be stated about the design, where no weight has to suit.
            if objective.is_guaranteed_gain() && found.best.is_some() {
                break;
            }
        }
        if found.best.is_none() {
            let widened = found.bounds.iter().rev().take(WIDENED_UNITS);
            let widened: Vec<_> = widened.cloned().collect();
            found.back_off(self, &widened, &WIDER_BACK_OFFS)?;
        }
        self.descend(&mut found)?;
        let enough = self
            .asked
            .is_some_and(|asked| best_objective(&found) <= asked);
        if objective.is_guaranteed_gain() && !enough {
            weight_search::improve(self.request, self.session, &mut found)?;
        }
        if let Some(asked) = self.asked {
            self.meet(asked, &mut found)?;
        }
        Ok(found)
    }

    /// Designs at smaller bounds than the solver's smallest, where it stopped before it was sure of that: a design well
    /// inside the conditions is an easier problem than the smallest bound.
    fn descend(&mut self, found: &mut UnitAttempts) -> Result<(), SynthesisError> {
        let Some(best) = found.best.as_ref().filter(|_| !self.accurate) else {
            return Ok(());
        };
        let units = &best.file.provenance.problem;
        let own = found.bounds.iter().filter(|(other, _)| other == units);
        let mut bound = own.fold(f64::INFINITY, |least, (_, bound)| least.min(*bound));
        for _ in 0..DESCENTS {
            let lower = bound * (1.0 - FIRST_STEP);
            // The first says whether the smallest bound is one.
            if bound.is_infinite()
                || !self.proves_at(lower, found)? && !self.proves_in_any_units(lower, found)?
            {
                break;
            }
            bound = self.lowest_from(lower, found)?;
        }
        Ok(())
    }

    /// The smallest bound below one at which a better design is proved, in the units of the best.
    fn lowest_from(&mut self, bound: f64, found: &mut UnitAttempts) -> Result<f64, SynthesisError> {
        let (mut bound, mut step) = (bound, LARGEST_STEP);
        for _ in 0..MOST_STEPS {
            if step < IMPROVEMENT {
                break;
            }
            match self.proves_at(bound * (1.0 - step), found)? {
                true => bound *= 1.0 - step,
                false => step *= 0.5,
            }
        }
        Ok(bound)
    }

    /// The same as [`Self::proves_at`] in one system of units after the other, where an attempt is cheap.
    fn proves_in_any_units(
        &mut self,
        bound: f64,
        found: &mut UnitAttempts,
    ) -> Result<bool, SynthesisError> {
        if self.request.task.system.vertices.len() > CHEAP_VERTICES {
            return Ok(false);
        }
        let before = best_objective(found);
        self.try_bound(bound, found)?;
        let better = best_objective(found) < before;
        if better {
            found.best_seen = found.best_seen.min(bound);
        }
        Ok(better)
    }

    /// Whether a better design is proved at a bound, in the units of the best; it is then kept.
    fn proves_at(&mut self, bound: f64, found: &mut UnitAttempts) -> Result<bool, SynthesisError> {
        let Some(best) = &found.best else {
            return Ok(false);
        };
        let units = best.file.provenance.problem.clone();
        let before = best_objective(found);
        let attempt = found.back_off(self, &[(units, bound)], &[0.0])?;
        let better = attempt == Attempt::Proved && best_objective(found) < before;
        if better {
            found.best_seen = found.best_seen.min(bound);
        }
        Ok(better)
    }

    /// Designs whose containment condition is stated about a point, then about the last design's, as long as the gain
    /// falls: no weight rho has to suit the set.
    pub fn about_points(
        request: DesignRequest,
        first: DMatrix<f64>,
        session: &mut Session,
    ) -> Result<UnitAttempts, SynthesisError> {
        let mut found = UnitAttempts::default();
        let mut next = Some(first);
        for _ in 0..LINEARISATIONS {
            let Some(linearisation) = next.take() else {
                break;
            };
            let task = request.task.containing_about(linearisation);
            let asked = request.model.file.specs.gamma;
            let request = DesignRequest {
                task: &task,
                form: session.form,
                ..request
            };
            let mut synthesis = GainSynthesis::new(request, asked, session);
            let before = best_objective(&found);
            let mut about = synthesis.in_all_settings()?;
            next = synthesis.linearisation;
            found.keep::<GainSynthesis>(about.best.take());
            found.best_seen = found.best_seen.min(about.best_seen);
            if before <= (1.0 + IMPROVEMENT) * best_objective(&found) {
                break;
            }
        }
        Ok(found)
    }

    /// Puts a design at a gain that is asked for in the place of the best, where it can be had: with more margin than the
    /// smallest; or where no smallest was found, because it is 0 or never attained.
    fn meet(&mut self, asked: f64, found: &mut UnitAttempts) -> Result<(), SynthesisError> {
        let best = found.best.take();
        match &best {
            Some(design) if GainSynthesis::objective(&design.file) <= asked => {
                let units = design.file.provenance.problem.clone();
                found.back_off(self, &[(units, asked)], &[-CLAIM_ROOM])?;
            }
            _ => self.try_bound(asked, found)?,
        }
        found.best = found.best.take().or(best);
        Ok(())
    }

    /// A design at a given bound, without a solve for the smallest.
    fn try_bound(&mut self, asked: f64, found: &mut UnitAttempts) -> Result<(), SynthesisError> {
        for &containment_weight in containment_weights(self.request.task) {
            for &state_fraction in &STATE_UNITS {
                let mut units = ProblemUnits::of_fraction(state_fraction, containment_weight);
                for _ in 0..=RESCALINGS {
                    let attempt =
                        found.back_off(self, &[(units.clone(), asked)], &[-CLAIM_ROOM])?;
                    if attempt == Attempt::Proved {
                        return Ok(());
                    }
                    let Some(state_units) = self.suggested.take() else {
                        break;
                    };
                    if units.state_units == state_units {
                        break;
                    }
                    units.state_units = state_units;
                }
            }
        }
        Ok(())
    }

    /// For scheduled gains: the units in which a constant gain is proved, a smaller problem that
    /// shows how large the certified set will be.
    fn units_of_constant_gain(
        &mut self,
        weight: f64,
    ) -> Result<Option<ProblemUnits>, SynthesisError> {
        if self.request.task.gains.count == 1 || self.request.task.gains.given.is_some() {
            return Ok(None);
        }
        let mut task = self.request.task.clone();
        task.gains = GainPlan::constant();
        let mut session = self.session.fresh(self.request.form);
        let request = DesignRequest {
            task: &task,
            ..self.request
        };
        let mut constant = GainSynthesis::new(request, None, &mut session);
        let mut found = Attempts::default();
        let outcome = constant.try_units(weight, None, &mut found);
        self.session.runs.append(&mut session.runs);
        outcome?;
        Ok(found.best.map(|design| design.file.provenance.problem))
    }

    /// Tries units one after the other until a design is proved that is about as good as a solver says. The point of
    /// a solver suggests the next units.
    fn try_units(
        &mut self,
        containment_weight: f64,
        first: Option<ProblemUnits>,
        found: &mut UnitAttempts,
    ) -> Result<(), SynthesisError> {
        let usual = STATE_UNITS.iter().rev();
        let usual = usual.map(|&fraction| ProblemUnits::of_fraction(fraction, containment_weight));
        let mut next: Vec<ProblemUnits> = usual.chain(first).collect();
        let (mut tried, mut rescalings) = (Vec::new(), 0);
        while let Some(units) = next.pop() {
            let (scaling, _) = scaled(self.request.task, &units);
            if tried.contains(&scaling.state) {
                continue;
            }
            tried.push(scaling.state);
            let before = best_objective(found);
            let attempt = found.attempt(self, &units, &BACK_OFFS)?;
            let settled = before <= (1.0 + IMPROVEMENT) * best_objective(found);
            match attempt {
                Attempt::Proved if !is_poor(found) && (self.accurate || settled) => return Ok(()),
                // Confirmed once in other units, then given up.
                Attempt::Infeasible if found.infeasible > 1 => return Ok(()),
                _ => {}
            }
            if let Some(state_units) = self.suggested.take().filter(|_| rescalings < RESCALINGS) {
                rescalings += 1;
                next.push(ProblemUnits {
                    state_units,
                    ..units
                });
            }
        }
        Ok(())
    }
}

/// Whether there is a design that is about as good as a solver says.
pub(super) fn is_enough(found: &UnitAttempts) -> bool {
    found.best.is_some() && !is_poor(found)
}

/// Whether the best design is much worse than the smallest bound that a solver reported, which is reason enough to go on
/// even where its point violates the conditions.
fn is_poor(found: &UnitAttempts) -> bool {
    let optimality = Optimality::of_smallest(best_objective(found), found.smallest_bound());
    optimality.is_some_and(|optimality| optimality.is_poor())
}
