//! Theorem 1 of Xu & Huang (analysis form, corrected), stated for the numbers of a design file.
//!
//! Every condition is a symmetric matrix that must be positive definite. The matrices are assembled
//! over a [`Scalar`], so the check (intervals) and the tests' oracle (exact rationals) read the same
//! statement.

mod actuators;
mod decrease;
mod first_torque;
mod gain_error;
mod hand_over;
mod measurement;
mod mismatch;
mod sets;
mod supply;

pub use crate::certify::certificate::{
    Certificate, FinalBounds, FirstTorque, HandOver, HeldWeights, MeasurementWeights,
    MismatchSlack, RuleGains,
};
pub use hand_over::for_each_hand_over_condition;
pub(crate) use supply::decided;
pub use supply::{
    certified_start, longest_without_torque, oldest_sample, reached_from_rest, relative_supply,
    supplied,
};

use nalgebra::DMatrix;

use crate::certify::plant::{reference_statements, DescriptorPlant};
use crate::certify::signals::{bounded, BoundedSignal};
use crate::fuzzy::inertia_bounds;
use crate::model::{Imperfections, Mismatch, Model, Plant};
use gain_error::GainError;
use supply::Supply;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// A named symmetric matrix that must be positive definite.
#[derive(Debug, Clone)]
pub struct Statement<S> {
    /// Name of the condition.
    pub name: String,
    /// The matrix.
    pub matrix: Matrix<S>,
}

/// Everything the conditions need, over one scalar type.
struct Assembly<'a, S> {
    certificate: &'a Certificate,
    imperfections: &'a Imperfections,
    /// The plant; of an uncertain inertia the nominal one, for all that does not depend on it.
    plant: DescriptorPlant<S>,
    /// The plants at the vertices of the inertia's set: (18) is affine in (J, A), and (J, A) lies in their
    /// convex hull, so it holds for every inertia and every state of the box when it holds at all of them.
    plants: Vec<DescriptorPlant<S>>,
    phi: S,
    /// The greatest age of the sample behind the torque in force: hbar, or h_m in a network with delay or loss.
    oldest: S,
    /// Not below e^(phi oldest).
    growth: S,
    nu: S,
    /// The signals of bounded norm.
    bounded: Vec<BoundedSignal<S>>,
    /// Everything that feeds the functional.
    supply: Supply<S>,
    /// k2.
    level: S,
    /// What the actuators may do to the torque, where their gain is not 1.
    gain_error: Option<GainError<S>>,
    /// Q_k = eps_k Q.
    multipliers: [Matrix<S>; 3],
    lyapunov: Matrix<S>,
    /// F_j and N_j of every gain.
    gains: Vec<(Matrix<S>, Matrix<S>)>,
    /// kappa, where rule j of the plant goes with gain j.
    matched: Option<S>,
    /// kappa is above 0: without slack nothing is proved.
    slack_needed: bool,
}

/// All conditions of Theorem 1 for a model and a certificate, one after the other; `check` is
/// called with each. They are not collected, because there may be thousands.
pub fn for_each_condition<S: Scalar>(
    model: &Model,
    certificate: &Certificate,
    mut check: impl FnMut(Statement<S>),
) {
    let assembly = Assembly::new(model, certificate);
    let mut emit = |name: String, matrix: Matrix<S>| check(Statement { name, matrix });
    inertia_positive(model, &mut emit);
    for (name, matrix) in reference_statements(&model.plant) {
        emit(name, matrix);
    }
    assembly.positivity(&mut emit);
    assembly.measurement(&mut emit);
    assembly.mismatch(&mut emit);
    assembly.decrease(&mut emit);
    assembly.first_torque(&mut emit);
    assembly.anti_windup(&mut emit);
    assembly.peak_gain(&mut emit);
    assembly.region(&mut emit);
    assembly.must_contain(model, &mut emit);
    assembly.weight_limit(model, &mut emit);
    assembly.certified_attitudes(model, &mut emit);
    assembly.final_bounds(model, &mut emit);
}

/// The conditions that depend on what feeds the functional: levels, sets and bounds. The decrease (18) does not.
pub fn for_each_level_condition<S: Scalar>(
    model: &Model,
    certificate: &Certificate,
    emit: &mut dyn FnMut(String, Matrix<S>),
) {
    let assembly = Assembly::new(model, certificate);
    let mut emit = |name: String, matrix: Matrix<S>| emit(name, matrix);
    assembly.first_torque(&mut emit);
    assembly.anti_windup(&mut emit);
    assembly.region(&mut emit);
    assembly.must_contain(model, &mut emit);
    assembly.certified_attitudes(model, &mut emit);
    assembly.final_bounds(model, &mut emit);
}

