//! The event trigger and its adaptive threshold.

use approx::assert_relative_eq;
use proptest::prelude::*;
use runtime::error::{AllowedRange, Field, ParameterError};
use runtime::nalgebra::{Matrix2, Matrix4, Vector2};
use runtime::trigger::{Adaptation, AperiodicTrigger, ThresholdUpdate};

/// Constants of Xu and Huang 2020, section 4.
const PUBLISHED: Adaptation = Adaptation {
    amplitude: 10.0,
    slope: 1.0,
    dead_band: 0.02,
};

fn weight() -> Matrix2<f64> {
    Matrix2::new(2.0, 0.5, 0.5, 1.0)
}

fn trigger(update: ThresholdUpdate) -> AperiodicTrigger<2> {
    AperiodicTrigger::new(weight(), update).unwrap()
}

fn clamped(minimum: f64, maximum: f64) -> ThresholdUpdate {
    ThresholdUpdate::Clamped {
        adaptation: PUBLISHED,
        minimum,
        maximum,
    }
}

fn as_published() -> ThresholdUpdate {
    ThresholdUpdate::UnclampedAsPublished {
        adaptation: PUBLISHED,
        minimum: 0.2,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_clamped_threshold_stays_within_its_bounds(
        states in prop::collection::vec([-2.0..2.0f64, -2.0..2.0f64], 1..60),
        scale in prop::sample::select(vec![1e-6, 1e-2, 1.0, 1e6]),
    ) {
        let mut trigger = trigger(clamped(0.05, 0.3));
        for state in states {
            trigger.record_sent(&(Vector2::from(state) * scale));
            prop_assert!((0.05..=0.3).contains(&trigger.threshold()));
        }
    }

    #[test]
    fn the_unclamped_threshold_is_never_below_its_minimum(
        states in prop::collection::vec([-2.0..2.0f64, -2.0..2.0f64], 1..60),
    ) {
        let mut trigger = trigger(as_published());
        for state in states {
            trigger.record_sent(&Vector2::from(state));
            prop_assert!(trigger.threshold() >= 0.2);
        }
    }

    #[test]
    fn the_trigger_compares_the_two_quadratic_forms(
        sent in [-2.0..2.0f64, -2.0..2.0f64],
        now in [-2.0..2.0f64, -2.0..2.0f64],
        threshold in 0.0..1.0f64,
    ) {
        let mut trigger = trigger(ThresholdUpdate::Fixed { threshold });
        let form = |x: f64, y: f64| 2.0 * x * x + x * y + y * y;
        let error = form(now[0] - sent[0], now[1] - sent[1]);
        let reference = threshold * form(sent[0], sent[1]);
        prop_assume!((error - reference).abs() > 1e-12);
        trigger.record_sent(&Vector2::from(sent));
        prop_assert_eq!(trigger.fires(&Vector2::from(now)), Some(error >= reference));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_weight_is_accepted_exactly_when_every_pivot_is_positive(
        below in prop::array::uniform6(-2.0..2.0f64),
        pivots in prop::array::uniform4(prop_oneof![4 => 0.5..2.0f64, 1 => -2.0..-0.5f64]),
    ) {
        let [a, b, c, d, e, f] = below;
        let lower = Matrix4::new(
            1.0, 0.0, 0.0, 0.0, //
            a, 1.0, 0.0, 0.0, //
            b, c, 1.0, 0.0, //
            d, e, f, 1.0,
        );
        let weight = lower * Matrix4::from_diagonal(&pivots.into()) * lower.transpose();
        let outcome = AperiodicTrigger::new(weight, ThresholdUpdate::Fixed { threshold: 0.1 });
        match pivots.iter().position(|pivot| *pivot < 0.0) {
            None => prop_assert!(outcome.is_ok()),
            Some(first) => {
                let Err(ParameterError::NotPositiveDefinite { field, pivot }) = outcome else {
                    panic!("{outcome:?}");
                };
                prop_assert_eq!(field, Field::entry("trigger_weight", first, first));
                prop_assert!((pivot - pivots[first]).abs() < 1e-10);
            }
        }
    }
}

#[test]
fn the_first_sample_is_always_sent() {
    let trigger = trigger(ThresholdUpdate::Fixed { threshold: 0.9 });
    assert_eq!(trigger.fires(&Vector2::new(0.3, 0.0)), Some(true));
    assert_eq!(trigger.fires(&Vector2::zeros()), Some(true));
    assert!(trigger.sent().is_none());
}

#[test]
fn equality_fires() {
    let mut trigger = AperiodicTrigger::new(
        Matrix2::identity(),
        ThresholdUpdate::Fixed { threshold: 0.25 },
    )
    .unwrap();
    trigger.record_sent(&Vector2::new(2.0, 0.0));
    assert_eq!(trigger.fires(&Vector2::new(3.0, 0.0)), Some(true));
    assert_eq!(trigger.fires(&Vector2::new(2.999, 0.0)), Some(false));
}

#[test]
fn at_threshold_zero_every_sample_is_sent() {
    let mut trigger = trigger(ThresholdUpdate::Fixed { threshold: 0.0 });
    let state = Vector2::new(0.1, 0.2);
    trigger.record_sent(&state);
    assert_eq!(trigger.fires(&state), Some(true));
}

#[test]
fn near_rest_the_published_update_grows_by_an_eighth_at_every_trigger() {
    let mut trigger = trigger(as_published());
    trigger.record_sent(&Vector2::zeros());
    assert_eq!(trigger.threshold(), 0.2);
    let mut previous = trigger.threshold();
    for _ in 0..40 {
        trigger.record_sent(&Vector2::zeros());
        // 1 + (20 / pi) atan(0.02), with atan(0.02) = 0.02 - 0.02^3 / 3.
        assert_relative_eq!(trigger.threshold() / previous, 1.1273, epsilon = 5e-5);
        previous = trigger.threshold();
    }
    assert!(previous > 1.0, "threshold {previous}");
}

#[test]
fn a_step_longer_than_the_dead_band_lowers_the_threshold() {
    let update = clamped(0.0, 0.9);
    let expected = 0.5 * (1.0 - 20.0 / std::f64::consts::PI * 0.03_f64.atan());
    assert_relative_eq!(update.next(0.5, 0.05), expected, max_relative = 1e-14);
    assert_eq!(clamped(0.1, 0.9).next(0.5, 1e3), 0.1);
    assert_relative_eq!(update.next(0.5, 0.02), 0.5, max_relative = 1e-15);
}

#[test]
fn the_unclamped_threshold_ends_at_the_largest_number_and_the_trigger_still_answers() {
    let mut trigger = trigger(as_published());
    for _ in 0..7000 {
        trigger.record_sent(&Vector2::zeros());
    }
    assert_eq!(trigger.threshold(), f64::MAX);
    assert_eq!(trigger.fires(&Vector2::new(1.0, 0.0)), Some(true));
    trigger.record_sent(&Vector2::new(1e-3, 0.0));
    assert_eq!(trigger.fires(&Vector2::new(1.0, 0.0)), Some(false));
}

#[test]
fn only_bounded_updates_have_a_maximum_a_certificate_can_cover() {
    assert_eq!(clamped(0.05, 0.3).certifiable_maximum(), Some(0.3));
    let fixed = ThresholdUpdate::Fixed { threshold: 0.1 };
    assert_eq!(fixed.certifiable_maximum(), Some(0.1));
    assert_eq!(as_published().certifiable_maximum(), None);
}

#[test]
fn states_that_are_not_finite_or_too_large_have_no_answer_and_are_not_recorded() {
    let mut trigger = trigger(clamped(0.05, 0.3));
    let bad = [f64::NAN, f64::INFINITY, 1e200].map(|value| Vector2::new(0.1, value));
    for state in &bad {
        assert_eq!(trigger.fires(state), None);
        trigger.record_sent(state);
        assert!(trigger.sent().is_none());
    }
    let good = Vector2::new(0.1, 0.2);
    trigger.record_sent(&good);
    let before = trigger;
    for state in &bad {
        assert_eq!(trigger.fires(state), None);
        trigger.record_sent(state);
        assert_eq!(trigger, before);
    }
    assert_eq!(trigger.fires(&(good * 3.0)), Some(true));
}

#[test]
fn reset_goes_back_to_the_first_sample() {
    let mut trigger = trigger(as_published());
    let fresh = trigger;
    for _ in 0..5 {
        trigger.record_sent(&Vector2::zeros());
    }
    assert_ne!(trigger, fresh);
    trigger.reset();
    assert_eq!(trigger, fresh);
}

#[test]
fn a_weight_that_is_not_symmetric_is_refused_with_both_entries() {
    let skewed = Matrix2::new(2.0, 0.5, 0.4, 1.0);
    let update = ThresholdUpdate::Fixed { threshold: 0.1 };
    let error = AperiodicTrigger::new(skewed, update).unwrap_err();
    assert_eq!(
        error,
        ParameterError::NotSymmetric {
            field: Field::entry("trigger_weight", 0, 1),
            value: 0.5,
            mirrored: 0.4,
        }
    );
}

#[test]
fn an_indefinite_weight_is_refused_with_the_pivot() {
    let update = ThresholdUpdate::Fixed { threshold: 0.1 };
    let error = AperiodicTrigger::new(Matrix2::new(1.0, 2.0, 2.0, 1.0), update).unwrap_err();
    assert_eq!(
        error,
        ParameterError::NotPositiveDefinite {
            field: Field::entry("trigger_weight", 1, 1),
            pivot: -3.0,
        }
    );
    assert!(AperiodicTrigger::new(Matrix2::zeros(), update).is_err());
    let not_a_number = Matrix2::new(1.0, 0.0, f64::NAN, 1.0);
    let error = AperiodicTrigger::new(not_a_number, update).unwrap_err();
    assert_eq!(
        error.to_string(),
        "trigger_weight[1][0] is NaN, not a finite number"
    );
}

#[test]
fn thresholds_outside_of_zero_to_one_are_refused() {
    for threshold in [-0.1, 1.0, f64::NAN] {
        let update = ThresholdUpdate::Fixed { threshold };
        assert!(AperiodicTrigger::new(weight(), update).is_err());
        assert!(AperiodicTrigger::new(weight(), clamped(0.1, threshold)).is_err());
    }
    let error = AperiodicTrigger::new(weight(), clamped(0.1, 1.5)).unwrap_err();
    assert_eq!(
        error,
        ParameterError::OutOfRange {
            field: Field::scalar("maximum"),
            value: 1.5,
            allowed: AllowedRange::half_open(0.0, 1.0),
        }
    );
}

#[test]
fn a_minimum_above_the_maximum_is_refused_and_equality_is_not() {
    let error = AperiodicTrigger::new(weight(), clamped(0.3, 0.2)).unwrap_err();
    assert!(matches!(error, ParameterError::EmptyInterval { .. }));
    assert!(AperiodicTrigger::new(weight(), clamped(0.2, 0.2)).is_ok());
}

#[test]
fn negative_adaptation_constants_are_refused_by_name() {
    let cases = [
        (
            "amplitude",
            Adaptation {
                amplitude: -1.0,
                ..PUBLISHED
            },
        ),
        (
            "slope",
            Adaptation {
                slope: -1.0,
                ..PUBLISHED
            },
        ),
        (
            "dead_band",
            Adaptation {
                dead_band: -1.0,
                ..PUBLISHED
            },
        ),
    ];
    for (name, adaptation) in cases {
        for update in [
            ThresholdUpdate::Clamped {
                adaptation,
                minimum: 0.1,
                maximum: 0.2,
            },
            ThresholdUpdate::UnclampedAsPublished {
                adaptation,
                minimum: 0.1,
            },
        ] {
            let error = AperiodicTrigger::new(weight(), update).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!("{name} is -1, allowed is [0, inf)")
            );
        }
    }
}

#[test]
fn a_floor_is_added_to_the_relative_threshold() {
    let fixed = ThresholdUpdate::Fixed { threshold: 0.25 };
    let mut trigger = trigger(fixed).with_floor(0.5).unwrap();
    assert_eq!(trigger.floor(), 0.5);
    // The first sample is sent whatever the floor is.
    assert_eq!(trigger.fires(&Vector2::zeros()), Some(true));
    trigger.record_sent(&Vector2::new(2.0, 0.0));
    // 0.25 * 8 + 0.5 = 2.5, and e'We is 2 d^2 for e = (d, 0).
    assert_eq!(trigger.fires(&Vector2::new(3.0, 0.0)), Some(false));
    assert_eq!(trigger.fires(&Vector2::new(3.125, 0.0)), Some(true));
    trigger.record_sent(&Vector2::zeros());
    assert_eq!(trigger.fires(&Vector2::new(0.5, 0.0)), Some(true));
    assert_eq!(trigger.fires(&Vector2::new(0.4, 0.0)), Some(false));
}

#[test]
fn a_floor_that_is_negative_or_not_finite_is_refused() {
    let fixed = ThresholdUpdate::Fixed { threshold: 0.25 };
    for (floor, message) in [
        (-1.0, "trigger_floor is -1, allowed is [0, inf)"),
        (f64::NAN, "trigger_floor is NaN, not a finite number"),
    ] {
        let error = trigger(fixed).with_floor(floor).unwrap_err();
        assert_eq!(error.to_string(), message);
    }
}
