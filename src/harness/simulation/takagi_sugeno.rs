//! Runs of Takagi-Sugeno plants of any size, padded to one of a few sizes.

use super::judge::{self, Parts};
use super::state_log::StateLog;
use super::{Outcome, SimulateError};
use crate::harness::actuator::ActuatorData;
use crate::harness::closed_loop::ClosedLoop;
use crate::harness::controller::XuState;
use crate::harness::design::Design;
use crate::harness::lyapunov::LyapunovMonitor;
use crate::harness::padding;
use crate::harness::plant::TakagiSugenoPlant;
use crate::harness::sampling::Sampling;
use crate::harness::scenario::{Scenario, TakagiSugenoSystem};
use crate::harness::sensor::StateSensor;

/// Runs a scenario on a Takagi-Sugeno plant.
pub(super) fn run(
    scenario: &Scenario,
    system: &TakagiSugenoSystem,
    design: &Design,
    trajectory: bool,
) -> Result<Outcome, SimulateError> {
    let (states, inputs) = system.system.input_matrix.shape();
    let disturbances = system.system.disturbance_matrix.ncols();
    let outputs = design.model.plant.sizes().3;
    match (states.max(disturbances).max(outputs), inputs) {
        (..=2, ..=1) => run_padded::<2, 1>(scenario, system, design, trajectory),
        (..=6, ..=3) => run_padded::<6, 3>(scenario, system, design, trajectory),
        _ => run_padded::<24, 12>(scenario, system, design, trajectory),
    }
}

/// The limit of an input that only pads, which never receives a command.
const PADDED_LIMIT: f64 = 1.0;

fn run_padded<const N: usize, const M: usize>(
    scenario: &Scenario,
    system: &TakagiSugenoSystem,
    design: &Design,
    trajectory: bool,
) -> Result<Outcome, SimulateError> {
    let size = system.system.input_matrix.shape();
    let certificate = &design.certificate;
    let limit = design.model.plant.takagi_sugeno().input_limit;
    let controller = XuState::<N, M>::new(
        &design.file,
        &padding::matrix(&certificate.gain),
        &padding::with_unit_diagonal(&certificate.trigger_weight),
        &padding::filled(limit.as_slice(), PADDED_LIMIT),
        size.0,
    )?;
    let actuators = ActuatorData {
        limit: padding::filled(system.system.input_limit.as_slice(), f64::INFINITY),
        delay_s: system.input_delay_s,
        ..ActuatorData::ideal()
    };
    let mut log = StateLog::new(
        size,
        scenario.settle_tolerance_state,
        scenario.duration_s - scenario.tail_s,
        LyapunovMonitor::new(design.claims::<N>()),
        trajectory.then_some(scenario.output_interval_s),
    );
    let closed_loop = ClosedLoop {
        plant: &TakagiSugenoPlant::<N, M>::new(&system.system, system.mixing.clone()),
        disturbance: &system.disturbance.resized::<N>(),
        sensor: StateSensor::new(size.0, system.state_noise, scenario.seed),
        controller,
        sampling: Sampling::new(
            scenario.instants,
            scenario.dropout_probability,
            scenario.seed,
        ),
        actuators: &actuators,
        breakpoints_s: Vec::new(),
        method: scenario.method,
        duration_s: scenario.duration_s,
    };
    let end = closed_loop.run(&padding::vector(&system.initial_state), &mut log);
    let parts = Parts {
        system: "takagi_sugeno",
        controller: format!(
            "design '{}': Xu and Huang 2020, law (12) and trigger (10)",
            design.file.name
        ),
        events: &log.events,
        effort: (
            log.effort.updates,
            log.effort.max_torque,
            log.effort.impulse,
            log.effort.on_s,
        ),
        steps: log.steps,
        settle_seconds: log.error.settle_seconds(),
        torque_limit: limit.iter().copied().collect(),
        settle_tolerance: scenario.settle_tolerance_state,
        notes: Vec::new(),
        funnel: None,
        threshold: None,
        end,
    };
    let from_rest = log.start.norm() == 0.0;
    let certificate = judge::certificate(scenario, design, &log.lyapunov, from_rest);
    let mut summary = judge::summary(scenario, Some(design), parts, Some(certificate));
    summary.final_state_norm = Some(log.last.norm()).filter(|norm| norm.is_finite());
    summary.rms_state_norm = log.error.tail_rms();
    judge::conclude(scenario, &mut summary, end);
    Ok(Outcome {
        summary,
        trajectory: log.into_table(),
    })
}
