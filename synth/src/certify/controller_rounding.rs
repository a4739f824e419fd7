//! What rounding in the controller adds to the disturbance and to a decision of the trigger.
//!
//! With u = 2^-53 and c_k = k u / (1 - k u), a sum of n products of doubles, in whatever order and with or without fused
//! operations, is off by at most c_n times the sum of the products' magnitudes, and by a little for what underflows.
//! Let |w_j| <= X_j for whatever is measured where the proof holds: the box bounds the rates, and no vector part of a
//! quaternion that the controller accepts is above 1.01. Then
//!
//! ```text
//! torque:    |fl(F w) - F w| <= sum_i h_i (c_8 sum_j |F_ij| X_j)                  saturation adds nothing
//! decision:  a sample is not sent: e'We <= nu w'Ww + eps_a + c_24 ((4 + 2 nu) X'|W|X + eps_a)
//! ```
//!
//! with h_i what the actuators make of an axis's torque. The first is a further disturbance torque, the second a further
//! floor of the trigger: the theorem covers both, if its levels hold with them. See the book's derivation.

use super::theorem1::{for_each_hand_over_condition, for_each_level_condition};
use super::{judge_all, Certificate, HandOver, Verdict};
use crate::model::{Model, Plant};
use verified::interval::Interval;
use verified::rounding::{add_up, next_up};
use verified::scalar::Scalar;

/// Half the distance of 1 from the next double.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Roundings behind a term of a command: its product, at most six sums, and one to spare.
const OF_COMMAND: f64 = 8.0;
/// Roundings behind a term of a decision: two of the differences, two products, two sums of six, a product and a sum; and some
/// to spare.
const OF_DECISION: f64 = 24.0;

/// Magnitude of a component of a vector part that the controller accepts.
const LARGEST_VECTOR_PART: f64 = 1.01;

/// Far above what a few dozen results below the smallest normal number lose.
const UNDERFLOW: f64 = 1e-300;

/// The most that rounding adds.
#[derive(Debug, Clone)]
pub struct ControllerRounding<S> {
    /// To the torque (N m).
    pub torque: S,
    /// To what a decision of the trigger allows, in the unit of e'We.
    pub decision: S,
}

/// What rounding with this unit adds at most; `None` where no bound is known: another plant than the exact spacecraft, or
/// gains that are weighted.
pub fn controller_rounding<S: Scalar>(
    model: &Model,
    certificate: &Certificate,
    unit: f64,
) -> Option<ControllerRounding<S>> {
    let Plant::Spacecraft(craft) = &model.plant else {
        return None;
    };
    let mut gains = certificate.gains();
    let (Some(gain), None) = (gains.next(), gains.next()) else {
        return None;
    };
    let number = S::from_f64;
    let relative = |roundings: f64| {
        let sum = number(roundings) * number(unit);
        sum.clone() / (S::one() - sum)
    };
    let error = model.file.imperfections.measurement_error();
    let error = error.and_then(|bounds| bounds.rate_rad_s).unwrap_or(0.0);
    let largest: Vec<S> = (0..6)
        .map(|state| match craft.rate_bound.get(state) {
            Some(&rate) => number(rate) + number(error),
            None => number(LARGEST_VECTOR_PART),
        })
        .collect();
    let magnitude = |value: f64| number(value.abs());
    let imperfections = &model.file.imperfections;
    let torque = (0..gain.nrows()).fold(number(UNDERFLOW), |sum, axis| {
        let row = gain
            .row(axis)
            .iter()
            .zip(&largest)
            .fold(S::zero(), |sum, (&entry, most)| {
                sum + magnitude(entry) * most.clone()
            });
        let [_, most] = imperfections
            .effectiveness
            .as_ref()
            .map_or([1.0; 2], |own| own.of(axis));
        let acting = number(most) + number(2.0) * number(imperfections.misalignment);
        sum + acting.max(S::one()) * relative(OF_COMMAND) * row
    });
    let weight = &certificate.trigger_weight;
    let form = weight
        .row_iter()
        .zip(&largest)
        .fold(S::zero(), |sum, (row, most)| {
            let terms = row.iter().zip(&largest);
            let row = terms.fold(S::zero(), |sum, (&entry, most)| {
                sum + magnitude(entry) * most.clone()
            });
            sum + most.clone() * row
        });
    let floor = number(certificate.trigger_floor);
    let share = number(4.0) + number(2.0) * number(model.file.specs.nu);
    let decision = relative(OF_DECISION) * (share * form + floor) + number(UNDERFLOW);
    Some(ControllerRounding { torque, decision })
}

/// A disturbance torque (N m) that does to the functional what rounding with this unit does: xi (|tau| + b)^2 + c is at most
/// xi (|tau| + b + sqrt(c / xi))^2. Rounded up.
pub fn as_disturbance(model: &Model, certificate: &Certificate, unit: f64) -> Option<f64> {
    let added = controller_rounding::<Interval>(model, certificate, unit)?;
    let weight = Interval::from(certificate.disturbance_weight);
    let multiple = Interval::from(certificate.trigger_multiple);
    Some((added.torque + (multiple * added.decision / weight).sqrt()).hi())
}

/// The same model with so much more disturbance, and the same certificate with so much more of a floor; rounded up.
fn with_rounding(
    model: &Model,
    certificate: &Certificate,
    unit: f64,
) -> Option<(Model, Certificate)> {
    let added = controller_rounding::<Interval>(model, certificate, unit)?;
    let mut model = model.clone();
    if let Plant::Spacecraft(craft) = &mut model.plant {
        craft.disturbance_bound = next_up(add_up(craft.disturbance_bound, added.torque.hi()));
    }
    let certificate = Certificate {
        trigger_floor: next_up(add_up(certificate.trigger_floor, added.decision.hi())),
        ..certificate.clone()
    };
    Some((model, certificate))
}

/// Whether every level of a proved design holds with what rounding with this unit adds; `large` is the certificate of a large
/// set with how its states come under the small one.
pub fn holds_with_rounding(
    (model, certificate): (&Model, &Certificate),
    large: Option<(&Model, &Certificate, Option<&HandOver>)>,
    unit: f64,
) -> bool {
    let Some(small) = with_rounding(model, certificate, unit) else {
        return false;
    };
    let outer = large.map(|(model, certificate, _)| with_rounding(model, certificate, unit));
    let outer = match outer {
        Some(None) => return false,
        Some(Some(outer)) => Some(outer),
        None => None,
    };
    let report = judge_all(Vec::new(), |emit| {
        for (model, certificate) in [Some(&small), outer.as_ref()].into_iter().flatten() {
            for_each_level_condition::<Interval>(model, certificate, emit);
        }
        let hand_over = large.and_then(|(_, _, hand_over)| hand_over);
        if let (Some((model, certificate)), Some(hand_over)) = (&outer, hand_over) {
            let small = (&small.0, &small.1);
            for_each_hand_over_condition((model, certificate), small, hand_over, emit);
        }
    });
    report.verdict == Verdict::Proved
}
