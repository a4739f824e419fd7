//! `steadfast solve FILE.dat-s`

use std::path::{Path, PathBuf};
use std::time::Instant;

use synth::lmi::{SdpaForm, Semidefinite};
use synth::solve::{attempts, best, Accuracy, Attempt, Outcome};

use crate::base::compressed::read_text;
use crate::cli::answer::Answer;
use crate::cli::error::CliError;
use crate::cli::progress::watched;
use crate::cli::show::solution::{exit, SolutionReport};
use crate::cli::solver::SolverArg;

/// Largest file read, and largest text of a compressed one (bytes): semidefinite programs are longer than models.
const MAX_FILE_BYTES: u64 = 512 << 20;

/// Relative gap asked for.
const RELATIVE_GAP: f64 = 1e-8;

/// Arguments of `solve`.
#[derive(clap::Args)]
pub struct SolveArgs {
    /// SDPA file: sparse (.dat-s) or dense (.dat), also compressed (.gz)
    file: PathBuf,
    /// Which solvers may be asked; auto asks Clarabel where the structured solver's numbers do not decide
    #[arg(long, default_value = "auto")]
    solver: SolverArg,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Reads and solves. 0: solved or inaccurate; 2: infeasible or unbounded; 3: the solvers failed.
pub fn run(args: &SolveArgs) -> Result<Answer, CliError> {
    let begin = Instant::now();
    let text = read_text(&args.file, MAX_FILE_BYTES)
        .map_err(|problem| CliError::file(&args.file, problem))?;
    let problem = Semidefinite::from_sdpa_form(&text, form(&args.file))
        .map_err(|error| CliError::unsuitable(&args.file, error))?;
    let read_seconds = begin.elapsed().as_secs_f64();
    let accuracy = Accuracy {
        relative_gap: RELATIVE_GAP,
        objective_unit: 1.0,
    };
    let tried = watched("starting", |observer| match args.solver.named() {
        Some(solver) => vec![Attempt::run(solver, &problem, accuracy, Some(observer))],
        None => attempts(&problem, accuracy, Some(observer)),
    });
    let Some((attempt, found)) = best(&tried) else {
        return Err(refused(&args.file, &tried));
    };
    if found.judgement.outcome == Outcome::Cancelled {
        return Err(CliError::Interrupted);
    }
    let report = SolutionReport::new(&problem, &tried, (attempt, found), read_seconds);
    let mut lines = report.lines();
    if args.solver != SolverArg::Auto && !attempt.decides() {
        lines.push(format!(
            "only {} was asked, as --solver says; --solver auto asks the other one too",
            attempt.name
        ));
    }
    Ok(Answer::new(exit(found.judgement.outcome), &report, &lines))
}

/// As the name says: `.dat` (also `.dat.gz`) is dense, anything else sparse.
fn form(file: &Path) -> SdpaForm {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let name = name.to_lowercase();
    match name.strip_suffix(".gz").unwrap_or(&name).ends_with(".dat") {
        true => SdpaForm::Dense,
        false => SdpaForm::Sparse,
    }
}

/// Why no solver could start.
fn refused(file: &Path, tried: &[Attempt]) -> CliError {
    let errors = tried
        .iter()
        .filter_map(|attempt| attempt.found.as_ref().err());
    let mut reasons: Vec<String> = errors.map(ToString::to_string).collect();
    reasons.dedup();
    CliError::unsuitable(file, reasons.join("; "))
}
