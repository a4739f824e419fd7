//! Scenario files: a plant, a controller and what is required of them.

mod check;
mod controller_file;
mod controllers;
mod dispersions;
mod dispersions_file;
mod file;
mod inertia;
mod lei;
mod lei_file;
mod link_file;
mod links;
mod system_file;
mod systems;
mod yang;
mod yang_file;

pub use check::{sha256_of, Scenario};
pub use controller_file::*;
pub use controllers::{ControllerChoice, XuChoice};
pub use dispersions::{Dispersion, Dispersions, FaultDispersion};
pub use dispersions_file::*;
pub use file::*;
pub use lei_file::*;
pub use link_file::*;
pub use system_file::*;
pub(crate) use systems::attitude as attitude_of;
pub use systems::{RigidBodySystem, System, TakagiSugenoSystem};
pub use yang::YangChoice;
pub use yang_file::*;
