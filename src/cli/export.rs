//! `steadfast export FILE --format sdpa`

use std::path::PathBuf;
use std::process::ExitCode;

use clap::ValueEnum;
use synth::design::ProblemUnits;
use synth::model::{kind_of, read_text, Kind, Model};
use synth::synthesis::{assemble, scaled_task, Form, Goal, FIRST_UNITS};

use super::synthesize::FormArg;
use super::{files, print, CliError};

/// Arguments of `export`.
#[derive(clap::Args)]
pub struct ExportArgs {
    /// Model or design file
    file: PathBuf,
    /// Format to write
    #[arg(long)]
    format: FormatArg,
    /// Form of the decrease condition; a design's own by default, reduced for a model
    #[arg(long)]
    form: Option<FormArg>,
    /// File to write; standard output when left out
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Formats.
#[derive(Clone, Copy, ValueEnum)]
enum FormatArg {
    /// SDPA sparse text (.dat-s): the first problem that synthesis solves, in its scaled units; the
    /// optimum is gamma
    Sdpa,
}

/// Writes the semidefinite program of a model or of a design's model.
pub fn run(args: &ExportArgs) -> Result<ExitCode, CliError> {
    if let Some(output) = &args.output {
        files::check_output(output, &args.file)?;
    }
    let (model, units, own_form) = source(args)?;
    let form = args.form.map_or(own_form, Form::from);
    let FormatArg::Sdpa = args.format;
    let (_, task) = scaled_task(&model, units);
    let problem = assemble(&task, form, Goal::SmallestGain).problem.lower();
    let title = format!(
        "{}, {} form, smallest gain, by steadfast {}",
        model.file.name,
        form.name(),
        env!("CARGO_PKG_VERSION")
    );
    let text = problem.to_sdpa(&title);
    match &args.output {
        Some(path) => files::write(path, &text)?,
        None => print(text.trim_end()),
    }
    Ok(ExitCode::SUCCESS)
}

fn source(args: &ExportArgs) -> Result<(Model, ProblemUnits, Form), CliError> {
    let text = read_text(&args.file).map_err(|problem| CliError::file(&args.file, problem))?;
    if kind_of(&text) != Some(Kind::Design) {
        let (_, model) = files::model(&args.file)?;
        return Ok((model, FIRST_UNITS, Form::Reduced));
    }
    let (design, model) = files::design(&args.file)?;
    let form = Form::named(&design.provenance.form).unwrap_or(Form::Reduced);
    Ok((model, design.provenance.problem, form))
}
