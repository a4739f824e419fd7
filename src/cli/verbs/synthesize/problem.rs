//! What `synthesize` does for problem files.

use synth::certify::Verdict;
use synth::problem::{self, Problem, ProblemFailure, ProblemOutcome, ProblemSynthesized};

use super::args::SynthesizeArgs;
use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::progress::{solve, ASSEMBLING};
use crate::cli::show::problem::{headline, NoFeedbackReport, ProblemReport};
use crate::cli::show::solver::SolverStatus;
use crate::cli::show::written::{design_written, NOTHING};

/// Designs, writes and proves. 0: proved; 2: infeasible or not proved; 3: the solver failed.
pub fn synthesize(args: &SynthesizeArgs, text: &str) -> Result<Answer, CliError> {
    let problem = files::problem_of(&args.model, text)?;
    if let Some(option) = args.option_without_use() {
        let reason = format!(
            "this is a problem file ({}), for which {option} has no meaning",
            problem.task.name()
        );
        return Err(CliError::unsuitable(&args.model, reason));
    }
    if let Some(output) = &args.output {
        files::check_output(output, &args.model)?;
    }
    let backend = args.solver.backend();
    let outcome = solve(&args.model, ASSEMBLING, |observer| {
        problem::synthesize(&problem, text, backend.as_ref(), observer)
    })?;
    match outcome {
        ProblemOutcome::Solved(design) => found(args, &problem, &design),
        ProblemOutcome::Infeasible(failure) => {
            Ok(none(&problem, &failure, SolverStatus::Infeasible))
        }
        ProblemOutcome::Undecided(failure) => Ok(none(&problem, &failure, SolverStatus::Undecided)),
        ProblemOutcome::SolverFailed(failure) => Ok(none(&problem, &failure, SolverStatus::Failed)),
    }
}

fn found(
    args: &SynthesizeArgs,
    problem: &Problem,
    design: &ProblemSynthesized,
) -> Result<Answer, CliError> {
    let mut checked = design.report.clone();
    let kept = args.output.as_deref();
    let kept = kept.filter(|_| checked.verdict == Verdict::Proved);
    if let Some(path) = kept {
        files::write(path, &design.file.to_json())?;
        // What counts is what a reader of the file gets.
        let (file, problem) = files::problem_design_of(path, &files::text(path)?)?;
        let again = file.verify(&problem);
        checked = again.map_err(|fault| CliError::value(path, fault))?;
    }
    let report = ProblemReport::synthesized(problem, design, &checked);
    let mut lines = vec![headline(problem)];
    lines.extend(report.lines());
    lines.push(design_written(kept, checked.verdict));
    Ok(Answer::new(Exit::from(checked.verdict), &report, &lines))
}

fn none(problem: &Problem, failure: &ProblemFailure, status: SolverStatus) -> Answer {
    let report = NoFeedbackReport::new(problem, failure, status);
    let mut lines = vec![headline(problem)];
    lines.extend(report.lines());
    lines.push(NOTHING.to_string());
    Answer::new(status.exit_without_design(), &report, &lines)
}
