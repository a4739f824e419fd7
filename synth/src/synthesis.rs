//! From a model to a proved design.

mod assemble;
mod run;

pub use assemble::{assemble, Assembled, Form, Goal};
pub use run::{synthesize, Cancelled, Failure, Outcome, SynthesisError, Synthesized};
