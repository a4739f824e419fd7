//! The constants of the paper's proofs. The paper says of several that they exist; here each is
//! computed from the parameters, for as long as V2 < S2 and every |eps_i| < [`FUNNEL_USE`].

use nalgebra::Vector3;
use runtime::attitude::Quaternion;
use runtime::lei2022::{CompositeTrigger, ControlLaw};
use serde::Serialize;

/// What the conditions are evaluated for.
#[derive(Debug, Clone)]
pub struct Case {
    /// Control law with its inertia.
    pub law: ControlLaw,
    /// Composite trigger.
    pub trigger: CompositeTrigger,
    /// Torque limit of each axis, N m.
    pub torque_limit: Vector3<f64>,
    /// Error quaternion at the start, scalar part not negative.
    pub error: Quaternion,
    /// Body rate at the start, rad/s.
    pub rate_rad_s: Vector3<f64>,
    /// Bound of each component of the disturbance torque, N m.
    pub disturbance_nm: Vector3<f64>,
    /// Largest body rate that is required, rad/s, where it is.
    pub rate_limit_rad_s: Option<f64>,
}

/// k_u: the bound of |eps_i| that section VI-A sets.
pub const FUNNEL_USE: f64 = 1.5;

/// Largest |d/dx sech^2 x|: 4 / (3 sqrt 3).
const STEEPEST_SECANT: f64 = 0.7699;
/// Above the largest |x^2 d/dx sech^2 x|.
const STEEPEST_WEIGHTED_SECANT: f64 = 0.7516;

/// Constants of the proofs, in SI units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bounds {
    /// Smallest and largest principal moment of inertia, kg m^2.
    pub inertia_kg_m2: (f64, f64),
    /// max over t and i of |rho_i'| / rho_i, 1/s.
    pub funnel_contraction_per_s: f64,
    /// Smallest rho_i.
    pub narrowest_funnel: f64,
    /// B_omega: bound of the body rate, rad/s.
    pub rate_rad_s: f64,
    /// B_alpha: bound of alpha', rad/s^2.
    pub virtual_acceleration_rad_s2: f64,
    /// B_2alpha: bound of alpha'', rad/s^3.
    pub virtual_jerk_rad_s3: f64,
    /// B_q of (22): bound of P_q, N m.
    pub compensation_nm: f64,
    /// Bound of P_q', N m/s, which the paper also calls B_q in (58).
    pub compensation_rate_nm_s: f64,
    /// D_0 of (27), W.
    pub disturbance_residual_w: f64,
    /// b of (25), N m s: the one that makes V2 infinity smallest.
    pub young_constant_nm_s: f64,
    /// B_1 of (28), also C_eps of (44), at the start's |q_e0|, 1/s.
    pub first_layer_decay_per_s: f64,
    /// B_2 of (28), 1/s.
    pub second_layer_decay_per_s: f64,
    /// V2 infinity: (D_0 + m / (2 b)) / B_2, J.
    pub second_layer_residual_j: f64,
    /// U_z of (38), N m.
    pub drift_torque_nm: f64,
    /// a_0 of (41), J^(1/2)/s.
    pub drift_rate: f64,
    /// V1(0) and V2(0), J.
    pub start_energy_j: (f64, f64),
}

impl Bounds {
    /// The constants for a case.
    pub fn new(case: &Case) -> Self {
        let law = &case.law;
        let moments = law.inertia.symmetric_eigenvalues();
        let (least, most) = (moments.min(), moments.max());
        let contraction = funnel_contraction(case);
        let narrowest = law.performance.terminal.min();
        let rate = rate_bound(case, least);
        let (acceleration, jerk) = virtual_derivatives(case, (least, most), rate, contraction);
        let bound = law.disturbance.bound_nm;
        let residual = 3.0 * 0.2785 * law.disturbance.smoothing_rad_s * bound;
        let m = case.trigger.held_error_terminal;
        let young = young_constant(law.rate_gain, residual, m);
        let second = 2.0 * (law.rate_gain - 0.5 * young) / most;
        let strength = case.error.scalar.abs() * law.virtual_law.rate_scale_rad_s;
        let start = law.evaluate(0.0, &case.error, &case.rate_rad_s);
        let drift = most * rate * rate + bound + most * acceleration;
        Bounds {
            inertia_kg_m2: (least, most),
            funnel_contraction_per_s: contraction,
            narrowest_funnel: narrowest,
            rate_rad_s: rate,
            virtual_acceleration_rad_s2: acceleration,
            virtual_jerk_rad_s3: jerk,
            compensation_nm: 3f64.sqrt() * law.barrier.gain_j * FUNNEL_USE / narrowest,
            compensation_rate_nm_s: compensation_rate(case, rate, contraction),
            disturbance_residual_w: residual,
            young_constant_nm_s: young,
            first_layer_decay_per_s: strength - 4.0 * contraction,
            second_layer_decay_per_s: second,
            second_layer_residual_j: (residual + 0.5 * m / young) / second,
            drift_torque_nm: drift,
            drift_rate: drift * (2.0 / least).sqrt(),
            start_energy_j: (start.barrier_value, start.rate_error_energy),
        }
    }
}

