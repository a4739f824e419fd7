//! Proved designs with one number changed: never a panic, never a proof of a false statement, never a
//! refusal of a true one with room to spare. The judge of truth is exact rational arithmetic.

use std::sync::OnceLock;

use crate::exact::{Exact, Stream};
use crate::tampering::*;
use serde_json::Value;
use synth::certify::interval::Interval;
use synth::certify::theorem1::{for_each_condition, Certificate};
use synth::certify::{Report, Verdict};
use synth::design::DesignFile;
use synth::model::Model;
use synth::solve::Solver;
use synth::synthesis::{synthesize, Outcome, Solvers};

fn synthesized(text: &str) -> Value {
    let model = Model::from_json(text).expect("a valid model");
    let outcome = synthesize(
        &model,
        text,
        &Solvers::both([Solver::Clarabel, Solver::Structured]),
        None,
    );
    let Ok(Outcome::Solved(design)) = outcome else {
        panic!("no design was found");
    };
    assert_eq!(design.report.verdict, Verdict::Proved);
    serde_json::from_str(&design.file.to_json()).expect("a design file is JSON")
}

fn double_integrator() -> &'static Value {
    static DESIGN: OnceLock<Value> = OnceLock::new();
    DESIGN.get_or_init(|| synthesized(include_str!("../../../models/double-integrator.json")))
}

fn xu2020() -> &'static Value {
    static DESIGN: OnceLock<Value> = OnceLock::new();
    DESIGN.get_or_init(|| synthesized(include_str!("../../../models/xu2020.json")))
}

enum Answer {
    /// The file is refused with this reason.
    Invalid(String),
    Checked(Box<Checked>),
}

struct Checked {
    model: Model,
    certificate: Certificate,
    report: Report,
}

fn answer(text: &str) -> Answer {
    let (file, model) = match DesignFile::from_json(text) {
        Ok(read) => read,
        Err(error) => return Answer::Invalid(error.to_string()),
    };
    let certificate = file.certificate(&model).expect("checked when it was read");
    let report = file.verify(&model).expect("checked when it was read");
    let failed = report
        .conditions
        .iter()
        .filter(|condition| condition.margin < 0.0)
        .count();
    let worst = report.worst().expect("there are conditions");
    assert!(!worst.name.is_empty());
    match report.verdict {
        Verdict::Proved => assert_eq!(failed, 0, "{}", worst.name),
        Verdict::NotProved => assert!(failed > 0 && worst.margin < 0.0, "{}", worst.name),
    }
    Answer::Checked(Box::new(Checked {
        model,
        certificate,
        report,
    }))
}

/// The truth about the conditions that `chosen` picks by their place in the report, by place.
fn truth(checked: &Checked, chosen: impl Fn(usize) -> bool) -> Vec<(usize, bool)> {
    let mut out = Vec::new();
    let mut place = 0;
    for_each_condition::<Exact>(&checked.model, &checked.certificate, |statement| {
        assert_eq!(statement.name, checked.report.conditions[place].name);
        if chosen(place) {
            out.push((place, exactly_positive_definite(&statement.matrix)));
        }
        place += 1;
    });
    assert_eq!(place, checked.report.conditions.len());
    out
}

/// The smallest eigenvalue after scaling to a unit diagonal, in plain floating point.
fn room(checked: &Checked, place: usize) -> f64 {
    let mut out = f64::NAN;
    let mut at = 0;
    for_each_condition::<Interval>(&checked.model, &checked.certificate, |statement| {
        if at == place {
            out = scaled_smallest_eigenvalue(&statement.matrix);
        }
        at += 1;
    });
    out
}

#[derive(Default, Debug)]
struct Tally {
    invalid: usize,
    proved: usize,
    refused: usize,
    conditions_compared: usize,
    /// True conditions refused, all with less than [`ROOM`].
    close: usize,
}

impl Tally {
    /// Compares the check with the oracle at the chosen conditions.
    fn compare(&mut self, change: &Change, checked: &Checked, chosen: impl Fn(usize) -> bool) {
        for (place, holds) in truth(checked, chosen) {
            let condition = &checked.report.conditions[place];
            let (name, proved) = (&condition.name, condition.margin >= 0.0);
            let what = format!("{:?} = {:e}: {name}", change.paths, change.value);
            assert!(holds || !proved, "a false proof: {what}");
            if holds && !proved {
                let room = room(checked, place);
                assert!(room < ROOM, "true with room {room:e}, yet refused: {what}");
                self.close += 1;
            }
            self.conditions_compared += 1;
        }
    }

    fn count(&mut self, change: &Change, answer: &Answer) {
        match answer {
            Answer::Invalid(reason) => {
                assert!(reason.contains("field"), "{:?}: {reason}", change.paths);
                self.invalid += 1;
            }
            Answer::Checked(checked) => match checked.report.verdict {
                Verdict::Proved => self.proved += 1,
                Verdict::NotProved => self.refused += 1,
            },
        }
    }
}

