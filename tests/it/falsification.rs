//! The search for a run that breaks what is proved of a loop with imperfections: boundary starts and starts from rest, against
//! worst-case and random imperfections that use all that the model allows.

use std::collections::HashMap;
use std::fmt;

use nalgebra::{DVector, Matrix3, Quaternion, UnitQuaternion, Vector3};
use serde_json::{json, Value};
use steadfast::run::design::Design;
use steadfast::run::simulate;
use steadfast::run::summary::{CertificateOutcome, OutputBound, RunVerdict};
use steadfast::scenario::Scenario;
use synth::certify::theorem1::certified_start;
use synth::model::{Imperfections, Model, MomentumBound, ReferenceMotion};
use synth::synthesis::{synthesize, Outcome, Solvers};

use crate::common;
use crate::support::random::Random;

/// Boundary starts of each design; STEADFAST_FALSIFIED=240 for the long search, which flies every design.
pub(crate) fn starts_asked() -> Option<usize> {
    let asked = std::env::var("STEADFAST_FALSIFIED").ok();
    asked.and_then(|count| count.parse().ok())
}

/// Boundary starts of each design in the short search, which flies the designs that are found fastest.
const FEW: usize = 12;

/// The bound on the disturbance, N m.
const TORQUE_NM: f64 = 0.01;

/// The momentum that a run from the boundary mostly needs for its way back, N m s.
const TURNING_NMS: f64 = 1.0;

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
pub(crate) fn designed(imperfections: &Value) -> Design {
    let model = serde_json::from_str(common::SPACECRAFT_MODEL).expect("JSON");
    designed_from(model, imperfections)
}

