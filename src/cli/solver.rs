//! Which solver: the option shared by the verbs.

use clap::ValueEnum;
use synth::solve::Solver;
use synth::synthesis::{Form, Solvers};

/// Which solvers of semidefinite programs may be asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SolverArg {
    /// Both, in an order that depends on the size: the second where the first proves nothing
    Auto,
    /// Only Clarabel, a general conic interior-point method
    Clarabel,
    /// Only the interior-point method for few unknowns and many small cones
    Structured,
}

impl SolverArg {
    /// The solvers, in `order` where both may be asked; with problems in a given form, or in the one that each is
    /// fastest with.
    pub fn solvers(self, order: [Solver; 2], form: Option<Form>) -> Solvers {
        let form = form.unwrap_or(Form::suited_to(self.first(order)));
        match self.named() {
            Some(solver) => Solvers::named(solver, form),
            None => Solvers::both_with_form(order, form),
        }
    }

    /// The solver that alone may be asked.
    pub fn named(self) -> Option<Solver> {
        match self {
            SolverArg::Auto => None,
            SolverArg::Clarabel => Some(Solver::Clarabel),
            SolverArg::Structured => Some(Solver::Structured),
        }
    }

    /// Its name.
    pub fn only(self) -> Option<&'static str> {
        match self {
            SolverArg::Auto => None,
            SolverArg::Clarabel => Some("clarabel"),
            SolverArg::Structured => Some("structured"),
        }
    }

    /// The solver asked first.
    pub fn first(self, order: [Solver; 2]) -> Solver {
        self.named().unwrap_or(order[0])
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
