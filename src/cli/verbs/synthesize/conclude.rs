//! From the outcome of a synthesis or an analysis to the answer.

use std::path::Path;

use synth::certify::{Report, Verdict};
use synth::design::DesignFile;
use synth::feasibility::Decision;
use synth::model::{FileError, Model};
use synth::solve::Solver;
use synth::synthesis::{cross_check, CrossCheck, Form, Outcome, Solvers, Synthesized};

use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::progress::watched;
use crate::cli::show::design::SynthesisReport;
use crate::cli::show::facts::{design_written, only_one_asked, written_or_nothing, SolverStatus};
use crate::cli::show::infeasibility::Existence;
use crate::cli::show::no_design::NoDesignReport;

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
    /// The solver asked first, when both are to be compared at the end.
    pub cross_check: Option<Solver>,
    /// The solver that alone may be asked, where one was named.
    pub only: Option<&'static str>,
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
        let (kept, checked) = keep_design(self.output, design)?;
        let check = self.cross_check;
        let check = check.map(|solver| self.other_solver(solver, design));
        let report = SynthesisReport::new(design, self.model, &checked, check.transpose()?);
        let mut lines = report.lines(&design.file.name);
        lines.push(design_written(kept, checked.verdict));
        Ok(Answer::new(Exit::from(checked.verdict), &report, &lines))
    }

    /// The smallest gamma from both solvers, each with the form it is fastest with.
    fn other_solver(&self, solver: Solver, design: &Synthesized) -> Result<CrossCheck, CliError> {
        let order = match solver {
            Solver::Clarabel => [Solver::Clarabel, Solver::Structured],
            Solver::Structured => [Solver::Structured, Solver::Clarabel],
        };
        let candidates = Solvers::both_with_form(order, self.form);
        let units = &design.file.provenance.problem;
        // The design's own model has the form of the gyroscopic torque that was chosen.
        let model = Model::new(design.file.model.clone());
        let model = model.map_err(|error| CliError::value(self.model_path, error))?;
        let checked = watched("cross-check", |observer| {
            cross_check(&model, units, &candidates, Some(&observer))
        });
        checked.map_err(|error| CliError::synthesis(self.model_path, error.into()))
    }

    fn none(&self, decision: &Decision, status: SolverStatus) -> Result<Answer, CliError> {
        let wanted = self.keeps_refutation && status != SolverStatus::Failed;
        let proof = Existence::of(&decision.answer).certificate;
        let proof = proof.filter(|_| wanted);
        let kept = self.output.zip(proof);
        if let Some((path, proof)) = kept {
            files::write(path, proof.to_json())?;
        }
        let report = NoDesignReport::new(self.model, self.form, decision, status);
        let mut lines = report.lines(self.model_path, self.what);
        let only = self.only.filter(|_| status != SolverStatus::Infeasible);
        lines.extend(only.map(only_one_asked));
        lines.push(written_or_nothing(kept.map(|(path, _)| path)));
        Ok(Answer::new(status.exit_without_design(), &report, &lines))
    }
}

/// [`keep`] for the design of a model.
pub fn keep_design<'a>(
    output: Option<&'a Path>,
    design: &Synthesized,
) -> Result<(Option<&'a Path>, Report), CliError> {
    let again = |text: &str| {
        let (file, model) = DesignFile::from_json(text)?;
        Ok(file.verify(&model)?)
    };
    keep(output, &design.report, || design.file.to_json(), again)
}

/// Writes a proved design. What counts is then the check of what a reader of the file gets.
pub fn keep<'a>(
    output: Option<&'a Path>,
    report: &Report,
    json: impl FnOnce() -> String,
    again: impl FnOnce(&str) -> Result<Report, FileError>,
) -> Result<(Option<&'a Path>, Report), CliError> {
    let Some(path) = output.filter(|_| report.verdict == Verdict::Proved) else {
        return Ok((None, report.clone()));
    };
    files::write(path, json())?;
    let (_, report) = files::load(path, again)?;
    Ok((Some(path), report))
}
