//! The command line: the verbs, one file each, and how results and errors are printed.

mod answer;
mod design;
mod error;
mod files;
mod progress;
mod show;
mod solver;
mod verbs;

pub use error::CliError;
pub use verbs::run;
