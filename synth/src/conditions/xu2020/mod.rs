//! Xu & Huang 2020, Theorem 2, in the corrected form (see the book's chapter on the derivation).
//!
//! All unknowns are those after the congruence with the inverse multiplier: with Qh = Q^-1,
//! Uh = Qh U Qh', Yh = Qh Y Qh', Wh = Qh Upsilon Qh', L1h = Qh L1 Qh', L2h = Qh L2 Qh',
//! Fh = F Qh', Nh = N Qh', S = M^-1.

mod anti_windup;
mod decrease;
mod first_torque;
mod measurement;
mod mismatch;
mod peak_gain;
mod sets;
mod signals;
mod unknowns;

pub use anti_windup::gain_suffix;
pub use decrease::{condition_name, decrease, full_condition, full_matched_condition};
pub use first_torque::{smallest_growth, FirstTorqueUnknowns, Functional};
pub use peak_gain::GAIN_ABOVE;
pub use sets::containment;
pub use signals::{
    terms, terms_at, vertex_term, vertex_term_at, vertex_terms_at, Basis, Signal, Term,
};
pub use unknowns::{
    gain_error_unknowns, DesignUnknowns, MeasurementUnknowns, MismatchUnknowns, RuleUnknowns,
    SamplingEnd, Sector, SectorUnknowns, DEAD_ZONE_UNIT,
};

pub use super::Containment;
pub use sdp::lmi::Strictness;

use super::Task;
use sdp::lmi::Condition;

/// Every condition but the decrease condition (18): positivity, anti-windup (19), gain (20), box,
/// disturbance weight, must-contain states.
pub fn side_conditions(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let mut out = positivity_and_anti_windup(task, unknowns, strictness);
    out.push(peak_gain::peak_gain(task, unknowns, strictness));
    out.extend(peak_gain::gain_above_weight(task, unknowns, strictness));
    out.extend(weight_region_and_start(task, unknowns, strictness));
    out
}

/// The same without the gain (20): a gamma that is large enough satisfies it whatever the rest, so
/// that it does not decide whether a design exists.
pub fn conditions_without_gain(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let mut out = positivity_and_anti_windup(task, unknowns, strictness);
    out.extend(weight_region_and_start(task, unknowns, strictness));
    out
}

/// The same with `C'C <= g phi U` alone of the gain's conditions: with xi it bounds the gain by sqrt(g xi).
pub fn conditions_with_peak(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let mut out = conditions_without_gain(task, unknowns, strictness);
    out.push(peak_gain::peak_gain(task, unknowns, strictness));
    out
}

fn positivity_and_anti_windup(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let mut out = vec![
        strictness.positive("lyapunov positive", unknowns.lyapunov.clone()),
        strictness.positive("integral weight positive", unknowns.integral_weight.clone()),
    ];
    if !task.held_is_sample {
        let weight = unknowns.trigger_weight.clone();
        out.push(strictness.positive("trigger weight positive", weight));
    }
    out.extend(anti_windup::sector_positive(unknowns, strictness));
    out.extend(anti_windup::anti_windup(task, unknowns, strictness));
    out.extend(mismatch::bounded(task, unknowns, strictness));
    out.extend(measurement::measurement(task, unknowns, strictness));
    out
}

fn weight_region_and_start(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let mut out: Vec<Condition> = peak_gain::weight_bound(task, unknowns).collect();
    out.extend(sets::region(task, unknowns, strictness));
    out.extend(sets::must_contain(task, unknowns, strictness));
    out
}
