//! Facts that several verbs report: the solvers' runs, the proof, what blocks, and the files that were written.

use std::path::Path;

use serde::Serialize;
use synth::certify::{ConditionMargin, Report, Verdict};
use synth::design::SolverRun;
use synth::programs::Blocking;

use crate::cli::answer::Exit;
use synth::claim::Claim;

/// What a synthesis or an analysis came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SolverStatus {
    /// A candidate was found; its verdict says whether it is proved.
    Solved,
    /// There is none: proved.
    Infeasible,
    /// None was found, and none was proved not to exist.
    Undecided,
    /// The solvers failed numerically.
    Failed,
}

impl SolverStatus {
    /// The exit status where nothing was found.
    pub fn exit_without_design(self) -> Exit {
        match self {
            SolverStatus::Failed => Exit::SolverFailed,
            _ => Exit::No,
        }
    }

    /// What is to be said where nothing was found and nothing proved.
    pub fn nothing_found(self, what: &str) -> String {
        match self {
            SolverStatus::Undecided => {
                format!("UNDECIDED: no {what} was found, and none was proved not to exist")
            }
            _ => "the solvers failed numerically".to_string(),
        }
    }
}

/// What is to be said where a solver was named and found nothing.
pub fn only_one_asked(solver: &str) -> String {
    format!("only {solver} was asked; with --solver auto the other one is asked too")
}

/// What the solvers did.
#[derive(Debug, Serialize)]
pub struct SolverReport<'a> {
    /// What it came to.
    pub status: SolverStatus,
    /// Time in solvers (s).
    pub solve_seconds: f64,
    /// Each run; its status is the solver's and proves nothing.
    pub solver_runs: &'a [SolverRun],
}

impl SolverReport<'_> {
    /// One line for each run.
    pub fn lines(&self) -> impl Iterator<Item = String> + '_ {
        self.solver_runs.iter().map(|run| {
            format!(
                "solver: {}, {} at {} vertices: {} after {} iterations, {:.2} s (solver status, unverified)",
                run.solver, run.goal, run.vertices, run.status, run.iterations, run.seconds
            )
        })
    }
}

/// What was proved of a design, and under which assumptions.
#[derive(Debug, Serialize)]
pub struct ProofReport<'a> {
    /// Proved or not.
    verdict: Verdict,
    /// The condition with the smallest margin.
    worst: Option<&'a ConditionMargin>,
    /// Every condition.
    conditions: &'a [ConditionMargin],
    /// What the proof assumes; none where nothing is proved.
    not_covered: &'a [String],
}

impl<'a> ProofReport<'a> {
    /// From the outcome of the check.
    pub fn new(report: &'a Report) -> Self {
        ProofReport {
            verdict: report.verdict,
            worst: report.worst(),
            conditions: &report.conditions,
            not_covered: match report.verdict {
                Verdict::Proved => &report.not_covered,
                Verdict::NotProved => &[],
            },
        }
    }

    /// In words, with a remark on the line of the verdict where there is one. The verdict comes last; what is not
    /// proved claims and assumes nothing.
    pub fn lines(&self, remark: Option<&str>) -> Vec<String> {
        let mut lines = Vec::new();
        let worst = self.worst;
        lines.extend(worst.map(|worst| format!("worst condition: {}", margin(worst))));
        lines.extend(not_proved(self.conditions));
        lines.push(format!("{} conditions checked", self.conditions.len()));
        let assumed = self.not_covered.iter();
        let assumed = assumed.map(|item| format!("  - {item}"));
        lines.extend(titled("the proof assumes:", assumed));
        lines.push(match self.verdict {
            Verdict::Proved => {
                let remark = remark.map_or(String::new(), |remark| format!(", {remark}"));
                format!("verdict: PROVED{remark}")
            }
            Verdict::NotProved => "verdict: NOT PROVED".to_string(),
        });
        lines
    }
}

/// One line for each condition that is not proved.
pub fn not_proved<'a>(conditions: impl IntoIterator<Item = &'a ConditionMargin>) -> Vec<String> {
    let failed = conditions.into_iter();
    let failed = failed.filter(|condition| condition.margin < 0.0);
    let line = |condition| format!("  not proved: {}", margin(condition));
    failed.map(line).collect()
}

fn margin(condition: &ConditionMargin) -> String {
    let margin = Claim::AtLeast(condition.margin);
    format!("{}, margin {margin:.4}", condition.name)
}

/// The conditions that block, as many as are named where nothing is feasible.
pub fn blocking_lines(blocking: &[Blocking]) -> Vec<String> {
    let title = "conditions that block (fraction of the dual solution):";
    let lines = blocking.iter().take(12);
    let lines = lines.map(|one| format!("  {:5.1} %  {}", 100.0 * one.share, one.name));
    titled(title, lines)
}

/// The conditions at the best point of a search, as many as are named where it stopped short of its goal.
pub fn search_lines(blocking: &[Blocking]) -> Vec<String> {
    let title = "conditions by their fraction of the dual solution:";
    let lines = blocking.iter().take(6);
    let lines = lines.map(|one| format!("  {:4.1} %  {}", 100.0 * one.share, one.name));
    titled(title, lines)
}

/// Lines below a title; nothing without lines.
pub fn titled(title: &str, lines: impl Iterator<Item = String>) -> Vec<String> {
    let mut lines = lines.peekable();
    let title = lines.peek().map(|_| title.to_string());
    title.into_iter().chain(lines).collect()
}

/// The smallest slack.
pub fn slack_line(slack: Option<f64>) -> Option<String> {
    let slack = slack?;
    Some(format!(
        "smallest slack t with which every condition holds: {slack:.4e} (scaled units; the solver's number, not proved)"
    ))
}

/// The smallest slack, or that there is none.
pub fn slack_or_none(slack: Option<f64>) -> String {
    slack_line(slack)
        .unwrap_or_else(|| "the smallest slack could not be computed either".to_string())
}

/// Says that nothing was written.
pub const NOTHING: &str = "nothing written";

/// Names a file that was written.
pub fn written(path: &Path) -> String {
    format!("written: {}", path.display())
}

/// Names a file that was written, or says that none was.
pub fn written_or_nothing(path: Option<&Path>) -> String {
    path.map_or_else(|| NOTHING.to_string(), written)
}

/// What became of a design.
pub fn design_written(path: Option<&Path>, verdict: Verdict) -> String {
    match (path, verdict) {
        (None, Verdict::Proved) => format!("{NOTHING}; give -o DESIGN.json to keep the design"),
        (path, _) => written_or_nothing(path),
    }
}
