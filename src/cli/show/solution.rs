//! The solution of a semidefinite program.

use serde::Serialize;
use synth::claim::Claim;
use synth::lmi::Semidefinite;
use synth::solve::{Attempt, Found, Judgement, Outcome, Residuals, Timings};

use crate::cli::answer::Exit;

/// What the solvers returned for a program, and what the numbers show.
#[derive(Serialize)]
pub struct SolutionReport<'a> {
    /// `solved`, `inaccurate`, `infeasible`, `unbounded` or `failed`: from the numbers.
    status: &'static str,
    /// Name and version of the solver whose numbers these are.
    solver: &'a str,
    /// The solver's status, unverified.
    solver_status: &'a str,
    /// c'x; null, as the six next, when the solver returned a certificate instead of a point.
    objective: Option<f64>,
    /// That of the dual.
    dual_objective: Option<f64>,
    /// Their distance.
    relative_gap: Option<f64>,
    /// How far the objective may be from the optimum, relative to 1 plus the sizes of both: an estimate.
    uncertainty: Option<f64>,
    /// Smallest eigenvalue of the conditions, negated, relative to 1 plus the largest constant.
    violation: Option<f64>,
    /// Residual of the dual's equations, relative to 1 plus the largest cost.
    dual_residual: Option<f64>,
    /// Smallest eigenvalue of the dual matrices, negated, relative to 1 plus the largest cost.
    dual_violation: Option<f64>,
    /// Residual of the certificate that it is infeasible or unbounded.
    certificate_residual: Option<f64>,
    /// When infeasible: no point with every unknown below this in size satisfies the conditions, proved; 0 when
    /// nothing is proved.
    excluded_radius: Option<f64>,
    /// When unbounded: whether it is proved.
    unbounded_proved: Option<bool>,
    /// Number of unknowns.
    unknowns: usize,
    /// Number of cones.
    cones: usize,
    /// Side of the widest.
    widest_cone: usize,
    /// Iterations.
    iterations: u32,
    /// Time to read the file (s).
    read_seconds: f64,
    /// Time in all solvers (s).
    solve_seconds: f64,
    /// Time in the Schur complement (s); null with Clarabel.
    schur_seconds: Option<f64>,
    /// Time in linear systems (s); null with Clarabel.
    linear_seconds: Option<f64>,
    /// Each solver that was asked.
    solver_runs: Vec<RunReport<'a>>,
    #[serde(skip)]
    judgement: &'a Judgement,
    /// What the time went to, where it is known.
    #[serde(skip)]
    timings: Option<Timings>,
}

/// One solver's run.
#[derive(Serialize)]
struct RunReport<'a> {
    /// Name and version.
    solver: &'a str,
    /// As of the whole; `refused` when it could not start.
    status: &'static str,
    /// The solver's own status, unverified, or why it could not start.
    solver_status: String,
    /// c'x, where there is a point.
    objective: Option<f64>,
    /// Iterations.
    iterations: u32,
    /// Time (s).
    seconds: f64,
}

/// Yes when it is solved, possibly inaccurately.
pub fn exit(outcome: Outcome) -> Exit {
    match outcome {
        Outcome::Solved | Outcome::Inaccurate => Exit::Yes,
        Outcome::Infeasible | Outcome::Unbounded => Exit::No,
        Outcome::Failed | Outcome::Cancelled => Exit::SolverFailed,
    }
}

fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Solved => "solved",
        Outcome::Inaccurate => "inaccurate",
        Outcome::Infeasible => "infeasible",
        Outcome::Unbounded => "unbounded",
        Outcome::Failed | Outcome::Cancelled => "failed",
    }
}

impl<'a> RunReport<'a> {
    fn new(attempt: &'a Attempt) -> Self {
        let (status, solver_status, objective, iterations, seconds) = match &attempt.found {
            Ok(found) => (
                word(found.judgement.outcome),
                found.solution.status_text.clone(),
                found.judgement.residuals.map(|own| own.objective),
                found.solution.iterations,
                found.solution.seconds,
            ),
            Err(error) => ("refused", error.to_string(), None, 0, 0.0),
        };
        RunReport {
            solver: &attempt.name,
            status,
            solver_status,
            objective: objective.filter(|objective| objective.is_finite()),
            iterations,
            seconds,
        }
    }

    fn line(&self) -> String {
        match self.status {
            "refused" => format!("{}: {}", self.solver, self.solver_status),
            status => format!(
                "{}: {} after {} iterations, {:.3} s; its numbers: {status}",
                self.solver, self.solver_status, self.iterations, self.seconds
            ),
        }
    }
}

