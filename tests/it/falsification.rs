//! The search for a run that breaks what is proved of a loop with imperfections: boundary starts and starts from rest, against
//! worst-case and random imperfections that use all that the model allows.

use std::collections::HashMap;
use std::fmt;

use nalgebra::{DVector, Quaternion, UnitQuaternion, Vector3};
use serde_json::{json, Value};
use steadfast::run::design::Design;
use steadfast::run::simulate;
use steadfast::run::summary::{CertificateOutcome, OutputBound, RunVerdict};
use steadfast::scenario::Scenario;
use synth::certify::theorem1::certified_start;
use synth::model::Model;
use synth::synthesis::{synthesize, Outcome, Solvers};

use crate::common;
use crate::support::random::Random;

/// Boundary starts of each design; STEADFAST_FALSIFIED=240 for the long search, which flies every design.
fn starts_asked() -> Option<usize> {
    let asked = std::env::var("STEADFAST_FALSIFIED").ok();
    asked.and_then(|count| count.parse().ok())
}

/// Boundary starts of each design in the short search, which flies the designs that are found fastest.
const FEW: usize = 12;

/// Length of a run from the boundary and of one from rest, s.
const LENGTHS_S: [f64; 2] = [100.0, 200.0];

/// What a model allows, and whether the short search flies its design.
fn cases() -> Vec<(&'static str, Value, bool)> {
    // 1e-4 in q is an attitude error of 2e-4 rad.
    let measurement = json!({ "rate_rad_s": 1e-5, "attitude_deg": 0.0114591 });
    let slow = json!({ "rate_rad_s": 0.0011, "acceleration_rad_s2": 1e-6 });
    vec![
        (
            "measurement 1e-5 rad/s, 1e-4 in q",
            json!({ "measurement": measurement }),
            false,
        ),
        ("delay 20 ms", json!({ "delay_s": 0.02 }), true),
        (
            "2 messages lost in a row",
            json!({ "lost_in_a_row": 2 }),
            false,
        ),
        (
            "effectiveness [0.9, 1]",
            json!({ "effectiveness": [0.9, 1] }),
            true,
        ),
        (
            "wheels 20 N m s",
            json!({ "wheel_momentum_nms": 20 }),
            false,
        ),
        (
            "reference 0.0011 rad/s, 1e-6 rad/s^2",
            json!({ "reference": slow }),
            false,
        ),
        (
            "measurement, delay 20 ms, effectiveness [0.9, 1], wheels 5 N m s",
            json!({ "measurement": measurement, "delay_s": 0.02, "effectiveness": [0.9, 1],
                    "wheel_momentum_nms": 5 }),
            false,
        ),
        (
            "measurement, delay 20 ms, 2 lost, effectiveness [0.9, 1], wheels 5 N m s, reference",
            json!({ "measurement": measurement, "delay_s": 0.02, "lost_in_a_row": 2,
                    "effectiveness": [0.9, 1], "wheel_momentum_nms": 5, "reference": slow }),
            false,
        ),
    ]
}

/// The proved design of models/xu2020.json with these imperfections.
fn designed(imperfections: &Value) -> Design {
    let mut model: Value = serde_json::from_str(common::SPACECRAFT_MODEL).expect("JSON");
    if imperfections.get("measurement").is_some() {
        model["specs"]["trigger_floor"] = json!("auto");
    }
    model["imperfections"] = imperfections.clone();
    let text = model.to_string();
    let model = Model::from_json(&text).expect("a valid model");
    let solvers = Solvers::suited_to(&model);
    let Ok(Outcome::Solved(design)) = synthesize(&model, &text, &solvers, None) else {
        panic!("no design for {imperfections}");
    };
    let design = common::read(&design.file.to_json());
    assert!(design.proved(), "{imperfections}");
    design
}

/// A start x0 with x0'U x0 on the edge of what is certified: in any direction, at rest, or along U^-1 F_s'.
fn boundary(design: &Design, index: usize, random: &mut Random) -> DVector<f64> {
    let lyapunov = &design.certificate.lyapunov;
    let inverse = lyapunov.clone().try_inverse().expect("U > 0");
    let mut unit = |size: usize| {
        let any = DVector::from_fn(size, |_, _| random.signed_unit());
        any.normalize()
    };
    let direction = match index % 3 {
        0 => inverse.cholesky().expect("U > 0").l() * unit(6),
        1 => {
            let attitude = unit(3);
            DVector::from_fn(6, |k, _| if k < 3 { 0.0 } else { attitude[k - 3] })
        }
        _ => {
            let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
            let row = design.certificate.gain.row(index / 3 % 3).transpose();
            inverse * row * sign
        }
    };
    let level = direction.dot(&(lyapunov * &direction));
    let edge = certified_start(&design.model, &design.certificate) * (1.0 - 1e-9);
    direction * (edge / level).sqrt()
}

/// So close to the origin that the start does not count, but not where every worst case is zero.
fn nearly_at_rest(random: &mut Random) -> DVector<f64> {
    DVector::from_fn(6, |_, _| 1e-12 * random.signed_unit())
}

