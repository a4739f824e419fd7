//! One gain, two certificates.
//!
//! The inner certificate is for performance: a small set, the smallest gamma. The large-set certificate is for the
//! region: it must contain given starts. The controller (F, Upsilon) is the same, so that in each set
//! what is proved for it holds, and the command may saturate in the large set: with an N of its own, each certificate
//! admits as much saturation as it can prove.

mod coupled;
mod run;

pub use run::{coupled_problem, synthesize, CouplingChoice};
