//! The nonlinear spacecraft with a law u = F x(t_k) and its trigger on the command.

use nalgebra::{DMatrix, DVector, Vector3, Vector6};
use synth::certify::held_command::{reached_from_rest, HeldCommandCertificate};
use synth::fuzzy::ExactSpacecraft;
use synth::held_command::CommandProof;
use synth::model::{Model, Plant};

/// What disturbs the body.
#[derive(Debug, Clone, Copy)]
pub enum Disturbance {
    /// Along B'Ux: raises x'Ux fastest.
    Worst,
    /// Constant about an axis.
    Constant(Vector3<f64>),
    /// A sine about an axis, with its frequency [rad/s].
    Sine(Vector3<f64>, f64),
}

/// What differs from what was proved.
#[derive(Debug, Clone, Copy)]
pub struct Differs {
    pub limit: f64,
    pub disturbance: f64,
    pub relative: Option<f64>,
}

pub const AS_PROVED: Differs = Differs {
    limit: 1.0,
    disturbance: 1.0,
    relative: None,
};

/// How near a run came to the bounds; above 1 it broke them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Usage {
    /// x'Ux over its bound with the certificate of the starts.
    pub start: f64,
    /// The same with the last certificate, from the hand-over on.
    pub last: f64,
    /// |q| over its bound in the end.
    pub pointing: f64,
    /// Samples at which the torque was saturated.
    pub saturated: usize,
    /// When the state was handed over (s).
    pub hand_over_s: Option<f64>,
}

impl Usage {
    pub fn largest(&self) -> f64 {
        self.start.max(self.last).max(self.pointing)
    }

    pub fn with(self, other: Usage) -> Usage {
        let later = self.hand_over_s.into_iter().chain(other.hand_over_s);
        Usage {
            start: self.start.max(other.start),
            last: self.last.max(other.last),
            pointing: self.pointing.max(other.pointing),
            saturated: self.saturated + other.saturated,
            hand_over_s: later.reduce(f64::max),
        }
    }
}

/// The bound on x'Ux of one certificate from an instant on.
struct Watched<'a> {
    certificate: &'a HeldCommandCertificate,
    phi: f64,
    reached: f64,
    since: f64,
    level: f64,
}

impl Watched<'_> {
    fn value(&self, state: &Vector6<f64>) -> f64 {
        quadratic(&self.certificate.lyapunov, state)
    }

    fn usage(&self, time: f64, state: &Vector6<f64>) -> f64 {
        // At its first instant a run is on its bound.
        if time <= self.since {
            return 0.0;
        }
        let fallen = (-self.phi * (time - self.since)).exp();
        self.value(state) / (fallen * self.level + (1.0 - fallen) * self.reached)
    }
}

fn quadratic(matrix: &DMatrix<f64>, state: &Vector6<f64>) -> f64 {
    (state.transpose() * matrix * state)[(0, 0)]
}

pub fn craft_of(model: &Model) -> &ExactSpacecraft {
    match &model.plant {
        Plant::Spacecraft(craft) => craft,
        _ => panic!("a spacecraft"),
    }
}

/// Flies a start and compares with every bound.
pub fn fly(
    proof: &CommandProof,
    start: &Vector6<f64>,
    disturbance: Disturbance,
    differs: &Differs,
    duration_s: f64,
) -> Usage {
    let craft = craft_of(&proof.model);
    let stages = proof.stages();
    let mut first = Watched {
        certificate: &proof.certificate,
        phi: proof.model.file.specs.phi_per_s,
        reached: reached_from_rest(&stages.start),
        since: 0.0,
        level: 0.0,
    };
    first.level = first.value(start);
    let mut last: Option<Watched> = None;
    let hbar = proof.model.file.specs.hbar_s;
    let relative = differs.relative.unwrap_or(proof.law.trigger.relative);
    let mut state = *start;
    let mut command: Option<Vector3<f64>> = None;
    let mut usage = Usage::default();
    for sample in 0..(duration_s / hbar) as usize {
        let time = sample as f64 * hbar;
        let wanted = commanded(&proof.law.gain, &state);
        let threshold = relative * wanted.norm() + proof.law.trigger.absolute_nm;
        let held = match command {
            Some(held) if (held - wanted).norm() < threshold => held,
            _ => wanted,
        };
        command = Some(held);
        let limit = craft.torque_limit * differs.limit;
        let torque = held.zip_map(&limit, |torque, limit| torque.clamp(-limit, limit));
        usage.saturated += usize::from(torque != held);
        usage.start = usage.start.max(first.usage(time, &state));
        if let (None, Some(hand_over)) = (&last, &stages.hand_over) {
            if first.value(&state) <= hand_over.level {
                usage.hand_over_s = Some(time);
                let mut own = Watched {
                    certificate: hand_over.stage.certificate,
                    phi: hand_over.stage.model.file.specs.phi_per_s,
                    reached: reached_from_rest(&hand_over.stage),
                    since: time,
                    level: 0.0,
                };
                own.level = own.value(&state);
                last = Some(own);
            }
        }
        if let Some(own) = &last {
            usage.last = usage.last.max(own.usage(time, &state));
            let settled = own.phi * (time - own.since) > 9.0;
            let bound = own.certificate.final_bounds.vector_part;
            if settled {
                let vector_part = state.fixed_rows::<3>(3).norm();
                usage.pointing = usage.pointing.max(vector_part / bound);
            }
        }
        let worst = last.as_ref().unwrap_or(&first).certificate;
        let size = craft.disturbance_bound * differs.disturbance;
        let pushed = |time: f64, state: &Vector6<f64>| {
            torque + size * direction(craft, worst, disturbance, time, state)
        };
        state = step(craft, &state, time, hbar, &pushed);
    }
    usage
}

fn commanded(gain: &DMatrix<f64>, state: &Vector6<f64>) -> Vector3<f64> {
    let command: DVector<f64> = gain * state;
    Vector3::new(command[0], command[1], command[2])
}

/// The direction of the disturbance, with a norm of at most 1.
fn direction(
    craft: &ExactSpacecraft,
    certificate: &HeldCommandCertificate,
    disturbance: Disturbance,
    time: f64,
    state: &Vector6<f64>,
) -> Vector3<f64> {
    match disturbance {
        Disturbance::Constant(axis) => axis,
        Disturbance::Sine(axis, frequency) => axis * (frequency * time).sin(),
        Disturbance::Worst => {
            let slope: DVector<f64> = &certificate.lyapunov * state;
            let inverse = craft.inertia.try_inverse().expect("an inertia");
            let pull = inverse * Vector3::new(slope[0], slope[1], slope[2]);
            match pull.norm() > 0.0 {
                true => pull.normalize(),
                false => Vector3::x(),
            }
        }
    }
}

/// One step of the classical Runge-Kutta method.
fn step(
    craft: &ExactSpacecraft,
    state: &Vector6<f64>,
    time: f64,
    dt: f64,
    torque: &impl Fn(f64, &Vector6<f64>) -> Vector3<f64>,
) -> Vector6<f64> {
    let rate = |at: f64, state: &Vector6<f64>| craft.right_hand_side(state, &torque(at, state));
    let k1 = rate(time, state);
    let k2 = rate(time + dt / 2.0, &(state + k1 * (dt / 2.0)));
    let k3 = rate(time + dt / 2.0, &(state + k2 * (dt / 2.0)));
    let k4 = rate(time + dt, &(state + k3 * dt));
    state + (k1 + (k2 + k3) * 2.0 + k4) * (dt / 6.0)
}
