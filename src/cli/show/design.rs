//! A design with its proof.

use serde::Serialize;
use synth::certify::Report;
use synth::design::{DesignFile, SearchRecord};
use synth::model::Model;
use synth::optimality::Optimality;
use synth::synthesis::{CrossCheck, Synthesized};

use super::claims::DesignClaims;
use super::cross_check;
use super::solver::{SolverReport, SolverStatus};
use super::verdict::ProofReport;

/// What is proved of a design.
#[derive(Debug, Serialize)]
pub struct DesignReport<'a> {
    /// Its proof.
    #[serde(flatten)]
    pub proof: ProofReport<'a>,
    /// What it claims.
    #[serde(flatten)]
    pub claims: DesignClaims,
}

impl<'a> DesignReport<'a> {
    /// From a design and the outcome of its check.
    pub fn new(design: &DesignFile, model: &Model, report: &'a Report) -> Self {
        DesignReport {
            proof: ProofReport::new(report),
            claims: DesignClaims::of(design, model, report.verdict),
        }
    }

    /// In words.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = self.proof.lines(None);
        lines.extend(self.claims.gamma.map(|gamma| format!("gamma: {gamma}")));
        lines.extend(self.claims.further_lines());
        lines
    }
}

/// What a synthesis or an analysis found.
#[derive(Debug, Serialize)]
pub struct SynthesisReport<'a> {
    /// The design.
    #[serde(flatten)]
    pub design: DesignReport<'a>,
    /// What the solvers did.
    #[serde(flatten)]
    solver: SolverReport<'a>,
    /// Its objective beside the best one that a solver reported; null where it is not proved.
    optimality: Option<Optimality>,
    /// Form of the decrease condition.
    form: &'a str,
    /// Vertices of the model.
    vertices: usize,
    /// The search that chose the model's numbers; null without one.
    search: Option<&'a SearchRecord>,
    /// What both solvers say of the smallest gamma; null where they were not asked.
    cross_check: Option<CrossCheck>,
}

impl<'a> SynthesisReport<'a> {
    /// From a design and the outcome of its check.
    pub fn new(
        found: &'a Synthesized,
        model: &Model,
        report: &'a Report,
        cross_check: Option<CrossCheck>,
    ) -> Self {
        let provenance = &found.file.provenance;
        let design = DesignReport::new(&found.file, model, report);
        SynthesisReport {
            optimality: found.optimality.filter(|_| design.claims.gamma.is_some()),
            design,
            solver: SolverReport {
                status: SolverStatus::Solved,
                solve_seconds: found.solve_seconds,
                solver_runs: &provenance.solver_runs,
            },
            form: &provenance.form,
            vertices: model.task().system.vertices.len(),
            search: provenance.search.as_ref(),
            cross_check,
        }
    }

    /// In words.
    pub fn lines(&self, name: &str) -> Vec<String> {
        let mut lines = vec![format!("model: {name} ({} vertices)", self.vertices)];
        lines.extend(self.solver.lines());
        let check = self.cross_check.as_ref();
        lines.extend(check.map_or(Vec::new(), cross_check::lines));
        lines.extend(self.design.claims.gain_lines());
        lines.extend(self.design.claims.further_lines());
        let remark = self.optimality.and_then(|optimality| optimality.remark());
        lines.extend(self.design.proof.lines(remark.as_deref()));
        lines
    }
}
