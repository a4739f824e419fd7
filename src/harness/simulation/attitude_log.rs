//! What a run of the rigid body is measured by.

use nalgebra::{Vector3, Vector6};
use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;

use crate::harness::closed_loop::Observer;
use crate::harness::effort::Effort;
use crate::harness::events::EventCount;
use crate::harness::lyapunov::LyapunovMonitor;
use crate::harness::plant::{body_rate, RigidBodyState};
use crate::harness::pointing::ErrorStatistics;
use crate::harness::recorder::Recorder;
use crate::harness::reference::Reference;

/// Columns of the trajectory before those of a certificate.
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
const SENT: usize = 15;
/// Columns with a certificate.
const CERTIFICATE_COLUMNS: [&str; 2] = ["lyapunov", "lyapunov_bound"];
/// All columns.
const WIDTH: usize = COLUMNS.len() + CERTIFICATE_COLUMNS.len();

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
    recorder: Option<Recorder>,
    torque: Vector3<f64>,
    disturbance: Vector3<f64>,
}

impl AttitudeLog {
    /// Nothing yet. Settled means an attitude error of at most `settle_tolerance_rad`; the tail begins
    /// at `tail_from_s`; a trajectory is kept when `interval_s` says how dense.
    pub fn new(
        reference: Reference,
        settle_tolerance_rad: f64,
        tail_from_s: f64,
        lyapunov: Option<LyapunovMonitor<6>>,
        interval_s: Option<f64>,
    ) -> Self {
        let mut columns: Vec<String> = COLUMNS.map(str::to_string).into();
        if lyapunov.is_some() {
            columns.extend(CERTIFICATE_COLUMNS.map(str::to_string));
        }
        // |q| = sin(angle / 2).
        let tolerance = libm::sin(0.5 * settle_tolerance_rad);
        Self {
            reference,
            events: EventCount::default(),
            effort: Effort::new(),
            pointing: ErrorStatistics::new(tolerance, tail_from_s),
            steps: 0,
            rate_squared: 0.0,
            start: None,
            last: None,
            lyapunov,
            recorder: interval_s.map(|interval| Recorder::new(columns, interval)),
            torque: Vector3::zeros(),
            disturbance: Vector3::zeros(),
        }
    }

    /// The trajectory.
    pub fn into_table(self) -> Option<crate::harness::recorder::Table> {
        self.recorder.map(Recorder::into_table)
    }

    fn row(&self, time_s: f64, error: &AttitudeMeasurement, sent: bool) -> [f64; WIDTH] {
        let [q0, q1, q2, q3] = error.error.to_scalar_first();
        let [[w1, w2, w3]] = error.rate_rad_s.data.0;
        let [[u1, u2, u3]] = self.torque.data.0;
        let [[d1, d2, d3]] = self.disturbance.data.0;
        let angle = error.error.rotation_angle_rad().to_degrees();
        let (level, bound) = match &self.lyapunov {
            Some(monitor) => (monitor.level, monitor.bound()),
            None => (0.0, 0.0),
        };
        let sent = f64::from(u8::from(sent));
        [
            time_s, q0, q1, q2, q3, w1, w2, w3, u1, u2, u3, d1, d2, d3, angle, sent, level, bound,
        ]
    }

    fn write(&mut self, time_s: f64, error: &AttitudeMeasurement, sent: bool) {
        let row = self.row(time_s, error, sent);
        let width = if self.lyapunov.is_some() {
            WIDTH
        } else {
            COLUMNS.len()
        };
        if let Some(recorder) = &mut self.recorder {
            recorder.write(&row[..width]);
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

impl Observer<7, 3, 3> for AttitudeLog {
    fn start(&mut self, state: &RigidBodyState, disturbance: &Vector3<f64>) {
        let error = self.reference.error(0.0, state);
        self.disturbance = *disturbance;
        self.start = Some(error);
        self.last = Some(error);
        self.rate_squared = body_rate(state).norm_squared();
        self.pointing.start(error.error.vector.norm_squared());
        if let Some(monitor) = &mut self.lyapunov {
            monitor.start(&error.rigid_body_state(), disturbance.norm_squared());
        }
        if self.recorder.is_some() {
            self.write(0.0, &error, false);
        }
    }

    #[inline]
    fn sample(
        &mut self,
        time_s: f64,
        state: &RigidBodyState,
        command: &Command<3>,
        mismatch: Option<f64>,
    ) {
        self.events.record(time_s, command, mismatch);
        if command.sent && self.recorder.is_some() {
            let error = self.reference.error(time_s, state);
            self.write(time_s, &error, true);
        }
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
    ) {
        self.steps += 1;
        let error = self.reference.error(time_s, state);
        self.rate_squared = self.rate_squared.max(body_rate(state).norm_squared());
        let magnitude = error.error.vector.norm_squared();
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
        self.last = Some(error);
        self.disturbance = *disturbance;
        if self
            .recorder
            .as_ref()
            .is_some_and(|recorder| recorder.due(time_s))
        {
            self.write(time_s, &error, false);
        }
    }
}

const _: () = assert!(SENT + 1 == COLUMNS.len());
