//! The plants that a scenario file may name.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use super::rigid_body::{RigidBodyFile, RigidBodySystem};
use super::takagi_sugeno::{TakagiSugenoFile, TakagiSugenoSystem};
use crate::plants::rigid_body::check::rigid_body;
use crate::plants::takagi_sugeno::check::takagi_sugeno;

/// The kinds of systems.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SystemFile {
    /// A rigid spacecraft.
    RigidBody(Box<RigidBodyFile>),
    /// A Takagi-Sugeno model of any size.
    TakagiSugeno(Box<TakagiSugenoFile>),
}

/// The plant with its initial state, disturbance, sensors and actuators.
#[derive(Debug, Clone)]
pub enum System {
    /// A rigid spacecraft.
    RigidBody(Box<RigidBodySystem>),
    /// A Takagi-Sugeno model.
    TakagiSugeno(Box<TakagiSugenoSystem>),
}

/// Checks the system of a file.
pub(crate) fn check_system(file: &SystemFile, seed: u64) -> Result<System, ModelError> {
    match file {
        SystemFile::RigidBody(body) => {
            let body = rigid_body(body, seed).map_err(|error| error.within("system.rigid_body"))?;
            Ok(System::RigidBody(Box::new(body)))
        }
        SystemFile::TakagiSugeno(model) => {
            let model = takagi_sugeno(model).map_err(|e| e.within("system.takagi_sugeno"))?;
            Ok(System::TakagiSugeno(Box::new(model)))
        }
    }
}
