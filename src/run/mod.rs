//! From a scenario (and a design) to the outcome of its run.

pub mod design;
mod designed;
pub mod files;
mod flight;
pub mod inner;
mod judge;
mod log;
pub mod outcome;
mod rigid_body;
pub mod summary;
mod takagi_sugeno;

use design::Design;
use outcome::{Outcome, Recording, SimulateError};

use crate::controllers::ControllerChoice;
use crate::plants::System;
use crate::scenario::Scenario;

/// Runs a scenario. `trajectory`: whether to keep it.
///
/// # Errors
/// A design that is missing, not requested or does not fit; parameters that the flight code refuses.
pub fn simulate(
    scenario: &Scenario,
    design: Option<&Design>,
    trajectory: bool,
) -> Result<Outcome, SimulateError> {
    let recording = Recording {
        trajectory,
        ..Recording::default()
    };
    simulate_recording(scenario, design, &recording)
}

/// Runs a scenario and records more or less of it. What is recorded does not change the run.
///
/// # Errors
/// A design that is missing, not requested or does not fit; parameters that the flight code refuses.
pub fn simulate_recording(
    scenario: &Scenario,
    design: Option<&Design>,
    recording: &Recording,
) -> Result<Outcome, SimulateError> {
    check_design(scenario, design)?;
    match &scenario.system {
        System::RigidBody(body) => rigid_body::run(scenario, body, design, recording),
        System::TakagiSugeno(model) => {
            let design = design.ok_or(SimulateError::NoDesign)?;
            takagi_sugeno::run(scenario, model, design, recording)
        }
    }
}

/// Checks that the scenario has the design that it needs, and none that it does not use.
///
/// # Errors
/// A design that is missing, not requested or does not fit.
pub fn check_design(scenario: &Scenario, design: Option<&Design>) -> Result<(), SimulateError> {
    match (&scenario.controller, design) {
        (ControllerChoice::Design(_), None) => Err(SimulateError::NoDesign),
        (ControllerChoice::Design(_), Some(design)) => Ok(design.check_fit(&scenario.system)?),
        (_, Some(_)) => Err(SimulateError::UnusedDesign),
        (_, None) => Ok(()),
    }
}
