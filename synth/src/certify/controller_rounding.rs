//! What rounding in the controller adds to the disturbance and to a decision of the trigger.
//!
//! With u = 2^-53 and c_k = k u / (1 - k u), a sum of n products of doubles, in whatever order and with or without fused
//! operations, is off by at most c_n times the sum of the products' magnitudes, and by a little for what underflows.
//! Let |w_j| <= X_j for whatever is measured where the proof holds: the box of a spacecraft bounds the rates, and no vector
//! part of a quaternion that the controller accepts is above 1.01; the states of another plant are in x'Ux <= k2. Then, with n
//! states,
//!
//! ```text
//! command:   |fl(F w) - F w| <= sum_i h_i (c_(n+2) sum_j |F_ij| X_j)              saturation adds nothing
//! decision:  a sample is not sent: e'We <= nu w'Ww + eps_a + c_(2n+12) ((4 + 2 nu) X'|W|X + eps_a)
//! ```
//!
//! with h_i what the actuators make of a command. The first is a further disturbance where the disturbance acts on the inputs,
//! the second a further floor of the trigger: the theorem covers both, if its levels hold with them. See the book's derivation.

use super::theorem1::{
    for_each_hand_over_condition, for_each_level_condition, for_each_state_bound, reached_from_rest,
};
use super::{judge_all, Certificate, HandOver, Verdict};
use crate::model::{ErrorUnit, Model, Plant};
use verified::interval::Interval;
use verified::matrix::Matrix;
use verified::rounding::{add_up, next_up};
use verified::scalar::Scalar;

/// Half the distance of 1 from the next double.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Roundings behind a term of a command, of n states: its product, at most n sums, and one to spare.
fn of_command(states: usize) -> f64 {
    states as f64 + 2.0
}

/// Roundings behind a term of a decision: two of the differences, two products, two sums of n, a product and a sum; and some to
/// spare.
fn of_decision(states: usize) -> f64 {
    2.0 * states as f64 + 12.0
}

/// Magnitude of a component of a vector part that the controller accepts.
const LARGEST_VECTOR_PART: f64 = 1.01;

/// How far beyond the set x'Ux <= k2 its bounds on states are put, relative.
const BEYOND: f64 = 1e-3;

/// Far above what a few dozen results below the smallest normal number lose.
const UNDERFLOW: f64 = 1e-300;

/// The most that rounding adds.
#[derive(Debug, Clone)]
pub struct ControllerRounding<S> {
    /// To the command: the torque (N m), or the inputs of another plant, in norm.
    pub torque: S,
    /// To what a decision of the trigger allows, in the unit of e'We.
    pub decision: S,
}

/// Bounds on the magnitudes of the states where the proof holds; `None` where none is known.
fn state_bounds(model: &Model, certificate: &Certificate) -> Option<Vec<f64>> {
    if let Plant::Spacecraft(craft) = &model.plant {
        let rates = craft.rate_bound.iter().copied();
        return Some(rates.chain([LARGEST_VECTOR_PART; 3]).collect());
    }
    let inverse = certificate.lyapunov.clone().cholesky()?.inverse();
    let level = reached_from_rest(model, certificate).max(1.0);
    let bounds = inverse
        .diagonal()
        .map(|own| (1.0 + BEYOND) * (level * own).sqrt());
    let finite = bounds.iter().all(|bound| bound.is_finite());
    finite.then(|| bounds.iter().copied().collect())
}

/// Whether what is added to a command acts as a disturbance does.
fn disturbance_acts_on_inputs(plant: &Plant) -> bool {
    let system = match plant {
        Plant::Spacecraft(_) => return true,
        Plant::Vertices(system) => system,
        Plant::Rules(rules) => &rules.system,
    };
    system.disturbance_matrix == system.input_matrix && system.disturbance_bound > 0.0
}

