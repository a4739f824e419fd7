//! The attempts at a feedback, in order: an equation where there is one, then each solver in units that follow its
//! solutions, then objectives between the best one reported and the best one proved.

use std::time::Instant;

use super::request::{ProblemSynthesized, Request, BACK_OFFS, BELOW_WANTED};
use super::scaled::{near, sizes_of};
use crate::conditions::state_feedback::{DesignProblem, StateFeedback};
use crate::conditions::units::Sizes;
use crate::design::SolverRun;
use crate::programs::{Session, SynthesisError, GENERATOR};

/// A design within this of the best objective seen, relative, needs no further attempt.
const CLOSE: f64 = 1.5e-3;

/// Rounds in which the units follow the solution.
const ROUNDS: usize = 5;

/// Objectives tried between the best one reported and the best one proved.
const BISECTIONS: usize = 12;

/// Objectives this close, relative, are equally good.
const EQUAL: f64 = 7e-4;

/// What has been found so far. Objectives are in the file's units.
pub(super) struct Search<'a, P> {
    pub(super) request: &'a Request<'a, P>,
    /// The best proved design.
    pub(super) best: Option<Box<ProblemSynthesized>>,
    /// The last design that is not proved.
    pub(super) unproved: Option<Box<ProblemSynthesized>>,
    /// The best objective of a point that satisfies the conditions but for rounding.
    pub(super) seen: Option<f64>,
    /// The largest scalar unknown that a solver returned, at least 1.
    pub(super) largest: f64,
    /// How often a solver called the problem infeasible.
    pub(super) infeasible: u32,
    /// Every attempt, in order.
    pub(super) runs: Vec<SolverRun>,
}

impl<'a, P: DesignProblem> Search<'a, P> {
    pub(super) fn new(request: &'a Request<'a, P>) -> Self {
        Search {
            request,
            best: None,
            unproved: None,
            seen: None,
            largest: 1.0,
            infeasible: 0,
            runs: Vec::new(),
        }
    }

    pub(super) fn best_objective(&self) -> Option<f64> {
        let best = self.best.as_ref()?;
        Some(P::objective_of(best.file.certificate.guarantee))
    }

    /// True where the best design is within a relative distance of the best objective seen, or meets what is wanted.
    fn within(&self, distance: f64) -> bool {
        let Some(best) = self.best_objective() else {
            return false;
        };
        if self.request.requested.wanted().exactly.is_some() {
            return true;
        }
        self.seen
            .is_some_and(|seen| best <= seen * (1.0 + distance))
    }

    pub(super) fn saw(&mut self, objective: f64) {
        let least = self.request.floor.map_or(0.0, |floor| floor.objective);
        let objective = objective.max(least);
        if objective > 0.0 && objective.is_finite() {
            self.seen = Some(self.seen.map_or(objective, |seen| seen.min(objective)));
        }
    }

    /// Nothing better than the end of the search is claimed: what lies beyond depends on chance.
    pub(super) fn claimed(&self, found: &StateFeedback) -> StateFeedback {
        let least = self.request.floor.map_or(0.0, |floor| floor.objective);
        let mut found = found.clone();
        if P::objective_of(found.guarantee) < least {
            found.guarantee = P::guarantee_of(least);
        }
        found
    }

    /// Checks a candidate and keeps it where it is the best; true where it is proved.
    pub(super) fn consider(&mut self, found: &StateFeedback) -> bool {
        let found = &self.claimed(found);
        let Some(design) = self.request.design(found) else {
            return false;
        };
        if !design.is_proved() {
            self.unproved = Some(design);
            return false;
        }
        let objective = P::objective_of(found.guarantee);
        if self.is_better(objective, &design) {
            self.best = Some(design);
        }
        true
    }

    /// True for a better objective, and for one as good with smaller gains.
    fn is_better(&self, objective: f64, design: &ProblemSynthesized) -> bool {
        let Some((best, known)) = self.best_objective().zip(self.best.as_ref()) else {
            return true;
        };
        let largest = |design: &ProblemSynthesized| {
            let gains = design.file.controller.gain.iter().flatten();
            gains.fold(0.0, |largest: f64, gain| largest.max(gain.abs()))
        };
        let (own, other) = (largest(design), largest(known));
        objective < best * (1.0 - EQUAL) || (objective < best * (1.0 + EQUAL) && own < other)
    }

