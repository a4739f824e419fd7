//! Single programs of a search: each is solved, its point is taken back to the file's units, and what it gives is checked.

use super::program::{margin_at, program, weights, with_feedback, ProblemGoal, Program};
use super::request::{BACK_OFFS, BELOW_WANTED};
use super::scaled::{sizes_of, Scaled};
use super::search::Search;
use crate::conditions::state_feedback::{DesignProblem, StateFeedback};
use crate::conditions::units::Sizes;
use crate::programs::{has_point, largest_magnitude, satisfied, Session, SynthesisError};
use crate::riccati::symmetric;
use sdp::solve::{Solution, Status};

/// Part of the largest margin that is kept while the effort is minimised.
const KEPT_MARGIN: f64 = 0.25;

/// Objectives in this range, in scaled units, are near enough to 1.
const NEAR_UNIT: std::ops::RangeInclusive<f64> = 1e-2..=1e2;

/// A program, the solver's answer, and whether its numbers can be used.
struct Answer {
    program: Program,
    solution: Solution,
}

impl<P: DesignProblem> Search<'_, P> {
    /// The smallest objective, then designs above it; the sizes of what was found. Where the objective is far from its
    /// unit, the sizes alone: a solver's accuracy is that of its units.
    pub(super) fn smallest(
        &mut self,
        session: &mut Session,
        scaled: &mut Scaled<P>,
        label: &str,
        again: bool,
    ) -> Result<Option<Sizes>, SynthesisError> {
        let goal = ProblemGoal::SmallestObjective;
        let Some(answer) = self.run(session, scaled, goal, label)? else {
            return self.anything(session, scaled, label);
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
        let stated = answer.program.stated.iter().map(|stated| &stated.matrix);
        if satisfied(&answer.solution, stated) {
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
    pub(super) fn at_wanted(
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
    pub(super) fn centre(
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
        let bounded = self.request.problem.plant.gain.is_some() || P::GAIN_IS_AUXILIARY;
        if !proved || bounded {
            return Ok(Some((found, proved)));
        }
        let calm = self.calm(session, scaled, &answer, objective, label)?;
        let smaller = calm.filter(|calm| calm.gain.norm() < found.gain.norm());
        match smaller.filter(|calm| self.consider(calm)) {
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
        let whole = with_feedback(scaled, &q, objective);
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

    /// A design whatever its objective; its sizes.
    pub(super) fn anything(
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
        for run in &mut session.runs {
            run.state_units = scaled.units.state.iter().copied().collect();
            run.margin = Some(goal.margin(run.objective)).filter(|margin| margin.is_finite());
        }
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
