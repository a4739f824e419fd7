//! What feeds the functional, V' <= -phi V + r, and the levels of V that follow.

use super::Certificate;
use crate::certify::signals::{bounded, fed, BoundedSignal};
use crate::model::{ErrorBall, ErrorUnit, Model};
use verified::interval::Interval;
use verified::scalar::Scalar;

/// The double after that nearest to pi, which is below it: above pi.
const ABOVE_PI: f64 = 3.141_592_653_589_793_6;

/// The supply r and the levels of the functional.
pub(super) struct Supply<S> {
    /// r: with s, the most that a measurement error adds, and the trigger's floor.
    pub total: S,
    /// What of it a decision of the trigger allows: s and the floor.
    pub decision: S,
    /// Bound on the functional from rest: r / phi, or what it reaches before the first torque where that is more.
    pub from_rest: S,
    /// rho_0: starts with x0'U x0 up to this are certified; 1 where the torque acts at once.
    pub certified_start: S,
    /// Whether there is a disturbance, and V may be above what it alone gives.
    pub is_mixed: bool,
}

/// The greatest age of the sample behind the torque in force: hbar, or (N + 1) hbar + d_max.
pub(super) fn oldest<S: Scalar>(model: &Model) -> S {
    after_losses(model, 1)
}

/// (N + extra) hbar + d_max.
fn after_losses<S: Scalar>(model: &Model, extra: u32) -> S {
    let imperfections = &model.file.imperfections;
    let intervals = S::from_f64(f64::from(imperfections.lost_in_a_row + extra));
    let delay = S::from_f64(imperfections.delay_s);
    intervals * S::from_f64(model.file.specs.hbar_s) + delay
}

/// A bound on the norm of the errors of a ball. Half the angle, in radians, is above 2 sin(theta / 4).
pub(super) fn radius<S: Scalar>(ball: &ErrorBall) -> S {
    let bound = S::from_f64(ball.bound);
    match ball.factor {
        ErrorUnit::State => bound,
        ErrorUnit::RotationDeg => bound * S::from_f64(ABOVE_PI) / S::from_f64(360.0),
    }
}

impl<S: Scalar> Supply<S> {
    /// That of a model and a certificate.
    pub fn of(model: &Model, certificate: &Certificate) -> Self {
        let phi = S::from_f64(model.file.specs.phi_per_s);
        let signals = bounded::<S>(model);
        let torque = fed(&signals, |signal| weight(signal, certificate));
        let noise = noise::<S>(model, certificate);
        let floor = S::from_f64(certificate.trigger_floor);
        let floor = floor * S::from_f64(certificate.trigger_multiple);
        let beside = certificate.measurement.is_some()
            || certificate.trigger_floor != 0.0
            || model.file.imperfections.is_networked();
        let is_mixed = beside && torque.approximate() > 0.0;
        let decision = noise + floor;
        let total = torque.clone() + decision.clone();
        let reached = total.clone() / phi;
        let (certified_start, before) = before_torque(model, certificate, &torque);
        Supply {
            total,
            decision,
            from_rest: before.map_or(reached.clone(), |before: S| reached.max(before)),
            certified_start,
            is_mixed,
        }
    }
}

fn weight<S: Scalar>(signal: &BoundedSignal<S>, certificate: &Certificate) -> S {
    S::from_f64((signal.weight)(certificate))
}

/// s: the most that d'Lam d can be.
fn noise<S: Scalar>(model: &Model, certificate: &Certificate) -> S {
    let Some(weights) = &certificate.measurement else {
        return S::zero();
    };
    let Some(bounds) = model.file.imperfections.measurement_error() else {
        return S::zero();
    };
    let added = bounds.balls().into_iter().map(|ball| {
        let own = ball
            .states
            .iter()
            .map(|&state| weights.sample_weight[state]);
        let radius = radius::<S>(&ball);
        S::from_f64(own.fold(0.0, f64::max)) * radius.clone() * radius
    });
    added.fold(S::zero(), |sum, term| sum + term)
}

/// rho_0 = e^(-kappa d_m) - xi taubar^2 (1 - e^(-kappa d_m)) / kappa, with the last quotient at most d_m, and what V reaches
/// from rest until then, at most xi taubar^2 d_m e^(kappa d_m).
fn before_torque<S: Scalar>(
    model: &Model,
    certificate: &Certificate,
    torque: &S,
) -> (S, Option<S>) {
    let numbers = certificate.first_torque.as_ref();
    let Some(numbers) = numbers.filter(|_| model.file.imperfections.is_networked()) else {
        return (S::one(), None);
    };
    let longest = after_losses::<S>(model, 0);
    let growth = (S::from_f64(numbers.growth) * longest.clone()).exp_upper();
    let fed = torque.clone() * longest;
    (S::one() / growth.clone() - fed.clone(), Some(fed * growth))
}

/// rho_0 of a certificate, rounded down: starts with x0'U x0 up to this are certified.
pub fn certified_start(model: &Model, certificate: &Certificate) -> f64 {
    Supply::<Interval>::of(model, certificate)
        .certified_start
        .lo()
}

/// The bound on x'Ux from rest and in the end, rounded up.
pub fn reached_from_rest(model: &Model, certificate: &Certificate) -> f64 {
    Supply::<Interval>::of(model, certificate).from_rest.hi()
}

/// The greatest age of the sample behind the torque in force (s), rounded up.
pub fn oldest_sample(model: &Model) -> f64 {
    oldest::<Interval>(model).hi()
}

/// The longest time before the first torque (s), rounded up: 0 where it acts at once.
pub fn longest_without_torque(model: &Model, certificate: &Certificate) -> f64 {
    match certificate.first_torque {
        None => 0.0,
        Some(_) => after_losses::<Interval>(model, 0).hi(),
    }
}

/// What disturbance and measurement error feed the functional at most, without the trigger's floor; rounded up.
pub fn supplied(model: &Model, certificate: &Certificate) -> f64 {
    let without = Certificate {
        trigger_floor: 0.0,
        ..certificate.clone()
    };
    Supply::<Interval>::of(model, &without).total.hi()
}

/// What a decision of the trigger allows, rounded up: (x - w)' Wp (x - w) is at most nu w'W w and this.
pub(crate) fn decided(model: &Model, certificate: &Certificate) -> f64 {
    Supply::<Interval>::of(model, certificate).decision.hi()
}

/// r / taubar^2, rounded up, where more than the disturbance feeds the functional: gamma is not below it. 0 elsewhere.
pub fn relative_supply(model: &Model, certificate: &Certificate) -> f64 {
    let supply = Supply::<Interval>::of(model, certificate);
    if !supply.is_mixed {
        return 0.0;
    }
    let signals = bounded::<Interval>(model);
    let squares = fed(&signals, |_| Interval::from(1.0));
    (supply.total / squares).hi()
}
