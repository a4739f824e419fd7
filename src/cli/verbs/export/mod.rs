//! `steadfast export FILE --format FORMAT`

pub mod args;
mod data;
mod sdpa;

use std::path::{Path, PathBuf};

use args::{ExportArgs, Exported, FormatArg};

use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::run::files::TRAJECTORY_FILE;

/// Writes a file in the format of another program. 2: a design was written that is not proved.
pub fn run(args: &ExportArgs) -> Result<Answer, CliError> {
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
    let exit = Exit::of(exported.not_proved.is_none());
    let answer = match &args.output {
        Some(path) => {
            files::write_bytes(path, &exported.bytes)?;
            Answer::silent(exit)
        }
        None => {
            let text = String::from_utf8_lossy(&exported.bytes);
            Answer::text(exit, text.trim_end().to_string())
        }
    };
    Ok(match exported.not_proved {
        None => answer,
        Some(reason) => answer.remark(format!("{}: {reason}", args.file.display())),
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
