//! The designs that other tests share are checked in: proved again here, and what synthesis makes today.

use std::path::Path;

use serde_json::Value;

use crate::support::*;

/// A checked-in design, its model, and more arguments of `synthesize`.
const FIXTURES: [(&str, &str, &[&str]); 2] = [
    ("xu2020-design.json", "xu2020.json", &[]),
    (
        "double-integrator-design.json",
        "double-integrator.json",
        &[],
    ),
];

#[test]
fn every_shared_design_is_proved_again() {
    for (design, _, _) in FIXTURES {
        let report = steadfast([Path::new("verify"), &fixture(design), Path::new("--json")]);
        assert_eq!(report.ends_with(0).json()["verdict"], "proved", "{design}");
    }
}

/// Numbers of two documents, place by place, with the largest relative difference.
fn largest_difference(left: &Value, right: &Value) -> f64 {
    match (left, right) {
        (Value::Array(left), Value::Array(right)) if left.len() == right.len() => {
            let pairs = left.iter().zip(right);
            pairs
                .map(|(l, r)| largest_difference(l, r))
                .fold(0.0, f64::max)
        }
        (Value::Object(left), Value::Object(right)) if left.len() == right.len() => {
            let pairs = left.iter().map(|(key, value)| (value, &right[key]));
            pairs
                .map(|(l, r)| largest_difference(l, r))
                .fold(0.0, f64::max)
        }
        (Value::Number(left), Value::Number(right)) => {
            let (left, right) = (left.as_f64().unwrap(), right.as_f64().unwrap());
            (left - right).abs() / left.abs().max(right.abs()).max(1e-9)
        }
        _ if left == right => 0.0,
        _ => f64::INFINITY,
    }
}

/// With STEADFAST_REGENERATE the files are written anew.
#[test]
fn every_shared_design_is_what_synthesis_makes() {
    for (design, model, more) in FIXTURES {
        let folder = folder();
        let path = folder.path().join(design);
        let output = command()
            .arg("synthesize")
            .arg(shipped(model))
            .args(more)
            .arg("-o")
            .arg(&path)
            .output();
        Run::new(output.expect("the command runs")).ends_with(0);
        if std::env::var_os("STEADFAST_REGENERATE").is_some() {
            std::fs::copy(&path, fixture(design)).expect("a copy");
        }
        let (kept, made) = (json(&fixture(design)), json(&path));
        for part in [
            "schema_version",
            "name",
            "model",
            "controller",
            "certificate",
        ] {
            // Another processor may round the solver's sums differently; gamma is then the same to 1e-8 and the gains
            // to the solver's tolerance.
            let difference = largest_difference(&kept[part], &made[part]);
            assert!(
                difference < 1e-3,
                "{design}: {part} differs by {difference:e}"
            );
        }
        assert_relative(
            number(&made, "/certificate/gamma"),
            number(&kept, "/certificate/gamma"),
            1e-6,
        );
    }
}
