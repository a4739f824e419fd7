//! The derivative of the Lyapunov functional of Xu & Huang 2020 term by term, from (17), (21)-(25),
//! in the paper's own unknowns: an oracle for the matrices of the conditions.
//!
//! Included with `#[path]` by several test programs, none of which uses all of it.
#![allow(dead_code)]

use nalgebra::{DMatrix, DVector};
use synth::conditions::xu2020::{DesignUnknowns, DEAD_ZONE_UNIT};
use synth::conditions::Task;

/// U, Y, Upsilon, Q, L1, L2, F, N, M, xi: the unknowns before the congruence.
pub struct Quantities {
    pub lyapunov: DMatrix<f64>,
    pub integral_weight: DMatrix<f64>,
    pub trigger_weight: DMatrix<f64>,
    pub multiplier: DMatrix<f64>,
    pub free_state: DMatrix<f64>,
    pub free_sample: DMatrix<f64>,
    pub gain: DMatrix<f64>,
    pub anti_windup: DMatrix<f64>,
    pub sector_weight: DMatrix<f64>,
    pub disturbance_weight: f64,
}

impl Quantities {
    /// The congruence undone: X = Q Xh Q', F = Fh Qh^-T. Without sector unknowns N = 0 and M = I.
    pub fn of(design: &DesignUnknowns, values: &[f64]) -> Self {
        let q = design
            .multiplier
            .value(values)
            .try_inverse()
            .expect("an invertible multiplier");
        let back = |transformed: DMatrix<f64>| &q * transformed * q.transpose();
        let gain = design.gain.value(values) * q.transpose();
        let (anti_windup, sector_weight) = match &design.sector {
            None => (
                DMatrix::zeros(gain.nrows(), gain.ncols()),
                DMatrix::identity(gain.nrows(), gain.nrows()),
            ),
            Some(sector) => (
                sector.anti_windup.value(values) * q.transpose(),
                sector
                    .weight
                    .value(values)
                    .try_inverse()
                    .expect("a positive sector weight"),
            ),
        };
        Quantities {
            lyapunov: back(design.lyapunov.value(values)),
            integral_weight: back(design.integral_weight.value(values)),
            trigger_weight: back(design.trigger_weight.value(values)),
            free_state: back(design.free_state.value(values)),
            free_sample: back(design.free_sample.value(values)),
            gain,
            anti_windup,
            sector_weight,
            disturbance_weight: design.disturbance_weight.value(values)[(0, 0)],
            multiplier: q,
        }
    }
}

/// psi of (28): x, x', x(t_k^l), e, dead zone, tau.
#[derive(Debug, Clone)]
pub struct Instant {
    pub state: DVector<f64>,
    pub rate: DVector<f64>,
    pub sample: DVector<f64>,
    pub error: DVector<f64>,
    pub dead_zone: DVector<f64>,
    pub disturbance: DVector<f64>,
}

impl Instant {
    /// x(t_k), what the controller holds.
    pub fn held(&self) -> DVector<f64> {
        &self.sample - &self.error
    }
}

/// `x' W x`.
pub fn quadratic(weight: &DMatrix<f64>, at: &DVector<f64>) -> f64 {
    at.dot(&(weight * at))
}

/// `|x|' |W| |x|`, entry by entry: what rounding errors of [`quadratic`] are relative to.
pub fn magnitude(weight: &DMatrix<f64>, at: &DVector<f64>) -> f64 {
    quadratic(&weight.abs(), &at.abs())
}

