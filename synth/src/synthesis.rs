//! From a model to a proved design.

mod active;
mod assemble;
mod cross_check;
mod run;

pub use assemble::{assemble, assemble_at, Assembled, Form, Goal};
pub use cross_check::{cross_check, Candidate, CrossCheck, Found};
pub use run::{
    scaled_task, synthesize, Cancelled, Failure, Outcome, SynthesisError, Synthesized, FIRST_UNITS,
};
