//! `steadfast synthesize MODEL.json`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::ValueEnum;
use serde_json::{json, Value};
use synth::certify::Verdict;
use synth::model::Model;
use synth::solve::SolveError;
use synth::synthesis::{
    self, Candidate, CrossCheck, Failure, Form, Outcome, SynthesisError, Synthesized,
};

use super::progress::SolverProgress;
use super::solver::SolverArg;
use super::verify::{certified_angle_deg, describe, exit_code};
use super::{files, print, CliError, EXIT_NO, EXIT_SOLVER};

/// Arguments of `synthesize`.
#[derive(clap::Args)]
pub struct SynthesizeArgs {
    /// Model file
    model: PathBuf,
    /// Design file to write
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// What to optimise, in place of the model's own objective
    #[arg(long)]
    objective: Option<ObjectiveArg>,
    /// Form of the decrease condition; by default reduced for clarabel, slack for structured
    #[arg(long)]
    form: Option<FormArg>,
    /// Solver
    #[arg(long, default_value = "clarabel")]
    solver: SolverArg,
    /// Minimise gamma with both solvers at the end and report the difference
    #[arg(long)]
    cross_check: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// What to optimise.
#[derive(Clone, Copy, ValueEnum)]
pub enum ObjectiveArg {
    /// The smallest L-infinity gain bound
    Gain,
}

/// Form of the decrease condition.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FormArg {
    /// Small cones, exactly equivalent
    Reduced,
    /// Few unknowns, exactly equivalent
    Slack,
    /// Large cones, as published
    Full,
}

impl From<FormArg> for synthesis::Form {
    fn from(form: FormArg) -> Self {
        match form {
            FormArg::Reduced => synthesis::Form::Reduced,
            FormArg::Slack => synthesis::Form::Slack,
            FormArg::Full => synthesis::Form::Full,
        }
    }
}

impl SynthesizeArgs {
    fn form(&self) -> Form {
        self.form.map_or(self.solver.form(), Form::from)
    }
}

/// Designs, writes and proves. 0: proved; 2: infeasible or not proved; 3: the solver failed.
pub fn run(args: &SynthesizeArgs) -> Result<ExitCode, CliError> {
    let (text, mut model) = files::model(&args.model)?;
    if let Some(ObjectiveArg::Gain) = args.objective {
        model.file.specs.objective = synth::model::Objective::Gain;
    }
    if let Some(output) = &args.output {
        files::check_output(output, &args.model)?;
    }
    match solve(args, &model, &text)? {
        Outcome::Solved(design) => finish(args, &model, *design),
        Outcome::Infeasible(failure) => {
            tell_failure(args, &model, &failure, "infeasible");
            Ok(ExitCode::from(EXIT_NO))
        }
        Outcome::SolverFailed(failure) => {
            tell_failure(args, &model, &failure, "failed");
            Ok(ExitCode::from(EXIT_SOLVER))
        }
    }
}

fn solve(args: &SynthesizeArgs, model: &Model, text: &str) -> Result<Outcome, CliError> {
    let progress = SolverProgress::start("assembling the conditions");
    let observer = Some(progress.observer());
    let form = args.form();
    let backend = args.solver.backend_for(form);
    match synthesis::synthesize(model, text, form, backend.as_ref(), observer) {
        Err(SynthesisError::Cancelled(_)) => Err(CliError::Interrupted),
        // The numbers overflow on the way from the model to the solver.
        Err(SynthesisError::Solve(problem @ SolveError::NotFinite { .. })) => {
            let reason = format!("{problem}; the model's numbers are too far apart");
            Err(CliError::unsuitable(&args.model, reason))
        }
        other => Ok(other?),
    }
}

