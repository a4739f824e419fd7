//! Results as text and as JSON.

pub mod campaign;
pub mod claims;
pub mod feasibility;
pub mod reach;
pub mod run;
pub mod verdict;
