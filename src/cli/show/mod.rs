//! What the verbs report, each fact at one place: a type for the keys of `--json`, and the same in words.

pub mod blocking;
pub mod campaign;
pub mod check;
pub mod claims;
pub mod contents;
pub mod cross_check;
pub mod design;
pub mod feasibility;
pub mod infeasibility;
pub mod no_design;
pub mod problem;
pub mod run;
pub mod shortfall;
pub mod solution;
pub mod solver;
pub mod sweep;
pub mod tune;
pub mod verdict;
pub mod written;
