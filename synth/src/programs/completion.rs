//! What a certificate needs beside the solution of Theorem 2: the trigger's floor, and the time before the first torque.

use nalgebra::{DMatrix, DVector};

use super::outcome::SynthesisError;
use super::session::{has_point, Session};
use super::units::{scaled, FIRST_UNITS};
use crate::certify::theorem1::{relative_supply, supplied, Certificate, FirstTorque};
use crate::conditions::xu2020::{smallest_growth, Functional};
use crate::conditions::ERROR_SPLIT;
use crate::design::{add_claims, descriptor_multiplier, measurement_weights};
use crate::model::{ErrorBall, Model, TriggerFloor, FLOOR_SHARE};
use sdp::solve::Accuracy;

/// How far kappa lies above the smallest one, relative: a margin for the proof.
const GROWTH_ALLOWANCE: f64 = 1e-2;

/// The same, absolute [1/s].
const LEAST_GROWTH: f64 = 1e-6;

/// Accuracy of the smallest kappa.
const ACCURACY: Accuracy = Accuracy {
    relative_gap: 1e-4,
    objective_unit: 1e-3,
};

/// How far a floor found by the program lies above what a measurement error alone can do, relative.
const FLOOR_ALLOWANCE: f64 = 1e-3;

/// How far gamma lies above what feeds the functional, relative.
const GAMMA_ALLOWANCE: f64 = 1e-9;

/// The certificate with the floor, the numbers of the first torque and the claims that follow; `None` where there is no
/// such certificate.
pub(crate) fn complete(
    model: &Model,
    mut certificate: Certificate,
    session: &mut Session,
) -> Result<Option<Certificate>, SynthesisError> {
    if !add_measurement(model, &mut certificate) {
        return Ok(None);
    }
    let given = model.file.specs.trigger_floor;
    certificate.trigger_floor = floor(given, || automatic_floor(model, &certificate));
    with_claims(model, certificate, session)
}

/// The certificates of one controller with two, whose trigger weight is the first one's; the second functional uses
/// `multiple` times that weight, which is what its own numbers hold.
pub(crate) fn complete_both(
    models: [&Model; 2],
    certificates: [Certificate; 2],
    multiple: f64,
    session: &mut Session,
) -> Result<Option<[Certificate; 2]>, SynthesisError> {
    let [mut first, mut second] = certificates;
    if !(add_measurement(models[0], &mut first) && add_measurement(models[1], &mut second)) {
        return Ok(None);
    }
    let automatic = || {
        let second = automatic_floor(models[1], &second) / multiple;
        automatic_floor(models[0], &first).min(second)
    };
    let shared = floor(models[0].file.specs.trigger_floor, automatic);
    second.trigger_multiple = multiple;
    (first.trigger_floor, second.trigger_floor) = (shared, shared);
    let first = with_claims(models[0], first, session)?;
    let second = with_claims(models[1], second, session)?;
    Ok(first.zip(second).map(<[Certificate; 2]>::from))
}

/// The certificate with the numbers of the first torque, gamma and the claims that follow.
fn with_claims(
    model: &Model,
    mut certificate: Certificate,
    session: &mut Session,
) -> Result<Option<Certificate>, SynthesisError> {
    if !add_first_torque(model, &mut certificate, session)? {
        return Ok(None);
    }
    let least = relative_supply(model, &certificate) * (1.0 + GAMMA_ALLOWANCE);
    certificate.gain_bound = certificate.gain_bound.max(least);
    let claims = add_claims(model, &mut certificate);
    Ok(claims.map(|()| certificate))
}

/// How far Lam lies above (1 + c) W, relative.
const SPLIT_ALLOWANCE: f64 = 1e-6;

