//! `steadfast analyse GAINS.json --model MODEL.json`

use std::path::PathBuf;
use std::process::ExitCode;

use synth::synthesis;

use crate::cli::error::{solver_problem, CliError};
use crate::cli::files;
use crate::cli::progress::SolverProgress;
use crate::cli::solver::SolverArg;
use crate::cli::verbs::synthesize::reporting::Reporting;

/// Arguments of `analyse`.
#[derive(clap::Args)]
pub struct AnalyseArgs {
    /// Gains file
    gains: PathBuf,
    /// Model file
    #[arg(long)]
    model: PathBuf,
    /// File to write: the gains with their proof (a design), or the proof that there is none
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Solver
    #[arg(long, default_value = "clarabel")]
    solver: SolverArg,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Seeks the best proof for the gains. 0: proved; 2: infeasible or not proved; 3: the solver failed.
pub fn run(args: &AnalyseArgs) -> Result<ExitCode, CliError> {
    let gains_text = files::text(&args.gains)?;
    let gains = files::gains_of(&args.gains, &gains_text)?;
    let text = files::text(&args.model)?;
    let model = files::model_of(&args.model, &text)?;
    let (states, inputs, _, _) = model.plant.sizes();
    gains
        .check_size(inputs, states)
        .map_err(|problem| CliError::value(&args.gains, problem))?;
    if let Some(output) = &args.output {
        files::check_output(output, &args.model)?;
        files::check_output(output, &args.gains)?;
    }
    let progress = SolverProgress::start("assembling the conditions");
    let outcome = synthesis::analyse(
        &model,
        &text,
        &gains.gains,
        &gains_text,
        args.solver.form(),
        args.solver.backend().as_ref(),
        Some(progress.observer()),
    );
    let outcome = outcome.map_err(|error| solver_problem(&args.model, error))?;
    drop(progress);
    let reporting = Reporting {
        model_path: &args.model,
        model: &model,
        output: args.output.as_deref(),
        json: args.json,
        form: args.solver.form(),
        cross_check: None,
        what: "proof for these gains",
        keeps_refutation: true,
    };
    reporting.report(outcome)
}
