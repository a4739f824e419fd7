//! The answer of `feasibility`.

use std::path::Path;

use serde::Serialize;
use synth::design::SolverRun;
use synth::feasibility::{Answer, Decision, Relaxation};
use synth::programs::Blocking;

use super::facts::{blocking_lines, slack_line};
use super::infeasibility::Existence;
use crate::cli::answer::Exit;

/// Whether any design exists, and why not.
#[derive(Debug, Serialize)]
pub struct FeasibilityReport<'a> {
    /// `feasible`, `infeasible` (both proved) or `undecided`.
    verdict: &'static str,
    /// The smallest slack t in scaled units, the solver's number: above 0 the conditions cannot hold. Null where
    /// the solver found none.
    slack: Option<f64>,
    /// The conditions that carry the dual solution; empty where a design exists.
    blocking: &'a [Blocking],
    /// What is proved.
    #[serde(flatten)]
    existence: Existence<'a>,
    /// What relaxing one requirement alone does; null where it was not asked.
    pub relaxations: Option<Vec<Relaxation>>,
    /// Time of the verdict (s).
    seconds: f64,
    /// Time in solvers (s).
    solve_seconds: f64,
    /// Each run; its status is the solver's and proves nothing.
    solver_runs: &'a [SolverRun],
}

impl<'a> FeasibilityReport<'a> {
    /// From the answer, found in this time (s).
    pub fn new(decision: &'a Decision, seconds: f64) -> Self {
        let blocking: &[_] = match decision.answer {
            Answer::Feasible(_) => &[],
            _ => &decision.blocking,
        };
        let existence = Existence::of(&decision.answer);
        FeasibilityReport {
            verdict: existence.verdict,
            slack: decision.slack,
            blocking,
            existence,
            relaxations: None,
            seconds,
            solve_seconds: decision.solve_seconds,
            solver_runs: &decision.runs,
        }
    }

    /// Yes where a design exists.
    pub fn exit(&self) -> Exit {
        Exit::of(self.verdict == "feasible")
    }

    /// The verdict on the model of this file.
    pub fn headline(&self, model: &Path) -> String {
        format!("{}: {}", model.display(), self.existence.headline)
    }

    /// In words; with what became of the file.
    pub fn lines(&self, model: &Path, written: Option<String>) -> Vec<String> {
        let mut lines = vec![self.headline(model)];
        lines.extend(slack_line(self.slack));
        lines.extend(blocking_lines(self.blocking));
        lines.extend(written);
        if let Some(relaxations) = &self.relaxations {
            let title = "one requirement relaxed, all others kept:";
            lines.push(title.to_string());
            lines.extend(relaxations.iter().map(relaxation_line));
        }
        lines
    }
}

fn relaxation_line(relaxation: &Relaxation) -> String {
    let symbol = relaxation.requirement;
    let factors = relaxation.factor.zip(relaxation.not_at_factor);
    match relaxation.value.zip(factors) {
        Some((value, (factor, not_at))) => format!(
            "  {symbol}: feasible (proved) at {value}, {factor:.4} times the model's; not found at {not_at:.4} times"
        ),
        None => {
            let [largest, smallest] = relaxation.tried;
            format!(
                "  {symbol}: does not help alone (tried at {smallest:.4} to {largest:.4e} times the model's)"
            )
        }
    }
}
