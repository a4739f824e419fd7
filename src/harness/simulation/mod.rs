//! From a scenario (and a design) to the outcome of its run.

mod attitude_log;
mod designed;
mod judge;
mod rigid_body;
mod state_log;
mod takagi_sugeno;

pub use attitude_log::{AttitudeLog, SettleRule};

use runtime::error::ParameterError;

use super::design::{Design, FitError, NoLaw};
use super::recorder::Table;
use super::scenario::{ControllerChoice, Scenario, System};
use super::summary::Summary;

/// What a run left.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Its summary.
    pub summary: Summary,
    /// Its trajectory, when asked for.
    pub trajectory: Option<Table>,
    /// Its profile, one quantity of [`profile_quantities`] after the other.
    pub profile: Vec<f32>,
}

/// What is recorded of a run beside its metrics.
#[derive(Debug, Clone, Copy, Default)]
pub struct Recording<'a> {
    /// Whether the trajectory is kept.
    pub trajectory: bool,
    /// Times of the profile, s, increasing; none for no profile.
    pub profile_times_s: &'a [f64],
}

/// The quantities of a profile, with units.
pub fn profile_quantities(system: &System) -> Vec<&'static str> {
    match system {
        System::RigidBody(_) => vec!["error_deg", "rate_rad_s"],
        System::TakagiSugeno(_) => vec!["state_norm"],
    }
}

/// Why a scenario cannot be run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulateError {
    /// The scenario needs a design.
    #[error(
        "field 'controller.design': no design file is given; name one with --design or in \
         'controller.design.file'"
    )]
    NoDesign,
    /// The scenario does not use the design.
    #[error("field 'controller': a design is given, but the controller is not 'design'")]
    UnusedDesign,
    /// The design does not fit.
    #[error("the design does not fit the scenario: {0}")]
    Fit(#[from] FitError),
    /// The codec refuses the link.
    #[error("field 'link': {0}")]
    Link(ParameterError),
    /// The design's gains are no law that can be run.
    #[error(transparent)]
    NoLaw(#[from] NoLaw),
    /// The plant is to be weighted by the memberships of a model that has none.
    #[error(
        "field 'system.takagi_sugeno.mixing': \"model\" needs a design whose model has local rules, as \
         many as the scenario's vertices ({vertices})"
    )]
    NoRules {
        /// Vertices of the scenario.
        vertices: usize,
    },
    /// The flight code refuses the controller.
    #[error("the flight code refuses the controller: {0}")]
    Controller(ParameterError),
}

impl From<ParameterError> for SimulateError {
    fn from(error: ParameterError) -> Self {
        SimulateError::Controller(error)
    }
}

/// Runs a scenario. `trajectory`: whether to keep it.
///
/// # Errors
/// A design that is missing, not asked for or does not fit; parameters that the flight code refuses.
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
/// A design that is missing, not asked for or does not fit; parameters that the flight code refuses.
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
/// A design that is missing, not asked for or does not fit.
pub fn check_design(scenario: &Scenario, design: Option<&Design>) -> Result<(), SimulateError> {
    match (&scenario.controller, design) {
        (ControllerChoice::Design(_), None) => Err(SimulateError::NoDesign),
        (ControllerChoice::Design(_), Some(design)) => Ok(design.check_fit(&scenario.system)?),
        (_, Some(_)) => Err(SimulateError::UnusedDesign),
        (_, None) => Ok(()),
    }
}

/// Breakpoints in order, without those at the start or after the end.
fn ordered(mut breakpoints_s: Vec<f64>, duration_s: f64) -> Vec<f64> {
    breakpoints_s.retain(|&time| time > 0.0 && time < duration_s);
    breakpoints_s.sort_by(f64::total_cmp);
    breakpoints_s.dedup();
    breakpoints_s
}
