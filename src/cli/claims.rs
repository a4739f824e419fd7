//! What a design claims beside gamma, told alike by every verb that proves one.

use serde_json::{json, Value};
use synth::certify::Verdict;
use synth::design::DesignFile;
use synth::model::Model;

use super::both;
use super::reach::Reach;
use crate::harness::design::certified_angle_deg;
use crate::harness::transmissions::TransmissionBound;

/// The claims of a design, in words and as keys of `--json`; null and no words where it is not proved.
pub struct Claims {
    proved: bool,
    certified_angle_deg: Option<f64>,
    outer: Value,
    outer_lines: Vec<String>,
    reach: Reach,
    transmissions: TransmissionBound,
}

impl Claims {
    /// From the numbers of a design and the verdict about them.
    pub fn of(design: &DesignFile, model: &Model, verdict: Verdict) -> Self {
        let proved = verdict == Verdict::Proved;
        let part = &design.certificate;
        Claims {
            proved,
            certified_angle_deg: certified_angle_deg(part.certified_vector_part).filter(|_| proved),
            outer: match proved {
                true => both::outer_json(design, model),
                false => Value::Null,
            },
            outer_lines: match proved {
                true => both::outer_lines(design, model),
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