/// The weights of a measurement error for a certificate of (18) with a perfect measurement and the threshold nu (1 + c) /
/// c: with W (1 + c) / c for W and Lam >= (1 + c) W, nu W is what it was and Wp at least W. False where there are none.
fn add_measurement(model: &Model, certificate: &mut Certificate) -> bool {
    let Some(bounds) = model.file.imperfections.measurement_error() else {
        return true;
    };
    if certificate.measurement.is_some() {
        return true;
    }
    let weight = &certificate.trigger_weight;
    let balls = bounds.balls();
    // A weight that is above W in every ball and, several balls meeting, above all of it.
    let count = balls.len() as f64;
    let mut sample_weight = DVector::zeros(weight.nrows());
    for ball in &balls {
        let own = weight
            .select_rows(&ball.states)
            .select_columns(&ball.states);
        let largest = own.symmetric_eigenvalues().max();
        for &state in &ball.states {
            let above = (1.0 + ERROR_SPLIT) * (1.0 + SPLIT_ALLOWANCE);
            sample_weight[state] = count * largest * above;
        }
    }
    let scaled = weight * ((1.0 + ERROR_SPLIT) / ERROR_SPLIT);
    certificate.measurement = measurement_weights(&scaled, sample_weight);
    certificate.trigger_weight = scaled;
    certificate.measurement.is_some()
}

/// Adds the numbers of the first torque, where messages may come late; false where there are none.
fn add_first_torque(
    model: &Model,
    certificate: &mut Certificate,
    session: &mut Session,
) -> Result<bool, SynthesisError> {
    if !model.file.imperfections.is_networked() {
        return Ok(true);
    }
    certificate.first_torque = first_torque(model, certificate, session)?;
    Ok(certificate.first_torque.is_some())
}

/// eps_a: the model's own, or the automatic one.
fn floor(given: Option<TriggerFloor>, automatic: impl FnOnce() -> f64) -> f64 {
    match given {
        None => 0.0,
        Some(TriggerFloor::Given(floor)) => floor,
        Some(TriggerFloor::Auto(_)) => automatic(),
    }
}

/// As much as two measurement errors can make of e'We, up to a share of what else feeds the functional.
fn automatic_floor(model: &Model, certificate: &Certificate) -> f64 {
    let balls = model.file.imperfections.measurement_error();
    let balls = balls.map_or(Vec::new(), |bounds| bounds.balls());
    let noise = noise_in_trigger(&certificate.trigger_weight, &balls);
    (noise * (1.0 + FLOOR_ALLOWANCE)).min(FLOOR_SHARE * supplied(model, certificate))
}

/// A bound on (d1 - d2)'W(d1 - d2) for errors d1, d2 in the balls.
fn noise_in_trigger(weight: &DMatrix<f64>, balls: &[ErrorBall]) -> f64 {
    let root: f64 = balls
        .iter()
        .map(|ball| {
            let own = weight
                .select_rows(&ball.states)
                .select_columns(&ball.states);
            2.0 * ball.radius() * own.symmetric_eigenvalues().max().max(0.0).sqrt()
        })
        .sum();
    root * root
}

/// The smallest growth before the first torque, solved for in scaled units.
fn first_torque(
    model: &Model,
    certificate: &Certificate,
    session: &mut Session,
) -> Result<Option<FirstTorque>, SynthesisError> {
    let (scaling, task) = scaled(&model.task(), &FIRST_UNITS);
    let d = DMatrix::from_diagonal(&scaling.state);
    let functional = Functional {
        lyapunov: &d * &certificate.lyapunov * &d,
        integral_weight: &d * &certificate.integral_weight * &d,
        disturbance_weight: certificate.disturbance_weight * scaling.disturbance.powi(2),
    };
    let (problem, unknowns) = smallest_growth(&task, &functional);
    let vertices = task.system.vertices.len();
    let solution = session.run(
        &problem,
        "growth before the first torque",
        ACCURACY,
        vertices,
    )?;
    if !has_point(&solution) {
        return Ok(None);
    }
    let values = &solution.values;
    let to_state = scaling.to_state();
    let multiplier = |transformed: DMatrix<f64>| {
        descriptor_multiplier(&model.plant, &to_state * transformed * &to_state)
    };
    let disturbance = unknowns.disturbance.value(values) * &to_state / scaling.disturbance;
    let growth = unknowns.growth.value(values)[(0, 0)].max(0.0);
    Ok(Some(FirstTorque {
        growth: growth * (1.0 + GROWTH_ALLOWANCE) + LEAST_GROWTH,
        state: multiplier(unknowns.state.value(values)),
        rate: multiplier(unknowns.rate.value(values)),
        disturbance: descriptor_multiplier(&model.plant, disturbance),
    }))
}
