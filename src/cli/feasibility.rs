//! `steadfast feasibility MODEL.json`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::{json, Value};
use synth::feasibility::{decide, Answer, Decision};
use synth::solve::Clarabel;

use super::progress::SolverProgress;
use super::synthesize::solver_problem;
use super::{files, print, CliError, EXIT_NO};

/// Arguments of `feasibility`.
#[derive(clap::Args)]
pub struct FeasibilityArgs {
    /// Model file
    model: PathBuf,
    /// File to write: a design when one exists, an infeasibility certificate when none does
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Says whether a design exists. 0: proved that one does; 2: proved that none does, or unknown.
pub fn run(args: &FeasibilityArgs) -> Result<ExitCode, CliError> {
    let (text, model) = files::model(&args.model)?;
    if let Some(output) = &args.output {
        files::check_output(output, &args.model)?;
    }
    let progress = SolverProgress::start("assembling the conditions");
    let found = decide(
        &model,
        &text,
        &Clarabel::default(),
        Some(progress.observer()),
    );
    drop(progress);
    let decision = found.map_err(|error| solver_problem(&args.model, error))?;
    let written = write(args.output.as_deref(), &decision)?;
    if args.json {
        print(&report(&decision).to_string());
    } else {
        print(&describe(&args.model, &decision));
        match (args.output.as_deref(), written) {
            (Some(path), true) => print(&format!("written: {}", path.display())),
            (Some(_), false) => print("nothing written"),
            (None, _) => {}
        }
    }
    Ok(match decision.answer {
        Answer::Feasible(_) => ExitCode::SUCCESS,
        Answer::Infeasible(_) | Answer::Unknown => ExitCode::from(EXIT_NO),
    })
}

/// Writes the file that proves the answer, if there is one.
fn write(path: Option<&Path>, decision: &Decision) -> Result<bool, CliError> {
    let text = match &decision.answer {
        Answer::Feasible(design) => design.file.to_json(),
        Answer::Infeasible(proof) => proof.file.to_json(),
        Answer::Unknown => return Ok(false),
    };
    match path {
        Some(path) => files::write(path, &text).map(|()| true),
        None => Ok(false),
    }
}

/// The answer's name in reports.
pub fn verdict(answer: &Answer) -> &'static str {
    match answer {
        Answer::Feasible(_) => "feasible",
        Answer::Infeasible(_) => "infeasible",
        Answer::Unknown => "unknown",
    }
}

/// The bound of a proved no.
pub fn bound(answer: &Answer) -> Option<f64> {
    match answer {
        Answer::Infeasible(proof) => Some(proof.bound),
        _ => None,
    }
}

fn report(decision: &Decision) -> Value {
    let blocks = !matches!(decision.answer, Answer::Feasible(_));
    let blocking = decision.blocking.iter().filter(|_| blocks);
    let names: Vec<&String> = blocking.clone().map(|(name, _)| name).collect();
    let shares: Vec<f64> = blocking.map(|(_, share)| *share).collect();
    json!({
        "verdict": verdict(&decision.answer),
        "margin": decision.slack,
        "blocking": names,
        "blocking_shares": shares,
        "bound": bound(&decision.answer),
        "solve_seconds": decision.solve_seconds,
        "solver_runs": decision.runs,
    })
}

fn describe(model: &Path, decision: &Decision) -> String {
    let mut lines = vec![format!(
        "{}: {}",
        model.display(),
        headline(&decision.answer)
    )];
    lines.extend(slack_line(decision.slack));
    if !matches!(decision.answer, Answer::Feasible(_)) {
        lines.extend(blocking_lines(&decision.blocking));
    }
    lines.join("\n")
}

/// The answer in words.
pub fn headline(answer: &Answer) -> String {
    match answer {
        Answer::Feasible(design) => format!(
            "FEASIBLE, proved by a design with gamma {:.6} (not the smallest)",
            design.file.certificate.gamma
        ),
        Answer::Infeasible(proof) if proof.bound == f64::MAX => {
            "INFEASIBLE, proved: no design satisfies the conditions".to_string()
        }
        Answer::Infeasible(proof) => format!(
            "INFEASIBLE, proved: no design with multiplier entries up to R = {:.3e} (SI units) satisfies the conditions",
            proof.bound
        ),
        Answer::Unknown => "UNKNOWN: neither a design nor its impossibility could be proved".to_string(),
    }
}

/// The smallest slack in words.
pub fn slack_line(slack: Option<f64>) -> Option<String> {
    let slack = slack?;
    Some(format!(
        "smallest slack t with which every condition holds: {slack:.4e} (scaled units; the solver's number; above 0: they cannot hold)"
    ))
}

/// The conditions that block.
pub fn blocking_lines(blocking: &[(String, f64)]) -> Vec<String> {
    if blocking.is_empty() {
        return Vec::new();
    }
    let mut lines = vec!["conditions that block (share of the dual solution):".to_string()];
    let shares = blocking.iter().take(12);
    lines.extend(shares.map(|(name, share)| format!("  {:5.1} %  {name}", 100.0 * share)));
    lines
}
