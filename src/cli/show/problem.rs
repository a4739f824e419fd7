//! Design problems and their designs.

use serde::Serialize;
use synth::certify::{Report, Verdict};
use synth::conditions::h_infinity::FLOOR;
use synth::optimality::Optimality;
use synth::problem::{
    DesignTask, InfeasibilityProof, Problem, ProblemDesignFile, ProblemFailure, ProblemSynthesized,
    UnreachableMode,
};

use super::facts::{blocking_lines, slack_or_none, ProofReport, SolverReport, SolverStatus};
use super::no_design::FailureReport;
use synth::claim::Claim;

/// A problem, and what a feedback guarantees for it.
#[derive(Debug, Serialize)]
struct ProblemClaims<'a> {
    /// Which problem.
    problem: &'static str,
    /// The guaranteed number; null where it is not proved.
    guarantee: Option<f64>,
    /// What it means.
    guarantee_meaning: &'static str,
    /// The feedback; null without one.
    gain: Option<&'a [Vec<f64>]>,
    /// Vertices of the plant.
    vertices: usize,
    /// Whether the guaranteed number is a lower bound.
    #[serde(skip)]
    at_least: bool,
}

impl<'a> ProblemClaims<'a> {
    fn new(problem: &Problem, design: Option<&'a ProblemDesignFile>, verdict: Verdict) -> Self {
        let proved = design.filter(|_| verdict == Verdict::Proved);
        ProblemClaims {
            problem: problem.task.name(),
            guarantee: proved.map(|design| design.certificate.guarantee),
            guarantee_meaning: problem.task.guarantee(),
            gain: design.map(|design| design.controller.gain.as_slice()),
            vertices: problem.plant.vertices.len(),
            at_least: matches!(problem.task, DesignTask::SaturatedRegion(_)),
        }
    }

    fn line(&self) -> Option<String> {
        let guarantee = match self.at_least {
            true => Claim::AtLeast(self.guarantee?),
            false => Claim::AtMost(self.guarantee?),
        };
        let meaning = self.guarantee_meaning;
        Some(format!("guarantee: {guarantee} ({meaning})"))
    }
}

/// What is proved of a problem's design.
#[derive(Debug, Serialize)]
pub struct ProblemReport<'a> {
    /// Its proof.
    #[serde(flatten)]
    pub proof: ProofReport<'a>,
    /// What it claims.
    #[serde(flatten)]
    claims: ProblemClaims<'a>,
    /// How it was found; without it where a file is verified.
    #[serde(flatten)]
    synthesis: Option<ProblemSynthesis<'a>>,
}

/// A requirement of the file, on the guaranteed number.
#[derive(Debug, Clone, Copy, Serialize)]
struct Requirement {
    /// Its key.
    name: &'static str,
    /// What is guaranteed; null where nothing is.
    value: Option<f64>,
    /// What is required.
    limit: f64,
    /// True where the requirement is met.
    met: bool,
}

/// How a problem's design was found.
#[derive(Debug, Serialize)]
struct ProblemSynthesis<'a> {
    /// What the solvers did.
    #[serde(flatten)]
    solver: SolverReport<'a>,
    /// The guarantee beside the best one that a solver reported; null where it is not proved.
    optimality: Option<Optimality>,
    /// What the file requires of the guarantee.
    requirements: Vec<Requirement>,
    /// True where the search for a better guarantee stopped at its end: no best one was found.
    stopped: bool,
    /// What that means.
    #[serde(skip)]
    stop: Option<String>,
}

impl<'a> ProblemReport<'a> {
    /// Of a file, and the outcome of its check.
    pub fn verified(problem: &Problem, design: &'a ProblemDesignFile, report: &'a Report) -> Self {
        ProblemReport {
            proof: ProofReport::new(report),
            claims: ProblemClaims::new(problem, Some(design), report.verdict),
            synthesis: None,
        }
    }

