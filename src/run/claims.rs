//! What the certificates of a design claim of a run.

use nalgebra::{SMatrix, SVector};
use synth::certify::theorem1::{certified_start, reached_from_rest, Certificate};
use synth::model::{Model, Plant};

use super::design::Design;
use super::inner::HandOverClaim;
use super::summary::OutputBound;
use crate::sim::embedding;
use crate::sim::lyapunov::Claims;

/// How x'Ux of a design grows, for `N` states, `M` inputs and `D` disturbances, padded.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WorstCase<const N: usize, const M: usize, const D: usize> {
    /// B'U: with the input.
    pub by_input: SMatrix<f64, M, N>,
    /// B_w'U: with the disturbance.
    pub by_disturbance: SMatrix<f64, D, N>,
    /// F'B'U: with an error of the measurement.
    pub by_error: SMatrix<f64, N, N>,
}

impl Design {
    /// The claims that hold from the start on, padded to `N` states: the outer certificate's where there
    /// are two.
    pub fn claims<const N: usize>(&self) -> Claims<N> {
        match &self.outer {
            Some(outer) => claims(&outer.model, &outer.certificate),
            None => claims(&self.model, &self.certificate),
        }
    }

    /// B'U, B_w'U and F'B'U of the claims that hold from the start on, padded: how x'Ux grows with the input, with the
    /// disturbance, and with an error of the measurement. Of several gains the first counts.
    pub(crate) fn worst_case<const N: usize, const M: usize, const D: usize>(
        &self,
    ) -> WorstCase<N, M, D> {
        let outer = self.outer.as_ref();
        let certificate = outer.map_or(&self.certificate, |outer| &outer.certificate);
        let plant = self.model.plant.takagi_sugeno();
        let by_input = plant.input.transpose() * &certificate.lyapunov;
        let by_disturbance = plant.disturbance.transpose() * &certificate.lyapunov;
        let by_error = self.certificate.gain.transpose() * &by_input;
        WorstCase {
            by_input: embedding::matrix(&by_input),
            by_disturbance: embedding::matrix(&by_disturbance),
            by_error: embedding::matrix(&by_error),
        }
    }

    /// What is proved of sup|y| from rest. Where only the disturbance acts, |y|^2 <= g xi sup|tau|^2; with errors, a floor, a
    /// moving reference, rounded torques or late messages |y| <= G taubar, with taubar the bound on all that acts like a
    /// disturbance.
    pub fn output_bound(&self) -> OutputBound {
        let (model, certificate) = (&self.model, &self.certificate);
        let imperfections = &model.file.imperfections;
        let bound = model.plant.takagi_sugeno().disturbance_bound;
        let further = imperfections.measurement_error().is_some()
            || imperfections.is_networked()
            || certificate.trigger_floor > 0.0
            || bound > torque_bound(model);
        match (further, self.proved()) {
            (false, _) => OutputBound::Gain,
            (true, false) => OutputBound::None,
            (true, true) => OutputBound::Peak(certificate.guaranteed_gain * bound),
        }
    }

    /// At how many following samples the design's model has a value sent again.
    pub fn repeats(&self) -> u32 {
        self.model.file.imperfections.lost_in_a_row
    }

    /// The inner certificate's claims, where there are two.
    pub fn inner_claims<const N: usize>(&self) -> Option<Claims<N>> {
        let claims = || claims(&self.model, &self.certificate);
        self.outer.as_ref().map(|_| claims())
    }

    /// The hand-over from the outer set to the inner one, where the design proves one.
    pub fn hand_over<const N: usize>(&self) -> Option<HandOverClaim<N>> {
        let outer = self.outer.as_ref().filter(|_| self.proved())?;
        Some(HandOverClaim {
            lyapunov: (!outer.model.file.imperfections.is_networked())
                .then(|| embedding::matrix(&outer.certificate.lyapunov)),
            level: outer.hand_over.as_ref()?.level,
            latest_s: outer.hand_over_time()?,
        })
    }
}

/// Bound on the norm of the disturbance alone, without what the reference and rounded torques add to it.
fn torque_bound(model: &Model) -> f64 {
    match &model.plant {
        Plant::Spacecraft(craft) => craft.disturbance_bound,
        plant => plant.takagi_sugeno().disturbance_bound,
    }
}

/// A certificate's claims, padded to `N` states.
fn claims<const N: usize>(model: &Model, certificate: &Certificate) -> Claims<N> {
    let plant = model.plant.takagi_sugeno();
    let (ultimate, start) = (
        reached_from_rest(model, certificate),
        certified_start(model, certificate),
    );
    let mut bounds = Vec::new();
    let mut component_bounds = SVector::repeat(f64::INFINITY);
    let mut vector_part_bound = None;
    for condition in &plant.region {
        let bound = condition.bound_squared.sqrt();
        let row: Vec<f64> = condition.rows.iter().copied().collect();
        match (condition.rows.nrows(), unit_component(&row)) {
            (1, Some(component)) => {
                let least: &mut f64 = &mut component_bounds[component];
                *least = least.min(bound);
            }
            (1, None) => bounds.push((embedding::vector(&row), bound)),
            _ => vector_part_bound = Some(bound),
        }
    }
    Claims {
        lyapunov: embedding::matrix(&certificate.lyapunov),
        decay_rate: model.file.specs.phi_per_s,
        ultimate_level: ultimate,
        start_level: start,
        networked: model.file.imperfections.is_networked(),
        disturbance_bound: torque_bound(model),
        bounds,
        component_bounds,
        vector_part_bound,
        output: (!plant.output.is_identity(0.0)).then(|| embedding::matrix(&plant.output)),
    }
}

/// The component that a row picks out, when it is one of the identity's.
fn unit_component(row: &[f64]) -> Option<usize> {
    let component = row.iter().position(|&value| value != 0.0)?;
    let rest = &row[component + 1..];
    (row[component] == 1.0 && rest.iter().all(|&value| value == 0.0)).then_some(component)
}
