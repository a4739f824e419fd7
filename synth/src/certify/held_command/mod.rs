//! The theorem for a given law u = F x(t_k) with a trigger on the command, stated for the numbers of a design file.
//!
//! Every condition is a symmetric matrix that must be positive definite, assembled over a [`Scalar`]: the check reads it in
//! intervals, its oracle in exact rationals. The certified set is x'Ux <= 1.

mod decrease;
mod hand_over;
mod sets;

use nalgebra::{DMatrix, DVector};

use super::certificate::FinalBounds;
use super::plant::{annihilators, inertia_bounds, DescriptorPlant};
use super::{decide_all, judge_all, ExactReport, Report};
use crate::fuzzy::ExactSpacecraft;
use crate::model::{CommandTrigger, Model, Plant};
use verified::interval::Interval;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// The law that flies: u = F x(t_k), held and saturated, sent when |u - F x| >= relative |F x| + absolute.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldCommandLaw {
    /// F, m x n.
    pub gain: DMatrix<f64>,
    /// The trigger.
    pub trigger: CommandTrigger,
}

/// The numbers of one certificate, exactly as a reader of the file gets them. n states, m inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldCommandCertificate {
    /// theta, in (0, 1]: theta times the command stays within the limits on the certified set.
    pub within_limit: f64,
    /// U, n x n, symmetric.
    pub lyapunov: DMatrix<f64>,
    /// Y, n x n, symmetric.
    pub integral_weight: DMatrix<f64>,
    /// Q1, n x n: multiplier of x in the plant's equation in descriptor form.
    pub state_multiplier: DMatrix<f64>,
    /// Q2, n x n: multiplier of x'.
    pub rate_multiplier: DMatrix<f64>,
    /// L1, n x n.
    pub free_state: DMatrix<f64>,
    /// L2, n x n.
    pub free_sample: DMatrix<f64>,
    /// R1, n x 3: multiplier of x in omega^x omega = 0.
    pub annihilator_state: DMatrix<f64>,
    /// R2, n x 3: multiplier of x'.
    pub annihilator_rate: DMatrix<f64>,
    /// Diagonal of M, m entries above 0; empty where theta is 1.
    pub sector_weight: DVector<f64>,
    /// m, above 0: weight of the command's error.
    pub command_weight: f64,
    /// c, above 0: |e|^2 <= (1 + c) al^2 |F x|^2 + (1 + 1/c) ga^2.
    pub command_split: f64,
    /// xi.
    pub disturbance_weight: f64,
    /// Claimed radius: every attitude at rest whose error quaternion has a vector part up to this norm is certified.
    pub certified_vector_part: f64,
    /// Claimed bounds from rest, and in the end from every certified start.
    pub final_bounds: FinalBounds,
}

/// One certificate with what it is about.
#[derive(Debug, Clone, Copy)]
pub struct Stage<'a> {
    /// The model on the box of this certificate, with its decay rate.
    pub model: &'a Model,
    /// The law.
    pub law: &'a HeldCommandLaw,
    /// The numbers.
    pub certificate: &'a HeldCommandCertificate,
}

/// The certificate of the set that the state is handed over to.
#[derive(Debug, Clone, Copy)]
pub struct HandOver<'a> {
    /// rho', above r / phi of the certificate of the starts: x'Ux <= rho' is reached.
    pub level: f64,
    /// The certificate.
    pub stage: Stage<'a>,
}

/// The whole proof: a certificate, and that of the set which the state is handed over to, where there is one.
#[derive(Debug, Clone, Copy)]
pub struct HeldCommandProof<'a> {
    /// The certificate of the set of starts.
    pub start: Stage<'a>,
    /// The set that the state reaches.
    pub hand_over: Option<HandOver<'a>>,
}

/// Prefix of the names of the conditions of the set that the state is handed over to.
const FINAL: &str = "final set ";

/// Calls `emit` with every condition, one after the other.
pub fn for_each_condition<S: Scalar>(
    proof: &HeldCommandProof,
    emit: &mut dyn FnMut(String, Matrix<S>),
) {
    let start = Assembly::<S>::new(&proof.start);
    start.emit(emit);
    let Some(hand_over) = &proof.hand_over else {
        return;
    };
    let last = Assembly::<S>::new(&hand_over.stage);
    last.emit(&mut |name, matrix| emit(format!("{FINAL}{name}"), matrix));
    start.hands_over_to(&last, hand_over.level, emit);
}

/// Checks every condition in intervals.
pub fn check(proof: &HeldCommandProof) -> Report {
    judge_all(not_covered(proof), |emit| {
        for_each_condition::<Interval>(proof, emit);
    })
}

