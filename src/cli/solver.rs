//! Which solver: the option shared by the verbs.

use clap::ValueEnum;
use synth::solve::{Backend, Clarabel, Structured};

/// A semidefinite programming solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SolverArg {
    /// Clarabel: a general conic interior-point method
    Clarabel,
    /// The structured one: interior-point on few unknowns and many small cones
    Structured,
}

impl SolverArg {
    /// The solver with its usual settings.
    pub fn backend(self) -> Box<dyn Backend> {
        match self {
            SolverArg::Clarabel => Box::new(Clarabel::default()),
            SolverArg::Structured => Box::new(Structured::default()),
        }
    }
}
