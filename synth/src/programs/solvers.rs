//! Which solvers may be asked, and in which order.

use super::assemble::Form;
use crate::conditions::Task;
use crate::model::{Model, Objective};
use sdp::solve::{Backend, Clarabel, Solver, Structured};

/// Above this many statements of (18) at a vertex the structured solver is asked first.
const FEW_VERTICES: usize = 40;

/// A solver with the form of the problems that are put to it.
pub(crate) type Asked<'a> = (&'a (dyn Backend + Send + Sync), Form);

/// The solvers that may be asked: each further one only where those before it prove nothing.
pub struct Solvers {
    first: (Box<dyn Backend + Send + Sync>, Form),
    second: Option<(Box<dyn Backend + Send + Sync>, Form)>,
}

impl Solvers {
    /// One solver.
    pub fn only(backend: impl Backend + Send + Sync + 'static, form: Form) -> Self {
        Solvers {
            first: (Box::new(backend), form),
            second: None,
        }
    }

    /// The same with another solver to be asked where the first proves nothing.
    pub fn then(self, backend: impl Backend + Send + Sync + 'static, form: Form) -> Self {
        Solvers {
            second: Some((Box::new(backend), form)),
            ..self
        }
    }

    /// Both solvers in the given order, with their usual settings and the forms that they are fastest with.
    pub fn both(order: [Solver; 2]) -> Self {
        match order {
            [Solver::Structured, _] => Solvers::only(Structured::default(), Form::VertexRelaxed)
                .then(Clarabel::default(), Form::Chordal),
            [Solver::Clarabel, _] => Solvers::only(Clarabel::default(), Form::Chordal)
                .then(Structured::default(), Form::VertexRelaxed),
        }
    }

    /// Both solvers in the order that suits a model.
    pub fn suited_to(model: &Model) -> Self {
        Solvers::both(solver_order(model))
    }

    /// Puts another solver in the place of the first.
    pub fn begin_with(&mut self, backend: impl Backend + Send + Sync + 'static, form: Form) {
        self.first = (Box::new(backend), form);
    }

    /// Names and versions with the forms of their problems, in order.
    pub fn names(&self) -> String {
        let names = self.in_order().into_iter();
        let names =
            names.map(|(backend, form)| format!("{}, {} form", backend.name(), form.name()));
        names.collect::<Vec<_>>().join("; then ")
    }

    /// The solver asked first, with the form of its problems.
    pub fn first(&self) -> (&(dyn Backend + Send + Sync), Form) {
        (self.first.0.as_ref(), self.first.1)
    }

    /// The structured solver, where it may be asked; otherwise the first one.
    pub(crate) fn for_searches(&self) -> &(dyn Backend + Send + Sync) {
        let mut all = self.in_order().into_iter().map(|(backend, _)| backend);
        let structured = all.find(|&backend| is_structured(backend));
        structured.unwrap_or(self.first().0)
    }

    /// All solvers in order.
    pub(crate) fn in_order(&self) -> Vec<Asked<'_>> {
        let second = self.second.iter();
        let all = std::iter::once(&self.first).chain(second);
        all.map(|(backend, form)| (backend.as_ref(), *form))
            .collect()
    }
}

/// Whether this is the structured solver.
pub(crate) fn is_structured(backend: &dyn Backend) -> bool {
    backend.solver() == Some(Solver::Structured)
}

/// The order in which the two solvers are asked for a model: the structured one first for searches, two certificates
/// and many vertices, where it is faster; Clarabel first for a single small design.
pub fn solver_order(model: &Model) -> [Solver; 2] {
    let specs = &model.file.specs;
    let many_solves =
        specs.search.is_some() || matches!(specs.objective, Objective::Region | Objective::Both);
    match many_solves || statements(&model.task()) > FEW_VERTICES {
        true => [Solver::Structured, Solver::Clarabel],
        false => [Solver::Clarabel, Solver::Structured],
    }
}

/// How often (18) is stated at each end of the sampling interval: at every vertex system, for every gain.
fn statements(task: &Task) -> usize {
    task.system.vertices.len() * task.gains.count
}
