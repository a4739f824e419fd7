//! The solution of a semidefinite program.

use serde::Serialize;
use synth::certify::exclusion::Exclusion;
use synth::lmi::Semidefinite;
use synth::solve::{residuals, Residuals, Solution, Status, Timings};

use crate::cli::answer::Exit;

/// What a solver returned for a program, and how well it solves it.
#[derive(Serialize)]
pub struct SolutionReport<'a> {
    /// `solved`, `inaccurate`, `infeasible`, `unbounded` or `failed`.
    status: &'static str,
    /// Name and version.
    solver: String,
    /// The solver's status, unverified.
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
    /// The excluded radius, infinite where no bound is needed.
    #[serde(skip)]
    radius: Option<f64>,
    /// What the time went to, where it is known.
    #[serde(skip)]
    timings: Option<Timings>,
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
    /// From what a solver returned and how it spent its time, what its dual matrices exclude where it says that
    /// there is no point, and the time to read the file (s). The residuals are computed from the numbers.
    pub fn new(
        solver: String,
        problem: &Semidefinite,
        (solution, timings): (&'a Solution, Option<Timings>),
        exclusion: Option<&Exclusion>,
        read_seconds: f64,
    ) -> Self {
        let found = exit(solution.status) != Exit::No;
        let residuals = found.then(|| residuals(problem, solution));
        let number = |read: fn(&Residuals) -> f64| residuals.as_ref().map(read);
        let sides = problem.cones.iter().map(|cone| cone.side);
        SolutionReport {
            status: word(solution.status),
            solver,
            solver_status: &solution.status_text,
            objective: number(|own| own.objective),
            dual_objective: number(|own| own.dual_objective),
            relative_gap: number(|own| own.relative_gap),
            violation: number(|own| own.violation),
            dual_residual: number(|own| own.dual_residual),
            dual_violation: number(|own| own.dual_violation),
            unknowns: problem.cost.len(),
            cones: problem.cones.len(),
            widest_cone: sides.max().unwrap_or(0),
            iterations: solution.iterations,
            read_seconds,
            solve_seconds: solution.seconds,
            schur_seconds: timings.map(|timings| timings.schur),
            linear_seconds: timings.map(|timings| timings.linear),
            excluded_radius: exclusion.map(|exclusion| exclusion.radius.min(f64::MAX)),
            residuals,
            radius: exclusion.map(|exclusion| exclusion.radius),
            timings,
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
        lines.extend(self.timings.map(|timings| {
            format!(
                "time: {:.3} s Schur complement, {:.3} s linear systems, {:.3} s the rest",
                timings.schur, timings.linear, timings.rest
            )
        }));
        lines.extend(match &self.residuals {
            Some(residuals) => residual_lines(residuals),
            None => self.no_point_lines(),
        });
        lines
    }

    fn no_point_lines(&self) -> Vec<String> {
        let what = match self.status {
            "infeasible" => "no point satisfies the conditions (solver status, unverified)",
            _ => "the objective has no lower bound (solver status, unverified)",
        };
        let proved = self.radius.map(|radius| match radius > 0.0 {
            true => format!(
                "proved from its dual matrices: no point with every unknown below {radius:.1e} in size does"
            ),
            false => "not proved from its dual matrices".to_string(),
        });
        [what.to_string()].into_iter().chain(proved).collect()
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
