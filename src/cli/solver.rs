//! Which solver: the option shared by the verbs.

use clap::ValueEnum;
use synth::solve::{Backend, Clarabel, DenseColumns, Structured};
use synth::synthesis::Form;

/// A semidefinite programming solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SolverArg {
    /// A general conic interior-point method
    Clarabel,
    /// An interior-point method for few unknowns and many small cones
    Structured,
}

impl SolverArg {
    /// The solver with its usual settings.
    pub fn backend(self) -> Box<dyn Backend + Send + Sync> {
        match self {
            SolverArg::Clarabel => Box::new(Clarabel::default()),
            SolverArg::Structured => Box::new(Structured::default()),
        }
    }

    /// The solver with the settings that suit a form.
    pub fn backend_for(self, form: Form) -> Box<dyn Backend> {
        match (self, form) {
            // Densified columns make the full form faster but cost it digits, and they are there for comparison.
            (SolverArg::Clarabel, Form::Full) => Box::new(Clarabel {
                dense_columns: DenseColumns::None,
            }),
            _ => self.backend(),
        }
    }

    /// The form of the decrease condition that the solver is fastest with.
    pub fn form(self) -> Form {
        match self {
            SolverArg::Clarabel => Form::Chordal,
            SolverArg::Structured => Form::VertexRelaxed,
        }
    }

    /// The other solver.
    pub fn other(self) -> Self {
        match self {
            SolverArg::Clarabel => SolverArg::Structured,
            SolverArg::Structured => SolverArg::Clarabel,
        }
    }
}

/// Form of the decrease condition. Files keep the names of version 0.1.0, which are aliases here.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FormArg {
    /// Small cones, exactly equivalent
    #[value(alias = "reduced")]
    Chordal,
    /// Few unknowns, exactly equivalent
    #[value(alias = "slack")]
    VertexRelaxed,
    /// Large cones, as published
    Full,
}

impl From<FormArg> for Form {
    fn from(form: FormArg) -> Self {
        match form {
            FormArg::Chordal => Form::Chordal,
            FormArg::VertexRelaxed => Form::VertexRelaxed,
            FormArg::Full => Form::Full,
        }
    }
}
