//! Runs of the rigid body.

use nalgebra::Vector3;
use runtime::membership::Membership;
use runtime::xu2020;
use synth::model::Plant;

use super::attitude_log::{AttitudeLog, SettleRule, PROFILE_QUANTITIES};
use super::design::Design;
use super::designed::{designed, on_the_box, Use};
use super::inner::InnerMonitor;
use super::judge;
use super::judge::RunParts;
use super::outcome::{Outcome, Recording, SimulateError};
use super::summary::Summary;
use crate::controllers::law::{AnyAttitudeController, Flown, Surroundings};
use crate::controllers::xu2020::XuAttitude;
use crate::plants::rigid_body::RigidBodySystem;
use crate::scenario::Scenario;
use crate::sim::closed_loop::{ClosedLoop, End};
use crate::sim::controller::Controller;
use crate::sim::embedding;
use crate::sim::link::Link;
use crate::sim::lyapunov::LyapunovMonitor;
use crate::sim::metrics::Measured;
use crate::sim::profile::Profile;
use crate::sim::rigid_body_state::rigid_body_state;
use crate::sim::sampling::Sampling;
use crate::sim::sensor::AttitudeSensor;

/// Breakpoints in order, without those at the start or after the end.
fn ordered(mut breakpoints_s: Vec<f64>, duration_s: f64) -> Vec<f64> {
    breakpoints_s.retain(|&time| time > 0.0 && time < duration_s);
    breakpoints_s.sort_by(f64::total_cmp);
    breakpoints_s.dedup();
    breakpoints_s
}

/// Runs a scenario on the rigid body.
pub(crate) fn run(
    scenario: &Scenario,
    system: &RigidBodySystem,
    design: Option<&Design>,
    recording: &Recording,
) -> Result<Outcome, SimulateError> {
    let monitors = (
        design.map(|design| LyapunovMonitor::new(design.claims::<6>())),
        design.and_then(|design| Some(InnerMonitor::new(design.inner_claims::<6>()?))),
    );
    let link = scenario.link.as_ref();
    let link = link.map(|data| Link::new(data, scenario.seed));
    let attached = Attached {
        monitors,
        link: link.transpose().map_err(SimulateError::Link)?,
        recording,
    };
    let around = Surroundings {
        system,
        linked: attached.link.is_some(),
    };
    let (controller, name, limit) = match (scenario.controller.law(), design) {
        (Some(law), _) => (law.build(&around)?, law.name(), law.torque_limit()),
        (None, Some(design)) => attitude_controller(design)?,
        (None, None) => return Err(SimulateError::NoDesign),
    };
    let (end, log) = close_loop(scenario, system, controller, attached);
    Ok(finish(
        (scenario, system),
        design,
        (end, log),
        (name, limit),
    ))
}

/// What is between the controller and the actuators, and what is watched beside the metrics.
struct Attached<'a> {
    /// The link.
    link: Option<Link<3>>,
    /// The claims of a certificate, and of the inner one where there are two.
    monitors: (Option<LyapunovMonitor<6>>, Option<InnerMonitor<6>>),
    /// What is recorded.
    recording: &'a Recording<'a>,
}

/// The closed loop with a controller.
fn close_loop(
    scenario: &Scenario,
    system: &RigidBodySystem,
    controller: AnyAttitudeController,
    attached: Attached,
) -> (End, AttitudeLog) {
    let mut log = AttitudeLog::new(
        system.reference,
        match scenario.settle_tolerance_component {
            Some(tolerance) => SettleRule::Component(tolerance),
            None => SettleRule::Angle(scenario.settle_tolerance_rad),
        },
        scenario.duration_s - scenario.tail_s,
        attached.monitors,
        attached
            .recording
            .trajectory
            .then_some(scenario.output_interval_s),
        controller.signal_names(),
        attached.link.is_some(),
    );
    log.profile = Profile::new(attached.recording.profile_times_s, PROFILE_QUANTITIES);
    let mut breakpoints_s = system.actuators.fault_edges_s();
    breakpoints_s.extend(system.reference.kinks_s());
    breakpoints_s.extend(system.disturbance.kinks_s());
    let mut link = attached.link;
    let closed_loop = ClosedLoop {
        plant: &system.body,
        disturbance: &system.disturbance,
        sensor: AttitudeSensor::new(system.reference, system.sensors, scenario.seed),
        controller,
        link: link.as_mut(),
        sampling: Sampling::new(
            scenario.instants,
            scenario.dropout_probability,
            scenario.seed,
        ),
        actuators: &system.actuators,
        breakpoints_s: ordered(breakpoints_s, scenario.duration_s),
        method: scenario.method,
        duration_s: scenario.duration_s,
    };
    let initial = rigid_body_state(&system.attitude, &system.rate_rad_s);
    let end = closed_loop.run(&initial, &mut log);
    log.link = link.map(|link| link.outcome());
    (end, log)
}

