//! What the set of certified starts contains, as numbers that are proved: rounded down in verified arithmetic.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use verified::interval::{half_angle_sine_squared, Interval};

/// A start and how far the certified set goes along it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Along {
    /// A scale s: every state from the origin to s times the start is in the set.
    pub scale: f64,
    /// The angle at that scale, where the start is an attitude at rest (deg).
    pub angle_deg: Option<f64>,
}

/// Digits of an angle in degrees.
const ANGLE_UNIT_DEG: f64 = 1e-6;

/// How far x'Ux <= start goes along a state, the set of certified starts; 0 where nothing is proved. `spacecraft`: the last three of six states
/// are the vector part of a quaternion and the first three a rate.
pub fn along(lyapunov: &DMatrix<f64>, start: f64, state: &DVector<f64>, spacecraft: bool) -> Along {
    let exactly = |value: f64| Interval::from(value);
    let mut form = Interval::from(0.0);
    for r in 0..state.len() {
        for c in 0..state.len() {
            form += exactly(state[r]) * exactly(lyapunov[(r, c)]) * exactly(state[c]);
        }
    }
    let inverse = Interval::from(start.max(0.0)) / form;
    let squared = if form.lo() > 0.0 { inverse.lo() } else { 0.0 };
    let at_rest =
        spacecraft && state.len() == 6 && state.rows(0, 3).iter().all(|&rate| rate == 0.0);
    let sizes = state.iter().map(|&entry| exactly(entry).sqr());
    let length = sizes.fold(Interval::from(0.0), |sum, square| sum + square);
    let scale = Interval::new(squared, squared).sqrt().lo().max(0.0);
    Along {
        scale: if scale.is_finite() { scale } else { 0.0 },
        angle_deg: at_rest.then(|| angle_below((exactly(squared) * length).lo())),
    }
}

/// A time after which V <= `level` where V' <= -phi V + r and V(0) <= 1, with r / phi at most `reached`; `None` where the
/// level is not above it, and where no time is proved.
pub fn fall_time(phi: f64, reached: f64, level: f64) -> Option<f64> {
    let fall = ((1.0 - reached) / (level - reached)).ln().max(0.0) / phi;
    let time = fall * (1.0 + TIME_ALLOWANCE);
    let decay = (-(Interval::from(phi) * Interval::from(time))).exp();
    let bound = decay * (Interval::from(1.0) - Interval::from(reached)) + Interval::from(reached);
    let falls = level > reached && time.is_finite() && (level >= 1.0 || bound.hi() <= level);
    falls.then_some(time)
}

/// How far a time lies above the estimate that it comes from, relative.
const TIME_ALLOWANCE: f64 = 1e-9;

/// The angle of the rotations whose quaternions have a vector part up to this norm, rounded down (deg).
pub fn angle_of_vector_part_deg(norm: f64) -> f64 {
    angle_below(Interval::from(norm.max(0.0)).sqr().lo())
}

/// The angle of the rotations whose quaternions have a vector part up to this norm, rounded up (deg).
pub fn angle_above_vector_part_deg(norm: f64) -> f64 {
    let square = Interval::from(norm.max(0.0)).sqr().hi();
    if square.is_nan() || square >= 1.0 {
        return 180.0;
    }
    let steps = ((2.0 * square.sqrt().asin()).to_degrees() / ANGLE_UNIT_DEG).ceil();
    for ahead in 0..4 {
        let angle = (steps + f64::from(ahead)) * ANGLE_UNIT_DEG;
        let radians = Interval::from(angle) * Interval::PI / Interval::from(180.0);
        if half_angle_sine_squared(radians).lo() >= square {
            return angle;
        }
    }
    180.0
}

/// The largest multiple of the unit whose half-angle sine, squared, is proved to be at most `square`.
fn angle_below(square: f64) -> f64 {
    if square.is_nan() || square <= 0.0 {
        return 0.0;
    }
    if square >= 1.0 {
        return 180.0;
    }
    let estimate = (2.0 * square.sqrt().asin()).to_degrees();
    let steps = (estimate / ANGLE_UNIT_DEG).floor();
    for back in 0..4 {
        let angle = (steps - f64::from(back)) * ANGLE_UNIT_DEG;
        let radians = Interval::from(angle) * Interval::PI / Interval::from(180.0);
        if angle <= 0.0 || half_angle_sine_squared(radians).hi() <= square {
            return angle.max(0.0);
        }
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angles_of_a_vector_part_lie_on_their_side_of_the_true_one() {
        for degrees in [1e-3, 1.0, 8.0, 60.0, 83.2, 117.0, 179.9] {
            let norm = (0.5 * f64::to_radians(degrees)).sin();
            let angle = angle_of_vector_part_deg(norm);
            assert!(
                angle <= degrees + 1e-12 && angle > degrees - 3e-6,
                "{angle} of {degrees}"
            );
            let above = angle_above_vector_part_deg(norm);
            assert!(
                above >= degrees - 1e-12 && above < degrees + 3e-6,
                "{above} of {degrees}"
            );
        }
        assert_eq!(angle_of_vector_part_deg(0.0), 0.0);
        assert_eq!(angle_above_vector_part_deg(0.0), 0.0);
        assert_eq!(angle_above_vector_part_deg(1.0), 180.0);
    }

    #[test]
    fn the_angle_above_a_vector_part_is_never_below_the_true_one() {
        for degrees in [1e-3, 0.1435, 8.0, 117.0, 179.9] {
            let norm = (0.5 * f64::to_radians(degrees)).sin();
            let angle = angle_above_vector_part_deg(norm);
            assert!(
                angle >= degrees - 1e-12 && angle < degrees + 3e-6,
                "{angle} of {degrees}"
            );
        }
        assert_eq!(angle_above_vector_part_deg(2.0), 180.0);
    }

    #[test]
    fn a_state_on_the_edge_of_the_set_has_a_scale_just_below_one() {
        let lyapunov =
            DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 1.0, 1.0, 4.0, 4.0, 4.0]));
        let edge = DVector::from_vec(vec![0.0, 0.0, 0.0, 0.5, 0.0, 0.0]);
        let found = along(&lyapunov, 1.0, &edge, true);
        assert!(found.scale <= 1.0 && found.scale > 1.0 - 1e-12, "{found:?}");
        let angle = found.angle_deg.expect("an angle at rest");
        assert!(angle <= 60.0 && angle > 60.0 - 3e-6, "{angle}");
        let moving = DVector::from_vec(vec![0.1, 0.0, 0.0, 0.5, 0.0, 0.0]);
        assert_eq!(along(&lyapunov, 1.0, &moving, true).angle_deg, None);
    }

    #[test]
    fn nothing_is_claimed_along_a_direction_that_the_matrix_does_not_bound() {
        let lyapunov = DMatrix::from_element(1, 1, -1.0);
        let state = DVector::from_element(1, 1.0);
        assert_eq!(along(&lyapunov, 1.0, &state, false).scale, 0.0);
    }
}
