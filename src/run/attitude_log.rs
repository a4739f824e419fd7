//! What a run of the rigid body is measured by.

use nalgebra::{Vector3, Vector6};
use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;
use runtime::lei2022::SwitchCount;

use super::inner::InnerMonitor;
use crate::base::table::Table;
use crate::sim::bound_utilisation::BoundUtilisation;
use crate::sim::closed_loop::Observer;
use crate::sim::controller::Controller;
use crate::sim::effort::Effort;
use crate::sim::events::EventCount;
use crate::sim::link::LinkOutcome;
use crate::sim::lyapunov::LyapunovMonitor;
use crate::sim::pointing::ErrorStatistics;
use crate::sim::profile::Profile;
use crate::sim::recorder::Recorder;
use crate::sim::reference::Reference;
use crate::sim::rigid_body_state::{body_rate, RigidBodyState};

/// Columns of the trajectory before those of a certificate and of the controller's signals.
const COLUMNS: [&str; 16] = [
    "time_s",
    "error_q0_scalar",
    "error_q1",
    "error_q2",
    "error_q3",
    "rate_1_rad_s",
    "rate_2_rad_s",
    "rate_3_rad_s",
    "torque_1_nm",
    "torque_2_nm",
    "torque_3_nm",
    "disturbance_1_nm",
    "disturbance_2_nm",
    "disturbance_3_nm",
    "error_deg",
    "sent",
];
const FIRST_TORQUE: usize = 8;
/// Columns with a link, after the controller's signals.
const LINK_COLUMNS: [&str; 3] = ["link_step_1", "link_step_2", "link_step_3"];
/// Quantities of the profile: the error's angle and the norm of the body rate.
pub(crate) const PROFILE_QUANTITIES: usize = 2;
/// Columns with a certificate.
const CERTIFICATE_COLUMNS: [&str; 2] = ["lyapunov", "lyapunov_bound"];
/// Columns with a second, inner certificate.
const INNER_COLUMNS: [&str; 2] = ["inner_lyapunov", "inner_lyapunov_bound"];

/// Metrics, certificate and trajectory of one run.
#[derive(Debug, Clone)]
pub struct AttitudeLog {
    reference: Reference,
    /// Samples and messages.
    pub events: EventCount,
    /// Torque.
    pub effort: Effort<3>,
    /// Attitude error; its tail is in rad.
    pub pointing: ErrorStatistics,
    /// Integration steps.
    pub steps: u64,
    /// Largest squared norm of the body rate.
    pub rate_squared: f64,
    /// Largest |omega|^2 + |q|^2 at the start.
    pub start: Option<AttitudeMeasurement>,
    /// Error at the end of the last step.
    pub last: Option<AttitudeMeasurement>,
    /// The certificate's claims along the run.
    pub lyapunov: Option<LyapunovMonitor<6>>,
    /// The inner certificate's claims, where there are two.
    pub inner: Option<InnerMonitor<6>>,
    /// What the link carried.
    pub link: Option<LinkOutcome>,
    /// Use of the controller's prescribed bounds.
    pub funnel: Option<BoundUtilisation>,
    /// Use of its trigger's threshold.
    pub threshold: Option<BoundUtilisation>,
    /// How often it switched the actuators.
    pub switches: Option<SwitchCount>,
    /// Error and rate on a grid of times.
    pub profile: Profile,
    settle: SettleRule,
    recorder: Option<Recorder>,
    row: Vec<f64>,
    link_steps: Option<[f64; 3]>,
    torque: Vector3<f64>,
    disturbance: Vector3<f64>,
}

