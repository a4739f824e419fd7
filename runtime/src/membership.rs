//! Membership functions: how much each fuzzy rule counts at a state.

use nalgebra::{SVector, Vector6};

use crate::error::{AllowedRange, Field, ParameterError};

/// Membership functions of `R` rules over an `N`-dimensional state.
///
/// A constant gain is the case of one rule: see [`ConstantGain`].
pub trait Membership<const N: usize, const R: usize> {
    /// Weights of the rules (the zeta of Xu and Huang 2020, (8)), none negative, with sum 1 up to
    /// rounding. Outside of the region of the model the weights are those of the nearest point in
    /// the scheduling variables.
    fn weights(&self, state: &SVector<f64, N>) -> [f64; R];

    /// True when the state is in the region on which the model is meant to hold.
    fn contains(&self, state: &SVector<f64, N>) -> bool;
}

/// Turns the products of the rules' factors (in `weights`) and the sums of their exponents into
/// weights with sum 1. `false`, and equal weights, when every rule's grade is 0 or a number is not
/// finite.
pub fn normalise(weights: &mut [f64], exponents: &[f64]) -> bool {
    let used = weights
        .iter()
        .zip(exponents)
        .filter(|(&factor, _)| factor > 0.0);
    let nearest = used.fold(f64::INFINITY, |least, (_, &exponent)| least.min(exponent));
    let mut sum = 0.0;
    if nearest.is_finite() {
        for (weight, exponent) in weights.iter_mut().zip(exponents) {
            // Of a rule that is not used the exponential may overflow.
            if *weight > 0.0 {
                *weight *= libm::exp(nearest - exponent);
            }
            sum += *weight;
        }
    }
    let usable = sum > 0.0 && sum.is_finite();
    let count = weights.len() as f64;
    for weight in weights.iter_mut() {
        *weight = if usable { *weight / sum } else { 1.0 / count };
    }
    usable
}

/// One rule that always counts fully, on an unbounded region.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConstantGain;

impl<const N: usize> Membership<N, 1> for ConstantGain {
    fn weights(&self, _state: &SVector<f64, N>) -> [f64; 1] {
        [1.0]
    }

    fn contains(&self, _state: &SVector<f64, N>) -> bool {
        true
    }
}

/// Products of interval weights over a box of `V` scheduling variables, with one rule for each of
/// the `R = 2^V` vertices (exact sector form).
///
/// Order: bit `k` of a vertex's index is set when variable `k` is at its upper bound there. A
/// function that is affine in each variable is the weighted sum of its vertex values, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalProduct<const V: usize, const R: usize> {
    lower: [f64; V],
    upper: [f64; V],
}

impl<const V: usize, const R: usize> IntervalProduct<V, R> {
    /// Box from `lower` to `upper`, each variable in its own unit. `R` other than `2^V` does not
    /// compile.
    ///
    /// # Errors
    /// A bound that is not finite, or a lower bound that is not below its upper bound (by a
    /// difference that can be represented).
    pub fn new(lower: [f64; V], upper: [f64; V]) -> Result<Self, ParameterError> {
        const { assert!(R == 1 << V, "an interval product has 2^V vertices") };
        for (variable, (low, high)) in lower.iter().zip(&upper).enumerate() {
            let field = |name| Field::component(name, variable);
            AllowedRange::FINITE.check(field("lower"), *low)?;
            AllowedRange::FINITE.check(field("upper"), *high)?;
            let width = high - low;
            if !(width > 0.0 && width.is_finite()) {
                return Err(ParameterError::EmptyInterval {
                    field: field("lower"),
                    lower: *low,
                    upper: *high,
                });
            }
        }
        Ok(Self { lower, upper })
    }

    /// Values of the scheduling variables at a vertex; `None` when there is no such vertex.
    pub fn vertex(&self, index: usize) -> Option<[f64; V]> {
        if index >= R {
            return None;
        }
        let mut values = self.lower;
        for (variable, (value, high)) in values.iter_mut().zip(&self.upper).enumerate() {
            if at_upper(index, variable) {
                *value = *high;
            }
        }
        Some(values)
    }

    /// Weights of the vertices; variables outside of the box count as on its boundary. A variable that
    /// is not a number makes the weights so.
    pub fn weights(&self, variables: &[f64; V]) -> [f64; R] {
        let mut weights = [1.0; R];
        let bounds = self.lower.iter().zip(&self.upper);
        for (variable, (value, (low, high))) in variables.iter().zip(bounds).enumerate() {
            let fraction = ((value - low) / (high - low)).clamp(0.0, 1.0);
            for (index, weight) in weights.iter_mut().enumerate() {
                *weight *= if at_upper(index, variable) {
                    fraction
                } else {
                    1.0 - fraction
                };
            }
        }
        weights
    }

    /// True when every variable is within its bounds.
    pub fn contains(&self, variables: &[f64; V]) -> bool {
        let bounds = self.lower.iter().zip(&self.upper);
        variables
            .iter()
            .zip(bounds)
            .all(|(value, (low, high))| low <= value && value <= high)
    }
}

fn at_upper(index: usize, variable: usize) -> bool {
    (index >> variable) & 1 == 1
}

/// Number of vertices of a [`RigidBodyBox`].
pub const RIGID_BODY_VERTICES: usize = 16;

