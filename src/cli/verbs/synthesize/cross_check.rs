//! The smallest gamma from both solvers.

use serde_json::{json, Value};
use synth::model::Model;
use synth::synthesis::{cross_check, Candidate, CrossCheck, Form, SynthesisError, Synthesized};

use crate::cli::answer::print;
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
        Candidate {
            backend: backends[0].as_ref(),
            form,
        },
        Candidate {
            backend: backends[1].as_ref(),
            form: other.form(),
        },
    ];
    let units = design.file.provenance.problem;
    let checked = cross_check(model, units, candidates, Some(&observer));
    checked.map_err(|error| CliError::from(SynthesisError::from(error)))
}

/// The comparison as JSON.
pub fn json(check: &CrossCheck) -> Value {
    let found = check.found.iter().map(|found| {
        json!({
            "solver": found.solver,
            "status": found.status,
            "gamma": found.gamma,
            "seconds": found.seconds,
        })
    });
    json!({
        "found": found.collect::<Vec<_>>(),
        "relative_difference": check.relative_difference,
    })
}

/// The comparison as text.
pub fn print_lines(check: &CrossCheck) {
    for found in &check.found {
        let gamma = found
            .gamma
            .map_or("none".to_string(), |gamma| format!("{gamma:.9}"));
        print(&format!(
            "cross-check: {}: smallest gamma {gamma}, {} in {:.2} s",
            found.solver, found.status, found.seconds
        ));
    }
    match check.relative_difference {
        Some(difference) => print(&format!(
            "cross-check: relative difference {difference:.1e}"
        )),
        None => print("cross-check: one of the solvers found no gamma"),
    }
}