impl AttitudeLog {
    /// Nothing yet. `settle` says when an attitude error counts as settled; the tail begins
    /// at `tail_from_s`; a trajectory is kept when `interval_s` says how dense, with the controller's
    /// `signals` in its last columns, followed by the steps on the link where there is one.
    pub fn new(
        reference: Reference,
        settle: SettleRule,
        tail_from_s: f64,
        (lyapunov, inner): (Option<LyapunovMonitor<6>>, Option<InnerMonitor<6>>),
        interval_s: Option<f64>,
        signals: &[&str],
        linked: bool,
    ) -> Self {
        let mut columns: Vec<String> = COLUMNS.map(str::to_string).into();
        if lyapunov.is_some() {
            columns.extend(CERTIFICATE_COLUMNS.map(str::to_string));
        }
        if inner.is_some() {
            columns.extend(INNER_COLUMNS.map(str::to_string));
        }
        columns.extend(signals.iter().map(|name| name.to_string()));
        if linked {
            columns.extend(LINK_COLUMNS.map(str::to_string));
        }
        Self {
            reference,
            events: EventCount::default(),
            effort: Effort::new(),
            pointing: ErrorStatistics::new(settle.tolerance(), tail_from_s),
            steps: 0,
            rate_squared: 0.0,
            start: None,
            last: None,
            lyapunov,
            inner,
            link: None,
            funnel: None,
            threshold: None,
            switches: None,
            profile: Profile::new(&[], PROFILE_QUANTITIES),
            settle,
            row: Vec::with_capacity(columns.len()),
            link_steps: linked.then_some([0.0; 3]),
            recorder: interval_s.map(|interval| Recorder::new(columns, interval)),
            torque: Vector3::zeros(),
            disturbance: Vector3::zeros(),
        }
    }

    /// The profile of a run that was `completed` or diverged, and the trajectory.
    pub fn into_records(self, completed: bool) -> (Vec<f32>, Option<Table>) {
        let last = self.last.as_ref().map(quantities).unwrap_or_default();
        let profile = self.profile.into_values(completed, &last);
        (profile, self.recorder.map(Recorder::into_table))
    }

    fn write<C: Controller<AttitudeMeasurement, 3>>(
        &mut self,
        time_s: f64,
        error: &AttitudeMeasurement,
        sent: bool,
        controller: &C,
    ) {
        let angle = error.error.rotation_angle_rad().to_degrees();
        self.row.clear();
        self.row.push(time_s);
        self.row.extend(error.error.to_scalar_first());
        for vector in [&error.rate_rad_s, &self.torque, &self.disturbance] {
            self.row.extend(vector.iter());
        }
        self.row.extend([angle, f64::from(u8::from(sent))]);
        if let Some(monitor) = &self.lyapunov {
            self.row.extend([monitor.level, monitor.bound()]);
        }
        if let Some(inner) = &self.inner {
            self.row.extend(inner.columns());
        }
        let first = self.row.len();
        self.row
            .resize(first + controller.signal_names().len(), 0.0);
        controller.signals(time_s, error, &mut self.row[first..]);
        if let Some(steps) = &self.link_steps {
            let steps = if sent { *steps } else { [0.0; 3] };
            self.row.extend(steps);
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.write(&self.row);
        }
    }

    fn watch<C: Controller<AttitudeMeasurement, 3>>(
        &mut self,
        time_s: f64,
        error: &AttitudeMeasurement,
        controller: &C,
    ) {
        let funnel = controller.funnel_ratio(time_s, error);
        BoundUtilisation::record(&mut self.funnel, time_s, funnel);
        let threshold = controller.threshold_ratio(time_s, error);
        BoundUtilisation::record(&mut self.threshold, time_s, threshold);
    }
}

/// What a profile holds of an error, deg and rad/s: the rate is the body's where the reference rests.
fn quantities(error: &AttitudeMeasurement) -> [f64; PROFILE_QUANTITIES] {
    let angle = error.error.rotation_angle_rad().to_degrees();
    [angle, error.rate_rad_s.norm()]
}

/// What counts as settled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SettleRule {
    /// A rotation angle of at most this, rad.
    Angle(f64),
    /// Components of the error quaternion's vector part of at most this magnitude.
    Component(f64),
}

impl SettleRule {
    /// Bound of the magnitude.
    fn tolerance(self) -> f64 {
        match self {
            // |q| = sin(angle / 2).
            SettleRule::Angle(angle_rad) => libm::sin(0.5 * angle_rad),
            SettleRule::Component(tolerance) => tolerance,
        }
    }

    #[inline(always)]
    fn magnitude_squared(self, error: &AttitudeMeasurement) -> f64 {
        let vector = &error.error.vector;
        match self {
            SettleRule::Angle(_) => vector.norm_squared(),
            SettleRule::Component(_) => {
                // A component that is not a number must not vanish in a maximum.
                let largest = vector.amax();
                largest * largest + 0.0 * vector.sum()
            }
        }
    }
}

