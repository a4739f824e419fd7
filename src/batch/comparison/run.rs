//! The runs of a comparison.

use std::sync::atomic::AtomicBool;
use std::sync::Arc;

use nalgebra::Vector3;
use synth::model::ModelError;

use super::faults::{standard_faults, StandardFault};
use super::table::{
    compared_metrics, Comparison, ControllerRow, FaultOutcome, TaskSummary,
    COMPARISON_SCHEMA_VERSION,
};
use super::task::{limit_difference, Candidate, ComparisonError};
use crate::base::provenance::GENERATOR;
use crate::base::table::Table;
use crate::batch::engine::{Control, Job, Threads};
use crate::plants::SystemFile;
use crate::run::outcome::RunOutcome;
use crate::run::simulate;
use crate::run::summary::{CertificateOutcome, Summary};
use crate::scenario::Scenario;
use crate::sim::sampling::Instants;

/// The trajectory of a controller without a standard fault.
#[derive(Debug, Clone)]
pub struct Curves {
    /// The controller's label.
    pub label: String,
    /// Its trajectory.
    pub trajectory: Table,
}

/// Every candidate without and with each standard fault.
pub struct ComparisonJob<'a> {
    candidates: &'a [Candidate],
    taken_from: Option<String>,
    /// Torque that can act on each axis, N m.
    limit: Vector3<f64>,
    faults: Vec<StandardFault>,
}

impl<'a> ComparisonJob<'a> {
    /// The runs of candidates, at least one. All must have the same task but for `taken_from`, the scenario
    /// whose task was imposed on them.
    ///
    /// # Errors
    /// Torque limits that differ.
    pub fn new(
        candidates: &'a [Candidate],
        taken_from: Option<String>,
        with_faults: bool,
    ) -> Result<Self, ComparisonError> {
        let limit = common_limit(candidates, taken_from.is_some())?;
        let bounded = with_faults && limit.iter().all(|value| value.is_finite());
        let faults = match bounded {
            true => standard_faults(candidates[0].scenario.duration_s, &limit),
            false => Vec::new(),
        };
        Ok(ComparisonJob {
            candidates,
            taken_from,
            limit,
            faults,
        })
    }

    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.candidates.len() * self.runs_per_candidate()
    }

    fn runs_per_candidate(&self) -> usize {
        self.faults.len() + 1
    }

    /// Makes all runs.
    ///
    /// # Errors
    /// It was stopped; a scenario that cannot be run.
    pub fn compare(
        &self,
        threads: &Threads,
        control: &Control,
    ) -> Result<(Comparison, Vec<Curves>), ComparisonError> {
        let mut outcomes = threads.collect(self, self.runs(), control)?;
        let mut runs = Vec::new();
        let mut curves = Vec::new();
        let each = outcomes.chunks_mut(self.runs_per_candidate());
        for (candidate, outcomes) in self.candidates.iter().zip(each) {
            let Some((healthy, faulty)) = outcomes.split_first_mut() else {
                continue;
            };
            runs.push(self.row(candidate, &healthy.summary, faulty));
            curves.push(Curves {
                label: candidate.label.clone(),
                trajectory: healthy.trajectory.take().unwrap_or_default(),
            });
        }
        let first = &self.candidates[0].scenario;
        let faults = self.faults.iter();
        let comparison = Comparison {
            schema_version: COMPARISON_SCHEMA_VERSION,
            generator: GENERATOR.to_string(),
            task: TaskSummary {
                taken_from: self.taken_from.clone(),
                duration_s: first.duration_s,
                torque_limit_nm: self.limit.into(),
                settle_tolerance_deg: first.settle_tolerance_rad.to_degrees(),
                tail_s: first.tail_s,
                requirements: first.requirements.clone(),
            },
            faults: faults
                .map(|fault| (fault.name.to_string(), fault.description.clone()))
                .collect(),
            runs,
        };
        Ok((comparison, curves))
    }

    fn row(
        &self,
        candidate: &Candidate,
        summary: &Summary,
        faulty: &[RunOutcome],
    ) -> ControllerRow {
        let pairs = self.faults.iter().zip(faulty);
        let faults: Vec<FaultOutcome> = pairs
            .map(|(fault, outcome)| FaultOutcome::new(fault.name, &outcome.summary))
            .collect();
        let own = candidate.torque_limit();
        let mut notes = summary.notes.clone();
        if own != self.limit {
            let [a, b, c]: [f64; 3] = own.into();
            notes.push(format!(
                "The controller itself commands at most {a}, {b} and {c} N m, less than can act."
            ));
        }
        ControllerRow {
            label: candidate.label.clone(),
            controller: summary.controller.clone(),
            sampling: sampling(&candidate.scenario.instants),
            verdict: summary.verdict,
            proof: summary
                .certificate
                .as_ref()
                .map(CertificateOutcome::as_text),
            proof_covers: summary
                .certificate
                .as_ref()
                .map(|outcome| outcome.covers_run),
            metrics: compared_metrics(summary),
            link: summary.link.clone(),
            faults_survived: faults.iter().filter(|outcome| outcome.survived).count(),
            faults,
            notes,
            scenario_sha256: summary.provenance.scenario_sha256.clone(),
            design_sha256: summary.provenance.design_sha256.clone(),
        }
    }
}

