//! `steadfast feasibility MODEL.json`

use std::path::{Path, PathBuf};
use std::time::Instant;

use synth::feasibility::{self, decide, relaxations, Decision};
use synth::model::Model;
use synth::synthesis::solver_order;

use crate::cli::answer::{note, Answer};
use crate::cli::contents::DECISION;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics::{of_model, warn};
use crate::cli::progress::{ahead, solve, ASSEMBLING};
use crate::cli::show::facts::written_or_nothing;
use crate::cli::show::feasibility::FeasibilityReport;
use crate::cli::show::infeasibility::Existence;
use crate::cli::solver::SolverArg;
use crate::cli::target::Targets;

/// Arguments of `feasibility`.
#[derive(clap::Args)]
pub struct FeasibilityArgs {
    /// Model file
    model: PathBuf,
    /// File to write: a design when one exists, an infeasibility certificate when none does
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
    /// Do not search for the requirement whose relaxation makes an infeasible model feasible
    #[arg(long)]
    no_relaxations: bool,
    /// Which solvers may be asked
    #[arg(long, default_value = "auto")]
    solver: SolverArg,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Says whether a design exists. 0: proved that one does; 2: proved that none does, or unknown.
pub fn run(args: &FeasibilityArgs) -> Result<Answer, CliError> {
    let (text, model) = files::load(&args.model, Model::from_json)?;
    let targets = Targets {
        inputs: &[&args.model],
        force: args.force,
    };
    targets.check_file(args.output.as_deref(), DECISION)?;
    if model.file.specs.outer.is_some() {
        note("note: the answer is about the model's own box and requirements; specs.outer is not part of it");
    }
    warn(&of_model(&model, &text));
    let solvers = args.solver.solvers(solver_order(&model), None);
    let start = Instant::now();
    let decision = solve(&args.model, ASSEMBLING, |observer| {
        decide(&model, &text, &solvers, observer)
    })?;
    let mut report = FeasibilityReport::new(&decision, start.elapsed().as_secs_f64());
    let output = args.output.as_deref();
    let kept = output.map(|path| write(path, &decision)).transpose()?;
    let infeasible = matches!(decision.answer, feasibility::Answer::Infeasible(_));
    if infeasible && !args.no_relaxations {
        // What follows takes longer than the verdict.
        ahead(&report.headline(&args.model));
        let what = "relaxing one requirement after the other";
        let relaxed = solve(&args.model, what, |observer| {
            relaxations(&model, &solvers, observer)
        })?;
        report.relaxations = Some(relaxed);
    }
    let lines = report.lines(&args.model, kept.map(written_or_nothing));
    Ok(Answer::new(report.exit(), &report, &lines))
}

/// Writes the file that proves the answer; `None` where nothing is proved.
fn write<'a>(path: &'a Path, decision: &Decision) -> Result<Option<&'a Path>, CliError> {
    let text = match &decision.answer {
        feasibility::Answer::Feasible(design) => Some(design.file.to_json()),
        answer => Existence::of(answer)
            .certificate
            .map(|proof| proof.to_json()),
    };
    text.map(|text| files::write(path, &text).map(|()| path))
        .transpose()
}