/// The state [rate; vector part] with the sign that makes the scalar part positive.
#[inline(always)]
fn fuzzy_state(measurement: &AttitudeMeasurement) -> Vector6<f64> {
    let sign = if measurement.error.scalar < 0.0 {
        -1.0
    } else {
        1.0
    };
    let [[w1, w2, w3]] = measurement.rate_rad_s.data.0;
    let [[q1, q2, q3]] = measurement.error.vector.data.0;
    Vector6::new(w1, w2, w3, sign * q1, sign * q2, sign * q3)
}

impl<C: Controller<AttitudeMeasurement, 3>> Observer<C, 7, 3, 3> for AttitudeLog {
    fn start(&mut self, state: &RigidBodyState, disturbance: &Vector3<f64>, controller: &C) {
        let error = self.reference.error(0.0, state);
        self.disturbance = *disturbance;
        self.start = Some(error);
        self.last = Some(error);
        self.rate_squared = body_rate(state).norm_squared();
        self.pointing.start(self.settle.magnitude_squared(&error));
        if let Some(monitor) = &mut self.lyapunov {
            monitor.start(&error.rigid_body_state(), disturbance.norm_squared());
        }
        if let Some(inner) = &mut self.inner {
            inner.start(&fuzzy_state(&error), disturbance.norm_squared());
        }
        self.watch(0.0, &error, controller);
        if self.profile.due(0.0) {
            self.profile.record(0.0, &quantities(&error));
        }
        if self.recorder.is_some() {
            self.write(0.0, &error, false, controller);
        }
    }

    #[inline]
    fn sample(
        &mut self,
        time_s: f64,
        state: &RigidBodyState,
        command: &Command<3>,
        mismatch: Option<f64>,
        controller: &C,
    ) {
        self.events.record(time_s, command, mismatch);
        self.switches = controller.switch_count();
        if let Some(inner) = &mut self.inner {
            let error = self.reference.error(time_s, state);
            inner.sample(time_s, &fuzzy_state(&error), command.sent);
        }
        let transmitted = self.link_steps.iter().flatten().any(|&step| step != 0.0);
        if (command.sent || transmitted) && self.recorder.is_some() {
            let error = self.reference.error(time_s, state);
            self.write(time_s, &error, true, controller);
        }
    }

    fn transmitted(&mut self, steps: &[f64; 3]) {
        self.link_steps = Some(*steps);
    }

    #[inline]
    fn hold(&mut self, time_s: f64, torque: &Vector3<f64>) {
        self.effort.begin(torque);
        self.torque = *torque;
        if let Some(row) = self.recorder.as_mut().and_then(|r| r.last_row_at(time_s)) {
            row[FIRST_TORQUE..FIRST_TORQUE + 3].copy_from_slice(torque.as_slice());
        }
    }

    #[inline]
    fn held(&mut self, span_s: f64, torque: &Vector3<f64>) {
        self.effort.end(span_s, torque);
    }

    #[inline(always)]
    fn step(
        &mut self,
        time_s: f64,
        step_s: f64,
        state: &RigidBodyState,
        disturbance: &Vector3<f64>,
        controller: &C,
    ) {
        self.steps += 1;
        let error = self.reference.error(time_s, state);
        self.rate_squared = self.rate_squared.max(body_rate(state).norm_squared());
        let magnitude = self.settle.magnitude_squared(&error);
        self.pointing.record(time_s, step_s, magnitude, || {
            let angle = error.error.rotation_angle_rad();
            angle * angle
        });
        if let Some(monitor) = &mut self.lyapunov {
            monitor.step(
                time_s,
                step_s,
                &fuzzy_state(&error),
                disturbance.norm_squared(),
            );
        }
        if let Some(inner) = &mut self.inner {
            let square = disturbance.norm_squared();
            inner.step(time_s, step_s, &fuzzy_state(&error), square);
        }
        self.watch(time_s, &error, controller);
        if self.profile.due(time_s) {
            self.profile.record(time_s, &quantities(&error));
        }
        self.last = Some(error);
        self.disturbance = *disturbance;
        if self
            .recorder
            .as_ref()
            .is_some_and(|recorder| recorder.due(time_s))
        {
            self.write(time_s, &error, false, controller);
        }
    }
}
