//! `steadfast export FILE --format FORMAT`

mod data;
mod sdpa;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::ValueEnum;

use super::synthesize::FormArg;
use super::{files, print, CliError};
use crate::harness::output::TRAJECTORY_FILE;

/// Arguments of `export`.
#[derive(clap::Args)]
pub struct ExportArgs {
    /// Design file, trajectory.csv, or folder written by `simulate -o`; for sdpa a model, problem or
    /// design file
    file: PathBuf,
    /// Format to write
    #[arg(long)]
    format: FormatArg,
    /// Form of the decrease condition, for sdpa; a design's own by default, reduced for a model
    #[arg(long)]
    form: Option<FormArg>,
    /// File to write; standard output when left out, for text
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Formats.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FormatArg {
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
    fn name(self) -> &'static str {
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
struct Exported {
    bytes: Vec<u8>,
    not_proved: Option<String>,
}

/// Writes a file in the format of another program. 2: a design was written that is not proved.
pub fn run(args: &ExportArgs) -> Result<ExitCode, CliError> {
    let source = trajectory_of(&args.file);
    if let Some(output) = &args.output {
        files::check_output(output, source.as_deref().unwrap_or(&args.file))?;
    }
    if args.form.is_some() && args.format != FormatArg::Sdpa {
        return Err(CliError::Argument {
            argument: "--form",
            reason: format!(
                "has a meaning for --format sdpa only, not for {}",
                args.format.name()
            ),
        });
    }
    if args.output.is_none() && matches!(args.format, FormatArg::Parquet | FormatArg::Mat) {
        return Err(CliError::Argument {
            argument: "--output",
            reason: format!(
                "is needed with --format {}, which is not text",
                args.format.name()
            ),
        });
    }
    let exported = match (&source, args.format) {
        (Some(_), FormatArg::Sdpa) => {
            let reason = "this is a trajectory; sdpa is for model, problem and design files";
            return Err(CliError::unsuitable(&args.file, reason));
        }
        (Some(path), format) => data::trajectory(path, format)?,
        (None, FormatArg::Sdpa) => Exported {
            bytes: sdpa::export(args)?.into_bytes(),
            not_proved: None,
        },
        (None, format) => data::design(&args.file, format)?,
    };
    match &args.output {
        Some(path) => files::write_bytes(path, &exported.bytes)?,
        None => print(String::from_utf8_lossy(&exported.bytes).trim_end()),
    }
    Ok(match exported.not_proved {
        None => ExitCode::SUCCESS,
        Some(reason) => {
            eprintln!("{}: {reason}", args.file.display());
            ExitCode::from(super::EXIT_NO)
        }
    })
}

/// The trajectory that a path stands for: itself, or that of a folder.
fn trajectory_of(path: &Path) -> Option<PathBuf> {
    if path.is_dir() {
        return Some(path.join(TRAJECTORY_FILE));
    }
    let ending = path.extension()?;
    ending
        .eq_ignore_ascii_case("csv")
        .then(|| path.to_path_buf())
}
