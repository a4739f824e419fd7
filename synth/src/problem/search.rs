//! The attempts at a feedback, in order: an equation where there is one, then each solver in units that follow its
//! solutions, then objectives between the best one reported and the best one proved.

use std::time::Instant;

use super::checked::Problem;
use super::design::{verify, ProblemDesignFile, ProblemProvenance, ProofFile};
use super::program::{margin_at, program, weights, ProblemGoal, Program};
use super::scaled::{near, sizes_of, Scaled};
use crate::conditions::state_feedback::{DesignProblem, Floor, StateFeedback};
use crate::conditions::units::Sizes;
use crate::design::{SolverRun, DESIGN_SCHEMA_VERSION};
use crate::programs::{
    has_point, largest_magnitude, now, sha256_of, Session, SynthesisError, Synthesized, GENERATOR,
};
use crate::riccati::{positive, symmetric};
use sdp::solve::{Solution, Status};

use super::run::ProblemSynthesized;

/// Back-offs of the exported design from the optimum, relative: they leave a margin for the proof. Tried in order
/// until the design is proved.
const BACK_OFFS: [f64; 7] = [1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 1e-1];

/// A design within this of the best objective seen, relative, needs no further attempt.
const CLOSE: f64 = 1.5e-3;

/// Rounds in which the units follow the solution.
const ROUNDS: usize = 5;

/// Objectives tried between the best one reported and the best one proved.
const BISECTIONS: usize = 12;

/// What the conditions may miss, relative to the diagonals of their matrices, at a solver's optimum that counts.
const VIOLATION: f64 = 1e-6;

/// Objectives in this range, in scaled units, are near enough to 1.
const NEAR_UNIT: std::ops::RangeInclusive<f64> = 1e-2..=1e2;

/// Part of the largest margin that is kept while the effort is minimised.
const KEPT_MARGIN: f64 = 0.25;

/// Objectives this close, relative, are equally good.
const EQUAL: f64 = 1e-3;

/// Distance below a wanted objective, relative: the number that is guaranteed lies below the one asked for.
const BELOW_WANTED: f64 = 1e-7;

/// A problem in the file's units.
pub(super) struct Request<'a, P> {
    pub(super) problem: &'a Problem,
    pub(super) text: &'a str,
    pub(super) requested: &'a P,
    pub(super) floor: Option<Floor>,
}

impl<'a, P: DesignProblem> Request<'a, P> {
    pub(super) fn new(problem: &'a Problem, text: &'a str, requested: &'a P) -> Self {
        let wanted = requested.wanted();
        let floor = requested.floor(&problem.plant).map(|floor| Floor {
            // What is good enough is not below the floor.
            objective: wanted
                .at_most
                .into_iter()
                .fold(floor.objective, |least, at_most| {
                    least.min(at_most * (1.0 - 2.0 * BACK_OFFS[0]))
                }),
            ..floor
        });
        Request {
            problem,
            text,
            requested,
            floor,
        }
    }

    /// The problem in units for numbers of these sizes.
    pub(super) fn scaled(&self, sizes: &Sizes) -> Scaled<P> {
        Scaled::new(self.requested, &self.problem.plant, sizes, self.floor)
    }

    /// The sizes before anything is solved.
    pub(super) fn first_sizes(&self) -> Sizes {
        Sizes::of(&self.problem.plant, self.requested.decay_rate())
    }

    /// Puts the file together and checks what a reader of its text would get; `None` for numbers that no design file
    /// may hold.
    fn design(&self, found: &StateFeedback) -> Option<Box<ProblemSynthesized>> {
        let report = verify(self.problem, found);
        let (controller, certificate) = ProofFile::split(found);
        let file = ProblemDesignFile {
            schema_version: DESIGN_SCHEMA_VERSION,
            name: self.problem.file.name.clone(),
            model: self.problem.file.clone(),
            controller,
            certificate,
            verdict: report.clone(),
            provenance: ProblemProvenance {
                generator: GENERATOR.to_string(),
                model_sha256: sha256_of(self.text),
                date: now(),
                solver_runs: Vec::new(),
            },
        };
        file.feedback(self.problem).ok()?;
        Some(Box::new(Synthesized {
            file,
            report,
            solve_seconds: 0.0,
            optimality: None,
        }))
    }
}

/// A program, the solver's answer, and whether its numbers can be used.
struct Answer {
    program: Program,
    solution: Solution,
}

