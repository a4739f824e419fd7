//! Given gains with a trigger on the command: the chain of two certificates, its check, and what simulation shows.

mod falsification;
mod loop_with_command;
mod tamper;

use std::sync::OnceLock;

use serde_json::Value;
use synth::certify::reach::{angle_above_vector_part_deg, angle_of_vector_part_deg};
use synth::certify::Verdict;
use synth::held_command::{
    synthesize, CommandProof, CommandRequest, HeldCommandDesignFile, HeldCommandOutcome,
};
use synth::model::{GainsFile, GivenTrigger, Model};
use synth::solve::Solver;
use synth::synthesis::Solvers;

/// The design file that `analyse` writes for a model and gains.
fn analysed(gains_text: &str, model_text: &str) -> Value {
    let gains = GainsFile::from_json(gains_text).expect("valid gains");
    let model = Model::from_json(model_text).expect("a valid model");
    let Some(GivenTrigger::Command(trigger)) = gains.trigger else {
        panic!("gains with a trigger on the command");
    };
    let request = CommandRequest {
        model: &model,
        model_text,
        gain: &gains.gains[0],
        trigger,
        gains_text,
    };
    let solvers = Solvers::both([Solver::Structured, Solver::Clarabel]);
    let outcome = synthesize(&request, &solvers, None).expect("a synthesis");
    let HeldCommandOutcome::Solved(design) = outcome else {
        panic!("no proof was found");
    };
    serde_json::from_str(&design.file.to_json()).expect("a design file is JSON")
}

fn wu() -> &'static Value {
    static DESIGN: OnceLock<Value> = OnceLock::new();
    DESIGN.get_or_init(|| {
        analysed(
            include_str!("../../../../models/wu2018-gains.json"),
            include_str!("../../../../models/wu2018-plant.json"),
        )
    })
}

fn pd() -> &'static Value {
    static DESIGN: OnceLock<Value> = OnceLock::new();
    DESIGN.get_or_init(|| {
        analysed(
            include_str!("../../../../models/pd-gains.json"),
            include_str!("../../../../models/pd-plant.json"),
        )
    })
}

fn proof_of(design: &Value) -> CommandProof {
    let read = HeldCommandDesignFile::from_json(&design.to_string());
    read.expect("a valid design file").1
}

/// The angle at rest on every axis and the bound in the end (deg), both proved.
#[track_caller]
fn proved_angles(design: &Value) -> (f64, f64) {
    let proof = proof_of(design);
    let report = proof.verify();
    let worst = report.worst().expect("conditions");
    assert_eq!(report.verdict, Verdict::Proved, "{worst:?}");
    (
        angle_of_vector_part_deg(proof.certificate.certified_vector_part),
        angle_above_vector_part_deg(proof.last().final_bounds.vector_part),
    )
}

#[test]
fn the_law_of_wu_2018_as_shipped_is_proved_from_27_6_deg_at_rest_to_0_11_deg_in_the_end() {
    let (start, end) = proved_angles(wu());
    println!("from {start:.3} deg to {end:.4} deg");
    assert!(start >= 27.6, "{start}");
    assert!(end <= 0.11, "{end}");
}

#[test]
fn a_plain_pd_law_with_a_trigger_is_proved_from_81_deg_at_rest_to_0_67_deg_in_the_end() {
    let (start, end) = proved_angles(pd());
    println!("from {start:.3} deg to {end:.4} deg");
    assert!(start >= 81.0, "{start}");
    assert!(end <= 0.67, "{end}");
}

#[test]
fn exact_arithmetic_agrees_with_both_proofs() {
    for design in [wu(), pd()] {
        let proof = proof_of(design);
        let exact = proof.verify_exactly();
        assert_eq!(exact.verdict, Verdict::Proved, "{:?}", exact.failed);
        assert_eq!(exact.conditions, proof.verify().conditions.len());
    }
}
