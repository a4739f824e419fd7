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
            "gamma": claims.number(design.certificate.gamma),
            "guaranteed_gain": claims.number(design.certificate.guaranteed_gain),
            "xi": claims.number(design.certificate.xi),
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
        print(&describe(&report, None));
        if report.verdict == Verdict::Proved {
            print(&format!("gamma: {}", design.certificate.gamma));
            claims.lines().iter().for_each(|line| print(line));
        }
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

/// The verdict in words, with a remark on its line where there is one. What is not proved claims nothing and ends
/// with its verdict.
pub fn describe(report: &Report, remark: Option<&str>) -> String {
    let failed = report.conditions.iter();
    let failed = failed.filter(|condition| condition.margin < 0.0);
    let failed = failed.map(|condition| format!("  not proved: {}", describe_margin(condition)));
    let worst = report.worst();
    let worst = worst.map(|worst| format!("worst condition: {}", describe_margin(worst)));
    let count = format!("{} conditions checked", report.conditions.len());
    let mut lines: Vec<String> = worst.into_iter().chain(failed).chain([count]).collect();
    match report.verdict {
        Verdict::Proved => {
            let remark = remark.map_or(String::new(), |remark| format!(", {remark}"));
            lines.insert(0, format!("verdict: PROVED{remark}"));
            lines.push("the proof assumes:".to_string());
            lines.extend(report.not_covered.iter().map(|item| format!("  - {item}")));
        }
        Verdict::NotProved => lines.push("verdict: NOT PROVED".to_string()),
    }
    lines.join("\n")
}

fn describe_margin(condition: &ConditionMargin) -> String {
    format!("{}, margin {:.3e}", condition.name, condition.margin)
}
