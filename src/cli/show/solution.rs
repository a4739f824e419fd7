//! The solution of a semidefinite program.

use serde::Serialize;
use synth::certify::exclusion::Exclusion;
use synth::lmi::Semidefinite;
use synth::solve::{residuals, Residuals, Solution, Status, Timings};

use crate::cli::answer::Exit;

/// A program that a solver was given, and what came of it.
pub struct Solved<'a> {
    /// The solver's name and version.
    pub solver: String,
    /// The program.
    pub problem: &'a Semidefinite,
    /// What it returned.
    pub solution: &'a Solution,
    /// What its dual matrices exclude, where it says that there is no point.
    pub exclusion: Option<Exclusion>,
    /// What the time went to, where it is known.
    pub timings: Option<Timings>,
    /// Time to read the file (s).
    pub read_seconds: f64,
}

/// The same as keys.
#[derive(Serialize)]
pub struct SolutionReport<'a> {
    /// `solved`, `inaccurate`, `infeasible`, `unbounded` or `failed`.
    status: &'static str,
    /// Name and version.
    solver: &'a str,
    /// The solver's own word.
    solver_status: &'a str,
    /// c'x; null, as the five next, when infeasible or unbounded.
    objective: Option<f64>,
    /// That of the dual.
    dual_objective: Option<f64>,
    /// Their distance.
    relative_gap: Option<f64>,
    /// Smallest eigenvalue of the conditions, negated, relative to 1 plus the largest constant.
    violation: Option<f64>,
    /// Residual of the dual's equations, relative to 1 plus the largest cost.
    dual_residual: Option<f64>,
    /// Smallest eigenvalue of the dual matrices, negated, relative to 1 plus the largest cost.
    dual_violation: Option<f64>,
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
    /// Time in the solver (s).
    solve_seconds: f64,
    /// Time in the Schur complement (s); null with Clarabel.
    schur_seconds: Option<f64>,
    /// Time in linear systems (s); null with Clarabel.
    linear_seconds: Option<f64>,
    /// When infeasible: no point with every unknown below this in size satisfies the conditions, proved; 0 when
    /// nothing is proved.
    excluded_radius: Option<f64>,
    /// How well the numbers solve the program; `None` when infeasible or unbounded.
    #[serde(skip)]
    residuals: Option<Residuals>,
    /// Where it all comes from.
    #[serde(skip)]
    solved: &'a Solved<'a>,
}

/// Yes when it is solved.
pub fn exit(status: Status) -> Exit {
    match status {
        Status::Solved | Status::Inaccurate => Exit::Yes,
        Status::Infeasible | Status::Unbounded => Exit::No,
        Status::Failed | Status::Cancelled => Exit::SolverFailed,
    }
}

fn word(status: Status) -> &'static str {
    match status {
        Status::Solved => "solved",
        Status::Inaccurate => "inaccurate",
        Status::Infeasible => "infeasible",
        Status::Unbounded => "unbounded",
        Status::Failed | Status::Cancelled => "failed",
    }
}

impl<'a> SolutionReport<'a> {
    /// From what a solver returned; the residuals are computed from its numbers.
    pub fn new(solved: &'a Solved<'a>) -> Self {
        let (problem, solution) = (solved.problem, solved.solution);
        let found = exit(solution.status) != Exit::No;
        let residuals = found.then(|| residuals(problem, solution));
        let number = |read: fn(&Residuals) -> f64| residuals.as_ref().map(read);
        let exclusion = solved.exclusion.as_ref();
        SolutionReport {
            status: word(solution.status),
            solver: &solved.solver,
            solver_status: &solution.status_text,
            objective: number(|own| own.objective),
            dual_objective: number(|own| own.dual_objective),
            relative_gap: number(|own| own.relative_gap),
            violation: number(|own| own.violation),
            dual_residual: number(|own| own.dual_residual),
            dual_violation: number(|own| own.dual_violation),
            unknowns: problem.cost.len(),
            cones: problem.cones.len(),
            widest_cone: problem
                .cones
                .iter()
                .map(|cone| cone.side)
                .max()
                .unwrap_or(0),
            iterations: solution.iterations,
            read_seconds: solved.read_seconds,
            solve_seconds: solution.seconds,
            schur_seconds: solved.timings.map(|timings| timings.schur),
            linear_seconds: solved.timings.map(|timings| timings.linear),
            excluded_radius: exclusion.map(|exclusion| exclusion.radius.min(f64::MAX)),
            residuals,
            solved,
        }
    }

    /// In words.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![
            format!(
                "problem: {} unknowns, {} cones, the widest of side {}",
                self.unknowns, self.cones, self.widest_cone
            ),
            format!(
                "{}: {} after {} iterations, {:.3} s (read in {:.3} s)",
                self.solver,
                self.solver_status,
                self.iterations,
                self.solve_seconds,
                self.read_seconds
            ),
        ];
        lines.extend(self.solved.timings.map(|timings| {
            format!(
                "time: {:.3} s Schur complement, {:.3} s linear systems, {:.3} s the rest",
                timings.schur, timings.linear, timings.rest
            )
        }));
        lines.extend(match &self.residuals {
            Some(residuals) => residual_lines(residuals),
            None => no_point_lines(self.solved),
        });
        lines
    }
}

fn residual_lines(residuals: &Residuals) -> Vec<String> {
    vec![
        format!("objective: {:.10e}", residuals.objective),
        format!("dual objective: {:.10e}", residuals.dual_objective),
        format!("relative gap: {:.2e}", residuals.relative_gap),
        format!("violation of the conditions: {:.2e}", residuals.violation),
        format!(
            "dual residual: {:.2e}, violation of the dual conditions: {:.2e}",
            residuals.dual_residual, residuals.dual_violation
        ),
    ]
}

fn no_point_lines(solved: &Solved) -> Vec<String> {
    let what = match solved.solution.status {
        Status::Infeasible => "no point satisfies the conditions (solver status, unverified)",
        _ => "the objective has no lower bound (solver status, unverified)",
    };
    let proved = solved.exclusion.as_ref().map(|exclusion| {
        match exclusion.radius > 0.0 {
            true => format!(
                "proved from its dual matrices: no point with every unknown below {:.1e} in size does",
                exclusion.radius
            ),
            false => "not proved from its dual matrices".to_string(),
        }
    });
    [what.to_string()].into_iter().chain(proved).collect()
}
