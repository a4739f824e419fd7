//! Scenario files: a plant, a controller and what is required of them.

mod check;
mod controllers;
mod file;
mod systems;

pub use check::Scenario;
pub use controllers::{ControllerChoice, XuChoice};
pub use file::*;
pub use systems::{RigidBodySystem, System, TakagiSugenoSystem};
