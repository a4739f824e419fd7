//! Designs with two certificates: `synthesize --objective both`.

use synth::synthesis::{synthesize_two_certificates, Outcome, TwoCertificatesOutcome};

use super::args::SynthesizeArgs;
use super::conclude::Conclusion;
use crate::cli::answer::Answer;
use crate::cli::error::CliError;
use crate::cli::progress::{solve, ASSEMBLING};
use crate::cli::show::no_design::NoDesignReport;
use crate::cli::show::solver::SolverStatus;
use crate::cli::show::written::NOTHING;

/// Designs, writes and proves both certificates.
pub fn synthesize(
    args: &SynthesizeArgs,
    conclusion: &Conclusion,
    text: &str,
) -> Result<Answer, CliError> {
    if args.cross_check {
        let reason =
            "--cross-check compares designs with one certificate; with --objective both it \
                      has no meaning";
        return Err(CliError::unsuitable(&args.model, reason));
    }
    let (model, form) = (conclusion.model, conclusion.form);
    let backend = args.solver.backend_for(form);
    let found = solve(&args.model, ASSEMBLING, |observer| {
        synthesize_two_certificates(model, text, form, backend.as_ref(), observer)
    })?;
    match found {
        TwoCertificatesOutcome::Solved(design, _) => conclusion.answer(Outcome::Solved(design)),
        TwoCertificatesOutcome::None {
            infeasible,
            tried,
            blocking,
            runs,
        } => {
            let status = match infeasible {
                true => SolverStatus::Undecided,
                false => SolverStatus::Failed,
            };
            let attempts = tried.len();
            let report = NoDesignReport::two((model, form), status, attempts, &blocking, &runs);
            let mut lines = report.lines(&args.model, "design with both certificates");
            lines.push(NOTHING.to_string());
            Ok(Answer::new(status.exit_without_design(), &report, &lines))
        }
    }
}
