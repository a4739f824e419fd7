//! Runs of a spacecraft.

use super::design::Design;
use super::designed::designed_attitude;
use super::flight::{finish, Certified, Flight};
use super::judge::About;
use super::outcome::{Outcome, Recording, SimulateError};
use crate::controllers::law::{Flown, Surroundings};
use crate::plants::rigid_body::gauge::SettleRule;
use crate::plants::{RigidBodySystem, SystemKind};
use crate::scenario::Scenario;
use crate::sim::link::Link;

/// Runs a scenario on a spacecraft.
pub(crate) fn run(
    scenario: &Scenario,
    system: &RigidBodySystem,
    design: Option<&Design>,
    recording: &Recording,
) -> Result<Outcome, SimulateError> {
    let settle = match scenario.settle_tolerance_component {
        Some(tolerance) => SettleRule::Component(tolerance),
        None => SettleRule::Angle(scenario.settle_tolerance_rad),
    };
    let link = scenario.link.as_ref();
    let link = link.map(|data| Link::new(data, scenario.seed));
    let flight = Flight {
        scenario,
        bench: system.bench(settle, scenario.seed),
        design,
        link: link.transpose().map_err(SimulateError::Link)?,
        recording,
    };
    let around = Surroundings {
        system,
        linked: scenario.link.is_some(),
    };
    let law = scenario.controller.law();
    let (end, log) = match scenario
        .controller
        .build(&around, Certified::<_, 6>(flight))?
    {
        Ok(flown) => flown,
        Err(flight) => designed_attitude(design.ok_or(SimulateError::NoDesign)?, flight)?,
    };
    let notes = law.zip(log.start.as_ref()).map(|(law, start)| {
        law.notes(&Flown {
            system,
            instants: &scenario.instants,
            start,
            events: &log.events,
        })
    });
    let (controller, torque_limit) = match (law, design) {
        (Some(law), _) => (law.name(), law.torque_limit().as_slice().to_vec()),
        (None, Some(design)) => design.law(),
        (None, None) => Default::default(),
    };
    let about = About {
        system: SystemKind::RigidBody,
        controller,
        torque_limit,
        settle_tolerance: scenario.settle_tolerance_rad.to_degrees(),
        notes: notes.unwrap_or_default(),
        sends_by_link: law.is_some_and(|law| law.sends_by_link()),
    };
    Ok(finish(scenario, design, (end, log), about))
}
