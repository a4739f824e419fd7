//! The smallest gamma from both solvers.

use synth::model::Model;
use synth::synthesis::{cross_check, CrossCheck, Form, SynthesisError, Synthesized};

use crate::cli::error::CliError;
use crate::cli::progress::SolverProgress;
use crate::cli::solver::SolverArg;

/// The smallest gamma from both solvers, each with the form it is fastest with.
pub fn run(
    solver: SolverArg,
    (model, form): (&Model, Form),
    design: &Synthesized,
) -> Result<CrossCheck, CliError> {
    let progress = SolverProgress::start("cross-check");
    let observer = progress.observer();
    let other = solver.other();
    let backends = [solver.backend_for(form), other.backend_for(other.form())];
    let candidates = [
        (backends[0].as_ref(), form),
        (backends[1].as_ref(), other.form()),
    ];
    let units = design.file.provenance.problem;
    let checked = cross_check(model, units, candidates, Some(&observer));
    checked.map_err(|error| CliError::from(SynthesisError::from(error)))
}