/// max |rho'| / rho of (3), in closed form: 2 y / f_s where y = tanh((t - T_s) / f_s) solves
/// d/dt (|rho'| / rho) = 0, which gives y = (sqrt rho_0 - sqrt rho_inf) / (sqrt rho_0 + sqrt rho_inf).
fn funnel_contraction(case: &Case) -> f64 {
    let performance = &case.law.performance;
    let axes = performance.initial.iter().zip(&performance.terminal);
    let steepest = axes.map(|(initial, terminal)| {
        let (wide, narrow) = (initial.sqrt(), terminal.sqrt());
        2.0 / performance.time_scale_s * (wide - narrow) / (wide + narrow)
    });
    steepest.fold(0.0, f64::max)
}

/// |omega| <= |alpha| + |z2| <= k_m M |rho(0)| + sqrt(2 S2(0) / lambda_min).
fn rate_bound(case: &Case, least_inertia: f64) -> f64 {
    let funnel = case.law.performance.value(0.0).norm();
    let follow = (2.0 * case.trigger.envelope_initial_j / least_inertia).sqrt();
    case.law.virtual_law.strength() * funnel + follow
}

/// The b > 0 that minimises (D_0 + m / (2 b)) / (2 K_2 - b): the root of D_0 b^2 + m b - m K_2 = 0.
fn young_constant(rate_gain: f64, residual: f64, m: f64) -> f64 {
    let root = m + (m * m + 4.0 * residual * m * rate_gain).sqrt();
    2.0 * m * rate_gain / root
}

/// Bounds of |alpha'| and |alpha''|. With alpha = -k_m M A(Q) r, A quadratic in the quaternion Q,
/// |A| <= 1, |A'| <= 4 |Q'|, |A''| <= 4 |Q''| + 4 |Q'|^2, and r_i = rho_i tanh(gamma q_i / rho_i).
fn virtual_derivatives(
    case: &Case,
    (least, most): (f64, f64),
    rate: f64,
    contraction: f64,
) -> (f64, f64) {
    let law = &case.law;
    let (performance, slope) = (&law.performance, law.virtual_law.slope);
    let torque = case.torque_limit.norm() + case.disturbance_nm.norm();
    let angular_acceleration = (torque + most * rate * rate) / least;
    let turn = 0.5 * rate;
    let turn_rate = 0.5 * angular_acceleration + turn * turn;
    let width = performance.value(0.0).norm();
    let fall = 0.5 * (performance.initial - performance.terminal).norm() / performance.time_scale_s;
    let bend = 2.0 * STEEPEST_SECANT * fall / performance.time_scale_s;
    let narrowest = performance.terminal.min();
    let first = fall + slope * turn;
    let curvature = 2.0 * STEEPEST_SECANT * (slope * turn).powi(2) / narrowest
        + 2.0 * STEEPEST_WEIGHTED_SECANT * fall * contraction;
    let second = bend + slope * turn_rate + curvature;
    let strength = law.virtual_law.strength();
    let jerk = (4.0 * turn_rate + 4.0 * turn * turn) * width + 8.0 * turn * first + second;
    (strength * (4.0 * turn * width + first), strength * jerk)
}

/// Bound of |P_q'| for P_q = k_1 tanh(eps'eps / F_1) F_s' psi eps, by the product rule.
fn compensation_rate(case: &Case, rate: f64, contraction: f64) -> f64 {
    let barrier = &case.law.barrier;
    let narrowest = case.law.performance.terminal.min();
    let eps = 3f64.sqrt() * FUNNEL_USE;
    let eps_rate = 0.5 * rate / narrowest + contraction * eps;
    let parts = eps * eps * eps_rate / barrier.width
        + 0.25 * rate * eps
        + 0.5 * contraction * eps
        + 0.5 * eps_rate;
    barrier.gain_j * parts / narrowest
}
