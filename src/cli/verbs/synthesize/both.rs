//! Designs with two certificates: `synthesize --objective both`, and how they are reported.

use std::process::ExitCode;

use serde_json::{json, Value};
use synth::design::SolverRun;
use synth::synthesis::{synthesize_both, BothOutcome, Outcome, Tried};

use super::args::SynthesizeArgs;
use super::reporting::{describe_run, Reporting};
use crate::cli::answer::{print, EXIT_NO, EXIT_SOLVER};
use crate::cli::error::{solver_problem, CliError};
use crate::cli::progress::SolverProgress;
use crate::cli::show::feasibility;

/// Designs, writes and proves both certificates. 0: proved; 2: none found or not proved; 3: the solver
/// failed.
pub fn synthesize(
    args: &SynthesizeArgs,
    reporting: &Reporting,
    text: &str,
) -> Result<ExitCode, CliError> {
    if args.cross_check {
        let reason =
            "--cross-check compares designs with one certificate; with --objective both it \
                      has no meaning";
        return Err(CliError::unsuitable(&args.model, reason));
    }
    let progress = SolverProgress::start("assembling the conditions");
    let observer = Some(progress.observer());
    let backend = args.solver.backend_for(reporting.form);
    let found = synthesize_both(
        reporting.model,
        text,
        reporting.form,
        backend.as_ref(),
        observer,
    );
    drop(progress);
    match found.map_err(|error| solver_problem(&args.model, error))? {
        BothOutcome::Solved(design, _) => reporting.report(Outcome::Solved(design)),
        BothOutcome::None {
            infeasible,
            tried,
            blocking,
            runs,
        } => {
            print_none(reporting, infeasible, &tried, &blocking, &runs);
            Ok(ExitCode::from(match infeasible {
                true => EXIT_NO,
                false => EXIT_SOLVER,
            }))
        }
    }
}

fn print_none(
    reporting: &Reporting,
    infeasible: bool,
    tried: &[Tried],
    blocking: &[(String, f64)],
    runs: &[SolverRun],
) {
    let status = if infeasible { "undecided" } else { "failed" };
    if reporting.json {
        let shares = blocking.iter();
        let shares: Vec<Value> = shares
            .map(|(name, fraction)| json!({ "name": name, "share": fraction }))
            .collect();
        let report = json!({
            "status": status,
            "verdict": "not_proved",
            "gamma": null,
            "guaranteed_gain": null,
            "xi": null,
            "form": reporting.form.name(),
            "vertices": reporting.model.task().system.vertices.len(),
            "conditions": [],
            "certified_angle_deg": null,
            "outer": null,
            "feasibility": "undecided",
            "blocking": shares,
            "attempts": tried.len(),
            "solve_seconds": runs.iter().map(|run| run.seconds).sum::<f64>(),
            "solver_runs": runs,
        });
        print(&report.to_string());
        return;
    }
    let model = reporting.model_path.display();
    print(&match infeasible {
        true => format!(
            "{model}: UNDECIDED: no design with both certificates was found, and none was proved not to exist"
        ),
        false => format!("{model}: the solvers failed numerically"),
    });
    runs.iter().for_each(|run| print(&describe_run(run)));
    for line in feasibility::blocking_lines(blocking) {
        print(&line);
    }
    print("nothing written");
}
