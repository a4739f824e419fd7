//! `steadfast verify FILE.json`

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;
use synth::certify::{ConditionMargin, Report, Verdict};
use synth::model::{kind_of, Kind};

use super::reach::Reach;
use super::{both, feasibility, files, print, problem, CliError, EXIT_NO};
use crate::harness::design::certified_angle_deg;
use crate::harness::transmissions::TransmissionBound;

/// Arguments of `verify`.
#[derive(clap::Args)]
pub struct VerifyArgs {
    /// Design file or infeasibility certificate
    file: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Proves a design, or that none exists, from a file alone. 0: proved; 2: not proved.
pub fn run(args: &VerifyArgs) -> Result<ExitCode, CliError> {
    let text = files::text(&args.file)?;
    match kind_of(&text) {
        Some(Kind::Infeasibility) => feasibility::verify(&args.file, &text, args.json),
        Some(Kind::ProblemDesign) => problem::verify(&args.file, &text, args.json),
        _ => design(args, &text),
    }
}

fn design(args: &VerifyArgs, text: &str) -> Result<ExitCode, CliError> {
    let (design, model) = files::design_of(&args.file, text)?;
    let report = design
        .verify(&model)
        .map_err(|problem| CliError::value(&args.file, problem))?;
    let transmissions = TransmissionBound::of_model(&model);
    let reach = Reach::of(&design, &model, report.verdict);
    if args.json {
        let worst = report.worst();
        print(
            &json!({
                "verdict": report.verdict,
                "worst": worst,
                "gamma": design.certificate.gamma,
                "guaranteed_gain": design.certificate.guaranteed_gain,
                "xi": design.certificate.xi,
                "certified_angle_deg": certified_angle_deg(design.certificate.certified_vector_part),
                "min_inter_event_s": transmissions.min_inter_event_s,
                "max_transmissions_per_s": transmissions.max_transmissions_per_s,
                "outer": both::outer_json(&design, &model),
                "certified_angle_any_axis_deg": reach.any_axis_deg,
                "certified_angle_along_deg": reach.along_deg(),
                "must_contain": reach.states(),
                "conditions": report.conditions,
                "not_covered": report.not_covered,
            })
            .to_string(),
        );
    } else {
        print(&format!(
            "design: {} ({})",
            design.name,
            args.file.display()
        ));
        print(&describe(&report));
        print(&format!("gamma: {}", design.certificate.gamma));
        for line in both::outer_lines(&design, &model) {
            print(&line);
        }
        for line in reach.lines() {
            print(&line);
        }
        print(&transmissions.describe());
    }
    Ok(exit_code(report.verdict))
}

/// 0 for proved, 2 for not proved.
pub fn exit_code(verdict: Verdict) -> ExitCode {
    match verdict {
        Verdict::Proved => ExitCode::SUCCESS,
        Verdict::NotProved => ExitCode::from(EXIT_NO),
    }
}

/// The verdict in words.
pub fn describe(report: &Report) -> String {
    let mut out = String::new();
    match report.verdict {
        Verdict::Proved => out.push_str("verdict: PROVED\n"),
        Verdict::NotProved => out.push_str("verdict: NOT PROVED\n"),
    }
    if let Some(worst) = report.worst() {
        out.push_str(&format!("worst condition: {}\n", describe_margin(worst)));
    }
    let failed = report
        .conditions
        .iter()
        .filter(|condition| condition.margin < 0.0);
    for condition in failed {
        out.push_str(&format!("  not proved: {}\n", describe_margin(condition)));
    }
    out.push_str(&format!("{} conditions checked\n", report.conditions.len()));
    out.push_str("the proof assumes:");
    for item in &report.not_covered {
        out.push_str(&format!("\n  - {item}"));
    }
    out
}

fn describe_margin(condition: &ConditionMargin) -> String {
    format!("{}, margin {:.3e}", condition.name, condition.margin)
}
