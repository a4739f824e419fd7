//! From a model to a proved design.

mod active;
mod assemble;
mod run;

pub use assemble::{assemble, assemble_at, Assembled, Form, Goal};
pub use run::{scaled_task, synthesize, FIRST_UNITS, Cancelled, Failure, Outcome, SynthesisError, Synthesized};