/// Takes the controller in a box.
struct Boxed;

impl Use<6, 3> for Boxed {
    type Output = AnyAttitudeController;

    fn with<S, const R: usize>(self, controller: xu2020::Controller<S, 6, 3, R>) -> Self::Output
    where
        S: Membership<6, R> + Copy + std::fmt::Debug + 'static,
    {
        Box::new(XuAttitude::new(controller))
    }
}

/// The controller of a design, its name and its torque limits, N m.
fn attitude_controller(
    design: &Design,
) -> Result<(AnyAttitudeController, String, Vector3<f64>), SimulateError> {
    let controller = match &design.model.plant {
        Plant::Spacecraft(craft) => on_the_box(design, craft, Boxed)?,
        _ => designed::<6, 3, _>(design, Boxed)?,
    };
    let limit = design.model.plant.takagi_sugeno().input_limit;
    let name = format!(
        "design '{}': Xu and Huang 2020, law (12) and trigger (10)",
        design.file.name
    );
    Ok((controller, name, embedding::vector(limit.as_slice())))
}

/// A controller without a trigger of its own sends what the encoder behind it sends.
fn messages_on_the_link(summary: &mut Summary) {
    let Some(link) = &summary.link else {
        return;
    };
    summary.measured.triggers = link.messages;
    summary.measured.bits = link.bits;
    summary.measured.bytes = link.bytes;
    summary.shortest_interval_s = link.shortest_interval_s;
    summary.mean_interval_s = link.mean_interval_s;
}

fn measured(log: &AttitudeLog, duration_s: f64) -> Measured {
    let degrees = |angle: f64| Some(angle.to_degrees()).filter(|angle| angle.is_finite());
    let last = log.last.map(|last| last.error.rotation_angle_rad());
    Measured {
        settle_seconds: log.pointing.settle_seconds(),
        final_error_deg: last.and_then(degrees),
        rms_error_deg: log.pointing.tail_rms().and_then(degrees),
        tail_error_deg: log.pointing.tail_peak().and_then(degrees),
        max_rate: Some(log.rate_squared.sqrt()).filter(|rate| rate.is_finite()),
        turn_ons: log.switches.map(|count| u64::from(count.on)),
        turn_offs: log.switches.map(|count| u64::from(count.off)),
        ..Measured::of(&log.events, &log.effort, duration_s)
    }
}

fn finish(
    (scenario, system): (&Scenario, &RigidBodySystem),
    design: Option<&Design>,
    (end, log): (End, AttitudeLog),
    (controller, limit): (String, Vector3<f64>),
) -> Outcome {
    let start = log.start.as_ref();
    let from_rest = start.is_some_and(|start| start.rigid_body_state().norm() == 0.0);
    let law = scenario.controller.law();
    let notes = law.zip(start).map(|(law, start)| {
        law.notes(&Flown {
            system,
            instants: &scenario.instants,
            start,
            events: &log.events,
        })
    });
    let parts = RunParts {
        system: "rigid_body",
        controller,
        events: &log.events,
        measured: measured(&log, scenario.duration_s),
        steps: log.steps,
        torque_limit: limit.iter().copied().collect(),
        settle_tolerance: scenario.settle_tolerance_rad.to_degrees(),
        notes: notes.unwrap_or_default(),
        funnel: log.funnel.clone(),
        threshold: log.threshold.clone(),
        end,
    };
    let certificate = match (design, &log.lyapunov) {
        (Some(design), Some(monitor)) => Some(judge::certificate(
            scenario,
            design,
            (monitor, log.inner.as_ref()),
            &log.events,
            from_rest,
        )),
        _ => None,
    };
    let mut summary = judge::summary(scenario, design, parts, certificate);
    summary.link = log.link.clone();
    if law.is_some_and(|law| law.sends_by_link()) {
        messages_on_the_link(&mut summary);
    }
    judge::conclude(scenario, &mut summary, end);
    let (profile, trajectory) = log.into_records(end == End::Completed);
    Outcome {
        summary,
        trajectory,
        profile,
    }
}
