//! What a design claims beside gamma, printed alike by every verb that proves one.

use nalgebra::DVector;
use serde_json::{json, Value};
use synth::certify::theorem1::Certificate;
use synth::certify::Verdict;
use synth::design::{DesignFile, OuterCertificate};
use synth::model::Model;

use super::reach::Reach;
use crate::run::design::certified_angle_deg;
use crate::sim::transmissions::TransmissionBound;

/// The outer certificate's numbers; null for a design with one certificate.
pub fn outer_json(design: &DesignFile, model: &Model) -> Value {
    let Some(outer) = outer_of(design, model) else {
        return Value::Null;
    };
    let certificate = &outer.certificate;
    json!({
        "gamma": certificate.gain_bound,
        "guaranteed_gain": certificate.guaranteed_gain,
        "xi": certificate.disturbance_weight,
        "certified_angle_deg": certified_angle_deg(certificate.certified_vector_part),
        "trigger_multiple": certificate.trigger_multiple,
        "start_levels": start_levels(&outer),
    })
}

/// The same as text; none for a design with one certificate.
pub fn outer_lines(design: &DesignFile, model: &Model) -> Vec<String> {
    let Some(outer) = outer_of(design, model) else {
        return Vec::new();
    };
    let certificate = &outer.certificate;
    let mut lines = vec![format!(
        "outer certificate: gamma {:.6}, guaranteed gain {:.6}",
        certificate.gain_bound, certificate.guaranteed_gain
    )];
    if let Some(angle) = certified_angle_deg(certificate.certified_vector_part) {
        lines.push(format!(
            "outer certified set: every attitude at rest up to {angle:.3} deg"
        ));
    }
    for (index, level) in start_levels(&outer).iter().enumerate() {
        lines.push(format!(
            "outer start {}: x'Ux = {level:.6} (the set: at most 1)",
            index + 1
        ));
    }
    lines
}

/// A file that was read has been checked, so its outer certificate can be read again.
fn outer_of(design: &DesignFile, model: &Model) -> Option<OuterCertificate> {
    design.outer_certificate(model).ok().flatten()
}

/// x'Ux at each start that the outer set must contain.
fn start_levels(outer: &OuterCertificate) -> Vec<f64> {
    let level = |certificate: &Certificate, state: &Vec<f64>| {
        let state = DVector::from_column_slice(state);
        (state.transpose() * &certificate.lyapunov * &state)[(0, 0)]
    };
    let starts = outer.model.file.specs.must_contain.iter();
    starts
        .map(|state| level(&outer.certificate, state))
        .collect()
}

/// The claims of a design, as text and as keys of `--json`; null and no words where it is not proved.
pub struct Guarantees {
    proved: bool,
    certified_angle_deg: Option<f64>,
    outer: Value,
    outer_lines: Vec<String>,
    reach: Reach,
    transmissions: TransmissionBound,
}

impl Guarantees {
    /// From the numbers of a design and the verdict about them.
    pub fn of(design: &DesignFile, model: &Model, verdict: Verdict) -> Self {
        let proved = verdict == Verdict::Proved;
        let part = &design.certificate;
        Guarantees {
            proved,
            certified_angle_deg: certified_angle_deg(part.certified_vector_part).filter(|_| proved),
            outer: match proved {
                true => outer_json(design, model),
                false => Value::Null,
            },
            outer_lines: match proved {
                true => outer_lines(design, model),
                false => Vec::new(),
            },
            reach: Reach::of(design, model, verdict),
            transmissions: TransmissionBound::of_model(model),
        }
    }

    /// A proved number; null where nothing is proved.
    pub fn number(&self, value: f64) -> Value {
        match self.proved {
            true => json!(value),
            false => Value::Null,
        }
    }

    /// Largest angle such that every attitude at rest within it is a certified start (deg).
    pub fn certified_angle_deg(&self) -> Option<f64> {
        self.certified_angle_deg
    }

    /// Adds the keys to a JSON object.
    pub fn add_to(&self, report: &mut Value) {
        report["certified_angle_deg"] = json!(self.certified_angle_deg);
        let transmissions = self.proved.then_some(&self.transmissions);
        report["min_inter_event_s"] = json!(transmissions.map(|own| own.min_inter_event_s));
        report["max_transmissions_per_s"] =
            json!(transmissions.map(|own| own.max_transmissions_per_s));
        report["outer"] = self.outer.clone();
        report["certified_angle_any_axis_deg"] = json!(self.reach.any_axis_deg);
        report["certified_angle_along_deg"] = json!(self.reach.along_deg());
        report["must_contain"] = json!(self.reach.states());
    }

    /// One line for each claim but the certified angle.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = self.outer_lines.clone();
        lines.extend(self.reach.lines());
        if self.proved {
            lines.push(self.transmissions.describe());
        }
        lines
    }
}