/// Decides every condition in exact rational arithmetic.
pub fn check_exactly(proof: &HeldCommandProof) -> ExactReport {
    decide_all(|emit| for_each_condition(proof, emit))
}

/// r / phi of a certificate, rounded up: the bound on x'Ux from rest and in the end.
pub fn reached_from_rest(stage: &Stage) -> f64 {
    Assembly::<Interval>::new(stage).reached.hi()
}

/// Everything that the conditions of one certificate need, over one scalar type.
struct Assembly<'a, S> {
    model: &'a Model,
    certificate: &'a HeldCommandCertificate,
    /// The plants at the vertices of the inertia's set; one where it is known.
    plants: Vec<DescriptorPlant<S>>,
    /// [omega^x, 0] at the vertices of each plant.
    annihilators: Vec<Matrix<S>>,
    gain: Matrix<S>,
    lyapunov: Matrix<S>,
    theta: S,
    phi: S,
    hbar: S,
    /// Not below e^(phi hbar).
    growth: S,
    relative: S,
    absolute: S,
    /// r / phi.
    reached: S,
}

impl<'a, S: Scalar> Assembly<'a, S> {
    fn new(stage: &Stage<'a>) -> Self {
        let Stage {
            model,
            law,
            certificate,
        } = *stage;
        let number = S::from_f64;
        let plants = DescriptorPlant::<S>::each_inertia(&model.plant);
        let specs = &model.file.specs;
        let (phi, hbar) = (number(specs.phi_per_s), number(specs.hbar_s));
        let bound = plants[0].disturbance_bound.clone();
        let absolute = number(law.trigger.absolute_nm);
        let split = S::one() + S::one() / number(certificate.command_split);
        let floor = number(certificate.command_weight) * split * absolute.clone();
        let supply = number(certificate.disturbance_weight) * bound.clone() * bound
            + floor * absolute.clone();
        Assembly {
            model,
            certificate,
            annihilators: craft_of(model).map_or(Vec::new(), annihilators),
            plants,
            gain: Matrix::exactly(&law.gain),
            lyapunov: Matrix::exactly(&certificate.lyapunov),
            theta: number(certificate.within_limit),
            growth: (phi.clone() * hbar.clone()).exp_upper(),
            relative: number(law.trigger.relative),
            absolute,
            reached: supply / phi.clone(),
            phi,
            hbar,
        }
    }

    fn emit(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        self.inertia(emit);
        self.positivity(emit);
        self.decrease(emit);
        self.supply(emit);
        self.region(emit);
        self.within_limit(emit);
        self.certified_attitudes(emit);
        self.must_contain(emit);
        self.final_bounds(emit);
    }

    /// Every inertia of the set is positive definite; no proof for another plant.
    fn inertia(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let Some(craft) = craft_of(self.model) else {
            let never = Matrix::identity(1, -S::one());
            return emit("a rigid spacecraft".to_string(), never);
        };
        for (index, bound) in inertia_bounds(craft).into_iter().enumerate() {
            emit(format!("inertia positive {}", index + 1), bound);
        }
    }

    fn positivity(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        let own = self.certificate;
        emit("lyapunov positive".into(), self.lyapunov.clone());
        let integral = Matrix::exactly(&own.integral_weight);
        emit("integral weight positive".into(), integral);
        let single = [
            ("share within limit positive", own.within_limit),
            ("command weight positive", own.command_weight),
            ("command split positive", own.command_split),
            ("disturbance weight positive", own.disturbance_weight),
        ];
        let sector = own.sector_weight.iter();
        let sector = sector.map(|&weight| ("sector weight positive", weight));
        for (name, value) in single.into_iter().chain(sector) {
            emit(name.into(), Matrix::identity(1, S::from_f64(value)));
        }
    }

    /// The torque may saturate on the certified set.
    fn saturates(&self) -> bool {
        self.certificate.within_limit != 1.0
    }
}

fn craft_of(model: &Model) -> Option<&ExactSpacecraft> {
    match &model.plant {
        Plant::Spacecraft(craft) => Some(craft),
        Plant::Vertices(_) | Plant::Rules(_) => None,
    }
}

fn not_covered(proof: &HeldCommandProof) -> Vec<String> {
    let model = proof.start.model;
    let bound = craft_of(model).map_or(0.0, |craft| craft.disturbance_bound);
    vec![
        "the state is measured without error".to_string(),
        "no delay between sample, trigger, controller and actuator, and no lost message"
            .to_string(),
        format!(
            "no gap between samples longer than {} s",
            model.file.specs.hbar_s
        ),
        "a first sample at the start, t = 0, that is sent".to_string(),
        "an inertia in the model's set, and a rigid body".to_string(),
        "a scalar part q0 that starts positive".to_string(),
        format!("a disturbance torque whose norm stays within {bound} N m"),
    ]
}
