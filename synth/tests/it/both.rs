//! One gain, two certificates: the check of a tampered design agrees with exact rational arithmetic.

use std::sync::OnceLock;

use crate::exact::{Exact, Stream};
use crate::tampering::*;
use serde_json::{json, Value};
use synth::certify::theorem1::{for_each_condition, for_each_hand_over_condition};
use synth::certify::{Report, Verdict};
use synth::design::DesignFile;
use synth::model::Model;
use synth::solve::Solver;
use synth::synthesis::{synthesize, Form, Outcome, Solvers};

/// The design of models/xu2020-both.json for one choice of the search.
fn design() -> &'static Value {
    static DESIGN: OnceLock<Value> = OnceLock::new();
    DESIGN.get_or_init(|| {
        let text = include_str!("../../../models/xu2020-both.json");
        let mut file: Value = serde_json::from_str(text).expect("JSON");
        file["specs"]["outer"]["inner_scale"] = json!(1.0 / 6.0);
        file["specs"]["outer"]["containment_weight"] = json!(0.5);
        let text = file.to_string();
        let model = Model::from_json(&text).expect("a valid model");
        match synthesize(
            &model,
            &text,
            &Solvers::both([Solver::Clarabel, Solver::Structured]),
            None,
        ) {
            Ok(Outcome::Solved(design)) => {
                assert_eq!(design.report.verdict, Verdict::Proved);
                serde_json::from_str(&design.file.to_json()).expect("a design file is JSON")
            }
            other => panic!("no design: {other:?}"),
        }
    })
}

#[test]
fn the_structured_solver_alone_proves_both_certificates() {
    let text = include_str!("../../../models/xu2020-both.json");
    let model = Model::from_json(text).expect("a valid model");
    let alone = Solvers::named(Solver::Structured, Form::VertexRelaxed);
    match synthesize(&model, text, &alone, None) {
        Ok(Outcome::Solved(design)) => {
            assert_eq!(design.report.verdict, Verdict::Proved);
            let gain = design.file.certificate.guaranteed_gain;
            assert!((0.5..0.6).contains(&gain), "{gain}");
        }
        other => panic!("no design: {other:?}"),
    }
}

/// Name and exact truth of every condition that `chosen` picks by its place in the report.
fn truth(
    file: &DesignFile,
    model: &Model,
    report: &Report,
    chosen: &[usize],
) -> Vec<(usize, bool)> {
    let inner = file.certificate(model).expect("read before");
    let outer = file.large_set_certificate(model).expect("read before");
    let outer = outer.expect("two certificates");
    let mut out = Vec::new();
    let mut place = 0;
    let parts = [
        (model, &inner, ""),
        (&outer.model, &outer.certificate, "outer "),
    ];
    for (model, certificate, prefix) in parts {
        for_each_condition::<Exact>(model, certificate, |statement| {
            let name = format!("{prefix}{}", statement.name);
            assert_eq!(name, report.conditions[place].name);
            if chosen.contains(&place) {
                out.push((place, exactly_positive_definite(&statement.matrix)));
            }
            place += 1;
        });
    }
    let hand_over = outer
        .hand_over
        .as_ref()
        .expect("the design proves a hand-over");
    let large = (&outer.model, &outer.certificate);
    for_each_hand_over_condition::<Exact>(
        large,
        (model, &inner),
        hand_over,
        &mut |name, matrix| {
            assert_eq!(name, report.conditions[place].name);
            if chosen.contains(&place) {
                out.push((place, exactly_positive_definite(&matrix)));
            }
            place += 1;
        },
    );
    assert_eq!(place, report.conditions.len());
    out
}

/// Every number that the proof reads, the outer certificate's included.
fn paths() -> Vec<String> {
    let mut out = numbers_of_proof(design());
    numbers(&design()["outer"], "/outer", &mut out);
    out
}

#[test]
fn the_check_of_two_certificates_agrees_with_exact_arithmetic_after_tampering() {
    let paths = paths();
    let by: [fn(f64) -> f64; 5] = [|x| 1.1 * x, |x| 0.9 * x, |x| -x, |_| 0.0, |x| 3.0 * x];
    let mut stream = Stream(22);
    let (mut proved, mut refused, mut compared) = (0, 0, 0);
    for _ in 0..120 {
        let path = &paths[stream.integer(0, paths.len() as i64 - 1) as usize];
        let change = by[stream.integer(0, 4) as usize];
        let before = design()
            .pointer(path)
            .and_then(Value::as_f64)
            .expect("a number");
        let changes = [
            vec![path.clone()],
            mirrored(path).map_or(vec![], |other| vec![path.clone(), other]),
        ];
        for paths in changes.into_iter().filter(|paths| !paths.is_empty()) {
            let value = change(before);
            let text = Change { paths, value }.text(design());
            let Ok((file, model)) = DesignFile::from_json(&text) else {
                continue;
            };
            let report = file.verify(&model).expect("read before");
            match report.verdict {
                Verdict::Proved => proved += 1,
                Verdict::NotProved => refused += 1,
            }
            let margins = &report.conditions;
            let nearest = |wanted: bool| {
                let places = (0..margins.len()).filter(|&k| (margins[k].margin >= 0.0) == wanted);
                places.min_by(|&a, &b| margins[a].margin.abs().total_cmp(&margins[b].margin.abs()))
            };
            if stream.integer(0, 3) > 0 {
                continue;
            }
            let chosen: Vec<usize> = nearest(true).into_iter().chain(nearest(false)).collect();
            for (place, holds) in truth(&file, &model, &report, &chosen) {
                let condition = &margins[place];
                let says = condition.margin >= 0.0;
                assert!(
                    holds || !says,
                    "a false proof: {path} = {value:e}: {}",
                    condition.name
                );
                compared += 1;
            }
        }
    }
    assert!(
        proved > 3 && refused > 30 && compared > 10,
        "{proved} {refused} {compared}"
    );
}

#[test]
fn both_certificates_must_be_proved() {
    for path in ["/certificate/gamma", "/outer/certificate/gamma"] {
        let mut changed = design().clone();
        *changed.pointer_mut(path).expect("a path") = json!(1e-6);
        let (file, model) = DesignFile::from_json(&changed.to_string()).expect("a valid file");
        let report = file.verify(&model).expect("a valid file");
        assert_eq!(report.verdict, Verdict::NotProved, "{path}");
    }
}
