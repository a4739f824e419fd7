//! What is asked, with what a search needs of it; and the file of a design, checked.

use super::checked::Problem;
use super::design::{verify, ProblemDesignFile, ProblemProvenance, ProofFile};
use super::scaled::Scaled;
use crate::conditions::state_feedback::{DesignProblem, Floor, StateFeedback};
use crate::conditions::units::Sizes;
use crate::design::{SolverRun, DESIGN_SCHEMA_VERSION};
use crate::programs::{now, sha256_of, Recorded, Synthesized, GENERATOR};

/// A feedback and how it was found.
pub type ProblemSynthesized = Synthesized<ProblemDesignFile>;

impl Recorded for ProblemDesignFile {
    fn solver_runs(&mut self) -> &mut Vec<SolverRun> {
        &mut self.provenance.solver_runs
    }
}

/// Back-offs of the exported design from the optimum, relative: they leave a margin for the proof. Tried in order
/// until the design is proved.
pub(super) const BACK_OFFS: [f64; 7] = [1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 1e-1];

/// Distance below a wanted objective, relative: the number that is guaranteed lies below the one asked for.
pub(super) const BELOW_WANTED: f64 = 1e-7;

/// A problem in the file's units.
pub(super) struct Request<'a, P> {
    pub(super) problem: &'a Problem,
    pub(super) text: &'a str,
    pub(super) requested: &'a P,
    pub(super) floor: Option<Floor>,
}

impl<'a, P: DesignProblem> Request<'a, P> {
    pub(super) fn new(problem: &'a Problem, text: &'a str, requested: &'a P) -> Self {
        let wanted = requested.wanted();
        let ends = requested
            .floor(&problem.plant)
            .filter(|_| wanted.exactly.is_none());
        let floor = ends.map(|floor| Floor {
            // What is good enough is not below the floor.
            objective: wanted
                .at_most
                .into_iter()
                .fold(floor.objective, |least, at_most| {
                    least.min(at_most * (1.0 - 2.0 * BACK_OFFS[0]))
                }),
            ..floor
        });
        Request {
            problem,
            text,
            requested,
            floor,
        }
    }

    /// The problem in units for numbers of these sizes.
    pub(super) fn scaled(&self, sizes: &Sizes) -> Scaled<P> {
        Scaled::new(self.requested, &self.problem.plant, sizes, self.floor)
    }

    /// The sizes before anything is solved.
    pub(super) fn first_sizes(&self) -> Sizes {
        Sizes::of(&self.problem.plant, self.requested.decay_rate())
    }

    /// Puts the file together and checks what a reader of its text would get; `None` for numbers that no design file
    /// may hold.
    pub(super) fn design(&self, found: &StateFeedback) -> Option<Box<ProblemSynthesized>> {
        let report = verify(self.problem, found);
        let (controller, certificate) = ProofFile::split(found);
        let file = ProblemDesignFile {
            schema_version: DESIGN_SCHEMA_VERSION,
            name: self.problem.file.name.clone(),
            model: self.problem.file.clone(),
            controller,
            certificate,
            verdict: report.clone(),
            provenance: ProblemProvenance {
                generator: GENERATOR.to_string(),
                model_sha256: sha256_of(self.text),
                date: now(),
                solver_runs: Vec::new(),
            },
        };
        file.feedback(self.problem).ok()?;
        Some(Box::new(Synthesized {
            file,
            report,
            solve_seconds: 0.0,
            optimality: None,
        }))
    }
}