/// What rounding with this unit adds at most; `None` where no bound is known: a plant whose disturbance does not act on the
/// inputs, or gains that are weighted.
pub fn controller_rounding<S: Scalar>(
    model: &Model,
    certificate: &Certificate,
    unit: f64,
) -> Option<ControllerRounding<S>> {
    if !disturbance_acts_on_inputs(&model.plant) {
        return None;
    }
    let mut gains = certificate.gains();
    let (Some(gain), None) = (gains.next(), gains.next()) else {
        return None;
    };
    let number = S::from_f64;
    let relative = |roundings: f64| {
        let sum = number(roundings) * number(unit);
        sum.clone() / (S::one() - sum)
    };
    let states = gain.ncols();
    let errors = model.file.imperfections.measurement_error();
    let balls = errors.map_or(Vec::new(), |bounds| bounds.balls());
    let error = |state: usize| -> f64 {
        let own = balls.iter().filter(|ball| ball.states.contains(&state));
        // A quaternion that a spacecraft's controller accepts is bounded with its error.
        let exact = matches!(model.plant, Plant::Spacecraft(_));
        let own = own.filter(|ball| !exact || ball.factor == ErrorUnit::State);
        own.map(|ball| next_up(ball.radius())).fold(0.0, f64::max)
    };
    let bounds = state_bounds(model, certificate)?.into_iter().enumerate();
    let largest: Vec<S> = bounds
        .map(|(state, bound)| number(bound) + number(error(state)))
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
        sum + acting.max(S::one()) * relative(of_command(states)) * row
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
    let decision = relative(of_decision(states)) * (share * form + floor) + number(UNDERFLOW);
    Some(ControllerRounding { torque, decision })
}

/// A disturbance (N m for a spacecraft) that does to the functional what rounding with this unit does: xi (|tau| + b)^2 + c is at most
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
    let bound = match &mut model.plant {
        Plant::Spacecraft(craft) => &mut craft.disturbance_bound,
        Plant::Vertices(system) => &mut system.disturbance_bound,
        Plant::Rules(rules) => &mut rules.system.disturbance_bound,
    };
    *bound = next_up(add_up(*bound, added.torque.hi()));
    let certificate = Certificate {
        trigger_floor: next_up(add_up(certificate.trigger_floor, added.decision.hi())),
        ..certificate.clone()
    };
    Some((model, certificate))
}

/// The states stay within the bounds that rounding was computed from, with what it adds. The box of a spacecraft is among its
/// levels.
fn states_within_bounds(
    (model, certificate): (&Model, &Certificate),
    (more, floor): (&Model, &Certificate),
    emit: &mut dyn FnMut(String, Matrix<Interval>),
) {
    if matches!(model.plant, Plant::Spacecraft(_)) {
        return;
    }
    match state_bounds(model, certificate) {
        Some(bounds) => for_each_state_bound(more, floor, &bounds, emit),
        // Nothing is known: a condition that fails.
        None => emit(
            "bounds of the states".into(),
            Matrix::identity(1, -Interval::one()),
        ),
    }
}

/// Whether every level of a proved design holds with what rounding with this unit adds; `large` is the certificate of a large
/// set with how its states come under the small one.
pub fn holds_with_rounding(
    small: (&Model, &Certificate),
    large: Option<(&Model, &Certificate, Option<&HandOver>)>,
    unit: f64,
) -> bool {
    let sets = [Some(small), large.map(|own| (own.0, own.1))];
    let sets: Vec<_> = sets.into_iter().flatten().collect();
    let rounded = sets.iter();
    let rounded: Option<Vec<_>> = rounded
        .map(|(model, certificate)| with_rounding(model, certificate, unit))
        .collect();
    let Some(rounded) = rounded else {
        return false;
    };
    let report = judge_all(Vec::new(), |emit| {
        for (&set, (model, certificate)) in sets.iter().zip(&rounded) {
            for_each_level_condition::<Interval>(model, certificate, emit);
            states_within_bounds(set, (model, certificate), emit);
        }
        let hand_over = large.and_then(|(_, _, hand_over)| hand_over);
        if let ([small, large], Some(hand_over)) = (rounded.as_slice(), hand_over) {
            let (small, large) = ((&small.0, &small.1), (&large.0, &large.1));
            for_each_hand_over_condition(large, small, hand_over, emit);
        }
    });
    report.verdict == Verdict::Proved
}
