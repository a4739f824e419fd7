//! `steadfast synthesize MODEL.json`

pub mod conclude;
mod problem;
mod requirements;

use std::path::PathBuf;

use clap::ValueEnum;
use synth::model::{kind_of, Kind, Model, Objective};
use synth::synthesis::{self, solver_order, Form};

use conclude::Conclusion;

use crate::cli::answer::Answer;
use crate::cli::contents::Contents;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics::{of_model, warn};
use crate::cli::progress::{solve, ASSEMBLING};
use crate::cli::solver::{FormArg, SolverArg};
use crate::cli::target::Targets;

/// Arguments of `synthesize`.
#[derive(clap::Args)]
pub struct SynthesizeArgs {
    /// Model or problem file
    model: PathBuf,
    /// Design file to write
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
    /// What to optimise, in place of the model's own objective
    #[arg(long)]
    objective: Option<ObjectiveArg>,
    /// Form of the decrease condition; by default chordal for clarabel, vertex-relaxed for structured
    #[arg(long)]
    form: Option<FormArg>,
    /// Which solvers may be asked
    #[arg(long, default_value = "auto")]
    solver: SolverArg,
    /// Minimise gamma with both solvers at the end and report the difference
    #[arg(long)]
    cross_check: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// What to optimise.
#[derive(Clone, Copy, ValueEnum)]
enum ObjectiveArg {
    /// The smallest guaranteed L-infinity gain
    Gain,
    /// The smallest pointing error from rest and in the end
    Pointing,
    /// The smallest gamma of the paper, which bounds the gain and xi
    Gamma,
    /// One gain, two certificates: the smallest gain bound near the origin while the set of the model's
    /// specs.outer is certified too
    Both,
    /// The largest certified set along the must-contain states, or of attitudes at rest
    Region,
}

/// Designs, writes and proves. 0: proved; 2: infeasible or not proved; 3: the solver failed.
pub fn run(args: &SynthesizeArgs) -> Result<Answer, CliError> {
    let text = files::text(&args.model)?;
    let output = args.output.as_deref();
    let targets = Targets {
        inputs: &[&args.model],
        force: args.force,
    };
    // Options about the one problem of a model.
    let given = [
        (args.form.is_some(), "--form"),
        (args.objective.is_some(), "--objective"),
        (args.cross_check, "--cross-check"),
    ];
    let unused = given.into_iter().find(|(given, _)| *given);
    let unused = unused.map(|(_, option)| option);
    let how = (output, args.solver);
    match kind_of(&text) {
        Some(Kind::Problem) => {
            targets.check_file(output, Contents::Document(&[Kind::ProblemDesign]))?;
            return problem::synthesize(&args.model, &text, how, unused);
        }
        Some(Kind::Facts) => {
            targets.check_file(output, Contents::Document(&[Kind::Design]))?;
            return requirements::synthesize(&args.model, &text, how, unused);
        }
        _ => {}
    }
    let mut model = files::parse(&args.model, &text, Model::from_json)?;
    if let Some(objective) = args.objective {
        let mut file = model.file;
        file.specs.objective = match objective {
            ObjectiveArg::Gain => Objective::Gain,
            ObjectiveArg::Pointing => Objective::Pointing,
            ObjectiveArg::Gamma => Objective::Gamma,
            ObjectiveArg::Region => Objective::Region,
            ObjectiveArg::Both => Objective::Both,
        };
        model = Model::new(file).map_err(|problem| CliError::value(&args.model, problem))?;
    }
    targets.check_file(output, Contents::Document(&[Kind::Design]))?;
    warn(&of_model(&model, &text));
    let order = solver_order(&model);
    let solvers = args.solver.solvers(order, args.form.map(Form::from));
    let (_, form) = solvers.first();
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
        output,
        form,
        cross_check: args.cross_check.then_some(args.solver.first(order)),
        only: args.solver.only(),
        what: match both {
            true => "design with both certificates",
            false => "design",
        },
        keeps_refutation: false,
    };
    let outcome = solve(&args.model, ASSEMBLING, |observer| {
        synthesis::synthesize(&model, &text, &solvers, observer)
    })?;
    conclusion.answer(outcome)
}
