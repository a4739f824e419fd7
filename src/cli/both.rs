//! Designs with two certificates: `synthesize --objective both`, and what is told of them.

use std::process::ExitCode;

use nalgebra::DVector;
use serde_json::{json, Value};
use synth::certify::theorem1::Certificate;
use synth::design::{DesignFile, LargeSetCertificate, SolverRun};
use synth::model::Model;
use synth::synthesis::{
    synthesize_two_certificates, Outcome, TriedCoupling, TwoCertificatesOutcome,
};

use super::progress::SolverProgress;
use super::synthesize::{describe_run, solver_problem, Ending, SynthesizeArgs};
use super::{feasibility, print, CliError, EXIT_NO, EXIT_SOLVER};
use crate::harness::design::certified_angle_deg;

/// Designs, writes and proves both certificates. 0: proved; 2: none found or not proved; 3: the solver
/// failed.
pub fn synthesize(
    args: &SynthesizeArgs,
    ending: &Ending,
    text: &str,
) -> Result<ExitCode, CliError> {
    if args.cross_check {
        let reason =
            "--cross-check compares designs with one certificate; with --objective both it \
                      has no meaning";
        return Err(CliError::unsuitable(&args.model, reason));
    }
    let progress = SolverProgress::start("assembling the conditions");
    let observer = Some(progress.observer());
    let backend = args.solver.backend_for(ending.form);
    let found =
        synthesize_two_certificates(ending.model, text, ending.form, backend.as_ref(), observer);
    drop(progress);
    match found.map_err(|error| solver_problem(&args.model, error))? {
        TwoCertificatesOutcome::Solved(design, _) => ending.tell(Outcome::Solved(design)),
        TwoCertificatesOutcome::None {
            infeasible,
            tried,
            blocking,
            runs,
        } => {
            tell_none(ending, infeasible, &tried, &blocking, &runs);
            Ok(ExitCode::from(match infeasible {
                true => EXIT_NO,
                false => EXIT_SOLVER,
            }))
        }
    }
}

fn tell_none(
    ending: &Ending,
    infeasible: bool,
    tried: &[TriedCoupling],
    blocking: &[(String, f64)],
    runs: &[SolverRun],
) {
    let status = if infeasible { "undecided" } else { "failed" };
    if ending.json {
        let shares = blocking.iter();
        let shares: Vec<Value> = shares
            .map(|(name, share)| json!({ "name": name, "share": share }))
            .collect();
        let report = json!({
            "status": status,
            "verdict": "not_proved",
            "gamma": null,
            "guaranteed_gain": null,
            "xi": null,
            "form": ending.form.name(),
            "vertices": ending.model.task().system.vertices.len(),
            "conditions": [],
            "certified_angle_deg": null,
            "outer": null,
            "feasibility": "undecided",
            "blocking": shares,
            "attempts": tried.len(),
            "solve_seconds": runs.iter().map(|run| run.seconds).sum::<f64>(),
            "solver_runs": runs,
        });
        print(&report.to_string());
        return;
    }
    let model = ending.model_path.display();
    print(&match infeasible {
        true => format!(
            "{model}: UNDECIDED: no design with both certificates was found, and none was proved not to exist"
        ),
        false => format!("{model}: the solvers failed numerically"),
    });
    runs.iter().for_each(|run| print(&describe_run(run)));
    for line in feasibility::blocking_lines(blocking) {
        print(&line);
    }
    print("nothing written");
}

/// The outer certificate's numbers; null for a design with one certificate.
pub fn outer_json(design: &DesignFile, model: &Model) -> Value {
    let Some(outer) = outer_of(design, model) else {
        return Value::Null;
    };
    let certificate = &outer.certificate;
    json!({
        "gamma": certificate.gain_bound,
        "guaranteed_gain": certificate.guaranteed_gain,
        "xi": certificate.disturbance_weight,
        "certified_angle_deg": certified_angle_deg(certificate.certified_vector_part),
        "trigger_multiple": certificate.trigger_multiple,
        "start_levels": start_levels(&outer),
    })
}

/// The same in words; none for a design with one certificate.
pub fn outer_lines(design: &DesignFile, model: &Model) -> Vec<String> {
    let Some(outer) = outer_of(design, model) else {
        return Vec::new();
    };
    let certificate = &outer.certificate;
    let mut lines = vec![format!(
        "outer certificate: gamma {:.6}, guaranteed gain {:.6}",
        certificate.gain_bound, certificate.guaranteed_gain
    )];
    if let Some(angle) = certified_angle_deg(certificate.certified_vector_part) {
        lines.push(format!(
            "outer certified set: every attitude at rest up to {angle:.3} deg"
        ));
    }
    for (index, level) in start_levels(&outer).iter().enumerate() {
        lines.push(format!(
            "outer start {}: x'Ux = {level:.6} (the set: at most 1)",
            index + 1
        ));
    }
    lines
}

/// A file that was read has been checked, so its outer certificate can be read again.
fn outer_of(design: &DesignFile, model: &Model) -> Option<LargeSetCertificate> {
    design.large_set_certificate(model).ok().flatten()
}

/// x'Ux at each start that the outer set must contain.
fn start_levels(outer: &LargeSetCertificate) -> Vec<f64> {
    let level = |certificate: &Certificate, state: &Vec<f64>| {
        let state = DVector::from_column_slice(state);
        (state.transpose() * &certificate.lyapunov * &state)[(0, 0)]
    };
    let starts = outer.model.file.specs.must_contain.iter();
    starts
        .map(|state| level(&outer.certificate, state))
        .collect()
}