/// The box on which the rigid body is exactly a fuzzy model of 16 rules.
///
/// The system matrix of the rigid body with the state `[omega; q]` is affine in the four scheduling
/// variables, which are, in order, omega1, omega2, omega3 (rad/s) and the scalar part
/// `q0 = sqrt(1 - |q|^2)`. Vertex `i` has variable `k` at its upper bound when bit `k` of `i` is set:
/// vertex 0 is all rates at their lower bound and q0 at its minimum, vertex 8 the same with q0 = 1.
///
/// As a [`Membership`] it serves scheduled gains (16 rules) and a constant gain (1 rule) alike; the
/// latter uses the box only to notice that the state has left it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBodyBox {
    vertices: IntervalProduct<4, RIGID_BODY_VERTICES>,
}

impl RigidBodyBox {
    /// Box `|omega_i| <= rate_bound_rad_s[i]` (rad/s) and `scalar_min <= q0 <= 1`.
    ///
    /// # Errors
    /// A rate bound that is not finite and positive; `scalar_min` outside of `[0, 1)`.
    pub fn new(rate_bound_rad_s: [f64; 3], scalar_min: f64) -> Result<Self, ParameterError> {
        AllowedRange::POSITIVE.check_vector("rate_bound_rad_s", &rate_bound_rad_s.into())?;
        AllowedRange::half_open(0.0, 1.0).check_scalar("scalar_min", scalar_min)?;
        let [w1, w2, w3] = rate_bound_rad_s;
        let vertices = IntervalProduct::new([-w1, -w2, -w3, scalar_min], [w1, w2, w3, 1.0])?;
        Ok(Self { vertices })
    }

    /// Scheduling variables omega1, omega2, omega3 (rad/s) and q0 at a state `[omega; q]`. Where
    /// `|q| > 1`, which no attitude has, q0 is zero.
    pub fn scheduling_variables(state: &Vector6<f64>) -> [f64; 4] {
        let [[w1, w2, w3, q1, q2, q3]] = state.data.0;
        [w1, w2, w3, scalar_part(q1, q2, q3)]
    }

    /// Scheduling variables at a vertex, in the same order; `None` from index 16 on.
    pub fn vertex(&self, index: usize) -> Option<[f64; 4]> {
        self.vertices.vertex(index)
    }

    /// Weights of the 16 vertices at a state `[omega; q]`.
    pub fn vertex_weights(&self, state: &Vector6<f64>) -> [f64; RIGID_BODY_VERTICES] {
        self.vertices.weights(&Self::scheduling_variables(state))
    }

    /// True when the state `[omega; q]` is in the box.
    pub fn contains_state(&self, state: &Vector6<f64>) -> bool {
        let [[.., q1, q2, q3]] = state.data.0;
        q1 * q1 + q2 * q2 + q3 * q3 <= 1.0
            && self.vertices.contains(&Self::scheduling_variables(state))
    }
}

fn scalar_part(q1: f64, q2: f64, q3: f64) -> f64 {
    libm::sqrt((1.0 - (q1 * q1 + q2 * q2 + q3 * q3)).max(0.0))
}

impl Membership<6, RIGID_BODY_VERTICES> for RigidBodyBox {
    fn weights(&self, state: &Vector6<f64>) -> [f64; RIGID_BODY_VERTICES] {
        self.vertex_weights(state)
    }

    fn contains(&self, state: &Vector6<f64>) -> bool {
        self.contains_state(state)
    }
}

impl Membership<6, 1> for RigidBodyBox {
    fn weights(&self, _state: &Vector6<f64>) -> [f64; 1] {
        [1.0]
    }

    fn contains(&self, state: &Vector6<f64>) -> bool {
        self.contains_state(state)
    }
}

/// Normalised Gaussian memberships about the centres of local rules.
///
/// For models made of linearisations "about" a few states, such as the seven rules of Xu and Huang
/// 2020, section 4, whose membership functions the paper does not print. Such a model interpolates
/// the plant; it does not equal it, so it carries no certificate of the plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianRules<const N: usize, const R: usize> {
    centres: [SVector<f64, N>; R],
    widths: SVector<f64, N>,
}

impl<const N: usize, const R: usize> GaussianRules<N, R> {
    /// Rules about `centres`, with the standard deviation `widths` in each state, both in the state's
    /// units.
    ///
    /// # Errors
    /// A centre that is not finite; a width that is not finite and positive.
    pub fn new(
        centres: [SVector<f64, N>; R],
        widths: SVector<f64, N>,
    ) -> Result<Self, ParameterError> {
        const { assert!(R >= 1, "a fuzzy model has at least one rule") };
        AllowedRange::FINITE.check_rules("centres", &centres)?;
        AllowedRange::POSITIVE.check_vector("widths", &widths)?;
        Ok(Self { centres, widths })
    }
}

impl<const N: usize, const R: usize> Membership<N, R> for GaussianRules<N, R> {
    /// Weights relative to the nearest rule, so that they stay defined far from every centre; equal
    /// weights where even the distance overflows.
    fn weights(&self, state: &SVector<f64, N>) -> [f64; R] {
        let exponents = self.centres.map(|centre| {
            let offset = (state - centre).component_div(&self.widths);
            0.5 * offset.dot(&offset)
        });
        let mut weights = [1.0; R];
        normalise(&mut weights, &exponents);
        weights
    }

    fn contains(&self, _state: &SVector<f64, N>) -> bool {
        true
    }
}
