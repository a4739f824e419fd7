//! Which solvers may be asked, and in which order.

use std::sync::Arc;

use super::assemble::Form;
use crate::conditions::Task;
use crate::model::{Model, Objective};
use sdp::solve::{Backend, Clarabel, DenseColumns, Solver, Structured};

/// Above this many statements of (18) at a vertex the structured solver is asked first.
const FEW_VERTICES: usize = 40;

/// A solver with the form of the problems that are put to it.
pub(crate) type Asked<'a> = (&'a (dyn Backend + Send + Sync), Form);

/// The solvers that may be asked, in order: each further one only where those before it prove nothing. At least one.
pub struct Solvers {
    asked: Vec<(Arc<dyn Backend + Send + Sync>, Form)>,
}

impl Solvers {
    /// One solver.
    pub fn only(backend: impl Backend + Send + Sync + 'static, form: Form) -> Self {
        Solvers {
            asked: vec![(Arc::new(backend), form)],
        }
    }

    /// One of the two solvers with the settings that suit a form.
    pub fn named(solver: Solver, form: Form) -> Self {
        Solvers {
            asked: vec![(suited_to(solver, form), form)],
        }
    }

    /// Both solvers in the given order, with the forms that they are fastest with.
    pub fn both(order: [Solver; 2]) -> Self {
        Solvers::both_with_form(order, Form::suited_to(order[0]))
    }

    /// The same with the form of the first solver's problems. Only the published form is stated for both alike.
    pub fn both_with_form([first, second]: [Solver; 2], form: Form) -> Self {
        let second_form = match form {
            Form::Full => Form::Full,
            _ => Form::suited_to(second),
        };
        let asked = [(first, form), (second, second_form)];
        Solvers {
            asked: asked
                .map(|(solver, form)| (suited_to(solver, form), form))
                .into(),
        }
    }

    /// Both solvers in the order that suits a model.
    pub fn suited_to(model: &Model) -> Self {
        Solvers::both(solver_order(model))
    }

    /// Each solver alone, in order.
    pub fn one_by_one(&self) -> Vec<Self> {
        let alone = |(backend, form): &(Arc<dyn Backend + Send + Sync>, Form)| Solvers {
            asked: vec![(Arc::clone(backend), *form)],
        };
        self.asked.iter().map(alone).collect()
    }

    /// Puts another solver in the place of the first.
    pub fn begin_with(&mut self, backend: impl Backend + Send + Sync + 'static, form: Form) {
        self.asked[0] = (Arc::new(backend), form);
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
        let (backend, form) = &self.asked[0];
        (backend.as_ref(), *form)
    }

    /// The structured solver, where it may be asked; otherwise the first one.
    pub(crate) fn for_searches(&self) -> &(dyn Backend + Send + Sync) {
        let mut all = self.in_order().into_iter().map(|(backend, _)| backend);
        let structured = all.find(|&backend| is_structured(backend));
        structured.unwrap_or(self.first().0)
    }

    /// All solvers, the one that searches use first.
    pub(crate) fn fastest_first(&self) -> Vec<Asked<'_>> {
        let mut all = self.in_order();
        all.sort_by_key(|(backend, _)| !is_structured(*backend));
        all
    }

    /// All solvers in order.
    pub(crate) fn in_order(&self) -> Vec<Asked<'_>> {
        let all = self.asked.iter();
        all.map(|(backend, form)| (backend.as_ref(), *form))
            .collect()
    }
}

/// A solver with the settings that suit a form.
fn suited_to(solver: Solver, form: Form) -> Arc<dyn Backend + Send + Sync> {
    match (solver, form) {
        (Solver::Structured, _) => Arc::new(Structured::default()),
        // Densified columns make the full form faster but cost it digits, and it is there for comparison.
        (Solver::Clarabel, Form::Full) => Arc::new(Clarabel {
            dense_columns: DenseColumns::None,
        }),
        (Solver::Clarabel, _) => Arc::new(Clarabel::default()),
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
    match many_solves || !is_small(&model.task()) {
        true => [Solver::Structured, Solver::Clarabel],
        false => [Solver::Clarabel, Solver::Structured],
    }
}

/// Whether (18) is stated at few vertices and gains, so that either solver is fast.
pub(crate) fn is_small(task: &Task) -> bool {
    task.system.vertices.len() * task.gains.count <= FEW_VERTICES
}