#[test]
fn the_check_of_a_tampered_double_integrator_agrees_with_exact_arithmetic() {
    let design = double_integrator();
    let mut tally = Tally::default();
    let by = [&TEN_PERCENT[..], &GROSS[..]].concat();
    for change in changes(design, &by) {
        let answer = answer(&change.text(design));
        tally.count(&change, &answer);
        if let Answer::Checked(checked) = &answer {
            tally.compare(&change, checked, |_| true);
        }
    }
    assert!(
        tally.proved > 10 && tally.refused > 50 && tally.invalid > 20,
        "{tally:?}"
    );
}

/// Changes a xu2020 design; of `sampled` answers of each kind the conditions nearest to the
/// borderline and one at random are compared with the oracle.
fn tamper_with_xu2020(by: &[fn(f64) -> f64], sampled: usize, seed: u64) -> Tally {
    let design = xu2020();
    let mut tally = Tally::default();
    let mut kept: [Vec<(Change, Box<Checked>)>; 2] = [Vec::new(), Vec::new()];
    for change in changes(design, by) {
        let answer = answer(&change.text(design));
        tally.count(&change, &answer);
        if let Answer::Checked(checked) = answer {
            let kind = usize::from(checked.report.verdict == Verdict::Proved);
            kept[kind].push((change, checked));
        }
    }
    let mut stream = Stream(seed);
    for kind in &kept {
        for _ in 0..sampled.min(kind.len()) {
            let (change, checked) = &kind[stream.integer(0, kind.len() as i64 - 1) as usize];
            let margins = &checked.report.conditions;
            let nearest = |wanted: &dyn Fn(f64) -> bool| {
                let places = (0..margins.len()).filter(|&place| wanted(margins[place].margin));
                places.min_by(|&a, &b| margins[a].margin.abs().total_cmp(&margins[b].margin.abs()))
            };
            let proved = nearest(&|margin| margin >= 0.0);
            let refused = nearest(&|margin| margin < 0.0);
            let random = Some(stream.integer(0, margins.len() as i64 - 1) as usize);
            let chosen = [proved, refused, random];
            tally.compare(change, checked, |place| chosen.contains(&Some(place)));
        }
    }
    tally
}

#[test]
fn the_check_of_xu2020_with_any_number_off_by_ten_percent_agrees_with_exact_arithmetic() {
    let tally = tamper_with_xu2020(&TEN_PERCENT, 8, 10);
    assert!(
        tally.proved > 20 && tally.refused > 100 && tally.invalid > 20,
        "{tally:?}"
    );
}

#[test]
fn the_check_of_xu2020_with_any_number_grossly_wrong_agrees_with_exact_arithmetic() {
    let tally = tamper_with_xu2020(&GROSS, 8, 30);
    assert!(
        tally.proved > 5 && tally.refused > 100 && tally.invalid > 20,
        "{tally:?}"
    );
}

#[test]
fn a_verdict_in_the_file_is_not_believed() {
    let mut design = double_integrator().clone();
    assert_eq!(design["verdict"]["verdict"], "proved");
    design["certificate"]["gamma"] = Value::from(1e-6);
    let Answer::Checked(checked) = answer(&design.to_string()) else {
        panic!("the file is valid");
    };
    assert_eq!(checked.report.verdict, Verdict::NotProved);
    let names: Vec<&str> = checked
        .report
        .conditions
        .iter()
        .filter(|condition| condition.margin < 0.0)
        .map(|condition| condition.name.as_str())
        .collect();
    assert_eq!(names, ["peak gain", "gain bound above disturbance weight"]);
}

#[test]
fn numbers_outside_the_proof_do_not_change_the_verdict() {
    let design = double_integrator();
    let mut paths = Vec::new();
    for part in ["verdict", "provenance"] {
        numbers(&design[part], &format!("/{part}"), &mut paths);
    }
    assert!(paths.len() > 10);
    for path in paths {
        let mut changed = design.clone();
        let number = changed.pointer_mut(&path).expect("a path of the design");
        *number = match number.is_u64() {
            true => Value::from(77),
            false => Value::from(-0.5),
        };
        let Answer::Checked(checked) = answer(&changed.to_string()) else {
            panic!("{path} makes the file invalid");
        };
        assert_eq!(checked.report.verdict, Verdict::Proved, "{path}");
    }
}

#[test]
fn the_proof_imports_nothing_from_synthesis() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/certify");
    let folders = [folder.to_string(), format!("{folder}/infeasible")];
    let mut files = 0;
    for entry in folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).expect("a folder"))
    {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|kind| kind == "rs") {
            let text = std::fs::read_to_string(&path).expect("a text");
            for module in ["conditions", "reduce", "scaling", "synthesis", "programs"] {
                let name = format!("crate::{module}::");
                assert!(!text.contains(&name), "{name} in {}", path.display());
            }
            files += 1;
        }
    }
    assert!(files > 8, "{files}");
}
