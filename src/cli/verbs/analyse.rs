//! `steadfast analyse GAINS.json --model MODEL.json`

use std::path::PathBuf;

use synth::held_command::CommandRequest;
use synth::model::{GainsFile, GivenTrigger, Kind, Model};
use synth::synthesis::{self, solver_order};

use super::held_command;
use super::synthesize::conclude::Conclusion;
use crate::cli::answer::Answer;
use crate::cli::contents::{Contents, DECISION};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics::{of_model, warn};
use crate::cli::progress::{solve, ASSEMBLING};
use crate::cli::solver::SolverArg;
use crate::cli::target::Targets;

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
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
    /// Which solvers may be asked
    #[arg(long, default_value = "auto")]
    solver: SolverArg,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Seeks the best proof for the gains. 0: proved; 2: infeasible or not proved; 3: the solver failed.
pub fn run(args: &AnalyseArgs) -> Result<Answer, CliError> {
    let (gains_text, gains) = files::load(&args.gains, GainsFile::from_json)?;
    let (text, model) = files::load(&args.model, Model::from_json)?;
    let (states, inputs, _, _) = model.plant.sizes();
    gains
        .check_size(inputs, states)
        .map_err(|problem| CliError::value(&args.gains, problem))?;
    let targets = Targets {
        inputs: &[&args.model, &args.gains],
        force: args.force,
    };
    let kind = match gains.trigger {
        Some(_) => Contents::Document(&[Kind::HeldCommandDesign]),
        None => DECISION,
    };
    targets.check_file(args.output.as_deref(), kind)?;
    warn(&of_model(&model, &text));
    if let Some(GivenTrigger::Command(trigger)) = gains.trigger {
        let request = CommandRequest {
            model: &model,
            model_text: &text,
            gain: &gains.gains[0],
            trigger,
            gains_text: &gains_text,
        };
        let how = (args.output.as_deref(), args.solver);
        return held_command::analyse(&args.model, &request, how);
    }
    let solvers = args.solver.solvers(solver_order(&model), None);
    let outcome = solve(&args.model, ASSEMBLING, |observer| {
        synthesis::analyse(&model, &text, &gains.gains, &gains_text, &solvers, observer)
    })?;
    let conclusion = Conclusion {
        model_path: &args.model,
        model: &model,
        output: args.output.as_deref(),
        form: solvers.first().1,
        only: args.solver.only(),
        cross_check: None,
        what: "proof for these gains",
        keeps_refutation: true,
    };
    conclusion.answer(outcome)
}