/// The proved design of a model with these imperfections.
pub(crate) fn designed_from(mut model: Value, imperfections: &Value) -> Design {
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
pub(crate) fn boundary(design: &Design, index: usize, random: &mut Random) -> DVector<f64> {
    let outer = design.outer.as_ref();
    let (model, certificate) = match outer {
        None => (&design.model, &design.certificate),
        Some(outer) => (&outer.model, &outer.certificate),
    };
    let lyapunov = &certificate.lyapunov;
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
    let edge = certified_start(model, certificate) * (1.0 - 1e-9);
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

/// How imperfections are chosen within their bounds in one run.
struct Kinds {
    error: Value,
    delay: Value,
    loss: Value,
    gain: Value,
    instants: Value,
}

impl Kinds {
    /// Against the design where `worst`, else in any way; samples are at most `longest` seconds apart.
    fn drawn(worst: bool, longest: f64, random: &mut Random) -> Self {
        let mut kind = |hard: &[Value], mild: &[Value]| -> Value {
            any(if worst { hard } else { mild }, random).clone()
        };
        let along = json!({ "constant": { "direction": [1, -1, 1, -1, 1, 1] } });
        let held = json!("towards_held");
        let hard = [json!("worst"), json!("worst"), held.clone(), along.clone()];
        let aperiodic = json!({ "aperiodic": { "shortest_s": 0.001, "longest_s": longest } });
        Kinds {
            error: kind(&hard, &[json!("random"), along, held]),
            delay: kind(&[json!("worst"), json!("largest")], &[json!("random")]),
            loss: kind(
                &[json!("worst")],
                &[json!({ "random": { "probability": 0.7 } })],
            ),
            gain: kind(&[json!("worst")], &[json!("random"), json!("constant")]),
            instants: kind(
                &[json!({ "periodic": { "interval_s": longest } })],
                &[aperiodic],
            ),
        }
    }
}

/// A disturbance of the largest norm.
fn disturbance(worst: bool, random: &mut Random) -> Value {
    let push = (direction(random) * TORQUE_NM).as_slice().to_vec();
    match (worst, random.below(2)) {
        (true, _) => json!({ "worst_nm": TORQUE_NM }),
        (false, 0) => json!({ "bias_nm": push }),
        (false, _) => json!({ "sines": [{ "frequency_rad_s": 0.1, "sine_nm": push }] }),
    }
}

/// A reference that turns as fast as is allowed, and its rate at the start, where it is the zero attitude.
fn reference(bounds: &ReferenceMotion, random: &mut Random) -> (Value, Vector3<f64>) {
    let axis = direction(random);
    let zero = json!({ "quaternion_scalar_first": [1, 0, 0, 0] });
    let (direction, rate) = (axis.as_slice(), bounds.rate_rad_s);
    let moving = match random.below(2) {
        0 => json!({ "slew": { "start": zero, "axis": direction, "rate_rad_s": rate,
                               "from_s": 0, "until_s": 1e9 } }),
        _ => {
            let frequency = bounds.acceleration_rad_s2 / rate;
            let amplitude = (rate / frequency).to_degrees() * (1.0 - 1e-12);
            json!({ "sine": { "centre": zero, "axis": direction, "amplitude_deg": amplitude,
                              "frequency_rad_s": frequency * (1.0 - 1e-12) } })
        }
    };
    (moving, axis * rate)
}

/// That of models/xu2020.json, kg m^2.
fn inertia() -> Matrix3<f64> {
    Matrix3::new(350.0, 3.0, 4.0, 3.0, 270.0, 10.0, 4.0, 10.0, 190.0)
}

/// The spacecraft, which starts with the error x0.
fn spacecraft(
    proved: &Imperfections,
    start: &DVector<f64>,
    (kinds, worst, duration_s): (&Kinds, bool, f64),
    random: &mut Random,
) -> Value {
    let mut body = json!({ "disturbance": disturbance(worst, random) });
    let mut rate = Vector3::zeros();
    if let Some(bounds) = &proved.reference {
        (body["reference"], rate) = reference(bounds, random);
    }
    let vector = Vector3::new(start[3], start[4], start[5]);
    let scalar = (1.0 - vector.norm_squared()).sqrt();
    let error = UnitQuaternion::from_quaternion(Quaternion::from_parts(scalar, vector));
    let rate = Vector3::new(start[0], start[1], start[2]) + error.inverse() * rate;
    body["initial_attitude"] =
        json!({ "quaternion_scalar_first": [error.w, error.i, error.j, error.k] });
    body["initial_rate_rad_s"] = json!(rate.as_slice());
    let inertia = inertia();
    body["inertia_kg_m2"] =
        json!([0, 1, 2].map(|row| [0, 1, 2].map(|column| inertia[(row, column)])));
    if let Some(bounds) = &proved.measurement {
        body["sensors"] = json!({ "bounded_error": { "rate_rad_s": bounds.rate_rad_s,
            "attitude_deg": bounds.attitude_deg, "kind": kinds.error } });
    }
    if let Some(effectiveness) = &proved.effectiveness {
        let gain = json!({ "effectiveness": effectiveness, "kind": kinds.gain });
        body["actuators"] = json!({ "gain_error": gain });
    }
    if let Some(MomentumBound::Norm(bound)) = &proved.wheel_momentum_nms {
        // Body and wheels turn against each other, so that little is left for the wheels when the body has come to rest.
        let left = bound - TORQUE_NM * duration_s - TURNING_NMS;
        let momentum = direction(random) * left.max(0.0) - inertia * rate;
        body["wheels"] = json!({ "initial_momentum_nms": momentum.as_slice() });
    }
    body
}

/// A scenario of the spacecraft of models/xu2020.json that starts at x0 with all that the design's model allows: worst-case kinds where `worst`, else any.
pub(crate) fn scenario(
    design: &Design,
    start: &DVector<f64>,
    (worst, duration_s): (bool, f64),
    random: &mut Random,
) -> Value {
    let proved = &design.model.file.imperfections;
    let kinds = Kinds::drawn(worst, design.model.file.specs.hbar_s, random);
    let body = spacecraft(proved, start, (&kinds, worst, duration_s), random);
    let mut out = json!({
        "schema_version": 1, "name": "falsification", "duration_s": duration_s,
        "random": { "generator": "chacha8", "seed": random.below(1_000_000) },
        "system": { "rigid_body": body },
        "sampling": { "instants": kinds.instants },
        "controller": { "design": {} }
    });
    if proved.is_networked() {
        out["network"] = json!({ "delay_s": proved.delay_s, "delay": kinds.delay,
                                 "lost_in_a_row": proved.lost_in_a_row, "loss": kinds.loss });
    }
    out
}

pub(crate) fn flown(design: &Design, scenario: &Value) -> (CertificateOutcome, RunVerdict) {
    let scenario = Scenario::from_json(&scenario.to_string()).expect("a scenario");
    let outcome = simulate(&scenario, Some(design), false).expect("a run");
    let verdict = outcome.summary.verdict;
    (outcome.summary.certificate.expect("a certificate"), verdict)
}

/// How close the runs of a design came to what is proved.
#[derive(Default)]
struct Tightest {
    runs: usize,
    /// Runs that do not count: their wheels took up more momentum than the model allows.
    left_out: usize,
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
    while out.runs < count + count / 4 {
        let index = out.runs;
        let rest = usize::from(index >= count);
        let start = match rest {
            0 => boundary(design, index, &mut random),
            _ => nearly_at_rest(&mut random),
        };
        let how = (index % 4 != 3, LENGTHS_S[rest]);
        let scenario = scenario(design, &start, how, &mut random);
        let (outcome, verdict) = flown(design, &scenario);
        if !outcome.covers_run {
            // The momentum of wheels is a consequence of the run.
            let mut reasons = outcome.not_covered.iter();
            let momentum = reasons.all(|reason| reason.starts_with("momentum of the wheels"));
            out.left_out += 1;
            assert!(
                momentum && out.left_out < 3 * count,
                "{outcome:#?}\n{scenario}"
            );
            continue;
        }
        assert_ne!(verdict, RunVerdict::ProofBroken, "{outcome:#?}\n{scenario}");
        assert!(!outcome.broken(), "{outcome:#?}\n{scenario}");
        out.runs += 1;
        out.levels[rest] = out.levels[rest].max(outcome.largest_lyapunov_ratio);
        if rest == 1 {
            let bound = match outcome.output_bound {
                OutputBound::Peak(peak) => peak,
                _ => outcome.guaranteed_gain.expect("a gain") * TORQUE_NM,
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
        let [boundary, rest] = found.levels;
        println!("| {name} | {found} |");
        assert!(
            boundary > 0.9 && boundary.max(rest) <= 1.0,
            "{name}: {found}"
        );
        assert!(found.output > 0.1 && found.output <= 1.0, "{name}: {found}");
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
