//! Saturation of a command, entry by entry.

use proptest::prelude::*;
use runtime::error::{Field, ParameterError};
use runtime::nalgebra::Vector3;
use runtime::saturation::Saturation;

fn limits() -> Saturation<3> {
    Saturation::new(Vector3::new(2.0, 1.0, 0.5)).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn torque_is_the_saturated_part_plus_the_dead_zone(u in [-5.0..5.0f64, -5.0..5.0f64, -5.0..5.0f64]) {
        let (torque, saturation) = (Vector3::from(u), limits());
        let (kept, cut) = (saturation.saturate(&torque), saturation.dead_zone(&torque));
        prop_assert!((kept + cut - torque).norm() < 1e-15);
        for axis in 0..3 {
            prop_assert!(kept[axis].abs() <= saturation.limit()[axis]);
            prop_assert!(cut[axis] == 0.0 || kept[axis].abs() == saturation.limit()[axis]);
        }
    }

    #[test]
    fn saturating_twice_changes_nothing(u in [-5.0..5.0f64, -5.0..5.0f64, -5.0..5.0f64]) {
        let once = limits().saturate(&Vector3::from(u));
        prop_assert_eq!(limits().saturate(&once), once);
    }
}

#[test]
fn the_dead_zone_is_what_exceeds_the_limit_with_its_sign() {
    let torque = Vector3::new(2.5, -1.25, 0.5);
    assert_eq!(limits().saturate(&torque), Vector3::new(2.0, -1.0, 0.5));
    assert_eq!(limits().dead_zone(&torque), Vector3::new(0.5, -0.25, 0.0));
}

#[test]
fn infinite_torque_saturates() {
    let torque = Vector3::new(f64::INFINITY, f64::NEG_INFINITY, 0.0);
    assert_eq!(limits().saturate(&torque), Vector3::new(2.0, -1.0, 0.0));
}

#[test]
fn a_limit_that_is_zero_negative_or_not_finite_is_refused() {
    for bad in [0.0, -1.0] {
        let error = Saturation::new(Vector3::new(1.0, bad, 1.0)).unwrap_err();
        let ParameterError::OutOfRange { field, value, .. } = error else {
            panic!("{error}");
        };
        assert_eq!((field, value), (Field::component("torque_limit", 1), bad));
        assert_eq!(
            error.to_string(),
            format!("torque_limit[1] is {bad}, allowed is (0, inf)")
        );
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let error = Saturation::new(Vector3::new(1.0, 1.0, bad)).unwrap_err();
        assert!(matches!(error, ParameterError::NotFinite { .. }));
    }
}
