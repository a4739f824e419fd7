//! A synthesis or an analysis without a design.

use std::path::Path;

use serde::Serialize;
use synth::certify::Verdict;
use synth::feasibility::Decision;
use synth::model::Model;
use synth::programs::{Blocking, LimitingFactors};
use synth::synthesis::Form;

use super::blocking::{blocking_lines, search_lines, slack_line, slack_or_none};
use super::infeasibility;
use super::shortfall::limiting_lines;
use super::solver::{SolverReport, SolverStatus};

/// What is known where nothing is proved of any candidate, alike for models and problems.
#[derive(Debug, Serialize)]
pub struct FailureReport<'a> {
    /// What the solvers did.
    #[serde(flatten)]
    pub solver: SolverReport<'a>,
    /// Always `not_proved`.
    verdict: Verdict,
    /// Always empty.
    conditions: [(); 0],
    /// The conditions that carry the dual solution.
    pub blocking: &'a [Blocking],
}

impl<'a> FailureReport<'a> {
    /// From what the solvers did, and the conditions that carry the dual solution.
    pub fn new(solver: SolverReport<'a>, blocking: &'a [Blocking]) -> Self {
        FailureReport {
            solver,
            verdict: Verdict::NotProved,
            conditions: [],
            blocking,
        }
    }
}

/// A synthesis or an analysis without a design.
#[derive(Debug, Serialize)]
pub struct NoDesignReport<'a> {
    /// What is known of every failure.
    #[serde(flatten)]
    failure: FailureReport<'a>,
    /// Always null.
    gamma: (),
    /// Always null.
    guaranteed_gain: (),
    /// Always null.
    xi: (),
    /// Always null.
    certified_angle_deg: (),
    /// Form of the decrease condition.
    form: &'static str,
    /// Vertices of the model.
    vertices: usize,
    /// Whether there is any design: the verdict of `feasibility`.
    feasibility: &'static str,
    /// What else is known.
    #[serde(flatten)]
    detail: Detail<'a>,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Detail<'a> {
    /// Of a design with one certificate.
    One {
        /// What was proved about their existence, in words.
        #[serde(skip)]
        known: Option<String>,
        /// How far a search came; null without one.
        shortfall: Option<&'a LimitingFactors>,
        /// What was proved about a part of the designs; null where the answer is about all.
        shown: Option<String>,
        /// The bound of proved weights; null without.
        bound: Option<f64>,
        /// The given gains, from 1, that a proved no is about.
        blocking_gains: Vec<usize>,
        /// The smallest slack; null where the solver found none.
        slack: Option<f64>,
    },
    /// Of a design with two certificates.
    Two {
        /// Always null.
        outer: (),
        /// Attempts that were made.
        attempts: usize,
    },
}

impl<'a> NoDesignReport<'a> {
    /// From the decision that the synthesis ended with.
    pub fn new(model: &Model, form: Form, decision: &'a Decision, status: SolverStatus) -> Self {
        let solver = SolverReport {
            status,
            solve_seconds: decision.solve_seconds,
            solver_runs: &decision.runs,
        };
        let answer = &decision.answer;
        let detail = match decision.couplings {
            0 => Detail::One {
                known: infeasibility::bound(answer).map(|_| infeasibility::headline(answer)),
                shortfall: decision.limiting_factors.as_deref(),
                shown: infeasibility::shown(answer),
                bound: infeasibility::bound(answer),
                blocking_gains: infeasibility::blocking_gains(answer),
                slack: decision.slack,
            },
            attempts => Detail::Two {
                outer: (),
                attempts,
            },
        };
        NoDesignReport {
            failure: FailureReport::new(solver, &decision.blocking),
            gamma: (),
            guaranteed_gain: (),
            xi: (),
            certified_angle_deg: (),
            form: form.name(),
            vertices: model.task().system.vertices.len(),
            feasibility: infeasibility::verdict(answer),
            detail,
        }
    }

    /// In words: what was not found for the model of this file.
    pub fn lines(&self, path: &Path, what: &str) -> Vec<String> {
        let path = path.display();
        let blocking = self.failure.blocking;
        let solver = &self.failure.solver;
        let unknown = match solver.status {
            SolverStatus::Undecided => {
                format!("UNDECIDED: no {what} was found, and none was proved not to exist")
            }
            _ => "the solvers failed numerically".to_string(),
        };
        let mut lines = Vec::new();
        match &self.detail {
            Detail::One {
                shortfall: Some(shortfall),
                ..
            } => {
                lines.push(format!("{path}: UNDECIDED: {}", shortfall.reason));
                lines.extend(limiting_lines(shortfall));
                lines.extend(search_lines(blocking));
            }
            Detail::One { known, slack, .. } => {
                let headline = known.as_ref().unwrap_or(&unknown);
                lines.push(format!("{path}: {headline}"));
                lines.extend(match known {
                    Some(_) => slack_line(*slack),
                    None => Some(slack_or_none(*slack)),
                });
                lines.extend(blocking_lines(blocking));
            }
            Detail::Two { .. } => {
                lines.push(format!("{path}: {unknown}"));
                lines.extend(solver.lines());
                lines.extend(blocking_lines(blocking));
            }
        }
        lines
    }
}