    /// Of a design that was found, and the outcome of its check.
    pub fn synthesized(
        problem: &Problem,
        found: &'a ProblemSynthesized,
        report: &'a Report,
    ) -> Self {
        let proved = report.verdict == Verdict::Proved;
        let solver = SolverReport {
            status: SolverStatus::Solved,
            solve_seconds: found.solve_seconds,
            solver_runs: &found.file.provenance.solver_runs,
        };
        let guarantee = found.file.certificate.guarantee;
        let required = problem.task.wanted().at_most.map(|limit| Requirement {
            name: "gamma_max",
            value: Some(guarantee).filter(|_| proved),
            limit,
            met: proved && guarantee <= limit,
        });
        let stop = stop_of_search(problem, guarantee).filter(|_| proved);
        ProblemReport {
            synthesis: Some(ProblemSynthesis {
                solver,
                optimality: found.optimality.filter(|_| proved),
                requirements: required.into_iter().collect(),
                stopped: stop.is_some(),
                stop,
            }),
            ..ProblemReport::verified(problem, &found.file, report)
        }
    }

    /// In words.
    pub fn lines(&self) -> Vec<String> {
        let guarantee = self.claims.line();
        let Some(synthesis) = &self.synthesis else {
            return guarantee
                .into_iter()
                .chain(self.proof.lines(None))
                .collect();
        };
        let optimality = synthesis.optimality.and_then(|own| own.remark());
        let missed = synthesis.requirements.iter().filter(|one| !one.met);
        let missed = missed.map(|one| format!("{} {} is not met", one.name, one.limit));
        let remarks: Vec<String> = missed.chain(optimality).collect();
        let remark = (!remarks.is_empty()).then(|| remarks.join(", "));
        let lines = synthesis.solver.lines().chain(guarantee);
        let lines = lines.chain(synthesis.stop.clone());
        lines.chain(self.proof.lines(remark.as_deref())).collect()
    }

    /// True where every requirement of the file is met.
    pub fn meets_requirements(&self) -> bool {
        let synthesis = self.synthesis.as_ref();
        synthesis.is_none_or(|found| found.requirements.iter().all(|one| one.met))
    }
}

/// Relative distance from the end of the search below which a design counts as stopped there.
const NEAR_STOP: f64 = 0.11;

/// What the end of the search for a better number means, where a design was stopped there.
fn stop_of_search(problem: &Problem, guarantee: f64) -> Option<String> {
    if problem.task.wanted().exactly.is_some() {
        return None;
    }
    let stop = problem.task.floor(&problem.plant)?;
    match &problem.task {
        DesignTask::HInfinity(_) => (guarantee <= stop * (1.0 + NEAR_STOP)).then(|| {
            format!(
                "no smallest gain above 0 was found: smaller ones can be had with larger feedback gains; this design \
                 stops at {FLOOR} of the gain without control or with a linear-quadratic regulator (key gamma asks for \
                 another)"
            )
        }),
        _ => (guarantee >= stop * (1.0 - NEAR_STOP)).then(|| {
            format!("no largest region was found: the search ends at a scale of {stop:.3e}")
        }),
    }
}

/// A problem without a feedback.
#[derive(Debug, Serialize)]
pub struct NoFeedbackReport<'a> {
    /// What is known of every failure.
    #[serde(flatten)]
    failure: FailureReport<'a>,
    /// The problem.
    #[serde(flatten)]
    claims: ProblemClaims<'a>,
    /// The smallest slack; null where the solver found none.
    slack: Option<f64>,
    /// No solution of the scaled problem has all unknowns below this; null where nothing is excluded.
    excluded_radius: Option<f64>,
    /// What every condition exceeds in the solutions that are excluded.
    excluded_margin: Option<f64>,
    /// The mode that no input reaches, in words, where it rules every feedback out.
    #[serde(skip_serializing_if = "Option::is_none")]
    unreachable_mode: Option<String>,
    /// The gain that is asked for, and the smallest that a feedback was found for, where that is larger.
    #[serde(skip_serializing_if = "Option::is_none")]
    wanted: Option<Requirement>,
    /// Both numbers.
    #[serde(skip)]
    excluded: Option<InfeasibilityProof>,
}

