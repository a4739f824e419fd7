//! What holds on the sets x'Ux <= k2 and x'Ux <= 1: saturation, region, starts, gain, pointing.

use super::{gain_suffix, Assembly};
use crate::certify::certified_set::{self, attitudes_contained, final_bounds, states_contained};
use crate::model::{Model, Plant};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

impl<S: Scalar> Assembly<'_, S> {
    /// (19) with k2 for every gain and input, on what a measurement error leaves of the limit.
    pub(super) fn anti_windup(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        for (rule, (gain, anti_windup)) in self.gains.iter().enumerate() {
            let difference = gain.minus(anti_windup);
            for (input, limit) in self.plant.input_limit.iter().enumerate() {
                let name = format!("anti-windup input {}", input + 1);
                let name = name + &gain_suffix(self.gains.len(), rule);
                let row = difference.row(input);
                let limit = self.limit_without_error(limit, &row, &name, emit);
                let factor = limit.clone() * limit / self.level.clone();
                emit(name, self.inside(factor, &row, S::one()));
            }
        }
    }

    /// (20): C'C <= gamma phi U and gamma above every weight; and the claimed guaranteed gain G: C'C <= G^2/xi phi U
    /// with the largest weight xi. Where more than the disturbance feeds the functional, r / taubar^2 is in the place of the
    /// weight.
    pub(super) fn peak_gain(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        let gamma = S::from_f64(self.certificate.gain_bound);
        let claim = S::from_f64(self.certificate.guaranteed_gain);
        emit("peak gain".into(), self.gain_block(gamma.clone()));
        for (signal, weight) in self.weighted() {
            let above = gamma.clone() - S::from_f64(weight);
            let name = format!("gain bound above {} weight", signal.name);
            emit(name, Matrix::identity(1, above));
        }
        let squared = claim.clone() * claim;
        if self.supply.is_mixed {
            let bound = self.plant.disturbance_bound.clone();
            let bound = bound.clone() * bound;
            let above = gamma * bound.clone() - self.supply.total.clone();
            emit("gain bound above supply".into(), Matrix::identity(1, above));
            // y'y <= g phi V with g = G^2 taubar^2 / (phi V): phi is in the block.
            let reached = self.phi.clone() * self.supply.from_rest.clone();
            let implied = squared * bound / reached;
            emit("guaranteed gain".into(), self.gain_block(implied));
            return;
        }
        // Comes last: dividing by a weight needs it to be positive, which (18) has shown.
        let weights = self.weighted().map(|(_, weight)| weight);
        let largest = S::from_f64(weights.fold(f64::NEG_INFINITY, f64::max));
        emit("guaranteed gain".into(), self.gain_block(squared / largest));
    }

    /// A weight above the model's xi_max is no design for the model; a condition of its own only where it fails.
    pub(super) fn weight_limit(&self, model: &Model, emit: &mut impl FnMut(String, Matrix<S>)) {
        for (signal, weight) in self.weighted() {
            let within = weight <= model.file.specs.xi_max;
            if !within {
                let name = format!("{} weight within xi_max", signal.name);
                emit(name, Matrix::identity(1, -S::one()));
            }
        }
    }

    /// `C'C <= bound phi U`.
    fn gain_block(&self, bound: S) -> Matrix<S> {
        self.inside(self.phi.clone(), &self.plant.output, bound)
    }

    fn inside(&self, factor: S, rows: &Matrix<S>, unit: S) -> Matrix<S> {
        certified_set::inside(&self.lyapunov, &factor, rows, unit)
    }

    /// |x_j| <= X_j on x'Ux <= k2, for each state.
    pub(super) fn state_bounds(&self, bounds: &[f64], emit: &mut dyn FnMut(String, Matrix<S>)) {
        for (state, &bound) in bounds.iter().enumerate() {
            let row = Matrix::from_fn(1, bounds.len(), |_, column| match column == state {
                true => S::one(),
                false => S::zero(),
            });
            let squared = S::from_f64(bound) * S::from_f64(bound);
            let factor = squared / self.level.clone();
            emit(
                format!("bound of state {}", state + 1),
                self.inside(factor, &row, S::one()),
            );
        }
    }

    /// The set x'Ux <= k2 lies in the region of the model.
    pub(super) fn region(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        for bound in &self.plant.region {
            let factor = bound.bound_squared.clone() / self.level.clone();
            let inside = self.inside(factor, &bound.rows, S::one());
            emit(format!("box {}", bound.name), inside);
        }
    }

    /// Every state that the model requires is a certified start, x0'U x0 < rho_0; rho_0 = 1 where the torque acts at once.
    pub(super) fn must_contain(&self, model: &Model, emit: &mut impl FnMut(String, Matrix<S>)) {
        let (start, states) = (&self.supply.certified_start, &model.file.specs.must_contain);
        states_contained(&self.lyapunov, start, states, emit);
    }

    /// Every attitude at rest up to the claimed radius is a certified start.
    pub(super) fn certified_attitudes(
        &self,
        model: &Model,
        emit: &mut impl FnMut(String, Matrix<S>),
    ) {
        let radius = self.certificate.certified_vector_part;
        if let (Plant::Spacecraft(_), Some(radius)) = (&model.plant, radius) {
            let start = &self.supply.certified_start;
            attitudes_contained(&self.lyapunov, start, radius, emit);
        }
    }

    /// The bounds from rest, and in the end from every certified start.
    pub(super) fn final_bounds(&self, model: &Model, emit: &mut impl FnMut(String, Matrix<S>)) {
        let claims = &self.certificate.final_bounds;
        if let (Plant::Spacecraft(_), Some(claims)) = (&model.plant, claims) {
            final_bounds(&self.lyapunov, &self.supply.from_rest, claims, emit);
        }
    }
}
