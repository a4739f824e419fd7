//! Runs of Takagi-Sugeno plants of any size, padded to one of a few sizes.

use runtime::membership::Membership;
use runtime::xu2020;
use synth::fuzzy::RuleModel;
use synth::model::Plant;

use super::design::Design;
use super::designed::{designed, Use};
use super::judge;
use super::judge::RunParts;
use super::outcome::{Outcome, Recording, SimulateError};
use super::state_log::StateLog;
use crate::controllers::xu2020::XuState;
use crate::plants::takagi_sugeno::TakagiSugenoSystem;
use crate::plants::{Mixing, TakagiSugenoPlant};
use crate::scenario::Scenario;
use crate::sim::actuator::ActuatorData;
use crate::sim::closed_loop::{ClosedLoop, End};
use crate::sim::embedding;
use crate::sim::lyapunov::LyapunovMonitor;
use crate::sim::metrics::Measured;
use crate::sim::profile::Profile;
use crate::sim::sampling::Sampling;
use crate::sim::sensor::StateSensor;

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
    let size = system.system.input_matrix.shape();
    let limit = design.model.plant.takagi_sugeno().input_limit;
    let actuators = ActuatorData {
        limit: embedding::filled(system.system.input_limit.as_slice(), f64::INFINITY),
        delay_s: system.input_delay_s,
        ..ActuatorData::ideal()
    };
    let rules = mixing_rules(system, design)?;
    let mut log = StateLog::new(
        size,
        scenario.settle_tolerance_state,
        scenario.duration_s - scenario.tail_s,
        LyapunovMonitor::new(design.claims::<N>()),
        recording.trajectory.then_some(scenario.output_interval_s),
    );
    log.profile = Profile::new(recording.profile_times_s, 1);
    let close_loop = CloseLoop {
        scenario,
        system,
        plant: TakagiSugenoPlant::new(&system.system, system.mixing.clone(), rules),
        actuators,
        log,
    };
    let (end, log) = designed::<N, M, _>(design, close_loop)?;
    let parts = RunParts {
        system: "takagi_sugeno",
        controller: format!(
            "design '{}': Xu and Huang 2020, law (12) and trigger (10)",
            design.file.name
        ),
        events: &log.events,
        measured: Measured {
            settle_seconds: log.error.settle_seconds(),
            final_state_norm: Some(log.last.norm()).filter(|norm| norm.is_finite()),
            rms_state_norm: log.error.tail_rms(),
            ..Measured::of(&log.events, &log.effort, scenario.duration_s)
        },
        steps: log.steps,
        torque_limit: limit.iter().copied().collect(),
        settle_tolerance: scenario.settle_tolerance_state,
        notes: Vec::new(),
        funnel: None,
        threshold: None,
        end,
    };
    let from_rest = log.start.norm() == 0.0;
    let certificate = judge::certificate(
        scenario,
        design,
        (&log.lyapunov, None),
        &log.events,
        from_rest,
    );
    let mut summary = judge::summary(scenario, Some(design), parts, Some(certificate));
    judge::conclude(scenario, &mut summary, end);
    Ok(Outcome {
        summary,
        profile: log
            .profile
            .clone()
            .into_values(end == End::Completed, &[log.last.norm()]),
        trajectory: log.into_table(),
    })
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

/// The closed loop that waits for its controller.
struct CloseLoop<'a, const N: usize, const M: usize> {
    scenario: &'a Scenario,
    system: &'a TakagiSugenoSystem,
    plant: TakagiSugenoPlant<N, M>,
    actuators: ActuatorData<M>,
    log: StateLog<N, M>,
}

impl<const N: usize, const M: usize> Use<N, M> for CloseLoop<'_, N, M> {
    type Output = (End, StateLog<N, M>);

    fn with<S, const R: usize>(self, controller: xu2020::Controller<S, N, M, R>) -> Self::Output
    where
        S: Membership<N, R> + Copy + std::fmt::Debug + 'static,
    {
        let (scenario, system, mut log) = (self.scenario, self.system, self.log);
        let states = system.system.input_matrix.nrows();
        let closed_loop = ClosedLoop {
            plant: &self.plant,
            disturbance: &system.disturbance.resized::<N>(),
            sensor: StateSensor::new(states, system.state_noise, scenario.seed),
            controller: XuState::new(controller, states),
            link: None,
            sampling: Sampling::new(
                scenario.instants,
                scenario.dropout_probability,
                scenario.seed,
            ),
            actuators: &self.actuators,
            breakpoints_s: Vec::new(),
            method: scenario.method,
            duration_s: scenario.duration_s,
        };
        let end = closed_loop.run(&embedding::vector(&system.initial_state), &mut log);
        (end, log)
    }
}