/// What has been found so far. Objectives are in the file's units.
pub(super) struct Search<'a, P> {
    request: &'a Request<'a, P>,
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

    fn best_objective(&self) -> Option<f64> {
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

    fn saw(&mut self, objective: f64) {
        let least = self.request.floor.map_or(0.0, |floor| floor.objective);
        let objective = objective.max(least);
        if objective > 0.0 && objective.is_finite() {
            self.seen = Some(self.seen.map_or(objective, |seen| seen.min(objective)));
        }
    }

    /// Nothing better than the end of the search is claimed: what lies beyond depends on chance.
    fn claimed(&self, found: &StateFeedback) -> StateFeedback {
        let least = self.request.floor.map_or(0.0, |floor| floor.objective);
        let mut found = found.clone();
        if P::objective_of(found.guarantee) < least {
            found.guarantee = P::guarantee_of(least);
        }
        found
    }

    /// Checks a candidate and keeps it where it is the best; true where it is proved.
    fn consider(&mut self, found: &StateFeedback) -> bool {
        let found = &self.claimed(found);
        let Some(design) = self.request.design(found) else {
            return false;
        };
        if !design.is_proved() {
            self.unproved = Some(design);
            return false;
        }
        let objective = P::objective_of(found.guarantee);
        if self.best_objective().is_none_or(|best| objective < best) {
            self.best = Some(design);
        }
        true
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

    /// The smallest objective, then designs above it; the sizes of what was found. Where the objective is far from its
    /// unit, the sizes alone: a solver's accuracy is that of its units.
    fn smallest(
        &mut self,
        session: &mut Session,
        scaled: &mut Scaled<P>,
        label: &str,
        again: bool,
    ) -> Result<Option<Sizes>, SynthesisError> {
        let goal = ProblemGoal::SmallestObjective;
        let Some(answer) = self.run(session, scaled, goal, label)? else {
            return Ok(self.anything(session, scaled, label)?);
        };
        if answer.solution.status == Status::Infeasible {
            self.infeasible += 1;
        }
        let unit = scaled.units.objective;
        let smallest = answer.solution.objective;
        let values = &answer.solution.values;
        let objective = smallest * unit;
        let usable = objective > 0.0 && objective.is_finite();
        if !usable || !has_point(&answer.solution) {
            return self.anything(session, scaled, label);
        }
        if again && !NEAR_UNIT.contains(&smallest) {
            let sizes = scaled.sizes_at(&answer.program.transformed, values, objective);
            if sizes.is_some() {
                return Ok(sizes);
            }
        }
        if satisfied(&answer) {
            self.saw(objective);
        }
        let q = symmetric(&answer.program.transformed.inverse.value(values));
        scaled.weights = weights(scaled, &q, smallest);
        let mut last = None;
        for back_off in BACK_OFFS {
            let target = smallest * (1.0 + back_off);
            if let Some(better) = self.centre(session, scaled, target, label)? {
                last = Some(better.0);
                if better.1 {
                    break;
                }
            }
        }
        match last {
            Some(found) => Ok(sizes_of::<P>(&found)),
            None => self.anything(session, scaled, label),
        }
    }

    /// A design at the wanted objective; the sizes of what was found.
    fn at_wanted(
        &mut self,
        session: &mut Session,
        scaled: &mut Scaled<P>,
        wanted: f64,
        label: &str,
    ) -> Result<Option<Sizes>, SynthesisError> {
        let target = wanted * (1.0 - BELOW_WANTED) / scaled.units.objective;
        match self.centre(session, scaled, target, label)? {
            Some((found, _)) => Ok(sizes_of::<P>(&found)),
            None => self.anything(session, scaled, label),
        }
    }

    /// A design at an objective in scaled units, and whether it is proved.
    fn centre(
        &mut self,
        session: &mut Session,
        scaled: &Scaled<P>,
        objective: f64,
        label: &str,
    ) -> Result<Option<(StateFeedback, bool)>, SynthesisError> {
        let goal = ProblemGoal::LargestMargin { objective };
        let Some(answer) = self.run(session, scaled, goal, label)? else {
            return Ok(None);
        };
        let Some(found) = self.recover(scaled, &answer, objective * scaled.units.objective) else {
            return Ok(None);
        };
        let proved = self.consider(&found);
        if !proved || self.request.problem.plant.gain.is_some() {
            return Ok(Some((found, proved)));
        }
        let calm = self.calm(session, scaled, &answer, objective, label)?;
        let smaller = calm.filter(|calm| calm.gain.norm() < found.gain.norm());
        match smaller.filter(|calm| self.replace(calm)) {
            Some(calm) => Ok(Some((calm, true))),
            None => Ok(Some((found, true))),
        }
    }

    /// The smallest gains with a part of the margin that was found: nothing else keeps them small.
    fn calm(
        &mut self,
        session: &mut Session,
        scaled: &Scaled<P>,
        answer: &Answer,
        objective: f64,
        label: &str,
    ) -> Result<Option<StateFeedback>, SynthesisError> {
        let q = symmetric(
            &answer
                .program
                .transformed
                .inverse
                .value(&answer.solution.values),
        );
        let whole = scaled.completed(&q, objective);
        let margin = match scaled.eliminated {
            false => -answer.solution.objective,
            true => match scaled.problem.completed(&scaled.plant, &q) {
                Some(y) => margin_at(&whole, &q, &y, objective),
                None => return Ok(None),
            },
        };
        let margin = KEPT_MARGIN * margin;
        let goal = ProblemGoal::SmallestEffort { objective, margin };
        let answer = self.run(session, &whole, goal, label)?;
        let answer = answer.filter(|answer| has_point(&answer.solution));
        Ok(answer
            .and_then(|answer| self.recover(&whole, &answer, objective * whole.units.objective)))
    }

    /// Puts a candidate in the place of the best design where it is proved and as good; true where it is proved.
    fn replace(&mut self, found: &StateFeedback) -> bool {
        let found = &self.claimed(found);
        let Some(design) = self
            .request
            .design(found)
            .filter(|design| design.is_proved())
        else {
            return false;
        };
        let objective = P::objective_of(found.guarantee);
        let best = self.best_objective();
        if best.is_none_or(|best| objective <= best * (1.0 + EQUAL)) {
            self.best = Some(design);
        }
        true
    }

    /// A design whatever its objective; its sizes.
    fn anything(
        &mut self,
        session: &mut Session,
        scaled: &Scaled<P>,
        label: &str,
    ) -> Result<Option<Sizes>, SynthesisError> {
        let Some(answer) = self.run(session, scaled, ProblemGoal::AnyObjective, label)? else {
            return Ok(None);
        };
        let objective = &answer.program.transformed.objective;
        let objective = objective.value(&answer.solution.values)[(0, 0)];
        let found = self.recover(scaled, &answer, objective * scaled.units.objective);
        let Some(found) = found else {
            return Ok(None);
        };
        if self.request.requested.wanted().exactly.is_none() {
            self.consider(&found);
        }
        // Its objective is far from the smallest one and gives no unit.
        Ok(sizes_of::<P>(&found).map(|sizes| Sizes {
            objective: None,
            ..sizes
        }))
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

    fn recover(
        &self,
        scaled: &Scaled<P>,
        answer: &Answer,
        objective: f64,
    ) -> Option<StateFeedback> {
        let request = self.request;
        let given = request.problem.plant.gain.as_ref();
        let values = &answer.solution.values;
        scaled.recover(
            request.requested,
            given,
            &answer.program.transformed,
            (values, objective),
        )
    }

    /// One run of a solver; `None` where it refused or returned no numbers.
    fn run(
        &mut self,
        session: &mut Session,
        scaled: &Scaled<P>,
        goal: ProblemGoal,
        label: &str,
    ) -> Result<Option<Answer>, SynthesisError> {
        let program = program(scaled, goal);
        let vertices = scaled.plant.vertices.len();
        let name = match goal {
            ProblemGoal::LargestMargin { objective }
            | ProblemGoal::SmallestEffort { objective, .. } => {
                let guarantee = P::guarantee_of(objective * scaled.units.objective);
                format!("{} at {guarantee:.6e}, {label}", goal.name())
            }
            _ => format!("{}, {label}", goal.name()),
        };
        let problem = &program.problem;
        let ran = session.run(problem, &name, goal.accuracy(), vertices);
        self.runs.append(&mut session.runs);
        let solution = match ran {
            Ok(solution) => solution,
            // Units in which a number is not finite are no use; others may be.
            Err(SynthesisError::Solve(_)) => return Ok(None),
            Err(error) => return Err(error),
        };
        let largest = largest_magnitude(&solution.values);
        self.largest = self.largest.max(largest);
        let usable = largest.is_finite() && solution.values.len() == problem.unknowns.count();
        Ok(usable.then_some(Answer { program, solution }))
    }
}

/// True where a solver's point satisfies every condition but for rounding, each relative to its own diagonal.
fn satisfied(answer: &Answer) -> bool {
    let values = &answer.solution.values;
    has_point(&answer.solution)
        && answer.program.stated.iter().all(|stated| {
            let mut matrix = stated.matrix.value(values);
            let diagonal = matrix.diagonal().abs();
            let least = VIOLATION * diagonal.max();
            for k in 0..diagonal.len() {
                matrix[(k, k)] += VIOLATION * diagonal[k] + VIOLATION * least;
            }
            positive(&matrix)
        })
}

impl<P: DesignProblem> Search<'_, P> {
    /// The program for the smallest slack in the first units, with its solution.
    pub(super) fn smallest_slack(
        &mut self,
        session: &mut Session,
    ) -> Result<Option<(Scaled<P>, Program, Solution)>, SynthesisError> {
        let scaled = self.request.scaled(&self.request.first_sizes());
        let answer = self.run(
            session,
            &scaled,
            ProblemGoal::SmallestSlack,
            "balanced units",
        )?;
        Ok(answer.map(|answer| (scaled, answer.program, answer.solution)))
    }
}
