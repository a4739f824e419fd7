//! What a run leaves, and why there may be none.

use runtime::error::ParameterError;

use super::design::{FitError, NoLaw};
use super::summary::Summary;
use crate::base::table::Table;

/// What a run left.
#[derive(Debug, Clone)]
pub struct RunOutcome {
    /// Its summary.
    pub summary: Summary,
    /// Its trajectory, when requested.
    pub trajectory: Option<Table>,
    /// Its profile, one of the plant's
    /// [`profile_quantities`](crate::plants::System::profile_quantities) after the other.
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
