//! From a scenario (and a design) to the outcome of its run.

mod claims;
pub mod design;
pub(crate) mod designed;
pub mod files;
mod flight;
mod imperfections;
pub mod inner;
mod judge;
mod log;
pub mod outcome;
pub mod summary;

use synth::fuzzy::RuleModel;
use synth::model;

use design::Design;
use designed::{designed, designed_attitude};
use flight::{finish, Flight};
use judge::About;
use outcome::{Recording, RunOutcome, SimulateError};

use crate::controllers::law::{Flown, Surroundings};
use crate::controllers::ControllerChoice;
use crate::plants::rigid_body::gauge::{AttitudeGauge, SettleRule};
use crate::plants::{Mixing, RigidBodySystem, System, SystemKind, TakagiSugenoSystem};
use crate::scenario::Scenario;
use crate::sim::bench::Bench;
use crate::sim::link::Link;
use crate::sim::plant::Plant;
use crate::sim::sensor::AttitudeSensor;

/// Runs a scenario. `trajectory`: whether to keep it.
///
/// # Errors
/// A design that is missing, not requested or does not fit; parameters that the flight code refuses.
pub fn simulate(
    scenario: &Scenario,
    design: Option<&Design>,
    trajectory: bool,
) -> Result<RunOutcome, SimulateError> {
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
) -> Result<RunOutcome, SimulateError> {
    check_design(scenario, design)?;
    match &scenario.system {
        System::RigidBody(body) => run_spacecraft(scenario, body, design, recording),
        System::TakagiSugeno(model) => {
            let design = design.ok_or(SimulateError::NoDesign)?;
            run_takagi_sugeno(scenario, model, design, recording)
        }
    }
}

/// Checks that the scenario has the design that it needs, and none that it does not use, and that this design's law is
/// the one that was proved.
///
/// # Errors
/// A design that is missing, not requested, does not fit, or is no law that can be run.
pub fn check_design(scenario: &Scenario, design: Option<&Design>) -> Result<(), SimulateError> {
    match (&scenario.controller, design) {
        (ControllerChoice::Design(_), None) => Err(SimulateError::NoDesign),
        (ControllerChoice::Design(_), Some(design)) => {
            design.law_gains()?;
            Ok(design.check_fit(&scenario.system)?)
        }
        (_, Some(_)) => Err(SimulateError::UnusedDesign),
        (_, None) => Ok(()),
    }
}

/// Runs a scenario on a spacecraft.
fn run_spacecraft(
    scenario: &Scenario,
    system: &RigidBodySystem,
    design: Option<&Design>,
    recording: &Recording,
) -> Result<RunOutcome, SimulateError> {
    let settle = match scenario.settle_tolerance_component {
        Some(tolerance) => SettleRule::Component(tolerance),
        None => SettleRule::Angle(scenario.settle_tolerance_rad),
    };
    let worst = design.map(|design| design.worst_case::<6, 3, 3>().by_error);
    let bench = system.bench(settle, worst, scenario.seed);
    match system.wheels {
        None => fly(scenario, system, design, bench, recording),
        Some(wheels) => fly(
            scenario,
            system,
            design,
            bench.with_wheels(wheels),
            recording,
        ),
    }
}

/// Runs a scenario on a spacecraft with or without wheels.
fn fly<P, const N: usize>(
    scenario: &Scenario,
    system: &RigidBodySystem,
    design: Option<&Design>,
    bench: Bench<P, AttitudeSensor, AttitudeGauge, N, 3, 3>,
    recording: &Recording,
) -> Result<RunOutcome, SimulateError>
where
    P: Plant<N, 3, 3>,
{
    let link = scenario.link.as_ref();
    let link = link.map(|data| Link::new(data, scenario.seed));
    let flight = Flight::<_, _, _, N, 3, 3, 6> {
        scenario,
        bench,
        design,
        link: link.transpose().map_err(SimulateError::Link)?,
        recording,
    };
    let around = Surroundings {
        system,
        linked: scenario.link.is_some(),
    };
    let law = scenario.controller.law();
    let (end, log) = match scenario.controller.build(&around, flight)? {
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

/// Runs a scenario on a Takagi-Sugeno plant.
fn run_takagi_sugeno(
    scenario: &Scenario,
    system: &TakagiSugenoSystem,
    design: &Design,
    recording: &Recording,
) -> Result<RunOutcome, SimulateError> {
    let (states, inputs) = system.system.input_matrix.shape();
    let disturbances = system.system.disturbance_matrix.ncols();
    let outputs = design.model.plant.sizes().3;
    match (states.max(disturbances).max(outputs), inputs) {
        (..=2, ..=1) => run_padded::<2, 1>(scenario, system, design, recording),
        (..=6, ..=3) => run_padded::<6, 3>(scenario, system, design, recording),
        _ => run_padded::<24, 12>(scenario, system, design, recording),
    }
}

fn run_padded<const N: usize, const M: usize>(
    scenario: &Scenario,
    system: &TakagiSugenoSystem,
    design: &Design,
    recording: &Recording,
) -> Result<RunOutcome, SimulateError> {
    let tolerance = scenario.settle_tolerance_state;
    let rules = mixing_rules(system, design)?;
    let worst = design.worst_case::<N, M, N>().by_error;
    let flight = Flight::<_, _, _, N, M, N, N> {
        scenario,
        bench: system.bench::<N, M>(tolerance, rules, worst, scenario.seed),
        design: Some(design),
        link: None,
        recording,
    };
    let flown = designed::<_, N, M, _>(design, flight)?;
    let (controller, torque_limit) = design.law();
    let about = About {
        system: SystemKind::TakagiSugeno,
        controller,
        torque_limit,
        settle_tolerance: tolerance,
        notes: Vec::new(),
        sends_by_link: false,
    };
    Ok(finish(scenario, Some(design), flown, about))
}

/// The rules that weigh the plant's vertices, where the scenario wants the model's memberships.
fn mixing_rules(
    system: &TakagiSugenoSystem,
    design: &Design,
) -> Result<Option<RuleModel>, SimulateError> {
    let vertices = system.system.state_matrices.len();
    match (&system.mixing, &design.model.plant) {
        (Mixing::Model, model::Plant::Rules(rules)) if rules.sets.len() == vertices => {
            Ok(Some(rules.clone()))
        }
        (Mixing::Model, _) => Err(SimulateError::NoRules { vertices }),
        _ => Ok(None),
    }
}
