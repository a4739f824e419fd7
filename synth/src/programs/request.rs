//! The request for a design, and the design files made for it.

use nalgebra::DMatrix;

use super::assemble::Form;
use super::outcome::Synthesized;
use super::record::{now, sha256_of, GENERATOR};
use crate::certify::theorem1::Certificate;
use crate::certify::{Report, Verdict};
use crate::conditions::Task;
use crate::design::{
    CertificateFile, Coupling, DesignFile, OuterFile, ProblemUnits, Provenance,
    DESIGN_SCHEMA_VERSION,
};
use crate::model::{Model, Objective};

/// A model, its file's text and the form of its problem.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DesignRequest<'a> {
    pub model: &'a Model,
    pub model_text: &'a str,
    /// The task in SI units: the model's, or another with given gains.
    pub task: &'a Task,
    /// The given gains that the answer is about (SI units, m x n each); none where gains are unknown.
    pub given: &'a [DMatrix<f64>],
    /// The part of them, and of the model's vertices, that the task has.
    pub part: ConditionSubset<'a>,
    /// The text of the file that the gains come from.
    pub gains_text: Option<&'a str>,
    pub form: Form,
}

/// Which of the given gains and of the model's vertices a task has, in its order.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ConditionSubset<'a> {
    /// Indices of gains, from 0.
    pub gains: &'a [usize],
    /// Indices of vertices, from 0; `None`: all of them.
    pub vertices: Option<&'a [usize]>,
}

impl ConditionSubset<'_> {
    /// One gain, all vertices.
    pub const FIRST: ConditionSubset<'static> = ConditionSubset {
        gains: &[0],
        vertices: None,
    };
}

impl<'a> DesignRequest<'a> {
    /// A model whose gains are unknown.
    pub fn of_model(model: &'a Model, model_text: &'a str, task: &'a Task, form: Form) -> Self {
        DesignRequest {
            model,
            model_text,
            task,
            given: &[],
            part: ConditionSubset::FIRST,
            gains_text: None,
            form,
        }
    }
}

impl DesignRequest<'_> {
    /// Puts a design file together and checks what a reader of its text would get; with the second certificate of
    /// the same controller, where there is one. `None` for numbers that no design file may hold.
    pub fn design(
        &self,
        certificate: &Certificate,
        large_set: Option<(OuterFile, Coupling)>,
        units: &ProblemUnits,
    ) -> Option<Box<Synthesized>> {
        let (controller, mut certificate) = CertificateFile::split(certificate);
        let mut model = self.model.file.clone();
        // A solver exceeds the limit by its tolerance where it is active; the check starts from what is written.
        certificate.xi = certificate.xi.min(model.specs.xi_max);
        // One certificate does not prove what the objective requires of two.
        if large_set.is_none() && model.specs.objective == Objective::Both {
            model.specs.objective = Objective::Gamma;
        }
        let (outer, coupling) = large_set.unzip();
        let mut file = DesignFile {
            schema_version: DESIGN_SCHEMA_VERSION,
            name: model.name.clone(),
            model,
            controller,
            certificate,
            outer,
            verdict: Report {
                verdict: Verdict::NotProved,
                conditions: Vec::new(),
                not_covered: Vec::new(),
            },
            provenance: Provenance {
                coupling,
                ..self.provenance(units.clone())
            },
        };
        let report = file.verify(self.model).ok()?;
        file.verdict = report.clone();
        Some(Box::new(Synthesized {
            file,
            report,
            solve_seconds: 0.0,
            optimality: None,
        }))
    }

    /// Who made a file from which model and when.
    pub fn provenance(&self, problem: ProblemUnits) -> Provenance {
        Provenance {
            generator: GENERATOR.to_string(),
            model_sha256: sha256_of(self.model_text),
            date: now(),
            gains_sha256: self.gains_text.map(sha256_of),
            form: self.form.name().to_string(),
            problem,
            coupling: None,
            search: None,
            solver_runs: Vec::new(),
        }
    }
}
