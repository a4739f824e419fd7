//! When the pointing error of every certified start has become small: the time that the proof gives.

use super::file::DesignFile;
use crate::certify::interval::{half_angle_sine_squared, Interval};
use crate::certify::reach::fall_time;
use crate::certify::theorem1::{longest_without_torque, reached_from_rest};
use crate::model::Model;

/// Time from every certified start of a proved design after which the pointing error is at most `angle_deg` (s), by
/// `V <= e^(-phi t) V(0) + (1 - e^(-phi t)) r / phi` of each certificate in turn. `None` where that is not proved: the bound in
/// the end is larger, or nothing says that the small set is reached.
pub fn settling_time(file: &DesignFile, model: &Model, angle_deg: f64) -> Option<f64> {
    let own = file.certificate(model).ok()?;
    let start = match file.large_set_certificate(model).ok()? {
        None => longest_without_torque(model, &own),
        Some(large) => large.hand_over_time()?,
    };
    // |q|^2 <= V (claimed bound)^2 / (r / phi).
    let reached = reached_from_rest(model, &own);
    let claimed = Interval::from(own.final_bounds?.vector_part);
    let radians = Interval::from(angle_deg) * Interval::PI / Interval::from(180.0);
    let level = half_angle_sine_squared(radians) / claimed.sqr() * Interval::from(reached);
    Some(start + fall_time(model.file.specs.phi_per_s, reached, level.lo())?)
}
