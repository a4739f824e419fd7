//! Numbers that are allowed and yet hardly meant: what `check` says of a file, and every verb before its work.

use nalgebra::Matrix3;
use serde_json::Value;
use synth::model::{Model, Objective, Plant, Specs};
use synth::requirements::Facts;

use super::answer::note;
use crate::base::number::short;
use crate::base::unit::unit_of_key;
use crate::batch::tune::file::Requirements;
use crate::plants::System;
use crate::scenario::Scenario;
use crate::sim::disturbance::Disturbance;

/// A body rate above this is given in degrees more often than not, rad/s.
const LARGEST_RATE: f64 = 1.0;
/// Principal moments of a spacecraft, kg m^2.
const MOMENTS: [f64; 2] = [1e-6, 1e9];
/// Largest ratio of two principal moments.
const LARGEST_RATIO: f64 = 100.0;
/// Largest angular acceleration that actuators give a spacecraft, rad/s^2.
const LARGEST_ACCELERATION: f64 = 10.0;
/// Relative distance from a fraction of pi at which an angle in degrees is taken for one in radians.
const PI_ROUNDING: f64 = 2e-4;

/// Prints the warnings on standard error.
pub fn warn(warnings: &[String]) {
    warnings
        .iter()
        .for_each(|text| note(&format!("warning: {text}")));
}

/// What is to be said of a model with this file.
pub fn of_model(model: &Model, text: &str) -> Vec<String> {
    let mut out = of_keys(text);
    out.extend(of_search(&model.file.specs));
    let Some(inertia) = model.plant.inertia() else {
        return out;
    };
    let plant = model.plant.takagi_sugeno();
    let limits: Vec<f64> = plant.input_limit.iter().copied().collect();
    out.extend(of_body(inertia, &limits));
    let key = match &model.plant {
        Plant::Spacecraft(_) => "plant.exact.disturbance_bound_nm",
        _ => "the bound of the disturbance",
    };
    out.extend(of_disturbance(key, plant.disturbance_bound, &limits));
    for (index, state) in model.file.specs.must_contain.iter().enumerate() {
        let vector = state
            .iter()
            .skip(3)
            .take(3)
            .map(|q| q * q)
            .sum::<f64>()
            .sqrt();
        if vector > 1.0 {
            out.push(format!(
                "specs.must_contain[{index}]: entries 4 to 6 are the vector part of a quaternion, sin(angle / 2) times \
                 an axis, of norm at most 1; their norm is {}",
                short(vector)
            ));
        }
    }
    out
}

/// What is to be said of facts with this file.
pub fn of_facts(facts: &Facts, text: &str) -> Vec<String> {
    let mut out = of_keys(text);
    let craft = facts.craft();
    let inertia = Matrix3::from_fn(|row, column| craft.inertia_kg_m2[row][column]);
    out.extend(of_body(&inertia, &craft.torque_limit_nm));
    out.extend(of_disturbance(
        "plant.exact.disturbance_bound_nm",
        craft.disturbance_bound_nm,
        &craft.torque_limit_nm,
    ));
    out
}

/// A search for the smallest gain that has nothing to contain.
fn of_search(specs: &Specs) -> Option<String> {
    let search = specs.search.as_ref()?;
    let smallest = specs.objective != Objective::Region;
    let free = specs.must_contain.is_empty() && search.certified_angle_min_deg.is_none();
    (smallest && free).then(|| {
        "specs.search: nothing must be contained, and the smallest gain belongs to a set of no use; specs.must_contain or \
         specs.search.certified_angle_min_deg asks for one"
            .to_string()
    })
}

/// What is to be said of a scenario with this file.
pub fn of_scenario(scenario: &Scenario, text: &str) -> Vec<String> {
    let mut out = of_keys(text);
    let System::RigidBody(system) = &scenario.system else {
        return out;
    };
    let own = scenario.controller.law().map(|law| law.torque_limit());
    let limits: Vec<f64> = (0..3)
        .map(|axis| {
            let law = own.as_ref().map_or(f64::INFINITY, |limit| limit[axis]);
            system.actuators.limit[axis].min(law)
        })
        .collect();
    out.extend(of_body(system.body.inertia(), &limits));
    let most = largest(&system.disturbance);
    out.extend(of_disturbance("the disturbance torque", most, &limits));
    out
}

