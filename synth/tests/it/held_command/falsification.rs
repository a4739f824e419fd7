//! Many runs of the nonlinear plant from the boundary of the certified set break no bound, and do where the loop is not
//! the one that was proved.

use super::loop_with_command::{fly, Differs, Disturbance, Usage, AS_PROVED};
use super::{pd, proof_of, wu};
use crate::exact::Stream;
use nalgebra::{Vector3, Vector6};
use serde_json::Value;
use synth::held_command::CommandProof;

/// Starts on the boundary x'Ux = 1: in any direction, at rest, and along U^-1 F_s'.
fn starts(proof: &CommandProof, count: usize) -> Vec<Vector6<f64>> {
    let lyapunov = &proof.certificate.lyapunov;
    let inverse = lyapunov.clone().try_inverse().expect("U > 0");
    let factor = inverse.clone().cholesky().expect("U > 0").l();
    let mut stream = Stream(7);
    let mut unit = |size: usize| {
        let draw = nalgebra::DVector::from_fn(size, |_, _| stream.signed_unit());
        draw.clone() / draw.norm()
    };
    let direction = |index: usize| match index % 3 {
        0 => &factor * unit(6),
        1 => {
            let attitude = unit(3);
            nalgebra::DVector::from_fn(6, |k, _| if k < 3 { 0.0 } else { attitude[k - 3] })
        }
        _ => {
            let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
            let row = proof.law.gain.row(index / 3 % 3).transpose();
            &inverse * row * sign
        }
    };
    let directions: Vec<_> = (0..count).map(direction).collect();
    let on_boundary = |direction: &nalgebra::DVector<f64>| {
        let level = direction.dot(&(lyapunov * direction));
        Vector6::from_column_slice((direction * ((1.0 - 1e-9) / level).sqrt()).as_slice())
    };
    directions.iter().map(on_boundary).collect()
}

fn disturbances(bandwidth: f64) -> [Disturbance; 4] {
    let axis = Vector3::new(1.0, -1.0, 1.0).normalize();
    [
        Disturbance::Worst,
        Disturbance::Constant(axis),
        Disturbance::Constant(Vector3::z()),
        Disturbance::Sine(axis, bandwidth),
    ]
}

fn worst(
    design: &Value,
    differs: &Differs,
    bandwidth: f64,
    (count, duration_s): (usize, f64),
) -> Usage {
    let proof = proof_of(design);
    let mut out = Usage::default();
    for start in starts(&proof, count) {
        for disturbance in disturbances(bandwidth) {
            out = out.with(fly(&proof, &start, disturbance, differs, duration_s));
        }
    }
    out
}

#[test]
fn wu_2018_flown_from_the_boundary_breaks_no_bound() {
    let usage = worst(wu(), &AS_PROVED, 0.08, (48, 450.0));
    println!("{usage:?}");
    assert!(usage.largest() <= 1.0, "{usage:?}");
    assert!(usage.saturated > 100 && usage.pointing > 0.1, "{usage:?}");
}

#[test]
fn the_pd_law_flown_from_the_boundary_breaks_no_bound() {
    let usage = worst(pd(), &AS_PROVED, 0.1, (48, 400.0));
    println!("{usage:?}");
    assert!(usage.largest() <= 1.0, "{usage:?}");
    assert!(usage.saturated > 100 && usage.pointing > 0.1, "{usage:?}");
}

#[test]
fn another_limit_disturbance_or_trigger_than_the_proved_one_breaks_a_bound() {
    let weaker = Differs {
        limit: 1.0 / 3.0,
        ..AS_PROVED
    };
    let rougher = Differs {
        disturbance: 3.0,
        ..AS_PROVED
    };
    let lazier = Differs {
        relative: Some(2.0),
        ..AS_PROVED
    };
    for differs in [weaker, rougher, lazier] {
        let usage = worst(wu(), &differs, 0.08, (12, 400.0));
        println!("{differs:?}: {usage:?}");
        assert!(usage.largest() > 1.0, "{differs:?}: {usage:?}");
    }
}
