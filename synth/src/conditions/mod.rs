//! The published conditions, one file each, as named matrix inequalities.

mod bounded_real;
pub mod h_infinity;
pub mod held_command;
mod imperfections;
pub mod quadratic_stabilisation;
pub mod saturated_region;
pub mod state_feedback;
pub mod units;
pub mod vertex_plant;
pub mod xu2020;

pub use imperfections::{
    FloorSupply, GainErrorSet, LoopImperfections, MeasurementError, MeasurementPoint,
};

use nalgebra::{DMatrix, DVector};

use crate::fuzzy::TakagiSugeno;

/// c of the split (e + d)'W(e + d) <= (1 + 1/c) e'We + (1 + c) d'Wd: with the threshold nu (1 + c) / c and a perfect
/// measurement, (18) serves a loop with the threshold nu and the measurement error d.
pub const ERROR_SPLIT: f64 = 1.0;

/// The requirements of the closed loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Specification {
    /// Decay rate `phi` of the Lyapunov functional [1/s].
    pub decay_rate: f64,
    /// Longest sampling interval `hbar` (s).
    pub sampling_interval_max: f64,
    /// Largest trigger threshold `nu` that may occur at run time, in [0, 1).
    pub trigger_threshold: f64,
    /// Weights `eps_1, eps_2, eps_3` of the multiplier on x, x' and x(t_k^l); the second is positive.
    pub multiplier_weights: [f64; 3],
    /// Largest admitted disturbance weight `xi`.
    pub disturbance_weight_max: f64,
    /// States that must satisfy x0' U x0 <= 1.
    pub must_contain: Vec<DVector<f64>>,
    /// The scalar `rho` of the containment condition, in scaled units.
    pub containment_weight: f64,
    /// Margin of every strict inequality, in scaled units.
    pub margin: f64,
}

/// Which gains there are and what is assumed about their memberships.
#[derive(Debug, Clone, PartialEq)]
pub struct GainPlan {
    /// Number of gains F_j, at least 1. One: a constant gain.
    pub count: usize,
    /// Bound kappa on |zeta_j(t) - zeta_j(t_k)| of every rule j; the gains are then one for each
    /// vertex. `None` with several gains: they may be weighted in any way at any time.
    pub mismatch: Option<f64>,
    /// The gains, m x n each, where they are given; otherwise they are unknowns.
    pub given: Option<Vec<DMatrix<f64>>>,
}

impl GainPlan {
    /// One unknown gain.
    pub fn constant() -> Self {
        GainPlan {
            count: 1,
            mismatch: None,
            given: None,
        }
    }

    /// Given gains, m x n each.
    pub fn given(gains: &[DMatrix<f64>], mismatch: Option<f64>) -> Self {
        GainPlan {
            count: gains.len(),
            mismatch,
            given: Some(gains.to_vec()),
        }
    }

    /// Bound kappa when plant and gains are weighted by nearly the same memberships.
    pub fn matched(&self) -> Option<f64> {
        self.mismatch.filter(|_| self.count > 1)
    }
}

/// A signal s of bounded norm that drives the plant: x' = ... + coefficient s with |s| <= bound.
#[derive(Debug, Clone, PartialEq)]
pub struct FurtherSignal {
    /// The word for it in the names of conditions; each signal has its own.
    pub name: &'static str,
    /// n x d.
    pub coefficient: DMatrix<f64>,
    /// Bound on its Euclidean norm.
    pub bound: f64,
}

/// A model and a specification in one system of units.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// The T-S model.
    pub system: TakagiSugeno,
    /// The requirements.
    pub specification: Specification,
    /// Signals of bounded norm beside the disturbance, in units of its own; each has a weight up to that of the
    /// disturbance.
    pub further_signals: Vec<FurtherSignal>,
    /// What the loop does otherwise than an ideal one.
    pub imperfections: LoopImperfections,
    /// `xi` in these units times this number is `xi` in SI units.
    pub disturbance_weight_unit: f64,
    /// The bound on g that is minimised is at least this times xi (SI units); 1 for the gamma of the paper.
    pub gain_per_weight: f64,
    /// With nu = 0 the held state may be taken for the last sample: e = 0 whatever the trigger weight, which is then no
    /// part of (18); one that is large enough satisfies the whole of it.
    pub held_is_sample: bool,
    /// The gains.
    pub gains: GainPlan,
    /// Sets to be contained, where a search requires them.
    pub containment: Option<Containment>,
}

