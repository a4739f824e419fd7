//! From the outcome of a synthesis or an analysis to the answer.

use std::path::Path;

use synth::certify::Verdict;
use synth::feasibility::Decision;
use synth::model::Model;
use synth::synthesis::{Form, Outcome, Synthesized};

use super::cross_check;
use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::show::design::SynthesisReport;
use crate::cli::show::infeasibility::certificate;
use crate::cli::show::no_design::NoDesignReport;
use crate::cli::show::solver::SolverStatus;
use crate::cli::show::written::{design_written, written_or_nothing};
use crate::cli::solver::SolverArg;

/// What a synthesis or an analysis was asked.
pub struct Conclusion<'a> {
    /// The model file.
    pub model_path: &'a Path,
    /// Its content.
    pub model: &'a Model,
    /// The file to write.
    pub output: Option<&'a Path>,
    /// Form of the decrease condition.
    pub form: Form,
    /// The solver used, when the other is to be asked too.
    pub cross_check: Option<SolverArg>,
    /// What was requested: a design, or a proof for given gains.
    pub what: &'static str,
    /// A proof that there is none is written in the place of the design.
    pub keeps_refutation: bool,
}

impl Conclusion<'_> {
    /// Writes the design if it is proved, and answers.
    pub fn answer(&self, outcome: Outcome) -> Result<Answer, CliError> {
        match outcome {
            Outcome::Solved(design) => self.found(&design),
            Outcome::Infeasible(decision) => self.none(&decision, SolverStatus::Infeasible),
            Outcome::Undecided(decision) => self.none(&decision, SolverStatus::Undecided),
            Outcome::SolverFailed(decision) => self.none(&decision, SolverStatus::Failed),
        }
    }

    fn found(&self, design: &Synthesized) -> Result<Answer, CliError> {
        let mut checked = design.report.clone();
        let kept = self.output.filter(|_| checked.verdict == Verdict::Proved);
        if let Some(path) = kept {
            files::write(path, &design.file.to_json())?;
            // What counts is what a reader of the file gets.
            let (file, model) = files::design_of(path, &files::text(path)?)?;
            let again = file.verify(&model);
            checked = again.map_err(|problem| CliError::value(path, problem))?;
        }
        let check = self
            .cross_check
            .map(|solver| cross_check::run(solver, (self.model, self.form), design));
        let check = check.transpose()?;
        let report = SynthesisReport::new(design, self.model, &checked, check);
        let mut lines = report.lines(&design.file.name);
        lines.push(design_written(kept, checked.verdict));
        Ok(Answer::new(Exit::from(checked.verdict), &report, &lines))
    }

    fn none(&self, decision: &Decision, status: SolverStatus) -> Result<Answer, CliError> {
        let wanted = self.keeps_refutation && status != SolverStatus::Failed;
        let proof = certificate(&decision.answer).filter(|_| wanted);
        let kept = self.output.zip(proof);
        if let Some((path, proof)) = kept {
            files::write(path, &proof.to_json())?;
        }
        let report = NoDesignReport::new(self.model, self.form, decision, status);
        let mut lines = report.lines(self.model_path, self.what);
        lines.push(written_or_nothing(kept.map(|(path, _)| path)));
        Ok(Answer::new(status.exit_without_design(), &report, &lines))
    }
}