fn finish(args: &SynthesizeArgs, model: &Model, design: Synthesized) -> Result<ExitCode, CliError> {
    let mut report = design.report.clone();
    let kept = args
        .output
        .as_ref()
        .filter(|_| report.verdict == Verdict::Proved);
    if let Some(path) = kept {
        files::write(path, &design.file.to_json())?;
        // What counts is what a reader of the file gets.
        let (file, model) = files::design(path)?;
        report = file
            .verify(&model)
            .map_err(|problem| CliError::value(path, problem))?;
    }
    let check = match args.cross_check {
        true => Some(cross_check(args, model, &design)?),
        false => None,
    };
    let part = &design.file.certificate;
    let vertices = model.task().system.vertices.len();
    let angle = certified_angle_deg(part.certified_vector_part);
    if args.json {
        print(
            &json!({
                "status": "solved",
                "verdict": report.verdict,
                "gamma": part.gamma,
                "guaranteed_gain": part.guaranteed_gain,
                "xi": part.xi,
                "form": design.file.provenance.form,
                "vertices": vertices,
                "solve_seconds": design.solve_seconds,
                "certified_angle_deg": angle,
                "worst": report.worst(),
                "conditions": report.conditions,
                "not_covered": report.not_covered,
                "solver_runs": design.file.provenance.solver_runs,
                "cross_check": check.as_ref().map(cross_check_json),
            })
            .to_string(),
        );
        return Ok(exit_code(report.verdict));
    }
    print(&format!(
        "model: {} ({vertices} vertices)",
        design.file.name
    ));
    for run in &design.file.provenance.solver_runs {
        print(&format!(
            "solver: {}, {} at {} vertices: {} after {} iterations, {:.2} s (its own opinion)",
            run.solver, run.goal, run.vertices, run.status, run.iterations, run.seconds
        ));
    }
    if let Some(check) = &check {
        tell_cross_check(check);
    }
    print(&format!("gamma: {:.6}", part.gamma));
    print(&format!(
        "guaranteed gain: {:.6} (sup|y| / sup|tau| from rest)",
        part.guaranteed_gain
    ));
    if let Some(angle) = angle {
        print(&format!(
            "certified set: every attitude at rest up to {angle:.3} deg"
        ));
    }
    print(&describe(&report));
    match (kept, report.verdict) {
        (Some(path), _) => print(&format!("written: {}", path.display())),
        (None, Verdict::NotProved) => print("nothing written"),
        (None, Verdict::Proved) => print("nothing written; give -o DESIGN.json to keep the design"),
    }
    Ok(exit_code(report.verdict))
}

/// The smallest gamma from both solvers, each with the form it is fastest with.
fn cross_check(
    args: &SynthesizeArgs,
    model: &Model,
    design: &Synthesized,
) -> Result<CrossCheck, CliError> {
    let progress = SolverProgress::start("cross-check");
    let observer = progress.observer();
    let other = args.solver.other();
    let backends = [
        args.solver.backend_for(args.form()),
        other.backend_for(other.form()),
    ];
    let candidates = [
        Candidate {
            backend: backends[0].as_ref(),
            form: args.form(),
        },
        Candidate {
            backend: backends[1].as_ref(),
            form: other.form(),
        },
    ];
    let units = design.file.provenance.problem;
    let checked = synthesis::cross_check(model, units, candidates, Some(&observer));
    checked.map_err(|error| CliError::from(SynthesisError::from(error)))
}

fn cross_check_json(check: &CrossCheck) -> Value {
    let found = check.found.iter().map(|found| {
        json!({
            "solver": found.solver,
            "status": found.status,
            "gamma": found.gamma,
            "seconds": found.seconds,
        })
    });
    json!({
        "found": found.collect::<Vec<_>>(),
        "relative_difference": check.relative_difference,
    })
}

fn tell_cross_check(check: &CrossCheck) {
    for found in &check.found {
        let gamma = found
            .gamma
            .map_or("none".to_string(), |gamma| format!("{gamma:.9}"));
        print(&format!(
            "cross-check: {}: smallest gamma {gamma}, {} in {:.2} s",
            found.solver, found.status, found.seconds
        ));
    }
    match check.relative_difference {
        Some(difference) => print(&format!(
            "cross-check: relative difference {difference:.1e}"
        )),
        None => print("cross-check: one of the solvers found no gamma"),
    }
}

fn tell_failure(args: &SynthesizeArgs, model: &Model, failure: &Failure, status: &str) {
    let blocking: Vec<Value> = failure
        .blocking
        .iter()
        .map(|(name, share)| json!({ "name": name, "share": share }))
        .collect();
    if args.json {
        print(
            &json!({
                "status": status,
                "verdict": "not_proved",
                "gamma": null,
                "guaranteed_gain": null,
                "xi": null,
                "form": args.form().name(),
                "vertices": model.task().system.vertices.len(),
                "conditions": [],
                "certified_angle_deg": null,
                "slack": failure.slack,
                "blocking": blocking,
                "solve_seconds": failure.solve_seconds,
                "solver_runs": failure.runs,
            })
            .to_string(),
        );
        return;
    }
    print(&headline(&args.model, status));
    match failure.slack {
        Some(slack) => print(&format!(
            "smallest slack t with which every condition holds: {slack:.4e} (scaled units; above 0: they cannot hold)"
        )),
        None => print("the smallest slack could not be computed either"),
    }
    print("conditions that block (share of the dual solution):");
    for (name, share) in failure.blocking.iter().take(12) {
        print(&format!("  {:5.1} %  {name}", 100.0 * share));
    }
    print("nothing written");
}

fn headline(model: &Path, status: &str) -> String {
    match status {
        "infeasible" => format!(
            "{}: no design exists, says the solver (not proved)",
            model.display()
        ),
        _ => format!("{}: the solver failed numerically", model.display()),
    }
}