impl Task {
    /// A task in the units of its model, for a constant gain.
    pub fn new(system: TakagiSugeno, specification: Specification) -> Self {
        Task {
            system,
            specification,
            further_signals: Vec::new(),
            imperfections: LoopImperfections::default(),
            disturbance_weight_unit: 1.0,
            gain_per_weight: 1.0,
            held_is_sample: false,
            gains: GainPlan::constant(),
            containment: None,
        }
    }

    /// The same task with its containment condition stated about a point P in the place of a weight rho, or of another
    /// point.
    pub fn containing_about(&self, linearisation: DMatrix<f64>) -> Task {
        let mut task = self.clone();
        let states = std::mem::take(&mut task.specification.must_contain).into_iter();
        let columns =
            states.map(|state| DMatrix::from_column_slice(state.len(), 1, state.as_slice()));
        let other = task.containment.take();
        let (mut contained, scaled) =
            other.map_or_else(Default::default, |other| (other.contained, other.scaled));
        contained.extend(columns);
        task.containment = Some(Containment {
            linearisation,
            contained,
            scaled,
        });
        task
    }

    /// The greatest age of the sample behind the torque in force (s): hbar, or h_m.
    pub fn oldest_sample(&self) -> f64 {
        let networked = self.imperfections.oldest_sample;
        networked.unwrap_or(self.specification.sampling_interval_max)
    }

    /// The threshold of (18): nu; or, with a measurement error for which there is no point of linearisation, the larger one
    /// of a loop with a perfect measurement whose functional serves this loop as well.
    pub fn trigger_threshold(&self) -> f64 {
        let nu = self.specification.trigger_threshold;
        let error = self.imperfections.measurement.as_ref();
        match error.is_some_and(|error| error.point.is_none()) {
            true => nu * (1.0 + ERROR_SPLIT) / ERROR_SPLIT,
            false => nu,
        }
    }

    /// Unit of the bound on g in these units, in SI units.
    pub fn gain_unit(&self) -> f64 {
        self.disturbance_weight_unit * self.gain_per_weight
    }

    /// The weight with which the supply of all bounded signals reaches phi, so that k2 = 1: a larger one gains nothing,
    /// because U, Y, W, Q, L, M and all weights divided by k2 satisfy the conditions too, with the same guaranteed gain.
    /// Infinite without a disturbance.
    pub fn largest_useful_weight(&self) -> f64 {
        let further = self.further_signals.iter().map(|signal| signal.bound);
        let bounds = std::iter::once(self.system.disturbance_bound).chain(further);
        let squares: f64 = bounds.map(|bound| bound * bound).sum();
        self.specification.decay_rate / squares
    }

    /// Level `k2 = max(1, xi_max taubar^2 / phi)`, the sum over all bounded signals: x'Ux never exceeds it once it
    /// started below 1.
    pub fn invariant_level(&self) -> f64 {
        let specification = &self.specification;
        let further = self.further_signals.iter().map(|signal| signal.bound);
        let bounds = std::iter::once(self.system.disturbance_bound).chain(further);
        let reached: f64 = bounds
            .map(|bound| specification.disturbance_weight_max * bound * bound)
            .sum();
        (reached / specification.decay_rate).max(1.0)
    }
}

/// What x'Ux <= 1 must cover: ellipsoids {D z, |z| <= 1}, a single column being a state and its negative.
/// n states.
#[derive(Debug, Clone, PartialEq)]
pub struct Containment {
    /// P, n x n, in the units of the task. At P = Uh^-1 Qh of the solution the linearisation is exact.
    pub linearisation: DMatrix<f64>,
    /// The D, n x k each, to be contained at scale 1.
    pub contained: Vec<DMatrix<f64>>,
    /// The D to be contained after multiplication by one common scale, which may be maximised.
    pub scaled: Vec<DMatrix<f64>>,
}

impl Containment {
    /// The scalar case P = rho I, which needs no known point.
    pub fn scalar(states: usize, rho: f64) -> Self {
        Containment {
            linearisation: DMatrix::identity(states, states) * rho,
            contained: Vec::new(),
            scaled: Vec::new(),
        }
    }
}
