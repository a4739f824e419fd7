//! What a certified set contains, and why it does not contain more, in words and as JSON.

use std::path::Path;

use serde_json::{json, Value};
use synth::certify::reach::{angle_of_vector_part_deg, Along};
use synth::certify::Verdict;
use synth::design::DesignFile;
use synth::model::Model;
use synth::synthesis::{reached, LimitingFactors};

use super::print;

/// What the certified set of a design contains: proved, rounded down.
pub struct Reach {
    /// Every attitude at rest up to this angle, about any axis (deg).
    pub any_axis_deg: Option<f64>,
    along: Vec<Along>,
}

impl Reach {
    /// From the numbers of a design; nothing where they are not proved.
    pub fn of(design: &DesignFile, model: &Model, verdict: Verdict) -> Self {
        let part = &design.certificate;
        if verdict == Verdict::NotProved {
            return Reach {
                any_axis_deg: None,
                along: Vec::new(),
            };
        }
        Reach {
            any_axis_deg: part.certified_vector_part.map(angle_of_vector_part_deg),
            along: reached(model, &part.lyapunov),
        }
    }

    /// The smallest angle along the must-contain states that are attitudes at rest (deg).
    pub fn along_deg(&self) -> Option<f64> {
        self.along
            .iter()
            .filter_map(|along| along.angle_deg)
            .reduce(f64::min)
    }

    /// Each must-contain state: how many times it the set contains, and the angle there.
    pub fn states(&self) -> Vec<Value> {
        let states = self.along.iter();
        let states =
            states.map(|along| json!({ "scale": along.scale, "angle_deg": along.angle_deg }));
        states.collect()
    }

    /// One line for each must-contain state.
    pub fn lines(&self) -> Vec<String> {
        let line = |(index, along): (usize, &Along)| {
            let angle = along.angle_deg.map_or(String::new(), |angle| {
                format!(", up to {angle:.3} deg at rest")
            });
            format!(
                "must-contain state {}: covered up to {:.4} times the state{angle}",
                index + 1,
                along.scale
            )
        };
        self.along.iter().enumerate().map(line).collect()
    }
}

/// Conditions named at most.
const BLOCKING: usize = 6;

/// Why what was asked for was not reached, as JSON.
pub fn shortfall_json(shortfall: &LimitingFactors) -> Value {
    let limits = shortfall.limits.iter().map(|limit| {
        json!({ "what": limit.what, "value": limit.value, "percent_per_percent": limit.per_cent })
    });
    json!({
        "reason": shortfall.reason,
        "scale": shortfall.scale,
        "angle_deg": shortfall.angle_deg,
        "limits": limits.collect::<Vec<_>>(),
    })
}

/// The same in words.
pub fn tell_shortfall(model: &Path, shortfall: &LimitingFactors, blocking: &[(String, f64)]) {
    print(&format!(
        "{}: UNDECIDED: {}",
        model.display(),
        shortfall.reason
    ));
    if !shortfall.limits.is_empty() {
        print("what holds it back (1 % more of the number changes the outcome by so much):");
    }
    for limit in &shortfall.limits {
        print(&format!(
            "  {:+.3} %  {}, now {}",
            limit.per_cent, limit.what, limit.value
        ));
    }
    if !blocking.is_empty() {
        print("conditions by their share of the dual solution:");
    }
    for (name, share) in blocking.iter().take(BLOCKING) {
        print(&format!("  {:4.1} %  {name}", 100.0 * share));
    }
    print("nothing written");
}
