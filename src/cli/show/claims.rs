//! What a design claims, the same in every verb that proves one.

use nalgebra::DVector;
use serde::Serialize;
use synth::certify::reach::{angle_of_vector_part_deg, Along};
use synth::certify::Verdict;
use synth::design::{DesignFile, LargeSetCertificate};
use synth::model::Model;
use synth::synthesis::reached;

use crate::run::design::certified_angle_deg;
use crate::sim::transmissions::TransmissionBound;

/// The claims of a design; null, and no words, where it is not proved.
#[derive(Debug, Default, Serialize)]
pub struct DesignClaims {
    /// The bound of the L-infinity gain.
    pub gamma: Option<f64>,
    /// sup|y| / sup|tau| from rest.
    pub guaranteed_gain: Option<f64>,
    /// The weight of the disturbance.
    xi: Option<f64>,
    /// Largest angle such that every attitude at rest within it is a certified start (deg).
    certified_angle_deg: Option<f64>,
    /// Every attitude at rest up to this angle, about any axis, is in the set (deg).
    certified_angle_any_axis_deg: Option<f64>,
    /// The smallest angle along the must-contain states that are attitudes at rest (deg).
    certified_angle_along_deg: Option<f64>,
    /// How far the set goes along each must-contain state: proved, rounded down.
    must_contain: Vec<Along>,
    /// No two messages are closer than this (s).
    min_inter_event_s: Option<f64>,
    /// Its inverse.
    max_transmissions_per_s: Option<f64>,
    /// The outer certificate; null for a design with one certificate.
    outer: Option<OuterClaims>,
    /// The bound that both numbers above come from.
    #[serde(skip)]
    transmissions: Option<TransmissionBound>,
}

/// The claims of the outer certificate of a design with two.
#[derive(Debug, Serialize)]
struct OuterClaims {
    /// The bound of the L-infinity gain.
    gamma: f64,
    /// sup|y| / sup|tau| from rest.
    guaranteed_gain: f64,
    /// The weight of the disturbance.
    xi: f64,
    /// Largest angle such that every attitude at rest within it is a certified start (deg).
    certified_angle_deg: Option<f64>,
    /// Its trigger weight as a multiple of the inner one's.
    trigger_multiple: f64,
    /// x'Ux at each start that the outer set must contain.
    start_levels: Vec<f64>,
}

impl DesignClaims {
    /// From the numbers of a design and the verdict about them.
    pub fn of(design: &DesignFile, model: &Model, verdict: Verdict) -> Self {
        if verdict == Verdict::NotProved {
            return DesignClaims::default();
        }
        let part = &design.certificate;
        let along = reached(model, &part.lyapunov);
        let transmissions = TransmissionBound::of_model(model);
        // A file that was read has been checked, so its outer certificate can be read again.
        let outer = design.large_set_certificate(model).ok().flatten();
        DesignClaims {
            gamma: Some(part.gamma),
            guaranteed_gain: Some(part.guaranteed_gain),
            xi: Some(part.xi),
            certified_angle_deg: certified_angle_deg(part.certified_vector_part),
            certified_angle_any_axis_deg: part.certified_vector_part.map(angle_of_vector_part_deg),
            certified_angle_along_deg: along
                .iter()
                .filter_map(|one| one.angle_deg)
                .reduce(f64::min),
            must_contain: along,
            min_inter_event_s: Some(transmissions.min_inter_event_s),
            max_transmissions_per_s: Some(transmissions.max_transmissions_per_s),
            outer: outer.as_ref().map(OuterClaims::of),
            transmissions: Some(transmissions),
        }
    }

    /// The gain and the certified angle, rounded.
    pub fn gain_lines(&self) -> Vec<String> {
        let gamma = self.gamma.map(|gamma| format!("gamma: {gamma:.6}"));
        let gain = self.guaranteed_gain;
        let gain =
            gain.map(|gain| format!("guaranteed gain: {gain:.6} (sup|y| / sup|tau| from rest)"));
        let angle = self.certified_angle_deg;
        let angle = angle
            .map(|angle| format!("certified set: every attitude at rest up to {angle:.3} deg"));
        [gamma, gain, angle].into_iter().flatten().collect()
    }

    /// One line for each further claim.
    pub fn further_lines(&self) -> Vec<String> {
        let mut lines = self.outer.as_ref().map_or(Vec::new(), OuterClaims::lines);
        lines.extend(self.must_contain.iter().enumerate().map(|(index, state)| {
            let angle = state.angle_deg.map_or(String::new(), |angle| {
                format!(", up to {angle:.3} deg at rest")
            });
            let (number, scale) = (index + 1, state.scale);
            format!("must-contain state {number}: covered up to {scale:.4} times the state{angle}")
        }));
        lines.extend(self.transmissions.iter().map(TransmissionBound::describe));
        lines
    }
}

impl OuterClaims {
    fn of(outer: &LargeSetCertificate) -> Self {
        let certificate = &outer.certificate;
        let level = |state: &Vec<f64>| {
            let state = DVector::from_column_slice(state);
            (state.transpose() * &certificate.lyapunov * &state)[(0, 0)]
        };
        let starts = outer.model.file.specs.must_contain.iter();
        OuterClaims {
            gamma: certificate.gain_bound,
            guaranteed_gain: certificate.guaranteed_gain,
            xi: certificate.disturbance_weight,
            certified_angle_deg: certified_angle_deg(certificate.certified_vector_part),
            trigger_multiple: certificate.trigger_multiple,
            start_levels: starts.map(level).collect(),
        }
    }

    fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "outer certificate: gamma {:.6}, guaranteed gain {:.6}",
            self.gamma, self.guaranteed_gain
        )];
        let angle = self.certified_angle_deg;
        lines.extend(angle.map(|angle| {
            format!("outer certified set: every attitude at rest up to {angle:.3} deg")
        }));
        lines.extend(self.start_levels.iter().enumerate().map(|(index, level)| {
            format!(
                "outer start {}: x'Ux = {level:.6} (the set: at most 1)",
                index + 1
            )
        }));
        lines
    }
}