impl Job for ComparisonJob<'_> {
    type Record = RunOutcome;
    type Error = ComparisonError;

    /// A candidate without a fault, then with each; the candidates one after the other.
    fn run(&self, index: u64, _stop: &Arc<AtomicBool>) -> Result<RunOutcome, ComparisonError> {
        let (index, each) = (index as usize, self.runs_per_candidate());
        let fault = (index % each).checked_sub(1);
        let fault = fault.and_then(|fault| self.faults.get(fault));
        run(&self.candidates[index / each], fault)
    }
}

/// The torque that can act in every run, N m. When a task was imposed, a controller's own limit may be
/// smaller; then it is the largest of all.
fn common_limit(candidates: &[Candidate], imposed: bool) -> Result<Vector3<f64>, ComparisonError> {
    let mut limits = candidates
        .iter()
        .map(|candidate| (candidate, candidate.torque_limit()));
    let Some((first, mut limit)) = limits.next() else {
        return Ok(Vector3::zeros());
    };
    for (candidate, other) in limits {
        if imposed {
            limit = limit.zip_map(&other, f64::max);
        } else if let Some(difference) = limit_difference(&other, &limit) {
            return Err(ComparisonError::Differs {
                file: candidate.label.clone(),
                other_file: first.label.clone(),
                difference,
            });
        }
    }
    Ok(limit)
}

fn run(
    candidate: &Candidate,
    fault: Option<&StandardFault>,
) -> Result<RunOutcome, ComparisonError> {
    let label = || candidate.label.clone();
    let scenario = match fault {
        None => Ok(candidate.scenario.clone()),
        Some(fault) => with_fault(candidate, fault),
    };
    let scenario = scenario.map_err(|problem| ComparisonError::Fault {
        label: label(),
        problem,
    })?;
    let outcome = simulate(&scenario, candidate.design.as_ref(), fault.is_none());
    outcome.map_err(|problem| ComparisonError::Simulate {
        label: label(),
        problem,
    })
}

fn with_fault(candidate: &Candidate, fault: &StandardFault) -> Result<Scenario, ModelError> {
    let mut file = candidate.entry.file.clone();
    if let SystemFile::RigidBody(body) = &mut file.system {
        body.faults.extend(fault.faults.iter().cloned());
    }
    Scenario::from_file(&file, candidate.entry.sha256.clone())
}

fn sampling(instants: &Instants) -> String {
    match *instants {
        Instants::Periodic {
            interval_s,
            jitter_s,
        } if jitter_s > 0.0 => format!("every {interval_s} s, jitter {jitter_s} s"),
        Instants::Periodic { interval_s, .. } => format!("every {interval_s} s"),
        Instants::Aperiodic {
            shortest_s,
            longest_s,
        } => format!("every {shortest_s} to {longest_s} s"),
        Instants::Continuous { .. } => "trigger watched continuously".to_string(),
    }
}
