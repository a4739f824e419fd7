//! Designs for loops with imperfections: proved, confirmed in exact arithmetic, and refused where a number is changed.

mod tamper;

use synth::certify::theorem1::Certificate;
use synth::certify::{check, check_exactly, Verdict};
use synth::design::DesignFile;
use synth::feasibility::{decide, Answer};
use synth::model::{Model, PlantFile};
use synth::synthesis::{synthesize, Outcome, Solvers};

const CART: &str = r#"{
    "schema_version": 1, "name": "cart",
    "plant": { "vertices": {
        "state_matrices": [[[0, 1], [0, 0]], [[0, 1], [0, -0.1]]],
        "input_matrix": [[0], [1]], "input_limit": [1], "disturbance_bound": 0.02,
        "box": [{ "row": [1, 0], "bound": 1 }, { "row": [0, 1], "bound": 1 }]
    } },
    "specs": { "phi_per_s": 0.1, "hbar_s": 0.05, "nu": 0.05, "xi_max": 100, "objective": "gamma",
               "trigger_floor": "auto" },
    "imperfections": { "measurement": { "state": [1e-4, 1e-4] }, "delay_s": 0.02, "lost_in_a_row": 1,
                       "effectiveness": [0.9, 1.1] }
}"#;

/// A proved design of a model.
fn design_of(text: &str) -> DesignFile {
    let model = Model::from_json(text).expect("a valid model");
    let solvers = Solvers::suited_to(&model);
    let Ok(Outcome::Solved(design)) = synthesize(&model, text, &solvers, None) else {
        panic!("no design of {text}");
    };
    assert_eq!(design.report.verdict, Verdict::Proved);
    design.file
}

/// The model of the cart and the certificate of its design, as a reader of its file gets them.
fn designed() -> (Model, Certificate) {
    let file = design_of(CART);
    let own = Model::new(file.model.clone()).expect("a valid model");
    let certificate = file.certificate(&own).expect("a certificate");
    (own, certificate)
}

#[test]
fn a_design_with_every_imperfection_is_proved_and_exact_arithmetic_confirms_it() {
    let (model, certificate) = designed();
    assert!(certificate.measurement.is_some() && certificate.first_torque.is_some());
    assert_eq!(certificate.gain_error_weight.len(), 1);
    assert!(certificate.trigger_floor > 0.0);
    let exact = check_exactly(&model, &certificate);
    assert_eq!(exact.verdict, Verdict::Proved, "{:?}", exact.failed);
}

/// Multiplies some numbers of a certificate by a factor.
type Change = fn(&mut Certificate, f64);

#[test]
fn a_weight_that_promises_too_much_is_refused() {
    let (model, certificate) = designed();
    let refused: [(&str, Change, f64); 5] = [
        (
            "error weight",
            |one, by| one.measurement.as_mut().expect("weights").error_weight *= by,
            1.01,
        ),
        (
            "sample weight",
            |one, by| one.measurement.as_mut().expect("weights").sample_weight *= by,
            0.9,
        ),
        (
            "growth",
            |one, by| one.first_torque.as_mut().expect("numbers").growth *= by,
            0.5,
        ),
        ("floor", |one, by| one.trigger_floor *= by, 1e6),
        ("guaranteed gain", |one, by| one.guaranteed_gain *= by, 0.5),
    ];
    for (name, change, by) in refused {
        let mut changed = certificate.clone();
        change(&mut changed, by);
        let verdict = check(&model, &changed).verdict;
        assert_eq!(verdict, Verdict::NotProved, "{name} times {by}");
    }
}

#[test]
fn a_worse_loop_than_the_proved_one_is_refused() {
    let (model, certificate) = designed();
    let worse: [fn(&mut synth::model::Imperfections); 4] = [
        |one| one.measurement.as_mut().expect("bounds").state = Some(vec![1e-1, 1e-1]),
        |one| one.delay_s = 0.5,
        |one| one.lost_in_a_row = 20,
        |one| one.effectiveness = Some(synth::model::Effectiveness::Common([0.3, 1.7])),
    ];
    for change in worse {
        let mut file = model.file.clone();
        change(&mut file.imperfections);
        let changed = Model::new(file).expect("a valid model");
        assert_eq!(check(&changed, &certificate).verdict, Verdict::NotProved);
        assert_eq!(
            check_exactly(&changed, &certificate).verdict,
            Verdict::NotProved
        );
    }
}

#[test]
fn a_model_with_a_measurement_error_or_a_network_is_feasible() {
    let xu2020 = include_str!("../../../models/xu2020.json");
    let cases = [
        (CART, r#"{ "measurement": { "state": [1e-4, 1e-4] } }"#),
        (CART, r#"{ "delay_s": 0.02 }"#),
        (CART, r#"{ "lost_in_a_row": 1 }"#),
        (
            xu2020,
            r#"{ "measurement": { "rate_rad_s": 1e-5, "attitude_deg": 0.01 } }"#,
        ),
        (xu2020, r#"{ "delay_s": 0.02, "lost_in_a_row": 2 }"#),
    ];
    let mut models = vec![Model::from_json(CART).expect("a valid model")];
    for (text, imperfections) in cases {
        let mut file = Model::from_json(text).expect("a valid model").file;
        file.imperfections = serde_json::from_str(imperfections).expect("imperfections");
        file.specs.trigger_floor = None;
        models.push(Model::new(file).expect("a valid model"));
    }
    for model in models {
        let decision = decide(&model, "", &Solvers::suited_to(&model), None).expect("a decision");
        let Answer::Feasible(design) = decision.answer else {
            panic!("{:?}: {:?}", model.file.imperfections, decision.answer);
        };
        assert_eq!(design.report.verdict, Verdict::Proved);
        // The same model, with a form of the gyroscopic torque where that is free.
        let mut expected = model.file.clone();
        if let (PlantFile::Exact(own), PlantFile::Exact(found)) =
            (&mut expected.plant, &design.file.model.plant)
        {
            own.gyroscopic_form_kg_m2 = found.gyroscopic_form_kg_m2;
        }
        assert_eq!(design.file.model, expected);
    }
}