impl<'a> SolutionReport<'a> {
    /// From all attempts and the best of them, and the time to read the file (s).
    pub fn new(
        problem: &Semidefinite,
        tried: &'a [Attempt],
        (attempt, found): (&'a Attempt, &'a Found),
        read_seconds: f64,
    ) -> Self {
        let judgement = &found.judgement;
        let number = |read: fn(&Residuals) -> f64| {
            let number = judgement.residuals.as_ref().map(read);
            number.filter(|number| number.is_finite())
        };
        let (refutation, descent) = (&judgement.refutation, &judgement.descent);
        let residual = refutation.as_ref().map(|own| own.residual);
        let residual = residual.or(descent.as_ref().map(|own| own.residual));
        let radius = refutation.as_ref().map(|own| own.exclusion.radius);
        let solver_runs: Vec<RunReport> = tried.iter().map(RunReport::new).collect();
        SolutionReport {
            status: word(judgement.outcome),
            solver: &attempt.name,
            solver_status: &found.solution.status_text,
            objective: number(|own| own.objective),
            dual_objective: number(|own| own.dual_objective),
            relative_gap: number(|own| own.relative_gap),
            uncertainty: number(|own| own.uncertainty),
            violation: number(|own| own.violation),
            dual_residual: number(|own| own.dual_residual),
            dual_violation: number(|own| own.dual_violation),
            certificate_residual: residual.filter(|residual| residual.is_finite()),
            excluded_radius: radius.map(|radius| radius.min(f64::MAX)),
            unbounded_proved: descent.as_ref().map(|own| own.proved),
            unknowns: problem.cost.len(),
            cones: problem.cones.len(),
            widest_cone: problem.widest(),
            iterations: found.solution.iterations,
            read_seconds,
            solve_seconds: solver_runs.iter().map(|run| run.seconds).sum(),
            schur_seconds: found.timings.map(|timings| timings.schur),
            linear_seconds: found.timings.map(|timings| timings.linear),
            solver_runs,
            judgement,
            timings: found.timings,
        }
    }

    /// In words.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "problem: {} unknowns, {} cones, the widest of side {} (read in {:.3} s)",
            self.unknowns, self.cones, self.widest_cone, self.read_seconds
        )];
        lines.extend(self.solver_runs.iter().map(RunReport::line));
        lines.extend(self.timings.map(|timings| {
            format!(
                "time: {:.3} s Schur complement, {:.3} s linear systems, {:.3} s the rest",
                timings.schur, timings.linear, timings.rest
            )
        }));
        lines.push(self.status_line());
        lines.extend(self.judgement.residuals.iter().flat_map(residual_lines));
        lines
    }

    fn status_line(&self) -> String {
        let judgement = self.judgement;
        let claim = match (&judgement.refutation, &judgement.descent) {
            (Some(own), _) if own.exclusion.radius == f64::INFINITY => format!(
                ": certificate with residual {:.1e}; proved: no point satisfies the conditions",
                own.residual
            ),
            (Some(own), _) if own.exclusion.radius > 0.0 => format!(
                ": certificate with residual {:.1e}; proved: no point with every unknown below {:.2} in size \
                 satisfies the conditions",
                own.residual,
                Claim::AtLeast(own.exclusion.radius)
            ),
            (Some(own), _) => format!(
                ": the solver claims that no point satisfies the conditions, but its certificate (residual {:.1e}) \
                 proves nothing",
                own.residual
            ),
            (None, Some(own)) if own.proved => format!(
                ": direction with residual {:.1e}; proved: there are points that satisfy the conditions, with \
                 objectives below any bound",
                own.residual
            ),
            (None, Some(own)) => format!(
                ": direction along which the objective falls, with residual {:.1e}; not proved, and whether any point \
                 satisfies the conditions is not decided",
                own.residual
            ),
            (None, None) => match self.solver_runs.len() {
                _ if judgement.outcome != Outcome::Failed => String::new(),
                1 => ": the solver stopped without a usable point".to_string(),
                _ => ": no solver found a usable point; this is the better one".to_string(),
            },
        };
        format!("{}{claim}", self.status)
    }
}

fn residual_lines(residuals: &Residuals) -> Vec<String> {
    vec![
        format!("objective: {:.10e}", residuals.objective),
        format!("dual objective: {:.10e}", residuals.dual_objective),
        format!(
            "relative gap: {:.2e}, uncertainty of the objective: {:.2e} (estimate)",
            residuals.relative_gap, residuals.uncertainty
        ),
        format!("violation of the conditions: {:.2e}", residuals.violation),
        format!(
            "dual residual: {:.2e}, violation of the dual conditions: {:.2e}",
            residuals.dual_residual, residuals.dual_violation
        ),
    ]
}
