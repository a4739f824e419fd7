//! From a model to a proved design.

mod active;
mod assemble;
mod run;
mod solver;

pub use assemble::{assemble, assemble_at, Assembled, Form, Goal};
pub use run::{
    scaled_task, synthesize, Cancelled, Failure, Outcome, SynthesisError, Synthesized, FIRST_UNITS,
};

pub(crate) use solver::{generator, now, run_solver, sha256_of, Sought};
