//! Spacecraft drawn at random, from facts to a design: proved, or answered with a change that is proved when it is made.

use std::time::Instant;

use serde_json::{json, Value};

use crate::support::random::Random;
use crate::support::*;

/// How many spacecraft; STEADFAST_SPACECRAFT=200 for the long search, with every angle.
fn asked() -> Option<usize> {
    std::env::var("STEADFAST_SPACECRAFT").ok()?.parse().ok()
}

/// Spacecraft of the short search, for the first angle.
const FEW: usize = 2;

/// Certified angles (deg), each with the pointing error that is required over angle and ratio of disturbance to torque.
const ANGLES: [[f64; 2]; 3] = [[20.0, 3.0], [60.0, 4.0], [90.0, 6.0]];

/// Between two numbers, uniform on a logarithmic scale.
fn between(low: f64, high: f64, random: &mut Random) -> f64 {
    let part = 0.5 * (1.0 + random.signed_unit());
    low * (high / low).powf(part)
}

/// A spacecraft without requirements, and the ratio of its disturbance to its torque: largest moment 1e-3 to 1e5 kg m^2,
/// ratios to 20 that a rigid body can have, 5 to 500 s for a turn by 60 deg at full torque; three in ten have a large
/// disturbance and few samples.
fn spacecraft(random: &mut Random) -> (Value, f64) {
    let ratios = loop {
        let drawn = [1.0, between(0.05, 1.0, random), between(0.05, 1.0, random)];
        if drawn[1] + drawn[2] >= 1.0 {
            break drawn;
        }
    };
    let (largest, turn) = (between(1e-3, 1e5, random), between(5.0, 500.0, random));
    let hard = random.below(10) < 3;
    let [disturbance, interval] = match hard {
        false => [between(1e-4, 1e-1, random), between(1e-3, 3e-2, random)],
        true => [between(1.2e-2, 6.6e-2, random), between(1e-2, 1e-1, random)],
    };
    let torque = std::f64::consts::FRAC_PI_3 * largest / (turn * turn);
    let moments = ratios.map(|ratio| ratio * largest);
    let craft = json!({
        "schema_version": 1, "name": "random",
        "plant": { "exact": {
            "inertia_kg_m2": [[moments[0], 0, 0], [0, moments[1], 0], [0, 0, moments[2]]],
            "torque_limit_nm": [torque, torque, torque],
            "disturbance_bound_nm": disturbance * torque } },
        "specs": { "hbar_s": interval * turn }
    });
    (craft, disturbance)
}

#[test]
fn a_random_spacecraft_has_a_proved_design_or_a_change_with_which_it_has_one() {
    let (count, angles) = match asked() {
        Some(count) => (count, ANGLES.as_slice()),
        None => (FEW, &ANGLES[..1]),
    };
    let folder = folder();
    let mut random = Random(20);
    let (mut proved, mut changed, mut without) = (0, 0, 0);
    for index in 0..count {
        let (craft, disturbance) = spacecraft(&mut random);
        for &[angle, merit] in angles {
            let mut file = craft.clone();
            let pointing = (merit * angle * disturbance).min(170.0);
            file["requirements"] =
                json!({ "certified_angle_deg": angle, "pointing_deg": pointing });
            let path = write(folder.path(), "facts.json", file.to_string());
            let begun = Instant::now();
            let run = synthesize(&path, &["--json"]);
            let answer = run.json();
            let seconds = begun.elapsed().as_secs_f64();
            let verdict = &answer["verdict"];
            println!("spacecraft {index}, {angle} deg: {verdict}, {seconds:.1} s");
            if *verdict == "proved" {
                run.ends_with(0);
                proved += 1;
                continue;
            }
            run.ends_with(2);
            match with_first_change(&file, &answer) {
                Some(better) => {
                    let better = write(folder.path(), "changed.json", better.to_string());
                    synthesize(&better, &["--json"]).ends_with(0);
                    changed += 1;
                }
                None => {
                    println!("no design and no change: spacecraft {index}, {angle} deg: {file}");
                    without += 1;
                }
            }
        }
    }
    println!("proved {proved}, proved with a change {changed}, neither {without}");
    assert!(
        proved > 0 && without * 5 <= proved + changed,
        "{proved} {changed} {without}"
    );
}
