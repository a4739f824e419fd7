//! `steadfast solve FILE.dat-s`

use std::path::PathBuf;
use std::time::Instant;

use synth::certify::exclusion::exclude;
use synth::lmi::Semidefinite;
use synth::model::read_text_up_to;
use synth::solve::{Accuracy, SolveError, Solver, Status, Structured};

use crate::cli::answer::Answer;
use crate::cli::error::CliError;
use crate::cli::progress::watched;
use crate::cli::show::solution::{exit, SolutionReport};
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
    pub(super) json: bool,
}

/// Reads and solves. 0: solved; 2: infeasible or unbounded; 3: the solver failed.
pub fn run(args: &SolveArgs) -> Result<Answer, CliError> {
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
    let solvers = args
        .solver
        .solvers([Solver::Structured, Solver::Clarabel], None);
    let (backend, _) = solvers.first();
    let solved: Result<_, SolveError> = watched("starting", |observer| match args.solver {
        SolverArg::Auto | SolverArg::Structured => Structured::default()
            .solve_timed(&problem, accuracy, Some(observer))
            .map(|(solution, timings)| (solution, Some(timings))),
        SolverArg::Clarabel => {
            let solved = backend.solve(&problem, accuracy, Some(observer));
            solved.map(|solution| (solution, None))
        }
    });
    let (solution, timings) = solved.map_err(|error| CliError::unsuitable(&args.file, error))?;
    if solution.status == Status::Cancelled {
        return Err(CliError::Interrupted);
    }
    let infeasible = solution.status == Status::Infeasible;
    let excluded = infeasible.then(|| exclude(&problem, &solution.duals));
    let found = (&solution, timings);
    let name = backend.name();
    let report = SolutionReport::new(name, &problem, found, excluded.as_ref(), read_seconds);
    Ok(Answer::new(exit(solution.status), &report, &report.lines()))
}
