//! `steadfast export FILE --format FORMAT`

mod data;
mod flight;
mod former;
mod sdpa;

use std::path::{Path, PathBuf};

use synth::synthesis::Form;

use data::{Exported, FormatArg};

use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::show::facts::written;
use crate::cli::solver::FormArg;
use crate::cli::target::Targets;
use crate::export::flight::source::Precision;
use crate::run::files::{SUMMARY_FILE, TRAJECTORY_FILE};

/// Arguments of `export`.
#[derive(clap::Args)]
pub struct ExportArgs {
    /// Design file, trajectory.csv, or folder written by `simulate -o`; for sdpa a model, problem or
    /// design file, for c99, basilisk and fmu a design or scenario file
    file: PathBuf,
    /// Format to write
    #[arg(long)]
    format: FormatArg,
    /// Form of the decrease condition, for sdpa; a design's own by default, chordal for a model
    #[arg(long)]
    form: Option<FormArg>,
    /// File to write, for c99 the folder; standard output when left out, for text
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Samples of the reference vectors, for c99: 50 to 100000, 400 when left out
    #[arg(long, value_parser = clap::value_parser!(u32).range(50..=100_000))]
    samples: Option<u32>,
    /// Compute in single precision, for c99: of designs with a fixed threshold and of the law of Wu
    /// 2018. The proof is of the controller in doubles
    #[arg(long)]
    float: bool,
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
}

/// Writes a file in the format of another program. 2: a design was written that is not proved.
pub fn run(args: &ExportArgs) -> Result<Answer, CliError> {
    let source = trajectory_of(&args.file);
    let input = source.as_deref().unwrap_or(&args.file);
    // What is said of a trajectory is taken from the summary beside it.
    let summary = input.with_file_name(SUMMARY_FILE);
    let inputs = match source {
        Some(_) => vec![input, &summary],
        None => vec![input],
    };
    let targets = Targets {
        inputs: &inputs,
        force: args.force,
    };
    if args.format == FormatArg::C99 && source.is_none() {
        form_is_for_sdpa(args)?;
        let precision = match args.float {
            true => Precision::Single,
            false => Precision::Double,
        };
        let form = (args.samples, precision);
        return flight::export(&args.file, args.output.as_deref(), form, &targets);
    }
    let contents = args.format.contents(source.is_some());
    targets.check_file(args.output.as_deref(), contents)?;
    form_is_for_sdpa(args)?;
    let for_c99 = [
        ("--samples", args.samples.is_some()),
        ("--float", args.float),
    ];
    if let Some((argument, _)) = for_c99.into_iter().find(|(_, given)| *given) {
        let reason = format!(
            "has a meaning for --format c99 only, not for {}",
            args.format.name()
        );
        return Err(CliError::Argument { argument, reason });
    }
    if args.output.is_none()
        && matches!(
            args.format,
            FormatArg::Parquet | FormatArg::Mat | FormatArg::Fmu
        )
    {
        let reason = format!(
            "is needed with --format {}, which is not text",
            args.format.name()
        );
        return Err(CliError::Argument {
            argument: "--output",
            reason,
        });
    }
    let exported = match (&source, args.format) {
        (Some(_), FormatArg::Sdpa) => {
            let reason = "this is a trajectory; sdpa is for model, problem and design files";
            return Err(CliError::unsuitable(&args.file, reason));
        }
        (Some(path), format) => data::trajectory(path, format)?,
        (None, FormatArg::Sdpa) => Exported {
            bytes: sdpa::export(&args.file, args.form.map(Form::from))?.into_bytes(),
            not_proved: None,
        },
        (None, FormatArg::Basilisk) => flight::basilisk(&args.file)?,
        (None, FormatArg::Fmu) => flight::unit(&args.file)?,
        (None, format) => data::design(&args.file, format)?,
    };
    let exit = Exit::of(exported.not_proved.is_none());
    let answer = match &args.output {
        Some(path) => {
            files::write(path, &exported.bytes)?;
            Answer::silent(exit).remark(written(path))
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

/// Refuses --form where it has no meaning.
fn form_is_for_sdpa(args: &ExportArgs) -> Result<(), CliError> {
    if args.form.is_none() || args.format == FormatArg::Sdpa {
        return Ok(());
    }
    let name = args.format.name();
    Err(CliError::Argument {
        argument: "--form",
        reason: format!("has a meaning for --format sdpa only, not for {name}"),
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
