//! Scheduled gains: the slack form of the mismatch bound says what it must, in both forms.

use nalgebra::DMatrix;
use synth::certify::theorem1::Certificate;
use synth::certify::{check, Verdict};
use synth::design::ProblemUnits;
use synth::fuzzy::VertexSystem;
use synth::model::{GainForm, Mismatch, Model, Plant};
use synth::solve::{Backend, Clarabel, DenseColumns, Solver, Status};
use synth::synthesis::{assemble, scaled_task, synthesize, Form, Goal, Outcome, Solvers};

/// The units in which the designs of this model are proved.
const UNITS: ProblemUnits = ProblemUnits::of_fraction(2.0, 1.0);

fn model(kappa: f64) -> Model {
    let text = include_str!("../../../models/two-rules.json");
    let mut file = Model::from_json(text).expect("the shipped model").file;
    file.gains = GainForm::Scheduled;
    file.mismatch = Mismatch::Kappa(kappa);
    Model::new(file).expect("a valid model")
}

fn proved(model: &Model) -> Certificate {
    let outcome = synthesize(
        model,
        "",
        &Solvers::both([Solver::Clarabel, Solver::Structured]),
        None,
    );
    let Ok(Outcome::Solved(design)) = outcome else {
        panic!("{outcome:?}");
    };
    assert_eq!(design.report.verdict, Verdict::Proved);
    design.file.certificate(model).expect("a valid certificate")
}

/// The same plant with one vertex: A at the given weights.
fn frozen(model: &Model, weights: [f64; 2]) -> Model {
    let Plant::Rules(rules) = &model.plant else {
        panic!("a model of rules");
    };
    let [a1, a2] = [0, 1].map(|rule| &rules.system.state_matrices[rule]);
    let mut file = model.file.clone();
    file.gains = GainForm::Constant;
    file.mismatch = Mismatch::None;
    Model {
        file,
        plant: Plant::Vertices(VertexSystem {
            state_matrices: vec![a1 * weights[0] + a2 * weights[1]],
            ..rules.system.clone()
        }),
    }
}

/// The same certificate with the constant gain at the given weights.
fn held(certificate: &Certificate, weights: [f64; 2]) -> Certificate {
    let gains: Vec<&DMatrix<f64>> = certificate.gains().collect();
    Certificate {
        gain: gains[0] * weights[0] + gains[1] * weights[1],
        further: Vec::new(),
        mismatch: Vec::new(),
        ..certificate.clone()
    }
}

#[test]
fn what_is_proved_with_slack_holds_for_every_admitted_pair_of_memberships() {
    let kappa = 0.2;
    let model = model(kappa);
    let certificate = proved(&model);
    assert_eq!(
        (certificate.further.len(), certificate.mismatch.len()),
        (1, 2)
    );
    for step in 0..=20 {
        let now = f64::from(step) / 20.0;
        for shift in [-kappa, -0.5 * kappa, 0.0, 0.5 * kappa, kappa] {
            let sent = now + shift;
            if !(0.0..=1.0).contains(&sent) {
                continue;
            }
            let plant = frozen(&model, [now, 1.0 - now]);
            let controller = held(&certificate, [sent, 1.0 - sent]);
            let report = check(&plant, &controller);
            assert_eq!(report.verdict, Verdict::Proved, "{now} {sent} {report:?}");
        }
    }
}

#[test]
fn the_gains_differ_and_their_exchange_is_not_covered() {
    let model = model(0.0);
    let certificate = proved(&model);
    // Full mismatch, which kappa = 0 excludes, breaks the bound that was proved.
    let plant = frozen(&model, [1.0, 0.0]);
    let controller = held(&certificate, [0.0, 1.0]);
    assert_eq!(check(&plant, &controller).verdict, Verdict::NotProved);
}

#[test]
fn a_certificate_without_its_slack_is_not_proved() {
    let model = model(0.2);
    let mut certificate = proved(&model);
    certificate.mismatch.clear();
    let report = check(&model, &certificate);
    assert_eq!(report.verdict, Verdict::NotProved);
    let worst = report.worst().expect("a condition");
    assert!(worst.name.contains("slack present"), "{worst:?}");
}

#[test]
fn full_and_reduced_form_have_the_same_optimum() {
    for kappa in [0.0, 0.2] {
        let (_, task) = scaled_task(&model(kappa), &UNITS);
        let smallest = |form, dense_columns| {
            let problem = assemble(&task, form, Goal::SmallestGain).problem.lower();
            let backend = Clarabel { dense_columns };
            let accuracy = Goal::SmallestGain.accuracy(&task);
            let solution = backend.solve(&problem, accuracy, None).expect("a run");
            let usable = matches!(solution.status, Status::Solved | Status::Inaccurate);
            assert!(usable, "{}", solution.status_text);
            solution.objective
        };
        let full = smallest(Form::Full, DenseColumns::None);
        let reduced = smallest(Form::Chordal, DenseColumns::default());
        // The full form has the sector unknowns too, with margins of their own.
        assert!((full - reduced).abs() < 0.02 * reduced, "{full} {reduced}");
    }
}