/// What is to be said of requirements with this file.
pub fn of_requirements(requirements: &Requirements, text: &str) -> Vec<String> {
    let mut out = of_keys(text);
    let limits: Vec<f64> = requirements.torque_limit_nm.iter().copied().collect();
    out.extend(of_body(&requirements.inertia, &limits));
    out
}

/// A bound of the norm of a disturbance without its faults, N m.
fn largest(disturbance: &Disturbance<3>) -> f64 {
    let waves = disturbance.harmonics.iter();
    let waves: f64 = waves
        .map(|wave| wave.sine.norm().hypot(wave.cosine.norm()))
        .sum();
    let table = disturbance.table.iter().flat_map(|table| &table.values);
    let table = table.map(|value| value.norm()).fold(0.0, f64::max);
    disturbance.bias.norm() + waves + table
}

/// Principal moments and torques out of all proportion.
fn of_body(inertia: &Matrix3<f64>, limits_nm: &[f64]) -> Vec<String> {
    let moments = inertia.symmetric_eigenvalues();
    let (smallest, largest) = (moments.min(), moments.max());
    let mut out = Vec::new();
    if smallest < MOMENTS[0] || largest > MOMENTS[1] {
        out.push(format!(
            "the principal moments of inertia are {} to {} kg m^2; those of spacecraft are from {} to {} kg m^2: is the \
             unit kg m^2?",
            short(smallest),
            short(largest),
            short(MOMENTS[0]),
            short(MOMENTS[1])
        ));
    }
    if largest > LARGEST_RATIO * smallest {
        out.push(format!(
            "the principal moments of inertia are {} to {} kg m^2, a ratio of {}; above {LARGEST_RATIO} is unusual",
            short(smallest),
            short(largest),
            short(largest / smallest)
        ));
    }
    let limits = limits_nm.iter().copied().filter(|limit| limit.is_finite());
    let acceleration = limits.fold(0.0, f64::max) / smallest;
    if acceleration > LARGEST_ACCELERATION {
        out.push(format!(
            "the largest torque over the smallest principal moment of inertia is {} rad/s^2; above \
             {LARGEST_ACCELERATION} is unusual",
            short(acceleration)
        ));
    }
    out
}

/// A disturbance that the actuators cannot hold.
fn of_disturbance(name: &str, most_nm: f64, limits_nm: &[f64]) -> Option<String> {
    let least = limits_nm.iter().copied().fold(f64::INFINITY, f64::min);
    (most_nm > least).then(|| {
        format!(
            "{name} is up to {} N m, above the smallest torque limit, {} N m: no controller holds against it",
            short(most_nm),
            short(least)
        )
    })
}

/// Angles and rates whose numbers look like another unit than their key's.
fn of_keys(text: &str) -> Vec<String> {
    let mut out = Vec::new();
    if let Ok(file) = serde_json::from_str(text) {
        walk(&file, "", "", &mut out);
    }
    out
}

/// Visits every number with its path and the key that it stands under.
fn walk(value: &Value, path: &str, key: &str, out: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            for (name, inner) in fields {
                let path = if path.is_empty() {
                    name.clone()
                } else {
                    format!("{path}.{name}")
                };
                walk(inner, &path, name, out);
            }
        }
        Value::Array(entries) => {
            for (index, inner) in entries.iter().enumerate() {
                walk(inner, &format!("{path}[{index}]"), key, out);
            }
        }
        Value::Number(number) => {
            out.extend(
                number
                    .as_f64()
                    .and_then(|number| of_number(path, key, number)),
            );
        }
        _ => {}
    }
}

