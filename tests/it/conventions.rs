//! The conventions of the book are those of the simulator: quaternion, order of the error, signs of an inertia.

use std::path::Path;

use crate::support::*;
use serde_json::{json, Value};
use steadfast::base::table::Table;

/// A spacecraft that nothing acts on, at rest unless it is told otherwise.
fn free_body() -> Value {
    json!({
        "schema_version": 1,
        "name": "free",
        "duration_s": 0.5,
        "system": { "rigid_body": {
            "inertia_kg_m2": [[140, -20, 0], [-20, 110, 0], [0, 0, 150]],
            "initial_attitude": { "quaternion_scalar_first": [1, 0, 0, 0] },
            "initial_rate_rad_s": [0, 0, 0]
        } },
        "sampling": { "instants": { "periodic": { "interval_s": 0.001 } } },
        "integrator": { "dormand_prince853": { "tolerance": 1e-13 } },
        "controller": { "wu2018": {
            "gains": { "direct": { "error_gain_nm_s_rad": 1e-20, "attitude_weight_rad_s": 1e-20 } },
            "trigger": { "every_sample": {} },
            "torque_limit_nm": [1e-20, 1e-20, 1e-20]
        } }
    })
}

fn trajectory(scenario: &Value) -> Table {
    let folder = folder();
    let path = write(folder.path(), "scenario.json", scenario.to_string());
    let out = folder.path().join("run");
    let run = steadfast([Path::new("simulate"), &path, Path::new("-o"), &out]);
    assert!(matches!(run.status, Some(0 | 2)), "{run:#?}");
    Table::from_csv(&text(&out.join("trajectory.csv"))).expect("a table")
}

fn row(table: &Table, names: [&str; 4], index: usize) -> [f64; 4] {
    names.map(|name| table.column(name).expect("a column")[index])
}

const ERROR: [&str; 4] = ["error_q0_scalar", "error_q1", "error_q2", "error_q3"];

/// The worked example: a target 90 deg about axis 3, and a body 10 deg further about its own axis 1.
#[test]
fn the_error_is_the_conjugate_of_the_desired_times_the_actual_attitude() {
    let mut scenario = free_body();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let desired = json!({ "quaternion_scalar_first": [half, 0, 0, half] });
    let actual = json!({ "quaternion_scalar_last": [0.0616, 0.0616, 0.7044, 0.7044] });
    set(
        &mut scenario,
        "/system/rigid_body/reference",
        json!({ "constant": desired }),
    );
    set(&mut scenario, "/system/rigid_body/initial_attitude", actual);
    let found = row(&trajectory(&scenario), ERROR, 0);
    let (sine, cosine) = 5_f64.to_radians().sin_cos();
    for (found, expected) in found.into_iter().zip([cosine, sine, 0.0, 0.0]) {
        assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    }
}

/// About a principal axis the rate stays: the body turns by its angle, right-handed.
#[test]
fn a_positive_rate_turns_the_body_right_handed() {
    let mut scenario = free_body();
    set(
        &mut scenario,
        "/system/rigid_body/initial_rate_rad_s",
        json!([0, 0, 0.8]),
    );
    let table = trajectory(&scenario);
    let found = row(&table, ERROR, table.rows() - 1);
    let (sine, cosine) = 0.2_f64.sin_cos();
    for (found, expected) in found.into_iter().zip([cosine, 0.0, 0.0, sine]) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

/// J dw = -w x J w with the two masses of the book, whose product of inertia P_xy is +20 kg m^2, entered as -20.
#[test]
fn off_diagonal_entries_are_those_of_the_matrix() {
    let mut scenario = free_body();
    let rate = [0.3, 0.1, 0.2];
    set(
        &mut scenario,
        "/system/rigid_body/initial_rate_rad_s",
        json!(rate),
    );
    set(&mut scenario, "/duration_s", json!(0.002));
    let table = trajectory(&scenario);
    // H = J w = (40, 5, 30); w x H = (2, -1, -2.5); J^-1 of its opposite.
    let moment = [
        0.1 * 30.0 - 0.2 * 5.0,
        0.2 * 40.0 - 0.3 * 30.0,
        0.3 * 5.0 - 0.1 * 40.0,
    ];
    let determinant = 140.0 * 110.0 - 400.0;
    let slope = [
        -(110.0 * moment[0] + 20.0 * moment[1]) / determinant,
        -(20.0 * moment[0] + 140.0 * moment[1]) / determinant,
        -moment[2] / 150.0,
    ];
    let times = table.column("time_s").expect("a column");
    for (axis, slope) in (1..=3).zip(slope) {
        let rates = table.column(&format!("rate_{axis}_rad_s"));
        let rates = rates.expect("a column");
        let last = rates.len() - 1;
        let found = (rates[last] - rates[0]) / (times[last] - times[0]);
        let error = (found - slope).abs();
        assert!(error < 1e-4 * slope.abs().max(1e-3), "{found} {slope}");
    }
}
