//! What `analyse` does for gains with a trigger on the command.

use std::path::Path;

use synth::held_command::{
    check_synthesized, synthesize, CommandRequest, HeldCommandDesignFile, HeldCommandOutcome,
    HeldCommandSynthesized,
};
use synth::solve::Solver;

use super::synthesize::conclude::keep;
use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::progress::{solve, ASSEMBLING};
use crate::cli::show::facts::{design_written, only_one_asked, NOTHING};
use crate::cli::show::held_command::{nothing_found, HeldCommandReport};
use crate::cli::solver::SolverArg;

/// Seeks the proof. 0: proved; 2: none found.
pub fn analyse(
    model_path: &Path,
    request: &CommandRequest,
    (output, solver): (Option<&Path>, SolverArg),
) -> Result<Answer, CliError> {
    check_synthesized(request.model).map_err(|problem| CliError::value(model_path, problem))?;
    let solvers = solver.solvers([Solver::Structured, Solver::Clarabel], None);
    let outcome = solve(model_path, ASSEMBLING, |observer| {
        synthesize(request, &solvers, observer)
    })?;
    let failure = match outcome {
        HeldCommandOutcome::Solved(design) => return found(model_path, output, request, &design),
        HeldCommandOutcome::Infeasible(failure)
        | HeldCommandOutcome::Undecided(failure)
        | HeldCommandOutcome::SolverFailed(failure) => failure,
    };
    let (report, mut lines) = nothing_found(&failure);
    lines.extend(solver.only().map(only_one_asked));
    lines.push(NOTHING.to_string());
    Ok(Answer::new(Exit::No, &report, &lines))
}

fn found(
    model_path: &Path,
    output: Option<&Path>,
    request: &CommandRequest,
    design: &HeldCommandSynthesized,
) -> Result<Answer, CliError> {
    let again = |text: &str| {
        let (_, proof) = HeldCommandDesignFile::from_json(text)?;
        Ok(proof.verify())
    };
    let json = || design.file.to_json();
    let (kept, checked) = keep(output, &design.report, json, again)?;
    let proof = design.file.proof(request.model);
    let proof = proof.map_err(|error| CliError::synthesis(model_path, error.into()))?;
    let report = HeldCommandReport::found(&proof, design, &checked);
    let mut lines = vec![format!("model: {}", design.file.name)];
    lines.extend(report.lines());
    lines.push(design_written(kept, checked.verdict));
    Ok(Answer::new(Exit::from(checked.verdict), &report, &lines))
}
