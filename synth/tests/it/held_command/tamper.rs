//! Proofs with one number changed.

use super::{proof_of, wu};
use crate::exact::{Exact, Stream};
use crate::numbers::numbers;
use crate::tampering::{exactly_positive_definite, mirrored, Change};
use serde_json::{json, Value};
use synth::certify::held_command::for_each_condition;
use synth::certify::Verdict;
use synth::held_command::{CommandProof, HeldCommandDesignFile};

fn changed(by: impl FnOnce(&mut Value)) -> CommandProof {
    let mut design = wu().clone();
    by(&mut design);
    proof_of(&design)
}

fn scale(design: &mut Value, path: &str, factor: f64) {
    let number = design.pointer_mut(path).expect("a number of the design");
    *number = json!(number.as_f64().expect("a number") * factor);
}

/// Multiplies every number below a path.
fn scale_all(design: &mut Value, path: &str, factor: f64) {
    let mut paths = Vec::new();
    let part = design.pointer(path).expect("a part of the design");
    numbers(part, path, &mut paths);
    for path in paths {
        scale(design, &path, factor);
    }
}

#[track_caller]
fn assert_refused(what: &str, proof: &CommandProof) {
    let report = proof.verify();
    assert_eq!(report.verdict, Verdict::NotProved, "{what}");
    assert_eq!(proof.verify_exactly().verdict, Verdict::NotProved, "{what}");
}

#[test]
fn what_the_proof_is_about_off_by_five_per_cent_is_refused() {
    let worse = [
        ("/controller/trigger/command/relative", 1.05),
        ("/model/plant/exact/torque_limit_nm/0", 0.95),
        ("/model/plant/exact/disturbance_bound_nm", 1.05),
        ("/model/specs/phi_per_s", 1.05),
        ("/model/specs/command_trigger/final/phi_per_s", 1.05),
        ("/model/plant/exact/rate_rad_s/0", 0.95),
        ("/certificate/within_limit", 1.05),
        ("/certificate/certified_vector_part", 1.05),
        ("/hand_over/certificate/final_bounds/vector_part", 0.95),
        ("/hand_over/level", 0.95),
    ];
    for (path, factor) in worse {
        let proof = changed(|design| scale(design, path, factor));
        assert_refused(path, &proof);
    }
}

#[test]
fn a_larger_set_from_the_same_numbers_is_refused() {
    for path in ["/certificate/lyapunov", "/hand_over/certificate/lyapunov"] {
        let proof = changed(|design| scale_all(design, path, 0.95));
        assert_refused(path, &proof);
    }
}

#[test]
fn without_the_multipliers_of_the_annihilator_the_proof_is_refused() {
    for part in ["/certificate", "/hand_over/certificate"] {
        for name in ["annihilator_state", "annihilator_rate"] {
            let path = format!("{part}/{name}");
            let proof = changed(|design| scale_all(design, &path, 0.0));
            assert_eq!(proof.verify().verdict, Verdict::NotProved, "{path}");
        }
    }
}

/// Whether every condition that the check proves with the least margin holds in truth.
fn nearest_hold(proof: &CommandProof, count: usize) -> bool {
    let report = proof.verify();
    let mut places: Vec<usize> = (0..report.conditions.len()).collect();
    places.sort_by(|&a, &b| {
        let margin = |place: usize| report.conditions[place].margin;
        margin(a).total_cmp(&margin(b))
    });
    let chosen = &places[..count.min(places.len())];
    let mut place = 0;
    let mut holds = true;
    for_each_condition::<Exact>(&proof.stages(), &mut |_, matrix| {
        if chosen.contains(&place) {
            holds &= exactly_positive_definite(&matrix);
        }
        place += 1;
    });
    holds
}

#[test]
fn a_thousand_changes_of_single_numbers_are_never_proved_against_exact_arithmetic() {
    let design = wu();
    let mut paths = Vec::new();
    for part in ["model", "controller", "certificate", "hand_over"] {
        numbers(&design[part], &format!("/{part}"), &mut paths);
    }
    let mut stream = Stream(41);
    let (mut proved, mut refused, mut invalid) = (0, 0, 0);
    for round in 0..1000 {
        let path = &paths[stream.integer(0, paths.len() as i64 - 1) as usize];
        let before = design
            .pointer(path)
            .and_then(Value::as_f64)
            .expect("a number");
        let exponent = -8.0 * (0.5 + 0.5 * stream.signed_unit());
        let value = before * (1.0 + 10.0_f64.powf(exponent) * stream.signed_unit().signum());
        let mut paths = vec![path.clone()];
        paths.extend(mirrored(path));
        let change = Change { paths, value };
        let text = change.text(design);
        let Ok((_, proof)) = HeldCommandDesignFile::from_json(&text) else {
            invalid += 1;
            continue;
        };
        match proof.verify().verdict {
            Verdict::NotProved => refused += 1,
            Verdict::Proved => {
                proved += 1;
                // The rest of the conditions keep more room; a tenth of the changes decides all of them.
                let holds = match round % 40 {
                    0 => proof.verify_exactly().verdict == Verdict::Proved,
                    _ => nearest_hold(&proof, 2),
                };
                assert!(holds, "a false proof: {:?} = {value:e}", change.paths);
            }
        }
    }
    println!("{proved} proved, {refused} refused, {invalid} invalid");
    assert!(proved > 50 && refused > 50, "{proved} {refused} {invalid}");
}
