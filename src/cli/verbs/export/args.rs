//! Arguments of `export`.

use std::path::PathBuf;

use clap::ValueEnum;

use crate::cli::solver::FormArg;

/// Arguments of `export`.
#[derive(clap::Args)]
pub struct ExportArgs {
    /// Design file, trajectory.csv, or folder written by `simulate -o`; for sdpa a model, problem or
    /// design file
    pub(super) file: PathBuf,
    /// Format to write
    #[arg(long)]
    pub(super) format: FormatArg,
    /// Form of the decrease condition, for sdpa; a design's own by default, chordal for a model
    #[arg(long)]
    pub(super) form: Option<FormArg>,
    /// File to write; standard output when left out, for text
    #[arg(short, long)]
    pub(super) output: Option<PathBuf>,
}

/// Formats.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FormatArg {
    /// SDPA sparse text (.dat-s): the first problem that synthesis solves, in its scaled units; the
    /// optimum is gamma
    Sdpa,
    /// Comma-separated values, of a design or a trajectory
    Csv,
    /// Apache Parquet, of a trajectory
    Parquet,
    /// MAT-file for MATLAB, Octave and scipy, of a design or a trajectory
    Mat,
    /// C header of static const tables, of a design
    C,
}

impl FormatArg {
    pub(super) fn name(self) -> &'static str {
        match self {
            FormatArg::Sdpa => "sdpa",
            FormatArg::Csv => "csv",
            FormatArg::Parquet => "parquet",
            FormatArg::Mat => "mat",
            FormatArg::C => "c",
        }
    }
}

/// What was put together: the bytes, and why the answer is no where it is.
pub(crate) struct Exported {
    pub(super) bytes: Vec<u8>,
    pub(super) not_proved: Option<String>,
}