impl<'a> NoFeedbackReport<'a> {
    /// From what was found.
    pub fn new(problem: &Problem, found: &'a ProblemFailure, status: SolverStatus) -> Self {
        let solver = SolverReport {
            status,
            solve_seconds: found.solve_seconds,
            solver_runs: &found.runs,
        };
        let excluded = found.answer.excluded;
        NoFeedbackReport {
            failure: FailureReport::new(solver, &found.blocking),
            claims: ProblemClaims::new(problem, None, Verdict::NotProved),
            slack: found.slack,
            excluded_radius: excluded.map(|excluded| excluded.radius.min(f64::MAX)),
            excluded_margin: excluded.map(|excluded| excluded.margin),
            unreachable_mode: excluded
                .and_then(|excluded| excluded.unreachable)
                .map(|mode| mode_in_words(mode, problem.task.decay_rate())),
            wanted: problem.task.wanted().exactly.map(|limit| Requirement {
                name: "gamma",
                value: found.answer.nearest,
                limit,
                met: false,
            }),
            excluded,
        }
    }

    /// In words.
    pub fn lines(&self) -> Vec<String> {
        let solver = &self.failure.solver;
        let mut lines: Vec<String> = solver.lines().collect();
        if let Some(mode) = &self.unreachable_mode {
            lines.push(format!("INFEASIBLE, proved in exact arithmetic: {mode}"));
            return lines;
        }
        if let Some(Requirement { value, limit, .. }) = self.wanted {
            let nearest = value.map(Claim::AtMost).map_or(String::new(), |value| {
                format!("; the smallest gain of a proved feedback is {value}")
            });
            lines.push(format!(
                "UNDECIDED: no feedback with gamma {limit} was found{nearest}"
            ));
            return lines;
        }
        lines.push(match (self.excluded, solver.status) {
            (Some(excluded), SolverStatus::Infeasible) => {
                format!("INFEASIBLE, proved {}", no_solution(excluded))
            }
            (Some(excluded), _) => format!(
                "UNDECIDED: no feedback was found; shown {}; solvers returned unknowns up to {:.3e}",
                no_solution(excluded),
                excluded.largest_returned
            ),
            (None, status) => status.nothing_found("feedback"),
        });
        lines.push(slack_or_none(self.slack));
        lines.extend(blocking_lines(self.failure.blocking));
        lines
    }
}

/// What a problem asks for.
pub fn headline(problem: &Problem) -> String {
    let what = match problem.plant.gain {
        Some(_) => "analysis of a given feedback",
        None => "state feedback",
    };
    format!(
        "problem: {}, {} ({what}, {} vertices)",
        problem.file.name,
        problem.task.name(),
        problem.plant.vertices.len()
    )
}

/// What is proved of a mode.
fn mode_in_words(mode: UnreachableMode, decay_rate: f64) -> String {
    let [first, second] = mode.vertices.map(|vertex| vertex + 1);
    let place = match first == second {
        true => format!("at vertex {first}"),
        false => format!("between vertices {first} and {second}"),
    };
    let growth = format!("a mode with growth rate at least {} 1/s", 0.0 - decay_rate);
    match mode.given_gain {
        true => format!("{place} the closed loop has {growth}"),
        false => format!("{place} no input reaches {growth}"),
    }
}

/// What is proved about solutions that there are not.
fn no_solution(excluded: InfeasibilityProof) -> String {
    let within = match excluded.radius == f64::INFINITY {
        true => String::new(),
        false => {
            let radius = Claim::AtLeast(excluded.radius);
            format!(" with every scalar unknown below {radius:.4}")
        }
    };
    let margin = match excluded.margin == 0.0 {
        true => String::new(),
        false => format!(" and a margin of {}", excluded.margin),
    };
    format!("for the scaled problem as given to the solver: it has no solution{within}{margin}")
}
