//! `steadfast verify FILE.json`

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;
use synth::certify::{ConditionMargin, Report, Verdict};
use synth::model::{kind_of, Kind};

use super::claims::Claims;
use super::{feasibility, files, print, problem, CliError, EXIT_NO};

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
    let claims = Claims::of(&design, &model, report.verdict);
    if args.json {
        let mut told = json!({
            "verdict": report.verdict,
            "worst": report.worst(),
            "gamma": design.certificate.gamma,
            "guaranteed_gain": design.certificate.guaranteed_gain,
            "xi": design.certificate.xi,
            "conditions": report.conditions,
            "not_covered": report.not_covered,
        });
        claims.add_to(&mut told);
        print(&told.to_string());
    } else {
        print(&format!(
            "design: {} ({})",
            design.name,
            args.file.display()
        ));
        print(&describe(&report));
        print(&format!("gamma: {}", design.certificate.gamma));
        claims.lines().iter().for_each(|line| print(line));
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
