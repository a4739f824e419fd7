//! Scenario files: a plant, a controller and what is required of them.

mod check;
mod controller_file;
mod controllers;
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

pub use check::Scenario;
pub use controller_file::*;
pub use controllers::{ControllerChoice, XuChoice};
pub use file::*;
pub use lei_file::*;
pub use link_file::*;
pub use system_file::*;
pub use systems::{RigidBodySystem, System, TakagiSugenoSystem};
pub use yang::YangChoice;
pub use yang_file::*;
