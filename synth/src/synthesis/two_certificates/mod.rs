//! One gain, two certificates.
//!
//! The inner certificate is for performance: a small set, the smallest gamma. The outer one is for the
//! region: it must contain given starts. The controller (F, Upsilon) is the same, so that in each set
//! that holds which is proved there, and a command that saturates in the outer set is no obstacle: with
//! N of its own each certificate admits as much saturation as it can prove.

mod assemble;
mod run;

pub use run::{coupled_problem, synthesize_both, BothOutcome, Choice, Tried};
