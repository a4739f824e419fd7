//! The command line.
//!
//! A verb (`verbs`) reads its files, calls the library and returns an `Answer`: an exit status, a report and the same
//! in words. `show` holds the reports, each fact at one place: a type whose documented fields are the keys of
//! `--json`, and its wording. `answer` prints, once; whatever else is printed, such as progress, goes to standard error.

mod answer;
mod arguments;
mod contents;
mod design;
mod document;
mod error;
mod files;
mod physics;
mod progress;
mod show;
mod solver;
mod target;
mod verbs;

pub use error::CliError;
pub use verbs::run;
