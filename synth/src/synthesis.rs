//! From a model to a proved design.

mod assemble;
mod run;

pub use assemble::{assemble, Assembled, Form, Goal};
pub use run::{scaled_task, synthesize, FIRST_UNITS, Cancelled, Failure, Outcome, SynthesisError, Synthesized};
