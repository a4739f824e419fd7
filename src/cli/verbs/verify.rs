//! `steadfast verify FILE.json`

use std::path::{Path, PathBuf};

use serde::Serialize;
use synth::certify::{ExactReport, Verdict};
use synth::design::DesignFile;
use synth::feasibility::InfeasibilityFile;
use synth::held_command::HeldCommandDesignFile;
use synth::model::{kind_of, Kind};
use synth::problem::ProblemDesignFile;

use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::show::design::DesignReport;
use crate::cli::show::held_command::HeldCommandReport;
use crate::cli::show::infeasibility::{is_proved, RefutationReport};
use crate::cli::show::problem::ProblemReport;

/// Arguments of `verify`.
#[derive(clap::Args)]
pub struct VerifyArgs {
    /// Design file or infeasibility certificate
    file: PathBuf,
    /// Decide every condition once more in exact rational arithmetic
    #[arg(long)]
    exact: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// A report with the outcome of the exact check; null where it was not requested.
#[derive(Serialize)]
struct Verified<'a, R> {
    #[serde(flatten)]
    report: R,
    exact: Option<&'a ExactReport>,
}

/// Proves a design, or that none exists, from a file alone. 0: proved; 2: not proved.
pub fn run(args: &VerifyArgs) -> Result<Answer, CliError> {
    let text = files::text(&args.file)?;
    match kind_of(&text) {
        Some(Kind::Infeasibility) => infeasibility(args, &text),
        Some(Kind::ProblemDesign) => problem(args, &text),
        Some(Kind::HeldCommandDesign) => held_command(args, &text),
        _ => design(args, &text),
    }
}

fn design(args: &VerifyArgs, text: &str) -> Result<Answer, CliError> {
    let path = &args.file;
    let (design, model) = files::parse(path, text, DesignFile::from_json)?;
    let wrong = |problem| CliError::value(path, problem);
    let mut checked = design.verify(&model).map_err(wrong)?;
    let exact = args.exact.then(|| design.verify_exactly(&model));
    let exact = exact.transpose().map_err(wrong)?;
    checked.verdict = agreed(checked.verdict, exact.as_ref());
    let report = DesignReport::new(&design, &model, &checked);
    let lines = [title(&design.name, path)].into_iter();
    let lines = lines.chain(exact_lines(exact.as_ref()));
    let lines: Vec<String> = lines.chain(report.lines()).collect();
    let exit = Exit::from(checked.verdict);
    Ok(answer(exit, report, exact.as_ref(), &lines))
}

fn problem(args: &VerifyArgs, text: &str) -> Result<Answer, CliError> {
    let path = &args.file;
    let (design, problem) = files::parse(path, text, ProblemDesignFile::from_json)?;
    let wrong = |fault| CliError::value(path, fault);
    let mut checked = design.verify(&problem).map_err(wrong)?;
    let exact = args.exact.then(|| design.verify_exactly(&problem));
    let exact = exact.transpose().map_err(wrong)?;
    checked.verdict = agreed(checked.verdict, exact.as_ref());
    let report = ProblemReport::verified(&problem, &design, &checked);
    let lines = [title(&design.name, path)].into_iter();
    let lines = lines.chain(exact_lines(exact.as_ref()));
    let lines: Vec<String> = lines.chain(report.lines()).collect();
    let exit = Exit::from(checked.verdict);
    Ok(answer(exit, report, exact.as_ref(), &lines))
}

fn held_command(args: &VerifyArgs, text: &str) -> Result<Answer, CliError> {
    let path = &args.file;
    let (design, proof) = files::parse(path, text, HeldCommandDesignFile::from_json)?;
    let mut checked = proof.verify();
    let exact = args.exact.then(|| proof.verify_exactly());
    checked.verdict = agreed(checked.verdict, exact.as_ref());
    let report = HeldCommandReport::verified(&proof, &checked);
    let lines = [title(&design.name, path)].into_iter();
    let lines = lines.chain(exact_lines(exact.as_ref()));
    let lines: Vec<String> = lines.chain(report.lines()).collect();
    let exit = Exit::from(checked.verdict);
    Ok(answer(exit, report, exact.as_ref(), &lines))
}

fn infeasibility(args: &VerifyArgs, text: &str) -> Result<Answer, CliError> {
    let path = &args.file;
    let (file, model) = files::parse(path, text, InfeasibilityFile::from_json)?;
    let wrong = |problem| CliError::value(path, problem);
    let mut checked = file.verify(&model).map_err(wrong)?;
    let exact = args.exact.then(|| file.verify_exactly(&model, &checked));
    let exact = exact.transpose().map_err(wrong)?;
    if exact.as_ref().is_some_and(is_denied) {
        checked.iter_mut().for_each(|one| one.proved = false);
    }
    let limits = match is_proved(&checked) {
        true => file.limits(&model, &checked),
        false => Ok(Vec::new()),
    };
    let limits = limits.map_err(|error| CliError::synthesis(path, error))?;
    let report = RefutationReport::new(&file, &checked, &limits);
    let lines = exact_lines(exact.as_ref()).into_iter();
    let lines: Vec<String> = lines.chain(report.lines(path)).collect();
    let exit = report.exit();
    Ok(answer(exit, report, exact.as_ref(), &lines))
}

fn answer(
    exit: Exit,
    report: impl Serialize,
    exact: Option<&ExactReport>,
    lines: &[String],
) -> Answer {
    Answer::new(exit, &Verified { report, exact }, lines)
}

fn is_denied(exact: &ExactReport) -> bool {
    exact.verdict == Verdict::NotProved
}

/// What both checks prove: an exact check that was made must agree.
fn agreed(verdict: Verdict, exact: Option<&ExactReport>) -> Verdict {
    match exact.is_some_and(is_denied) {
        true => Verdict::NotProved,
        false => verdict,
    }
}

/// The exact check in words.
fn exact_lines(exact: Option<&ExactReport>) -> Vec<String> {
    let Some(exact) = exact else {
        return Vec::new();
    };
    let decided = exact.conditions;
    let title = match exact.failed.len() {
        0 => format!("exact arithmetic: all {decided} conditions hold"),
        failed => format!("exact arithmetic: {failed} of {decided} conditions do not hold"),
    };
    let failed = exact.failed.iter();
    let failed = failed.map(|name| format!("  does not hold: {name}"));
    [title].into_iter().chain(failed).collect()
}

fn title(name: &str, path: &Path) -> String {
    format!("design: {name} ({})", path.display())
}
