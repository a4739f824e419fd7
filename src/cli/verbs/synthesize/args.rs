//! Arguments of `synthesize`.

use std::path::PathBuf;

use clap::ValueEnum;
use synth::synthesis::Form;

use crate::cli::solver::{FormArg, SolverArg};

/// Arguments of `synthesize`.
#[derive(clap::Args)]
pub struct SynthesizeArgs {
    /// Model or problem file
    pub(super) model: PathBuf,
    /// Design file to write
    #[arg(short, long)]
    pub(super) output: Option<PathBuf>,
    /// What to optimise, in place of the model's own objective
    #[arg(long)]
    pub(super) objective: Option<ObjectiveArg>,
    /// Form of the decrease condition; by default chordal for clarabel, vertex-relaxed for structured
    #[arg(long)]
    pub(super) form: Option<FormArg>,
    /// Solver
    #[arg(long, default_value = "clarabel")]
    pub(super) solver: SolverArg,
    /// Minimise gamma with both solvers at the end and report the difference
    #[arg(long)]
    pub(super) cross_check: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(in crate::cli::verbs) json: bool,
}

impl SynthesizeArgs {
    pub(super) fn form(&self) -> Form {
        self.form.map_or(self.solver.form(), Form::from)
    }

    /// An option given that says nothing about a problem file.
    pub(super) fn option_without_use(&self) -> Option<&'static str> {
        match (self.form, self.objective, self.cross_check) {
            (Some(_), _, _) => Some("--form"),
            (None, Some(_), _) => Some("--objective"),
            (None, None, true) => Some("--cross-check"),
            (None, None, false) => None,
        }
    }
}

/// What to optimise.
#[derive(Clone, Copy, ValueEnum)]
pub enum ObjectiveArg {
    /// The smallest L-infinity gain bound
    Gain,
    /// One gain, two certificates: the smallest gain bound near the origin while the set of the model's
    /// specs.outer is certified too
    Both,
    /// The largest certified set along the must-contain states, or of attitudes at rest
    Region,
}
