//! A synthesis or an analysis without a design.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;
use synth::certify::Verdict;
use synth::feasibility::{Answer, Decision};
use synth::model::Model;
use synth::programs::{Blocking, LimitingFactors};
use synth::synthesis::Form;

use super::facts::{
    blocking_lines, search_lines, slack_line, slack_or_none, titled, SolverReport, SolverStatus,
};
use super::infeasibility::Existence;

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

/// Claims of a design whose keys are there without one, too.
const CLAIMS: [&str; 4] = ["gamma", "guaranteed_gain", "xi", "certified_angle_deg"];

/// A synthesis or an analysis without a design.
#[derive(Debug, Serialize)]
pub struct NoDesignReport<'a> {
    /// What is known of every failure.
    #[serde(flatten)]
    failure: FailureReport<'a>,
    /// What a design would claim, all null.
    #[serde(flatten)]
    claims: BTreeMap<&'static str, ()>,
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
        /// What is proved.
        #[serde(flatten)]
        existence: Existence<'a>,
        /// What a search reached, and the limiting factors; null without one.
        shortfall: Option<&'a LimitingFactors>,
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
        let existence = Existence::of(answer);
        let feasibility = existence.verdict;
        let detail = match decision.couplings {
            0 => Detail::One {
                existence,
                shortfall: decision.limiting_factors.as_deref(),
                blocking_gains: match answer {
                    Answer::Infeasible(proof) => proof.file.blocking_gains(),
                    _ => Vec::new(),
                },
                slack: decision.slack,
            },
            attempts => Detail::Two {
                outer: (),
                attempts,
            },
        };
        NoDesignReport {
            failure: FailureReport::new(solver, &decision.blocking),
            claims: CLAIMS.map(|key| (key, ())).into(),
            form: form.name(),
            vertices: model.task().system.vertices.len(),
            feasibility,
            detail,
        }
    }

    /// In words: what was not found for the model of this file.
    pub fn lines(&self, path: &Path, what: &str) -> Vec<String> {
        let path = path.display();
        let blocking = self.failure.blocking;
        let solver = &self.failure.solver;
        let unknown = solver.status.nothing_found(what);
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
            Detail::One {
                existence, slack, ..
            } => {
                let proved = existence.certificate.is_some();
                let headline = if proved {
                    &existence.headline
                } else {
                    &unknown
                };
                lines.push(format!("{path}: {headline}"));
                lines.extend(match proved {
                    true => slack_line(*slack),
                    false => Some(slack_or_none(*slack)),
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

/// The limiting factors in words.
fn limiting_lines(factors: &LimitingFactors) -> Vec<String> {
    let title = "limiting factors (1 % more of the number changes the outcome by so much):";
    let limits = factors.limits.iter().map(|limit| {
        let (what, value) = (&limit.what, limit.value);
        format!("  {:+.3} %  {what}, now {value}", limit.per_cent)
    });
    titled(title, limits)
}
