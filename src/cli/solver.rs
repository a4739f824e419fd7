//! Which solver: the option shared by the verbs.

use clap::ValueEnum;
use synth::solve::{Clarabel, DenseColumns, Solver, Structured};
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
        if let Some(named) = self.named() {
            return only((named, form));
        }
        let [first, second] = order;
        // Only the published form is stated for both alike.
        let second = (second, form.filter(|form| *form == Form::Full));
        with(only((first, form)), second)
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

/// Clarabel with the settings that suit a form.
fn clarabel(form: Form) -> Clarabel {
    match form {
        // Densified columns make the full form faster but cost it digits, and they are there for comparison.
        Form::Full => Clarabel {
            dense_columns: DenseColumns::None,
        },
        _ => Clarabel::default(),
    }
}

fn only((solver, form): (Solver, Option<Form>)) -> Solvers {
    let form = form.unwrap_or(Form::suited_to(solver));
    match solver {
        Solver::Clarabel => Solvers::only(clarabel(form), form),
        Solver::Structured => Solvers::only(Structured::default(), form),
    }
}

fn with(first: Solvers, (solver, form): (Solver, Option<Form>)) -> Solvers {
    let form = form.unwrap_or(Form::suited_to(solver));
    match solver {
        Solver::Clarabel => first.then(clarabel(form), form),
        Solver::Structured => first.then(Structured::default(), form),
    }
}

/// Both solvers, the named one first.
pub fn beginning_with(solver: Solver, form: Form) -> Solvers {
    let order = match solver {
        Solver::Clarabel => [Solver::Clarabel, Solver::Structured],
        Solver::Structured => [Solver::Structured, Solver::Clarabel],
    };
    SolverArg::Auto.solvers(order, Some(form))
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
