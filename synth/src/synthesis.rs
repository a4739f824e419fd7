//! From a model to a proved design.

mod active;
mod assemble;
mod both;
mod cross_check;
mod outer;
mod run;
mod search;
mod solver;
mod subject;

pub use assemble::{assemble, assemble_at, Assembled, Form, Goal};
pub use both::{coupled_problem, synthesize_both, BothOutcome, Choice, Tried};
pub use cross_check::{cross_check, Candidate, CrossCheck, Found};
pub use outer::{reached, Sensitivity, Shortfall};
pub use run::{
    analyse, scaled_task, synthesize, Cancelled, Outcome, SynthesisError, Synthesized, FIRST_UNITS,
};

pub(crate) use run::{containment_weights, scaled, STATE_UNITS};
pub(crate) use search::Search;
pub(crate) use solver::{blocking, generator, now, run_solver, sha256_of, Sought};
pub(crate) use subject::{Part, Subject};