/// |x_j| is within a bound for every state of x'Ux <= k2.
pub fn for_each_state_bound<S: Scalar>(
    model: &Model,
    certificate: &Certificate,
    bounds: &[f64],
    emit: &mut dyn FnMut(String, Matrix<S>),
) {
    Assembly::new(model, certificate).state_bounds(bounds, emit);
}

/// Every inertia of the set is positive definite.
fn inertia_positive<S: Scalar>(model: &Model, emit: &mut impl FnMut(String, Matrix<S>)) {
    if let Plant::Spacecraft(craft) = &model.plant {
        for (index, bound) in inertia_bounds(craft).into_iter().enumerate() {
            emit(format!("inertia positive {}", index + 1), bound);
        }
    }
}

impl<'a, S: Scalar> Assembly<'a, S> {
    fn new(model: &'a Model, certificate: &'a Certificate) -> Self {
        let specs = &model.file.specs;
        let plant = DescriptorPlant::<S>::new(&model.plant);
        let exactly = |matrix: &DMatrix<f64>| Matrix::exactly(matrix);
        let phi = S::from_f64(specs.phi_per_s);
        let oldest: S = supply::oldest(model);
        let supply: Supply<S> = Supply::of(model, certificate);
        let multiplier = exactly(&certificate.multiplier);
        Assembly {
            growth: (phi.clone() * oldest.clone()).exp_upper(),
            nu: S::from_f64(specs.nu),
            level: supply.from_rest.clone().max(S::one()),
            supply,
            bounded: bounded(model),
            gain_error: GainError::of(&model.file.imperfections, plant.input.ncols()),
            multipliers: specs
                .eps
                .map(|weight| multiplier.scaled(&S::from_f64(weight))),
            lyapunov: exactly(&certificate.lyapunov),
            gains: certificate
                .gains()
                .zip(certificate.anti_windups())
                .map(|(gain, anti_windup)| (exactly(gain), exactly(anti_windup)))
                .collect(),
            slack_needed: certificate.is_matched(model)
                && !matches!(model.file.mismatch, Mismatch::Kappa(kappa) if kappa == 0.0),
            matched: match model.file.mismatch {
                Mismatch::Kappa(kappa) if certificate.is_matched(model) => Some(S::from_f64(kappa)),
                _ => None,
            },
            certificate,
            imperfections: &model.file.imperfections,
            plants: DescriptorPlant::each_inertia(&model.plant),
            plant,
            phi,
            oldest,
        }
    }

    fn positivity(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        let certificate = self.certificate;
        emit("lyapunov positive".into(), self.lyapunov.clone());
        let integral = Matrix::exactly(&certificate.integral_weight);
        emit("integral weight positive".into(), integral);
        let trigger = Matrix::exactly(&certificate.trigger_weight);
        emit("trigger weight positive".into(), trigger);
        if certificate.trigger_multiple != 1.0 {
            let multiple = S::from_f64(certificate.trigger_multiple);
            emit(
                "trigger multiple positive".into(),
                Matrix::identity(1, multiple),
            );
        }
        for (entry, &weight) in certificate.gain_error_weight.iter().enumerate() {
            let name = format!("gain error weight {}", entry + 1);
            emit(name, Matrix::identity(1, S::from_f64(weight)));
        }
        for (input, &weight) in certificate.sector_weight.iter().enumerate() {
            let name = format!("sector weight input {}", input + 1);
            emit(name, Matrix::identity(1, S::from_f64(weight)));
        }
    }

    /// The multiple of Upsilon in (18).
    fn trigger_weight(&self) -> Matrix<S> {
        let weight = Matrix::exactly(&self.certificate.trigger_weight);
        match self.certificate.trigger_multiple {
            1.0 => weight,
            multiple => weight.scaled(&S::from_f64(multiple)),
        }
    }

    /// The bounded signals with their weights.
    fn weighted(&self) -> impl Iterator<Item = (&BoundedSignal<S>, f64)> {
        let signals = self.bounded.iter();
        signals.map(|signal| (signal, (signal.weight)(self.certificate)))
    }
}

/// ` gain 3` where there are several gains.
pub(super) fn gain_suffix(count: usize, rule: usize) -> String {
    match count {
        1 => String::new(),
        _ => format!(" gain {}", rule + 1),
    }
}
