//! Scenario files: a plant, a controller and what is required of them.

mod check;
mod dispersions;
pub mod distribution;
mod file;
mod link;
mod network;

pub use check::{design_check, Scenario};
pub use dispersions::*;
pub use file::*;
pub use link::*;
pub use network::*;