fn any<'a, T>(of: &'a [T], random: &mut Random) -> &'a T {
    &of[random.below(of.len())]
}

fn direction(random: &mut Random) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.signed_unit()).normalize()
}

/// A scenario that starts at x0 with all that the design's model allows: worst-case kinds where `worst`, else any.
fn scenario(
    design: &Design,
    start: &DVector<f64>,
    (worst, duration_s): (bool, f64),
    random: &mut Random,
) -> Value {
    let proved = &design.model.file.imperfections;
    let mut kind = |hard: &[Value], mild: &[Value]| -> Value {
        any(if worst { hard } else { mild }, random).clone()
    };
    let along = json!({ "constant": { "direction": [1, -1, 1, -1, 1, 1] } });
    let error_kind = kind(
        &[
            json!("worst"),
            json!("worst"),
            json!("towards_held"),
            along.clone(),
        ],
        &[json!("random"), along, json!("towards_held")],
    );
    let delay_kind = kind(&[json!("worst"), json!("largest")], &[json!("random")]);
    let loss = kind(
        &[json!("worst")],
        &[json!({ "random": { "probability": 0.7 } })],
    );
    let gain_kind = kind(&[json!("worst")], &[json!("random"), json!("constant")]);
    let longest = design.model.file.specs.hbar_s;
    let instants = kind(
        &[json!({ "periodic": { "interval_s": longest } })],
        &[json!({ "aperiodic": { "shortest_s": 0.001, "longest_s": longest } })],
    );
    let push = direction(random) * 0.01;
    let disturbance = match (worst, random.below(2)) {
        (true, _) => json!({ "worst_nm": 0.01 }),
        (false, 0) => json!({ "bias_nm": [push.x, push.y, push.z] }),
        (false, _) => {
            json!({ "sines": [{ "frequency_rad_s": 0.1, "sine_nm": [push.x, push.y, push.z] }] })
        }
    };
    let mut body = json!({ "disturbance": disturbance });
    let (mut attitude, mut rate) = (UnitQuaternion::identity(), Vector3::zeros());
    if let Some(bounds) = &proved.reference {
        let axis = direction(random);
        let [x, y, z] = [axis.x, axis.y, axis.z];
        let zero = json!({ "quaternion_scalar_first": [1, 0, 0, 0] });
        rate = axis * bounds.rate_rad_s;
        body["reference"] = match random.below(2) {
            0 => {
                json!({ "slew": { "start": zero, "axis": [x, y, z], "rate_rad_s": bounds.rate_rad_s,
                                   "from_s": 0, "until_s": 1e9 } })
            }
            _ => {
                let frequency = bounds.acceleration_rad_s2 / bounds.rate_rad_s;
                let amplitude = (bounds.rate_rad_s / frequency).to_degrees() * (1.0 - 1e-12);
                json!({ "sine": { "centre": zero, "axis": [x, y, z], "amplitude_deg": amplitude,
                                  "frequency_rad_s": frequency * (1.0 - 1e-12) } })
            }
        };
    }
    let vector = Vector3::new(start[3], start[4], start[5]);
    let scalar = (1.0 - vector.norm_squared()).sqrt();
    let error = UnitQuaternion::from_quaternion(Quaternion::from_parts(scalar, vector));
    attitude *= error;
    let rate = Vector3::new(start[0], start[1], start[2]) + error.inverse() * rate;
    body["initial_attitude"] =
        json!({ "quaternion_scalar_first": [attitude.w, attitude.i, attitude.j, attitude.k] });
    body["initial_rate_rad_s"] = json!([rate.x, rate.y, rate.z]);
    body["inertia_kg_m2"] = json!([[350, 3, 4], [3, 270, 10], [4, 10, 190]]);
    if let Some(bounds) = &proved.measurement {
        body["sensors"] = json!({ "bounded_error": { "rate_rad_s": bounds.rate_rad_s,
            "attitude_deg": bounds.attitude_deg, "kind": error_kind } });
    }
    if let Some(effectiveness) = &proved.effectiveness {
        body["actuators"] =
            json!({ "gain_error": { "effectiveness": effectiveness, "kind": gain_kind } });
    }
    if let Some(bound) = &proved.wheel_momentum_nms {
        let bound = serde_json::to_value(bound)
            .expect("a number")
            .as_f64()
            .expect("a norm");
        // What the wheels take from the body and from the disturbance stays within the bound.
        let taken = 350.0 * rate.norm() + 0.01 * duration_s;
        let momentum = direction(random) * (bound - taken);
        body["wheels"] = json!({ "initial_momentum_nms": [momentum.x, momentum.y, momentum.z] });
    }
    let mut out = json!({
        "schema_version": 1, "name": "falsification", "duration_s": duration_s,
        "random": { "generator": "chacha8", "seed": random.below(1_000_000) },
        "system": { "rigid_body": body },
        "sampling": { "instants": instants },
        "controller": { "design": {} }
    });
    if proved.is_networked() {
        out["network"] = json!({ "delay_s": proved.delay_s, "delay": delay_kind,
                                 "lost_in_a_row": proved.lost_in_a_row, "loss": loss });
    }
    out
}

