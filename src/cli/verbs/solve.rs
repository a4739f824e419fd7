//! `steadfast solve FILE.dat-s`

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use serde_json::json;
use synth::certify::exclusion::{exclude, Exclusion};
use synth::lmi::Semidefinite;
use synth::model::read_text_up_to;
use synth::solve::{
    residuals, Accuracy, Residuals, Solution, SolveError, Status, Structured, Timings,
};

use crate::cli::answer::{print, EXIT_NO, EXIT_SOLVER};
use crate::cli::error::CliError;
use crate::cli::progress::SolverProgress;
use crate::cli::solver::SolverArg;

/// Largest file read (bytes): semidefinite programs are longer than models.
const MAX_FILE_BYTES: u64 = 512 << 20;

/// Relative gap asked for.
const RELATIVE_GAP: f64 = 1e-7;

/// Arguments of `solve`.
#[derive(clap::Args)]
pub struct SolveArgs {
    /// SDPA sparse file (.dat-s)
    file: PathBuf,
    /// Solver
    #[arg(long, default_value = "structured")]
    solver: SolverArg,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// What is told.
struct Told<'a> {
    args: &'a SolveArgs,
    solver: String,
    problem: &'a Semidefinite,
    solution: &'a Solution,
    residuals: Residuals,
    exclusion: Option<Exclusion>,
    timings: Option<Timings>,
    read_seconds: f64,
}

/// Reads and solves. 0: solved; 2: infeasible or unbounded; 3: the solver failed.
pub fn run(args: &SolveArgs) -> Result<ExitCode, CliError> {
    let begin = Instant::now();
    let text = read_text_up_to(&args.file, MAX_FILE_BYTES)
        .map_err(|problem| CliError::file(&args.file, problem))?;
    let problem =
        Semidefinite::from_sdpa(&text).map_err(|error| CliError::unsuitable(&args.file, error))?;
    let read_seconds = begin.elapsed().as_secs_f64();
    let accuracy = Accuracy {
        relative_gap: RELATIVE_GAP,
        objective_unit: 1.0,
    };
    let progress = SolverProgress::start("starting");
    let observer = Some(progress.observer());
    let backend = args.solver.backend();
    let solved: Result<_, SolveError> = match args.solver {
        SolverArg::Structured => Structured::default()
            .solve_timed(&problem, accuracy, observer)
            .map(|(solution, timings)| (solution, Some(timings))),
        SolverArg::Clarabel => {
            let solved = backend.solve(&problem, accuracy, observer);
            solved.map(|solution| (solution, None))
        }
    };
    drop(progress);
    let (solution, timings) = solved.map_err(|error| CliError::unsuitable(&args.file, error))?;
    if solution.status == Status::Cancelled {
        return Err(CliError::Interrupted);
    }
    Told {
        args,
        solver: backend.name(),
        problem: &problem,
        residuals: residuals(&problem, &solution),
        exclusion: match solution.status {
            Status::Infeasible => Some(exclude(&problem, &solution.duals)),
            _ => None,
        },
        timings,
        solution: &solution,
        read_seconds,
    }
    .report();
    Ok(match solution.status {
        Status::Solved | Status::Inaccurate => ExitCode::SUCCESS,
        Status::Infeasible | Status::Unbounded => ExitCode::from(EXIT_NO),
        Status::Failed | Status::Cancelled => ExitCode::from(EXIT_SOLVER),
    })
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

impl Told<'_> {
    fn report(&self) {
        let (solution, residuals) = (self.solution, &self.residuals);
        let found = matches!(
            solution.status,
            Status::Solved | Status::Inaccurate | Status::Failed
        );
        let sides = self.problem.cones.iter().map(|cone| cone.side);
        let widest = sides.max().unwrap_or(0);
        if self.args.json {
            let number = |value: f64| if found { json!(value) } else { json!(null) };
            print(
                &json!({
                    "status": word(solution.status),
                    "solver": self.solver,
                    "solver_status": solution.status_text,
                    "objective": number(residuals.objective),
                    "dual_objective": number(residuals.dual_objective),
                    "relative_gap": number(residuals.relative_gap),
                    "violation": number(residuals.violation),
                    "dual_residual": number(residuals.dual_residual),
                    "dual_violation": number(residuals.dual_violation),
                    "unknowns": self.problem.cost.len(),
                    "cones": self.problem.cones.len(),
                    "widest_cone": widest,
                    "iterations": solution.iterations,
                    "read_seconds": self.read_seconds,
                    "solve_seconds": solution.seconds,
                    "schur_seconds": self.timings.map(|timings| timings.schur),
                    "linear_seconds": self.timings.map(|timings| timings.linear),
                    "excluded_radius": self.exclusion.as_ref().map(|e| e.radius.min(f64::MAX)),
                })
                .to_string(),
            );
            return;
        }
        print(&format!(
            "problem: {} unknowns, {} cones, the widest of side {widest}",
            self.problem.cost.len(),
            self.problem.cones.len()
        ));
        print(&format!(
            "{}: {} after {} iterations, {:.3} s (read in {:.3} s)",
            self.solver,
            solution.status_text,
            solution.iterations,
            solution.seconds,
            self.read_seconds
        ));
        if let Some(timings) = self.timings {
            print(&format!(
                "time: {:.3} s Schur complement, {:.3} s linear systems, {:.3} s the rest",
                timings.schur, timings.linear, timings.rest
            ));
        }
        if !found {
            let what = match solution.status {
                Status::Infeasible => "no point satisfies the conditions, says the solver",
                _ => "the objective has no lower bound, says the solver",
            };
            print(what);
            match &self.exclusion {
                Some(exclusion) if exclusion.radius > 0.0 => print(&format!(
                    "proved from its dual matrices: no point with every unknown below {:.1e} in size does",
                    exclusion.radius
                )),
                Some(_) => print("not proved from its dual matrices"),
                None => {}
            }
            return;
        }
        print(&format!("objective: {:.10e}", residuals.objective));
        print(&format!(
            "dual objective: {:.10e}",
            residuals.dual_objective
        ));
        print(&format!("relative gap: {:.2e}", residuals.relative_gap));
        print(&format!(
            "violation of the conditions: {:.2e}",
            residuals.violation
        ));
        print(&format!(
            "dual residual: {:.2e}, violation of the dual conditions: {:.2e}",
            residuals.dual_residual, residuals.dual_violation
        ));
    }
}
