//! `steadfast feasibility MODEL.json`

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use serde_json::{json, Value};
use synth::certify::infeasible::Limit;
use synth::feasibility::{decide, relaxations, Answer, Decision, Relaxation};
use synth::model::Model;
use synth::solve::Backend;

use crate::cli::answer::{print, EXIT_NO};
use crate::cli::error::{solver_problem, CliError};
use crate::cli::files;
use crate::cli::progress::SolverProgress;
use crate::cli::show::feasibility::{
    blocking_lines, bound, headline, partial_statement, shown, slack_line, statement, verdict,
};
use crate::cli::solver::SolverArg;

/// Arguments of `feasibility`.
#[derive(clap::Args)]
pub struct FeasibilityArgs {
    /// Model file
    model: PathBuf,
    /// File to write: a design when one exists, an infeasibility certificate when none does
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Do not search for the requirement whose relaxation makes an infeasible model feasible
    #[arg(long)]
    no_relaxations: bool,
    /// Solver
    #[arg(long, default_value = "clarabel")]
    solver: SolverArg,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Says whether a design exists. 0: proved that one does; 2: proved that none does, or unknown.
pub fn run(args: &FeasibilityArgs) -> Result<ExitCode, CliError> {
    let text = files::text(&args.model)?;
    let model = files::model_of(&args.model, &text)?;
    if let Some(output) = &args.output {
        files::check_output(output, &args.model)?;
    }
    if model.file.specs.outer.is_some() {
        eprintln!("note: the answer is about the model's own box and requirements; specs.outer is not part of it");
    }
    let backend = args.solver.backend();
    let backend = backend.as_ref();
    let start = Instant::now();
    let progress = SolverProgress::start("assembling the conditions");
    let found = decide(&model, &text, backend, Some(progress.observer()));
    drop(progress);
    let decision = found.map_err(|error| solver_problem(&args.model, error))?;
    let seconds = start.elapsed().as_secs_f64();
    let written = write(args.output.as_deref(), &decision)?;
    if !args.json {
        print(&describe(&args.model, &decision));
        match (args.output.as_deref(), written) {
            (Some(path), true) => print(&format!("written: {}", path.display())),
            (Some(_), false) => print("nothing written"),
            (None, _) => {}
        }
    }
    let wanted = matches!(decision.answer, Answer::Infeasible(_)) && !args.no_relaxations;
    let relaxed = match wanted {
        true => Some(relax(args, &model, backend)?),
        false => None,
    };
    if args.json {
        print(&report(&decision, seconds, relaxed.as_deref()).to_string());
    } else if let Some(relaxed) = &relaxed {
        print(&describe_relaxations(relaxed));
    }
    Ok(match decision.answer {
        Answer::Feasible(_) => ExitCode::SUCCESS,
        Answer::Infeasible(_) | Answer::Undecided(_) => ExitCode::from(EXIT_NO),
    })
}

fn relax(
    args: &FeasibilityArgs,
    model: &Model,
    backend: &dyn Backend,
) -> Result<Vec<Relaxation>, CliError> {
    let progress = SolverProgress::start("relaxing one requirement after the other");
    let found = relaxations(model, backend, Some(progress.observer()));
    found.map_err(|error| solver_problem(&args.model, error))
}

/// Writes the file that proves the answer, if there is one.
fn write(path: Option<&Path>, decision: &Decision) -> Result<bool, CliError> {
    let text = match &decision.answer {
        Answer::Feasible(design) => design.file.to_json(),
        Answer::Infeasible(proof) | Answer::Undecided(Some(proof)) => proof.file.to_json(),
        Answer::Undecided(None) => return Ok(false),
    };
    match path {
        Some(path) => files::write(path, &text).map(|()| true),
        None => Ok(false),
    }
}

fn report(decision: &Decision, seconds: f64, relaxed: Option<&[Relaxation]>) -> Value {
    let blocks = !matches!(decision.answer, Answer::Feasible(_));
    let blocking = decision.blocking.iter().filter(|_| blocks);
    let names: Vec<&String> = blocking.clone().map(|(name, _)| name).collect();
    let shares: Vec<f64> = blocking.map(|(_, fraction)| *fraction).collect();
    let relaxations = relaxed.map(|relaxed| relaxed.iter().map(relaxation).collect::<Vec<_>>());
    json!({
        "verdict": verdict(&decision.answer),
        "margin": decision.slack,
        "blocking": names,
        "blocking_shares": shares,
        "bound": bound(&decision.answer),
        "shown": shown(&decision.answer),
        "relaxations": relaxations,
        "seconds": seconds,
        "solve_seconds": decision.solve_seconds,
        "solver_runs": decision.runs,
    })
}

fn relaxation(relaxation: &Relaxation) -> Value {
    json!({
        "requirement": relaxation.requirement.symbol(),
        "value": relaxation.feasible.map(|found| found.value),
        "factor": relaxation.feasible.map(|found| found.factor),
        "not_at_factor": relaxation.feasible.map(|found| found.not_at),
        "solves": relaxation.solves,
    })
}

fn describe_relaxations(relaxed: &[Relaxation]) -> String {
    let mut lines = vec!["one requirement relaxed, all others kept:".to_string()];
    lines.extend(relaxed.iter().map(|relaxation| {
        let symbol = relaxation.requirement.symbol();
        match relaxation.feasible {
            Some(found) => format!(
                "  {symbol}: feasible (proved) at {:.5}, {:.4} times the model's; not found at {:.4} times",
                found.value, found.factor, found.not_at
            ),
            None => format!("  {symbol}: does not help alone"),
        }
    }));
    lines.join("\n")
}

/// Proves from a file that no design exists. 0: proved; 2: not proved.
pub fn verify(path: &Path, text: &str, json: bool) -> Result<ExitCode, CliError> {
    let (file, model) = files::infeasibility_of(path, text)?;
    let outcomes = file.verify(&model);
    let outcomes = outcomes.map_err(|problem| CliError::value(path, problem))?;
    let proved = outcomes.iter().all(|outcome| outcome.proved);
    let limits = match proved {
        true => file.limits(&model),
        false => Ok(Vec::new()),
    };
    let limits = limits.map_err(|error| solver_problem(path, error))?;
    let verdict = match (proved, limits.as_slice()) {
        (true, []) => "proved",
        (true, _) => "undecided",
        (false, _) => "not_proved",
    };
    let exit = match verdict {
        "proved" => ExitCode::SUCCESS,
        _ => ExitCode::from(EXIT_NO),
    };
    let bound = outcomes.iter().map(|outcome| outcome.bound);
    let bound = bound.fold(f64::MAX, f64::min);
    let conditions = outcomes.iter().flat_map(|outcome| &outcome.conditions);
    let worst = conditions
        .clone()
        .min_by(|a, b| a.margin.total_cmp(&b.margin));
    if json {
        let report = json!({
            "verdict": verdict,
            "statement": "infeasible",
            "bound": bound,
            "limits": limits.iter().map(Limit::to_string).collect::<Vec<_>>(),
            "gains": file.blocking_gains(),
            "worst": worst,
            "conditions": conditions.collect::<Vec<_>>(),
        });
        print(&report.to_string());
        return Ok(exit);
    }
    print(&format!(
        "infeasibility of: {} ({})",
        file.name,
        path.display()
    ));
    for (index, outcome) in outcomes.iter().enumerate() {
        let constant = outcome.constant;
        print(&format!(
            "weights {}: constant {constant:.6e} (must be below 0), {} matrices checked",
            index + 1,
            outcome.conditions.len()
        ));
    }
    for condition in conditions.filter(|condition| condition.margin < 0.0) {
        print(&format!(
            "  not proved: {}, margin {:.3e}",
            condition.name, condition.margin
        ));
    }
    print(&match verdict {
        "proved" => format!("verdict: PROVED, {}", statement(&file, bound)),
        "undecided" => format!("verdict: UNDECIDED, {}", partial_statement(&file, &limits)),
        _ => "verdict: NOT PROVED".to_string(),
    });
    Ok(exit)
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
