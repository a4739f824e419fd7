//! The verbs, one file each.

pub mod analyse;
pub mod campaign;
pub mod check;
pub mod compare;
pub mod export;
pub mod feasibility;
pub mod merge;
pub mod report;
pub mod schema;
pub mod simulate;
pub mod solve;
pub mod sweep;
pub mod synthesize;
pub mod tune;
pub mod verify;
