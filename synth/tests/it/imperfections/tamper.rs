//! A search for false proofs: designs with imperfections, each with one number or one block of numbers changed. Whatever
//! is proved is decided in exact rational arithmetic.

use std::cell::OnceCell;
use std::fmt;

use serde_json::{json, Value};
use synth::certify::matrix::Matrix;
use synth::certify::theorem1::for_each_condition;
use synth::certify::Verdict;
use synth::design::DesignFile;
use synth::model::Model;

use super::{design_of, CART};
use crate::exact::{Exact, Stream};
use crate::tampering::*;

/// Changed designs; STEADFAST_TAMPERED=10000 for the long search.
fn changes_asked() -> u64 {
    let asked = std::env::var("STEADFAST_TAMPERED").ok();
    asked.and_then(|count| count.parse().ok()).unwrap_or(60)
}

/// Of the first change; each next one has the next.
const FIRST_SEED: u64 = 7000;

/// After so many changes the counts are printed.
const COUNTED: u64 = 500;

/// Two inputs that act in each other's place.
const PAIR: &str = r#"{
    "schema_version": 1, "name": "pair",
    "plant": { "vertices": {
        "state_matrices": [[[0, 0.1], [-0.1, 0]], [[0, 0.2], [-0.2, 0.02]]],
        "input_matrix": [[1, 0], [0, 1]], "input_limit": [1, 1], "disturbance_bound": 0.02,
        "box": [{ "row": [1, 0], "bound": 1 }, { "row": [0, 1], "bound": 1 }]
    } },
    "specs": { "phi_per_s": 0.1, "hbar_s": 0.05, "nu": 0.05, "xi_max": 100, "objective": "gamma",
               "trigger_floor": 1e-4, "must_contain": [[0.1, 0.1]] },
    "imperfections": { "measurement": { "state": [1e-4, 2e-4] }, "delay_s": 0.03,
                       "effectiveness": [[0.9, 1], [0.95, 1.05]], "misalignment": 0.02 }
}"#;

/// A shipped model with imperfections.
fn spacecraft(text: &str, imperfections: Value) -> Value {
    let mut model: Value = serde_json::from_str(text).expect("JSON");
    model["imperfections"] = imperfections;
    model["specs"]["trigger_floor"] = json!("auto");
    let form = [[130, 0, 0], [0, 130, 0], [0, 0, 130]];
    model["plant"]["exact"]["gyroscopic_form_kg_m2"] = json!(form);
    model
}

/// A design with what exact arithmetic has already decided of it.
struct Subject {
    design: Value,
    /// The numbers that a proof reads.
    paths: Vec<String>,
    /// Those of them that imperfections, two certificates and the form of the gyroscopic torque have added.
    new: Vec<String>,
    /// Its conditions, all of which hold.
    conditions: Vec<(String, Matrix<Exact>)>,
}

/// What the new numbers' paths have in them.
const NEW: [&str; 9] = [
    "/certificate/measurement/",
    "/certificate/first_torque/",
    "/certificate/gain_error_weight/",
    "/certificate/final_bounds/",
    "/certificate/certified_vector_part",
    "/trigger_floor",
    "/trigger_multiple",
    "/model/imperfections/",
    "/gyroscopic_form_kg_m2/",
];

impl Subject {
    fn new(model: &str) -> Self {
        let design: Value = serde_json::from_str(&design_of(model).to_json()).expect("JSON");
        let mut paths = numbers_of_proof(&design);
        numbers(&design["outer"], "/outer", &mut paths);
        let is_new = |path: &&String| NEW.iter().any(|part| path.contains(part));
        let (file, model) = DesignFile::from_json(&design.to_string()).expect("a design");
        let mut conditions = Vec::new();
        each_condition(&file, &model, |name, matrix| {
            assert!(exactly_positive_definite(&matrix), "{name}");
            conditions.push((name, matrix));
        });
        Subject {
            new: paths.iter().filter(is_new).cloned().collect(),
            paths,
            design,
            conditions,
        }
    }

    /// How many conditions of a changed design are not those of this one, all of which must hold.
    fn decide(&self, file: &DesignFile, model: &Model, what: &str) -> u64 {
        let (mut place, mut decided) = (0, 0);
        each_condition(file, model, |name, matrix| {
            let own = self.conditions.get(place);
            place += 1;
            let known = |(own, held): &(String, Matrix<Exact>)| {
                *own == name && held.entries() == matrix.entries()
            };
            if own.is_some_and(known) {
                return;
            }
            decided += 1;
            assert!(
                exactly_positive_definite(&matrix),
                "a false proof: {what}: {name}"
            );
        });
        assert!(place > 0);
        decided
    }
}

/// Every condition of every certificate of a file.
fn each_condition(file: &DesignFile, model: &Model, mut emit: impl FnMut(String, Matrix<Exact>)) {
    let certificate = file.certificate(model).expect("read before");
    for_each_condition::<Exact>(model, &certificate, |one| emit(one.name, one.matrix));
    let outer = file.large_set_certificate(model).expect("read before");
    if let Some(outer) = outer {
        for_each_condition::<Exact>(&outer.model, &outer.certificate, |one| {
            emit(format!("outer {}", one.name), one.matrix);
        });
    }
}

