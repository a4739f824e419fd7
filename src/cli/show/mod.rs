//! What the verbs report, each fact at one place: a type for the keys of `--json`, and the same in words.

pub mod campaign;
pub mod check;
pub mod cross_check;
pub mod design;
pub mod facts;
pub mod feasibility;
pub mod held_command;
pub mod infeasibility;
pub mod no_design;
pub mod problem;
pub mod requirements;
pub mod run;
pub mod solution;
pub mod sweep;
pub mod tune;