fn of_number(path: &str, key: &str, value: f64) -> Option<String> {
    let unit = unit_of_key(key);
    let rate = unit == "rad/s" && key.ends_with("rate_rad_s");
    if rate && value.abs() > LARGEST_RATE {
        return Some(format!(
            "{path}: {value} rad/s are {} deg/s; above {LARGEST_RATE} rad/s is unusual: is the number in deg/s?",
            short(value.to_degrees())
        ));
    }
    if unit == "rad" && value.abs() > std::f64::consts::TAU {
        return Some(format!(
            "{path}: {value} rad are {} deg, more than a turn: is the number in degrees?",
            short(value.to_degrees())
        ));
    }
    if unit == "deg" && value.abs() > 360.0 {
        return Some(format!("{path}: {value} deg are more than a turn"));
    }
    let twelfths = value * 12.0 / std::f64::consts::PI;
    let radians = twelfths.round() != 0.0
        && twelfths.abs() < 24.5
        && (twelfths - twelfths.round()).abs() < PI_ROUNDING * twelfths.abs();
    (unit == "deg" && radians).then(|| {
        format!(
            "{path}: {value} deg; as radians this would be {} deg: is the number in radians?",
            short(value.to_degrees())
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_another_unit_than_their_keys_are_named() {
        let file = r#"{"initial_rate_rad_s": [0.5, 5, 0], "angle_deg": 1.5708, "phase_rad": 90,
                       "settle_tolerance_deg": 0.1, "frequency_rad_s": 6, "rate_gain_nm_s_rad": 219.2, "euler_321_deg": [45, 400, 3]}"#;
        let mut found = of_keys(file);
        found.sort();
        assert_eq!(
            found,
            [
                "angle_deg: 1.5708 deg; as radians this would be 90 deg: is the number in radians?",
                "euler_321_deg[1]: 400 deg are more than a turn",
                "initial_rate_rad_s[1]: 5 rad/s are 286.48 deg/s; above 1 rad/s is unusual: is the number in deg/s?",
                "phase_rad: 90 rad are 5156.6 deg, more than a turn: is the number in degrees?",
            ]
        );
    }

    #[test]
    fn moments_and_torques_out_of_proportion_are_named_with_their_numbers() {
        let thin = Matrix3::from_diagonal(&[10.0, 10.0, 0.05].into());
        let found = of_body(&thin, &[1.0; 3]);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found[0].contains("a ratio of 200;"), "{found:?}");
        assert!(found[1].contains("is 20 rad/s^2"), "{found:?}");
        assert!(of_body(&Matrix3::identity(), &[f64::INFINITY; 3]).is_empty());
        let tiny = of_body(&(Matrix3::identity() * 1e-8), &[]);
        assert!(
            tiny[0].contains("1.0000e-8 to 1.0000e-8 kg m^2"),
            "{tiny:?}"
        );
    }

    #[test]
    fn a_search_for_the_smallest_gain_of_nothing_is_named() {
        let text = include_str!("../../models/xu2020-gain.json");
        let mut model = Model::from_json(text).expect("a model");
        assert_eq!(of_search(&model.file.specs), None);
        let search = model.file.specs.search.as_mut().expect("a search");
        search.certified_angle_min_deg = None;
        let said = of_search(&model.file.specs).expect("a note");
        assert!(said.starts_with("specs.search: nothing must be contained"));
        model.file.specs.must_contain = vec![vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0]];
        assert_eq!(of_search(&model.file.specs), None);
    }

    #[test]
    fn facts_out_of_proportion_are_named() {
        let text = include_str!("../../models/facts-cubesat.json");
        let facts = Facts::from_json(text).expect("facts");
        assert!(of_facts(&facts, text).is_empty());
        let text = text.replace("0.12, 0, 0", "120000, 0, 0");
        let text = text.replace("0, 0.1, 0", "0, 100000, 0");
        let facts = Facts::from_json(&text).expect_err("no rigid body has such moments");
        assert!(facts.to_string().contains("inertia"), "{facts}");
        let text = include_str!("../../models/facts-cubesat.json");
        let text = text.replace("[0.005, 0.005, 0.005]", "[5, 5, 5]");
        let facts = Facts::from_json(&text).expect("facts");
        let said = of_facts(&facts, &text);
        assert!(said[0].contains("is 100 rad/s^2"), "{said:?}");
    }

    #[test]
    fn a_disturbance_above_a_torque_limit_is_named() {
        let text = of_disturbance("it", 0.3, &[0.5, 0.2, 1.0]);
        assert!(text.is_some_and(|text| text.contains("up to 0.3 N m") && text.contains("0.2 N m")));
        assert_eq!(of_disturbance("it", 0.2, &[0.5, 0.2]), None);
    }
}