fn any<'a, T>(of: &'a [T], stream: &mut Stream) -> &'a T {
    &of[stream.integer(0, of.len() as i64 - 1) as usize]
}

/// A change of one number, of it and of that which mirrors it, or of the whole block that it stands in.
fn change(subject: &Subject, stream: &mut Stream) -> (String, Value) {
    let paths = match stream.integer(0, 1) {
        0 => &subject.new,
        _ => &subject.paths,
    };
    let path = any(paths, stream);
    let mut design = subject.design.clone();
    let number = design.pointer(path).expect("a number").clone();
    if let Some(count) = number.as_u64().filter(|_| path.contains("lost_in_a_row")) {
        let count = stream.integer(0, 2 * count as i64 + 1);
        *design.pointer_mut(path).expect("a number") = Value::from(count);
        return (format!("{path} = {count}"), design);
    }
    let before = number.as_f64().expect("a number");
    let size = 10.0_f64.powf(-5.0 * (1.0 + stream.signed_unit()));
    let factor = 1.0 + size * stream.signed_unit().signum();
    let kind = stream.integer(0, 9);
    let mut block = Vec::new();
    if kind == 9 {
        let levels = stream.integer(1, 2) as usize;
        let parent = path.rsplitn(levels + 1, '/').last().unwrap_or_default();
        block.extend(
            subject
                .paths
                .iter()
                .filter(|one| one.starts_with(parent))
                .cloned(),
        );
    } else {
        block.push(path.clone());
        block.extend(mirrored(path).filter(|_| stream.integer(0, 3) > 0));
    }
    let other = subject
        .design
        .pointer(any::<String>(&subject.paths, stream));
    let other = other.and_then(Value::as_f64).unwrap_or(before);
    for path in &block {
        let slot = design.pointer_mut(path).expect("a number");
        let own = slot.as_f64().expect("a number");
        *slot = Value::from(match kind {
            0 => 0.0,
            1 => -own,
            2 => own * 1e3,
            3 => other,
            _ => own * factor,
        });
    }
    (
        format!(
            "{path} and {} more, kind {kind}, factor {factor:e}",
            block.len() - 1
        ),
        design,
    )
}

/// What came of the changes so far.
#[derive(Default)]
struct Counts {
    proved: u64,
    denied: u64,
    invalid: u64,
    /// Conditions of proved changes that the change has altered.
    decided: u64,
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} changes: {} PROVED, {} denied, {} no valid file; {} conditions decided exactly, 0 false PROVED",
            self.proved + self.denied + self.invalid,
            self.proved,
            self.denied,
            self.invalid,
            self.decided
        )
    }
}

#[test]
fn what_is_proved_of_a_changed_design_with_imperfections_holds_in_exact_arithmetic() {
    let both = json!({ "measurement": { "rate_rad_s": 1e-6, "attitude_deg": 1e-3 }, "delay_s": 0.01,
                       "effectiveness": [0.95, 1] });
    let all = json!({ "measurement": { "rate_rad_s": 1e-6, "attitude_deg": 1e-3 }, "delay_s": 0.02,
                      "lost_in_a_row": 1, "effectiveness": [0.95, 1], "misalignment": 0.01,
                      "wheel_momentum_nms": 2,
                      "reference": { "rate_rad_s": 1e-3, "acceleration_rad_s2": 1e-6 } });
    let both = spacecraft(include_str!("../../../../models/xu2020-both.json"), both);
    let all = spacecraft(include_str!("../../../../models/xu2020.json"), all);
    let models = [CART, PAIR, &both.to_string(), &all.to_string()];
    let subjects: [OnceCell<Subject>; 4] = Default::default();
    let mut counts = Counts::default();
    for index in 0..changes_asked() {
        let mut stream = Stream(FIRST_SEED + index);
        // A proof of the last two is decided in half a minute, one of the first two in a hundredth of a second.
        let kind = match index % 100 {
            99 => 3,
            33 | 66 => 2,
            other => (other % 2) as usize,
        };
        let subject = subjects[kind].get_or_init(|| Subject::new(models[kind]));
        let (what, design) = change(subject, &mut stream);
        let what = format!("seed {}: {what}", FIRST_SEED + index);
        match DesignFile::from_json(&design.to_string()) {
            Err(_) => counts.invalid += 1,
            Ok((file, model)) => {
                let report = file.verify(&model).expect("checked when it was read");
                match report.verdict {
                    Verdict::NotProved => counts.denied += 1,
                    Verdict::Proved => {
                        counts.proved += 1;
                        counts.decided += subject.decide(&file, &model, &what);
                    }
                }
            }
        }
        if (index + 1) % COUNTED == 0 {
            eprintln!("{counts}");
        }
    }
    eprintln!("{counts}");
    assert!(counts.proved > 5 && counts.denied > 5, "{counts}");
}
