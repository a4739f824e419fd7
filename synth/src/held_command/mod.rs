//! A proof for a given law u = F x(t_k), held and saturated, that sends by a trigger on the command.
//!
//! The conditions are those of [`conditions::held_command`](crate::conditions::held_command), the proof that of
//! [`certify::held_command`](crate::certify::held_command). Here are the solves, the choice of numbers, and the file.

mod claims;
mod file;
mod program;
mod scaled;
mod synthesize;

pub use file::{
    check_covered, CommandCertificateFile, CommandControllerFile, CommandProof, HandOverFile,
    HeldCommandDesignFile, HeldCommandProvenance,
};
pub use synthesize::{
    check_synthesized, synthesize, CommandRequest, HeldCommandOutcome, HeldCommandSynthesized,
};
