//! `steadfast synthesize MODEL.json`

pub mod args;
pub mod conclude;
pub mod cross_check;
pub mod problem;

use std::path::Path;

use synth::model::{kind_of, Kind, Model, Objective};
use synth::synthesis;

use args::{ObjectiveArg, SynthesizeArgs};
use conclude::Conclusion;

use crate::cli::answer::Answer;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::progress::{solve, ASSEMBLING};

/// Designs, writes and proves. 0: proved; 2: infeasible or not proved; 3: the solver failed.
pub fn run(args: &SynthesizeArgs) -> Result<Answer, CliError> {
    let text = files::text(&args.model)?;
    if kind_of(&text) == Some(Kind::Problem) {
        return problem::synthesize(args, &text);
    }
    let mut model = files::model_of(&args.model, &text)?;
    if let Some(objective) = args.objective {
        model = with_objective(model, objective, &args.model)?;
    }
    if let Some(output) = &args.output {
        files::check_output(output, &args.model)?;
    }
    let form = args.form();
    let both = model.file.specs.objective == Objective::Both;
    if both && args.cross_check {
        let reason =
            "--cross-check compares designs with one certificate; with --objective both it \
                      has no meaning";
        return Err(CliError::unsuitable(&args.model, reason));
    }
    let conclusion = Conclusion {
        model_path: &args.model,
        model: &model,
        output: args.output.as_deref(),
        form,
        cross_check: args.cross_check.then_some(args.solver),
        what: match both {
            true => "design with both certificates",
            false => "design",
        },
        keeps_refutation: false,
    };
    let backend = args.solver.backend_for(form);
    let outcome = solve(&args.model, ASSEMBLING, |observer| {
        synthesis::synthesize(&model, &text, form, backend.as_ref(), observer)
    })?;
    conclusion.answer(outcome)
}

/// The model with the objective of the command line.
fn with_objective(model: Model, objective: ObjectiveArg, path: &Path) -> Result<Model, CliError> {
    let mut file = model.file;
    file.specs.objective = match objective {
        ObjectiveArg::Gain => Objective::Gain,
        ObjectiveArg::Region => Objective::Region,
        ObjectiveArg::Both => Objective::Both,
    };
    Model::new(file).map_err(|problem| CliError::value(path, problem))
}
