//! From a model to a proved design.

mod active;
mod assemble;
mod run;

pub use assemble::{assemble, assemble_at, Assembled, Form, Goal};
pub use run::{
    analyse, scaled_task, synthesize, Cancelled, Failure, Outcome, SynthesisError, Synthesized,
    FIRST_UNITS,
};
