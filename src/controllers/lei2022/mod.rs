//! The controller of Lei et al. 2022.

pub mod bounds;
pub mod conditions;
pub mod file;
mod law;

pub use bounds::{Bounds, Case};
pub use conditions::conditions;
pub use file::*;
