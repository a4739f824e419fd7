//! Scenario files: a plant, a controller and what is required of them.

mod check;
pub mod design_check;
mod dispersions;
mod dispersions_file;
pub mod distribution;
mod file;
mod link_file;
mod links;

pub use check::Scenario;
pub use design_check::design_check;
pub use dispersions::{Dispersion, Dispersions, FaultDispersion};
pub use dispersions_file::*;
pub use file::*;
pub use link_file::*;