    /// The equation that replaces a solver, where there is one.
    pub(super) fn directly(&mut self) {
        let start = Instant::now();
        let request = self.request;
        let wanted = request.requested.wanted();
        let Some(direct) = request.requested.direct(&request.problem.plant) else {
            return;
        };
        let targets: Vec<f64> = match wanted.exactly {
            Some(value) => vec![value * (1.0 - BELOW_WANTED)],
            None => {
                let Some(smallest) = direct.smallest() else {
                    return;
                };
                self.saw(smallest);
                let targets = BACK_OFFS.iter().map(|back_off| smallest * (1.0 + back_off));
                targets.collect()
            }
        };
        let mut tried = 0;
        let mut proved = false;
        'found: for target in targets {
            for candidate in direct.candidates(target) {
                tried += 1;
                proved = self.consider(&candidate);
                if proved {
                    break 'found;
                }
            }
        }
        let objective = match proved {
            true => self.best_objective(),
            false => self.seen,
        };
        self.runs.push(SolverRun {
            goal: match wanted.exactly {
                Some(_) => "wanted objective".to_string(),
                None => "smallest objective".to_string(),
            },
            vertices: 1,
            solver: format!("{} ({GENERATOR})", direct.name()),
            status: match proved {
                true => "solved".to_string(),
                false => "no candidate is proved".to_string(),
            },
            objective: objective.unwrap_or(0.0),
            iterations: tried,
            seconds: start.elapsed().as_secs_f64(),
            state_units: Vec::new(),
            margin: None,
        });
    }

    /// True where no further attempt is needed.
    pub(super) fn is_settled(&self) -> bool {
        self.within(CLOSE)
    }

    /// All attempts with one solver: in Q alone where the feedback can be eliminated, then in Q and Y, then in one unit
    /// for all states.
    pub(super) fn with_solver(&mut self, session: &mut Session) -> Result<(), SynthesisError> {
        let balanced = self.request.first_sizes();
        let uniform = Sizes {
            state: balanced.state.map(|_| 1.0),
            ..balanced.clone()
        };
        let eliminates = self.eliminates();
        let starts = [
            (&balanced, "balanced units", eliminates),
            (&balanced, "balanced units", false),
            (&uniform, "the file's units", eliminates),
            (&uniform, "the file's units", false),
        ];
        for (index, (sizes, label, eliminated)) in starts.into_iter().enumerate() {
            // Where nothing is eliminated the first of each two is the same as the second.
            if index % 2 == 0 && !eliminates {
                continue;
            }
            self.rounds(session, sizes.clone(), label, eliminated)?;
            if self.is_settled() {
                break;
            }
        }
        Ok(())
    }

    fn eliminates(&self) -> bool {
        P::ELIMINATES_GAIN && self.request.problem.plant.gain.is_none()
    }

    /// Attempts in units that follow the solution.
    fn rounds(
        &mut self,
        session: &mut Session,
        mut sizes: Sizes,
        mut label: &'static str,
        eliminated: bool,
    ) -> Result<(), SynthesisError> {
        for round in 0..ROUNDS {
            let mut scaled = self.request.scaled(&sizes);
            scaled.eliminated = eliminated;
            let before = self.best_objective();
            let next = match self.request.requested.wanted().exactly {
                Some(wanted) => self.at_wanted(session, &mut scaled, wanted, label)?,
                None => self.smallest(session, &mut scaled, label, round + 1 < ROUNDS)?,
            };
            let Some(next) = next else {
                break;
            };
            let same = near(&scaled.units, &next);
            let improved = match (before, self.best_objective()) {
                (Some(before), Some(after)) => after < before * (1.0 - CLOSE),
                (None, after) => after.is_some(),
                _ => false,
            };
            let settled = self.is_settled() && (same || (round > 0 && !improved));
            if settled || (self.is_settled() && self.request.requested.wanted().exactly.is_some()) {
                return Ok(());
            }
            sizes = next;
            label = "units of the last solution";
        }
        Ok(())
    }

    /// Designs between the best objective seen, or the floor, and the best one proved.
    pub(super) fn between(&mut self, session: &mut Session) -> Result<(), SynthesisError> {
        if self.request.requested.wanted().exactly.is_some() {
            return Ok(());
        }
        let mut sizes = self.request.first_sizes();
        if self.best.is_none() {
            let mut scaled = self.request.scaled(&sizes);
            scaled.eliminated = self.eliminates();
            self.anything(session, &scaled, "units of the last solution")?;
        }
        let Some(mut high) = self.best_objective() else {
            return Ok(());
        };
        let floor = self.request.floor.map(|floor| floor.objective);
        let mut low = self.seen.or(floor).unwrap_or(high * 1e-6);
        for _ in 0..BISECTIONS {
            if high <= low * (1.0 + CLOSE) {
                break;
            }
            if let Some(best) = &self.best {
                let known = best.file.feedback(self.request.problem).ok();
                sizes = known
                    .and_then(|found| sizes_of::<P>(&found))
                    .unwrap_or(sizes);
            }
            let mut scaled = self.request.scaled(&sizes);
            scaled.eliminated = self.eliminates();
            let middle = (low * high).sqrt();
            let target = middle / scaled.units.objective;
            let found = self.centre(session, &scaled, target, "between")?;
            match found {
                Some((_, true)) => high = self.best_objective().unwrap_or(middle).min(middle),
                _ => low = middle,
            }
        }
        Ok(())
    }
}
