//! The command line and the validation harness of Steadfast.

pub mod cli;
pub mod harness;
