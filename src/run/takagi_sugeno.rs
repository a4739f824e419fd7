//! Runs of Takagi-Sugeno plants of any size, padded to one of a few sizes.

use synth::fuzzy::RuleModel;
use synth::model::Plant;

use super::design::Design;
use super::designed::designed;
use super::flight::{finish, Certified, Flight};
use super::judge::About;
use super::outcome::{Outcome, Recording, SimulateError};
use crate::plants::{Mixing, SystemKind, TakagiSugenoSystem};
use crate::scenario::Scenario;

/// Runs a scenario on a Takagi-Sugeno plant.
pub(crate) fn run(
    scenario: &Scenario,
    system: &TakagiSugenoSystem,
    design: &Design,
    recording: &Recording,
) -> Result<Outcome, SimulateError> {
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
) -> Result<Outcome, SimulateError> {
    let tolerance = scenario.settle_tolerance_state;
    let rules = mixing_rules(system, design)?;
    let flight = Flight {
        scenario,
        bench: system.bench::<N, M>(tolerance, rules, scenario.seed),
        design: Some(design),
        link: None,
        recording,
    };
    let flown = designed::<_, N, M, _>(design, Certified::<_, N>(flight))?;
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
        (Mixing::Model, Plant::Rules(rules)) if rules.sets.len() == vertices => {
            Ok(Some(rules.clone()))
        }
        (Mixing::Model, _) => Err(SimulateError::NoRules { vertices }),
        _ => Ok(None),
    }
}
