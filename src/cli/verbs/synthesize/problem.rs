//! What `synthesize` does for problem files.

use std::path::Path;

use synth::problem::{
    self, Problem, ProblemDesignFile, ProblemFailure, ProblemOutcome, ProblemSynthesized,
};

use super::conclude::keep;
use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::progress::{solve, ASSEMBLING};
use crate::cli::show::facts::{design_written, only_one_asked, SolverStatus, NOTHING};
use crate::cli::show::problem::{headline, NoFeedbackReport, ProblemReport};
use crate::cli::solver::SolverArg;

/// Designs, writes and proves. 0: proved; 2: infeasible or not proved; 3: the solver failed.
/// `unused` is an option given that says nothing about a problem.
pub fn synthesize(
    path: &Path,
    text: &str,
    (output, solver): (Option<&Path>, SolverArg),
    unused: Option<&str>,
) -> Result<Answer, CliError> {
    let problem = files::parse(path, text, Problem::from_json)?;
    if let Some(option) = unused {
        let reason = format!(
            "this is a problem file ({}), for which {option} has no meaning",
            problem.task.name()
        );
        return Err(CliError::unsuitable(path, reason));
    }
    let solvers = solver.solvers(problem::solver_order(&problem), None);
    let outcome = solve(path, ASSEMBLING, |observer| {
        problem::synthesize(&problem, text, &solvers, observer)
    })?;
    let none =
        |failure: ProblemFailure, status| Ok(none(&problem, &failure, status, solver.only()));
    match outcome {
        ProblemOutcome::Solved(design) => found(output, &problem, &design),
        ProblemOutcome::Infeasible(failure) => none(failure, SolverStatus::Infeasible),
        ProblemOutcome::Undecided(failure) => none(failure, SolverStatus::Undecided),
        ProblemOutcome::SolverFailed(failure) => none(failure, SolverStatus::Failed),
    }
}

fn found(
    output: Option<&Path>,
    problem: &Problem,
    design: &ProblemSynthesized,
) -> Result<Answer, CliError> {
    let again = |text: &str| {
        let (file, problem) = ProblemDesignFile::from_json(text)?;
        Ok(file.verify(&problem)?)
    };
    let json = || design.file.to_json();
    let (kept, checked) = keep(output, &design.report, json, again)?;
    let report = ProblemReport::synthesized(problem, design, &checked);
    let mut lines = vec![headline(problem)];
    lines.extend(report.lines());
    lines.push(design_written(kept, checked.verdict));
    let exit = match report.meets_requirements() {
        true => Exit::from(checked.verdict),
        false => Exit::No,
    };
    Ok(Answer::new(exit, &report, &lines))
}

fn none(
    problem: &Problem,
    failure: &ProblemFailure,
    status: SolverStatus,
    only: Option<&str>,
) -> Answer {
    let report = NoFeedbackReport::new(problem, failure, status);
    let mut lines = vec![headline(problem)];
    lines.extend(report.lines());
    let only = only.filter(|_| status != SolverStatus::Infeasible);
    lines.extend(only.map(only_one_asked));
    lines.push(NOTHING.to_string());
    Answer::new(status.exit_without_design(), &report, &lines)
}