/// The terms of (28) at one instant, at one vertex.
pub struct Terms {
    /// (22): 2 x'U x' + phi x'Ux.
    pub lyapunov: f64,
    /// (23) at the start of the interval: hbar x''Yx'.
    pub integral_at_start: f64,
    /// (23) at its end: hbar e^(phi hbar) |L' [x; x(t_k^l)]|^2 in the norm of Y^-1.
    pub integral_at_end: f64,
    /// (23): 2 (x'L1 + x(t_k^l)'L2)(x - x(t_k^l)).
    pub path: f64,
    /// (24): zero where the plant's equation holds.
    pub plant: f64,
    /// (25): nu x(t_k)'W x(t_k) - e'We, not negative between triggers.
    pub trigger: f64,
    /// (17) with the held state: -2 p'M (p - N x(t_k)), not negative where the sector bound holds.
    pub sector: f64,
    /// -xi |tau|^2.
    pub disturbance: f64,
}

impl Terms {
    pub fn new(task: &Task, vertex: &DMatrix<f64>, at: &Instant, of: &Quantities) -> Self {
        let specs = &task.specification;
        let (phi, hbar) = (specs.decay_rate, specs.sampling_interval_max);
        let [e1, e2, e3] = specs.multiplier_weights;
        let held = at.held();
        let path = of.free_state.transpose() * &at.state + of.free_sample.transpose() * &at.sample;
        let inverse = of.integral_weight.clone().try_inverse().expect("Y > 0");
        let combination = &at.state * e1 + &at.rate * e2 + &at.sample * e3;
        let residual = vertex * &at.state
            + &task.system.input * (&of.gain * &held - &at.dead_zone)
            + &task.system.disturbance * &at.disturbance
            - &at.rate;
        let outside = &at.dead_zone - &of.anti_windup * &held;
        Terms {
            lyapunov: 2.0 * at.state.dot(&(&of.lyapunov * &at.rate))
                + phi * quadratic(&of.lyapunov, &at.state),
            integral_at_start: hbar * quadratic(&of.integral_weight, &at.rate),
            integral_at_end: hbar * (phi * hbar).exp() * quadratic(&inverse, &path),
            path: 2.0 * path.dot(&(&at.state - &at.sample)),
            plant: 2.0 * combination.dot(&(&of.multiplier * residual)),
            trigger: specs.trigger_threshold * quadratic(&of.trigger_weight, &held)
                - quadratic(&of.trigger_weight, &at.error),
            sector: -2.0 * at.dead_zone.dot(&(&of.sector_weight * outside)),
            disturbance: -of.disturbance_weight * at.disturbance.norm_squared(),
        }
    }

    /// What r = 1 and r = 2 share.
    fn common(&self) -> f64 {
        self.lyapunov + self.path + self.plant + self.trigger + self.sector + self.disturbance
    }

    /// The quadratic form of (18) for r = 1.
    pub fn at_start(&self) -> f64 {
        self.common() + self.integral_at_start
    }

    /// The quadratic form of (18) for r = 2.
    pub fn at_end(&self) -> f64 {
        self.common() + self.integral_at_end
    }
}

/// psi in the rows of the condition: x = Qh' xh for the four state rows, dead zone = unit S ph. The
/// dead-zone row is left out without sector unknowns.
pub fn in_rows(design: &DesignUnknowns, of: &Quantities, at: &Instant) -> DVector<f64> {
    let q = of.multiplier.transpose();
    let mut rows: Vec<f64> = Vec::new();
    for part in [&at.state, &at.rate, &at.sample, &at.error] {
        rows.extend((&q * part).iter());
    }
    if design.sector.is_some() {
        rows.extend((&of.sector_weight * &at.dead_zone / DEAD_ZONE_UNIT).iter());
    }
    rows.extend(at.disturbance.iter());
    DVector::from_vec(rows)
}

/// The Schur complement of the last `side` rows: `A - B C^-1 B'`.
pub fn schur_complement(matrix: &DMatrix<f64>, side: usize) -> DMatrix<f64> {
    let kept = matrix.nrows() - side;
    let corner = matrix.view((kept, kept), (side, side)).into_owned();
    let beside = matrix.view((0, kept), (kept, side)).into_owned();
    let inverse = corner.try_inverse().expect("an invertible corner");
    matrix.view((0, 0), (kept, kept)) - &beside * inverse * beside.transpose()
}
