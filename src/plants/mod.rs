//! Plants: what a controller is tried on, one folder each, as written in a scenario file and as checked.

pub mod registry;
pub mod rigid_body;
pub mod takagi_sugeno;

pub use registry::{System, SystemFile, SystemKind};
pub use rigid_body::{RigidBody, RigidBodySystem};
pub use takagi_sugeno::{Mixing, TakagiSugenoPlant, TakagiSugenoSystem};
