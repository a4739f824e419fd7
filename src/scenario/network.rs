//! The network of a scenario, and what of a scenario is chosen against a design.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use crate::base::bounded::{As, NonNegative};
use crate::base::ranges::require;
use crate::controllers::ControllerChoice;
use crate::plants::System;
use crate::sim::gain_error::GainKind;
use crate::sim::integrator::Method;
use crate::sim::measurement_error::ErrorKind;
use crate::sim::network::{Delay, Loss, NetworkData};
use crate::sim::sampling::Instants;

/// What happens to the controller's messages on their way.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NetworkFile {
    /// Longest time from a transmission to its arrival, not negative (s).
    #[serde(default, with = "As::<NonNegative>")]
    pub delay_s: f64,
    /// How late each message is.
    #[serde(default)]
    pub delay: Delay,
    /// The most transmissions that are lost in a row, at most 100; no more than so many, whatever the loss is.
    #[serde(default)]
    #[schemars(range(max = 100))]
    pub lost_in_a_row: u32,
    /// Which transmissions are lost, where any may be.
    #[serde(default)]
    pub loss: Loss,
    /// At how many following samples a value is sent again, at most 100; when left out, as many as the design's model
    /// says in imperfections.lost_in_a_row, and none for another controller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 100))]
    pub repeats: Option<u32>,
}

/// A network, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkChoice {
    data: NetworkData,
    repeats: Option<u32>,
}

/// The most losses and repetitions.
const MOST: u32 = 100;
/// The longest delay in intervals between samples: what is on its way is kept in memory.
const MOST_ON_THE_WAY: f64 = 1e4;

impl NetworkChoice {
    /// The network, for a design that repeats so often where the scenario does not say.
    pub fn data(&self, repeats: u32) -> NetworkData {
        NetworkData {
            repeats: self.repeats.unwrap_or(repeats),
            ..self.data
        }
    }
}

/// Checks the network of a file.
pub(crate) fn check_network(
    file: &NetworkFile,
    instants: &Instants,
    linked: bool,
) -> Result<NetworkChoice, ModelError> {
    for (field, count) in [
        ("network.lost_in_a_row", file.lost_in_a_row),
        ("network.repeats", file.repeats.unwrap_or(0)),
    ] {
        require(count <= MOST, field, f64::from(count), "in 0 to 100")?;
    }
    if linked {
        let expected =
            "one of them: a network carries the controller's messages, a link its torques";
        return Err(ModelError::shape("network", "network and link", expected));
    }
    if let Instants::Continuous { resolution_s } = *instants {
        let field = "sampling.instants.continuous.resolution_s";
        let allowed = "left out, because a network needs periodic or aperiodic sampling";
        require(false, field, resolution_s, allowed)?;
    }
    let samples = instants.expected_samples(file.delay_s).unwrap_or(0.0);
    let ok = samples <= MOST_ON_THE_WAY;
    let allowed = "at most 1e4 intervals between samples";
    require(ok, "network.delay_s", file.delay_s, allowed)?;
    Ok(NetworkChoice {
        data: NetworkData {
            delay_s: file.delay_s,
            delay: file.delay,
            lost_in_a_row: file.lost_in_a_row,
            loss: file.loss,
            repeats: 0,
        },
        repeats: file.repeats,
    })
}

/// Refuses what is chosen against a design where the controller is none, and a disturbance that is where there are no
/// events at which to choose it.
pub(crate) fn check_worst(
    system: &System,
    network: Option<&NetworkChoice>,
    controller: &ControllerChoice,
    (instants, method): (&Instants, &Method),
) -> Result<(), ModelError> {
    let (field, worst) = match system {
        System::RigidBody(body) => (
            "system.rigid_body.disturbance.worst_nm",
            body.disturbance.worst,
        ),
        System::TakagiSugeno(model) => (
            "system.takagi_sugeno.disturbance.worst",
            model.disturbance.worst,
        ),
    };
    let held = matches!(method, Method::RungeKutta4 { .. })
        && !matches!(instants, Instants::Continuous { .. });
    let design = matches!(controller, ControllerChoice::Design(_));
    let allowed = "0 unless the controller is a design, sampled, and the integrator runge_kutta4";
    require(worst == 0.0 || held && design, field, worst, allowed)?;
    if matches!(controller, ControllerChoice::Design(_)) {
        return Ok(());
    }
    let worst = worst_of(system).or_else(|| {
        let needs = network.is_some_and(|network| network.data.needs_design());
        needs.then_some("network")
    });
    worst.map_or(Ok(()), |field| {
        let expected = "a kind other than worst, or a design as the controller: x'Ux is a design's";
        Err(ModelError::shape(field, "worst", expected))
    })
}

/// The first part of a system that is chosen against a design.
fn worst_of(system: &System) -> Option<&'static str> {
    let (error, gain, fields) = match system {
        System::RigidBody(body) => (
            body.sensors.bounded.as_ref(),
            body.actuators.gain_error.as_ref().map(|gain| gain.kind),
            [
                "system.rigid_body.sensors.bounded_error.kind",
                "system.rigid_body.actuators.gain_error.kind",
            ],
        ),
        System::TakagiSugeno(model) => (
            model.measurement_error.as_ref(),
            model.gain_error.as_ref().map(|gain| gain.kind),
            [
                "system.takagi_sugeno.measurement_error.kind",
                "system.takagi_sugeno.gain_error.kind",
            ],
        ),
    };
    let [of_error, of_gain] = fields;
    if error.is_some_and(|error| error.kind == ErrorKind::Worst) {
        return Some(of_error);
    }
    (gain == Some(GainKind::Worst)).then_some(of_gain)
}

/// Whether anything in a scenario is chosen against a design.
pub(crate) fn has_worst(system: &System, network: Option<&NetworkChoice>) -> bool {
    worst_of(system).is_some() || network.is_some_and(|network| network.data.needs_design())
}
