//! `steadfast verify FILE.json`

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;
use synth::certify::Verdict;
use synth::model::{kind_of, Kind};

use super::feasibility;
use super::synthesize::problem;
use crate::cli::answer::{exit_code, print};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::show::claims::Guarantees;
use crate::cli::show::verdict::describe;

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
    let claims = Guarantees::of(&design, &model, report.verdict);
    if args.json {
        let mut object = json!({
            "verdict": report.verdict,
            "worst": report.worst(),
            "gamma": claims.number(design.certificate.gamma),
            "guaranteed_gain": claims.number(design.certificate.guaranteed_gain),
            "xi": claims.number(design.certificate.xi),
            "conditions": report.conditions,
            "not_covered": report.not_covered,
        });
        claims.add_to(&mut object);
        print(&object.to_string());
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
