//! `steadfast synthesize MODEL.json`

pub mod args;
pub mod both;
pub mod cross_check;
pub mod problem;
pub mod reporting;

use std::path::Path;
use std::process::ExitCode;

use synth::model::{kind_of, Kind, Model, Objective};
use synth::synthesis::{self, Outcome};

use args::{ObjectiveArg, SynthesizeArgs};
use reporting::Reporting;

use crate::cli::error::{solver_problem, CliError};
use crate::cli::files;
use crate::cli::progress::SolverProgress;

/// Designs, writes and proves. 0: proved; 2: infeasible or not proved; 3: the solver failed.
pub fn run(args: &SynthesizeArgs) -> Result<ExitCode, CliError> {
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
    let reporting = Reporting {
        model_path: &args.model,
        model: &model,
        output: args.output.as_deref(),
        json: args.json,
        form: args.form(),
        cross_check: args.cross_check.then_some(args.solver),
        what: "design",
        keeps_refutation: false,
    };
    match model.file.specs.objective {
        Objective::Both => both::synthesize(args, &reporting, &text),
        Objective::Gain | Objective::Region => reporting.report(solve(args, &model, &text)?),
    }
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

fn solve(args: &SynthesizeArgs, model: &Model, text: &str) -> Result<Outcome, CliError> {
    let progress = SolverProgress::start("assembling the conditions");
    let observer = Some(progress.observer());
    let form = args.form();
    let backend = args.solver.backend_for(form);
    let found = synthesis::synthesize(model, text, form, backend.as_ref(), observer);
    found.map_err(|error| solver_problem(&args.model, error))
}
