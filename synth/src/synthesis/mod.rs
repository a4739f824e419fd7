//! From a model to a proved design.

mod attempts;
mod coupled;
mod cross_check;
mod gain;
mod gyroscopic_form;
mod measured;
mod parameter_search;
mod restated;
mod run;
mod smallest_gain;
mod two_certificates;
mod weight_search;

pub use cross_check::{cross_check, CrossCheck, SolverOptimum};
pub use gyroscopic_form::with_chosen_form;
pub use parameter_search::reached;
pub(crate) use restated::restated;
pub use run::{analyse, synthesize};
pub use two_certificates::{coupled_problem, CouplingChoice};

pub use crate::programs::{
    assemble, assemble_at, scaled_task, solver_order, Assembled, Cancelled, Form, Goal,
    LimitingFactors, Outcome, Sensitivity, Solvers, SynthesisError, Synthesized, FIRST_UNITS,
};
