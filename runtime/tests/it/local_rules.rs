//! Memberships of local rules.

use nalgebra::Vector2;
use runtime::error::ParameterError;
use runtime::local_rules::{normalise, FuzzySet, LocalRules};
use runtime::membership::Membership;

const LEFT: FuzzySet = FuzzySet::Triangular {
    left: -3.0,
    peak: -1.0,
    right: 1.0,
};
const RIGHT: FuzzySet = FuzzySet::Triangular {
    left: -1.0,
    peak: 1.0,
    right: 3.0,
};

fn gaussian(centre: f64) -> FuzzySet {
    FuzzySet::Gaussian { centre, width: 0.5 }
}

fn two() -> LocalRules<2, 2> {
    let bounds = Vector2::new(1.0, 2.0);
    LocalRules::new([[LEFT, FuzzySet::Any], [RIGHT, FuzzySet::Any]], bounds).unwrap()
}

#[test]
fn two_triangles_interpolate_linearly() {
    for (place, right) in [(-1.0, 0.0), (-0.5, 0.25), (0.0, 0.5), (1.0, 1.0)] {
        let weights = two().weights(&Vector2::new(place, 0.3));
        assert!((weights[1] - right).abs() < 1e-15, "{weights:?}");
        assert!((weights[0] + weights[1] - 1.0).abs() < 1e-15);
    }
}

#[test]
fn outside_of_the_box_the_nearest_point_counts() {
    let inside = two().weights(&Vector2::new(1.0, 2.0));
    assert_eq!(two().weights(&Vector2::new(50.0, -9.0)), inside);
    assert!(!two().contains(&Vector2::new(1.1, 0.0)));
    assert!(!two().contains(&Vector2::new(0.0, f64::NAN)));
    assert!(two().contains(&Vector2::new(-1.0, 2.0)));
}

#[test]
fn a_trapezoid_is_one_on_its_top_and_zero_from_its_feet_on() {
    let set = FuzzySet::Trapezoidal {
        left: 0.0,
        left_top: 1.0,
        right_top: 2.0,
        right: 4.0,
    };
    let cases = [
        (0.0, 0.0),
        (0.5, 0.5),
        (1.0, 1.0),
        (2.0, 1.0),
        (3.0, 0.5),
        (4.0, 0.0),
    ];
    for (value, grade) in cases {
        assert_eq!(set.grade(value), (grade, 0.0), "at {value}");
    }
    let step = FuzzySet::Triangular {
        left: 0.0,
        peak: 0.0,
        right: 1.0,
    };
    assert_eq!((step.grade(-1e-9).0, step.grade(0.0).0), (0.0, 1.0));
}

#[test]
fn far_from_every_bell_the_weights_stay_defined() {
    let sets = [
        [gaussian(0.0), gaussian(0.0)],
        [gaussian(1.0), gaussian(0.0)],
    ];
    let rules = LocalRules::new(sets, Vector2::repeat(f64::INFINITY)).unwrap();
    let weights = rules.weights(&Vector2::new(1e3, 1e3));
    assert_eq!(weights, [0.0, 1.0]);
    let middle = rules.weights(&Vector2::new(0.5, 7.0));
    assert!((middle[0] - 0.5).abs() < 1e-12, "{middle:?}");
}

#[test]
fn a_rule_that_is_never_used_changes_nothing() {
    let sets = [[gaussian(0.0); 2], [gaussian(1.0); 2], [FuzzySet::Never; 2]];
    let padded = LocalRules::new(sets, Vector2::repeat(1.0)).unwrap();
    let plain = LocalRules::new([sets[0], sets[1]], Vector2::repeat(1.0)).unwrap();
    let state = Vector2::new(0.3, -0.2);
    let (padded, plain) = (padded.weights(&state), plain.weights(&state));
    assert_eq!((padded[0], padded[1], padded[2]), (plain[0], plain[1], 0.0));
}

#[test]
fn without_any_rule_the_weights_are_equal_and_it_is_said() {
    let mut weights = [0.0, 0.0];
    assert!(!normalise(&mut weights, &[0.0, 0.0]));
    assert_eq!(weights, [0.5, 0.5]);
}

#[test]
fn sets_out_of_order_and_bounds_that_are_not_positive_are_refused() {
    let wrong = FuzzySet::Triangular {
        left: 1.0,
        peak: 0.0,
        right: 2.0,
    };
    let refused = LocalRules::<2, 1>::new([[FuzzySet::Any, wrong]], Vector2::repeat(1.0));
    assert!(
        matches!(refused, Err(ParameterError::EmptyInterval { .. })),
        "{refused:?}"
    );
    let narrow = FuzzySet::Gaussian {
        centre: 0.0,
        width: 0.0,
    };
    let refused = LocalRules::<2, 1>::new([[narrow; 2]], Vector2::repeat(1.0));
    assert!(
        matches!(refused, Err(ParameterError::OutOfRange { .. })),
        "{refused:?}"
    );
    let refused = LocalRules::<2, 1>::new([[FuzzySet::Any; 2]], Vector2::new(1.0, 0.0));
    assert!(refused.is_err());
}