fn flown(design: &Design, scenario: &Value) -> (CertificateOutcome, RunVerdict) {
    let scenario = Scenario::from_json(&scenario.to_string()).expect("a scenario");
    let outcome = simulate(&scenario, Some(design), false).expect("a run");
    let verdict = outcome.summary.verdict;
    (outcome.summary.certificate.expect("a certificate"), verdict)
}

/// How close the runs of a design came to what is proved.
#[derive(Default)]
struct Tightest {
    runs: usize,
    /// x'Ux over its bound, from the boundary and from rest.
    levels: [f64; 2],
    /// |x| from rest over its bound.
    output: f64,
}

impl fmt::Display for Tightest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [boundary, rest] = self.levels;
        write!(
            f,
            "{} | {boundary:.4} | {rest:.3} | {:.3}",
            self.runs, self.output
        )
    }
}

/// Flies a design from boundary starts and, a quarter as often, from rest.
fn fly(design: &Design, count: usize) -> Tightest {
    let mut random = Random(29);
    let mut out = Tightest::default();
    for index in 0..count + count / 4 {
        let rest = usize::from(index >= count);
        let start = match rest {
            0 => boundary(design, index, &mut random),
            _ => nearly_at_rest(&mut random),
        };
        let how = (index % 4 != 3, LENGTHS_S[rest]);
        let scenario = scenario(design, &start, how, &mut random);
        let (outcome, verdict) = flown(design, &scenario);
        assert!(outcome.covers_run, "{:?}\n{scenario}", outcome.not_covered);
        assert_ne!(verdict, RunVerdict::ProofBroken, "{outcome:#?}\n{scenario}");
        assert!(!outcome.broken(), "{outcome:#?}\n{scenario}");
        out.runs += 1;
        out.levels[rest] = out.levels[rest].max(outcome.largest_lyapunov_ratio);
        if rest == 1 {
            let bound = match outcome.output_bound {
                OutputBound::Peak(peak) => peak,
                _ => outcome.guaranteed_gain.expect("a gain") * 0.01,
            };
            out.output = out.output.max(outcome.peak_output / bound);
        }
    }
    out
}

#[test]
fn no_run_breaks_what_is_proved_of_a_loop_with_imperfections() {
    let (count, all) = match starts_asked() {
        Some(count) => (count, true),
        None => (FEW, false),
    };
    for (name, imperfections, fast) in cases() {
        if !(all || fast) {
            continue;
        }
        let found = fly(&designed(&imperfections), count);
        println!("| {name} | {found} |");
        assert!(
            found.levels[0] > 0.9 && found.levels[0] <= 1.0 + 1e-9,
            "{name}: {found}"
        );
    }
}

/// What a scenario has that the model does not allow.
type Breach = fn(&mut Value);

#[test]
fn a_loop_outside_of_what_is_proved_is_found_to_break_the_bound() {
    let cases: [(&str, Value, usize, Breach); 5] = [
        (
            "losses that are not repeated",
            json!({ "lost_in_a_row": 2 }),
            0,
            |scenario| {
                scenario["network"]["repeats"] = json!(0);
            },
        ),
        (
            "a twentieth of the torque",
            json!({ "delay_s": 0.02 }),
            0,
            |scenario| {
                let limit = 0.1;
                scenario["system"]["rigid_body"]["actuators"] =
                    json!({ "torque_limit_nm": [limit, limit, limit] });
            },
        ),
        (
            "three times the disturbance",
            json!({ "delay_s": 0.02 }),
            1,
            |scenario| {
                scenario["system"]["rigid_body"]["disturbance"] = json!({ "worst_nm": 0.03 });
            },
        ),
        (
            "a delay of 3 s",
            json!({ "delay_s": 0.02 }),
            0,
            |scenario| {
                scenario["network"]["delay_s"] = json!(3);
                scenario["network"]["delay"] = json!("largest");
            },
        ),
        (
            "effectiveness 0.2",
            json!({ "effectiveness": [0.9, 1] }),
            0,
            |scenario| {
                scenario["system"]["rigid_body"]["actuators"]["gain_error"]["effectiveness"] =
                    json!([0.2, 1]);
            },
        ),
    ];
    let mut designs: HashMap<String, Design> = HashMap::new();
    for (name, imperfections, rest, breach) in cases {
        let own = designs.entry(imperfections.to_string());
        let design = own.or_insert_with(|| designed(&imperfections));
        let mut random = Random(31);
        let mut largest = 0.0_f64;
        for index in 0..FEW {
            let start = match rest {
                0 => boundary(design, index, &mut random),
                _ => nearly_at_rest(&mut random),
            };
            let mut scenario = scenario(design, &start, (true, LENGTHS_S[rest]), &mut random);
            breach(&mut scenario);
            let (outcome, _) = flown(design, &scenario);
            assert!(!outcome.covers_run, "{name}");
            largest = largest.max(outcome.largest_lyapunov_ratio);
        }
        println!("| {name} | {largest:.3} |");
        assert!(largest > 1.0, "{name}: {largest}");
    }
}
