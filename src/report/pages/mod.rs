//! The pages.

pub mod campaign;
pub mod comparison;
pub mod files;
pub mod run;
pub mod sweep;
