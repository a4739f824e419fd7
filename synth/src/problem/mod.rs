//! Design problems for a state feedback, from file to proof.
//!
//! The mathematics of each problem is one file of [`conditions`](crate::conditions), which implements
//! [`DesignProblem`]. Here is what they share: the [problem file](ProblemFile), the solves, the
//! [design file](ProblemDesignFile) and its check. A further problem is such a file, its keys in
//! the problem file, and a line in [`DesignTask`].

mod checked;
mod design;
mod exclusion;
mod file;
mod integers;
mod program;
mod request;
mod run;
mod scaled;
mod search;
mod solves;
mod unreachable;

pub use checked::Problem;
pub use design::{FeedbackFile, ProblemDesignFile, ProblemProvenance, ProofFile};
pub use exclusion::InfeasibilityProof;
pub use file::{
    HInfinityFile, HullFile, ProblemFile, ProblemKindFile, ProblemPlantFile,
    QuadraticStabilisationFile, ReferenceFile, SaturatedRegionFile, PROBLEM_SCHEMA_VERSION,
};
pub use program::first_program;
pub use request::ProblemSynthesized;
pub use run::{solver_order, synthesize, NoFeedback, ProblemFailure, ProblemOutcome};
pub use unreachable::UnreachableMode;

use crate::conditions::h_infinity::HInfinity;
use crate::conditions::quadratic_stabilisation::QuadraticStabilisation;
use crate::conditions::saturated_region::SaturatedRegion;
use crate::conditions::state_feedback::{DesignProblem, Proof, StateFeedback, VertexPlant, Wanted};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// Every design problem.
#[derive(Debug, Clone, PartialEq)]
pub enum DesignTask {
    /// Quadratic stabilisation with a decay rate.
    QuadraticStabilisation(QuadraticStabilisation),
    /// H-infinity state feedback.
    HInfinity(HInfinity),
    /// Region of attraction under saturation.
    SaturatedRegion(SaturatedRegion),
}

/// Evaluates an expression with the problem inside a [`DesignTask`].
macro_rules! with_problem {
    ($task:expr, $problem:ident => $value:expr) => {
        match $task {
            DesignTask::QuadraticStabilisation($problem) => $value,
            DesignTask::HInfinity($problem) => $value,
            DesignTask::SaturatedRegion($problem) => $value,
        }
    };
}
use with_problem;

fn key<P: DesignProblem>(_: &P) -> &'static str {
    P::NAME
}

fn guarantee<P: DesignProblem>(_: &P) -> &'static str {
    P::GUARANTEE
}

fn objective<P: DesignProblem>(_: &P) -> &'static str {
    P::OBJECTIVE
}

fn auxiliary_gains<P: DesignProblem>(_: &P) -> &'static [&'static str] {
    P::AUXILIARY_GAINS
}

impl DesignTask {
    /// The problem's key in a file.
    pub fn name(&self) -> &'static str {
        with_problem!(self, problem => key(problem))
    }

    /// The rate alpha with which V must decay twice as fast [1/s]; 0 where none is asked for.
    pub fn decay_rate(&self) -> f64 {
        with_problem!(self, problem => problem.decay_rate())
    }

    /// What the guaranteed number is.
    pub fn guarantee(&self) -> &'static str {
        with_problem!(self, problem => guarantee(problem))
    }

    /// What synthesis minimises, in terms of the guaranteed number: `gamma`, `c^2` or `1/beta^2`.
    pub fn objective(&self) -> &'static str {
        with_problem!(self, problem => objective(problem))
    }

    /// Names of the auxiliary gains that a proof needs.
    pub fn auxiliary_gains(&self) -> &'static [&'static str] {
        with_problem!(self, problem => auxiliary_gains(problem))
    }

    /// Every condition of the proof of a feedback, one after the other.
    pub fn for_each_condition<S: Scalar>(
        &self,
        plant: &VertexPlant,
        found: &StateFeedback,
        mut check: impl FnMut(String, Matrix<S>),
    ) {
        let proof = Proof::new(plant, found);
        with_problem!(self, problem => problem.statements(&proof, &mut check));
    }

    /// What is asked of the guaranteed number.
    pub fn wanted(&self) -> Wanted {
        with_problem!(self, problem => problem.wanted())
    }

    /// The same task with nothing asked of the guaranteed number.
    fn without_wanted(&self) -> Self {
        match self {
            DesignTask::QuadraticStabilisation(problem) => {
                DesignTask::QuadraticStabilisation(problem.without_wanted())
            }
            DesignTask::HInfinity(problem) => DesignTask::HInfinity(problem.without_wanted()),
            DesignTask::SaturatedRegion(problem) => {
                DesignTask::SaturatedRegion(problem.without_wanted())
            }
        }
    }

    /// The guaranteed number at which the search for a better one stops; `None` where nothing stops it.
    pub fn floor(&self, plant: &VertexPlant) -> Option<f64> {
        fn guarantee<P: DesignProblem>(problem: &P, plant: &VertexPlant) -> Option<f64> {
            let floor = problem.floor(plant)?;
            Some(P::guarantee_of(floor.objective))
        }
        with_problem!(self, problem => guarantee(problem, plant))
    }

    /// What the proof assumes.
    pub fn assumptions(&self) -> Vec<String> {
        let mut out = vec![
            "the state is measured without error".to_string(),
            "a feedback that acts continuously and without delay".to_string(),
            "a plant inside the convex hull of the vertex systems".to_string(),
        ];
        out.extend(with_problem!(self, problem => problem.assumptions()));
        out
    }
}
