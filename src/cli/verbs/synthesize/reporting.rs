//! How a synthesis or an analysis is reported.

use std::path::Path;
use std::process::ExitCode;

use serde_json::{json, Value};
use synth::certify::Verdict;
use synth::design::SolverRun;
use synth::feasibility::{Answer, Decision};
use synth::model::Model;
use synth::synthesis;
use synth::synthesis::{Outcome, Synthesized};

use super::cross_check;
use crate::cli::answer::{exit_code, print, EXIT_NO, EXIT_SOLVER};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::show::claims::Guarantees;
use crate::cli::show::verdict::describe;
use crate::cli::show::{feasibility, reach};
use crate::cli::solver::SolverArg;

/// How a synthesis or an analysis is reported.
pub struct Reporting<'a> {
    /// The model file.
    pub model_path: &'a Path,
    /// Its content.
    pub model: &'a Model,
    /// The design file to write.
    pub output: Option<&'a Path>,
    /// One JSON object on standard output.
    pub json: bool,
    /// Form of the decrease condition.
    pub form: synthesis::Form,
    /// The solver used, when the other is to be run too.
    pub cross_check: Option<SolverArg>,
    /// What was requested: a design, or a proof for given gains.
    pub what: &'static str,
    /// A proof that there is none is written in the place of the design.
    pub keeps_refutation: bool,
}

impl Reporting<'_> {
    /// Reports the outcome, writes the design if it is proved, and returns the exit status.
    pub fn report(&self, outcome: Outcome) -> Result<ExitCode, CliError> {
        match outcome {
            Outcome::Solved(design) => finish(self, *design),
            Outcome::Infeasible(decision) => {
                let kept = self.keep_refutation(&decision)?;
                print_failure(self, &decision, "infeasible", kept);
                Ok(ExitCode::from(EXIT_NO))
            }
            Outcome::Undecided(decision) => {
                let kept = self.keep_refutation(&decision)?;
                print_failure(self, &decision, "undecided", kept);
                Ok(ExitCode::from(EXIT_NO))
            }
            Outcome::SolverFailed(decision) => {
                print_failure(self, &decision, "failed", None);
                Ok(ExitCode::from(EXIT_SOLVER))
            }
        }
    }
}

impl Reporting<'_> {
    /// Writes the certificate of a proved no, where one is wanted.
    fn keep_refutation(&self, decision: &Decision) -> Result<Option<&Path>, CliError> {
        let path = self.output.filter(|_| self.keeps_refutation);
        match (path, &decision.answer) {
            (Some(path), Answer::Infeasible(proof) | Answer::Undecided(Some(proof))) => {
                files::write(path, &proof.file.to_json())?;
                Ok(Some(path))
            }
            _ => Ok(None),
        }
    }
}

fn finish(args: &Reporting, design: Synthesized) -> Result<ExitCode, CliError> {
    let model = args.model;
    let mut report = design.report.clone();
    let kept = args.output.filter(|_| report.verdict == Verdict::Proved);
    if let Some(path) = kept {
        files::write(path, &design.file.to_json())?;
        // What counts is what a reader of the file gets.
        let (file, model) = files::design_of(path, &files::text(path)?)?;
        report = file
            .verify(&model)
            .map_err(|problem| CliError::value(path, problem))?;
    }
    let check = args.cross_check;
    let check = check.map(|solver| cross_check::run(solver, (model, args.form), &design));
    let check = check.transpose()?;
    let part = &design.file.certificate;
    let vertices = model.task().system.vertices.len();
    let claims = Guarantees::of(&design.file, model, report.verdict);
    if args.json {
        let mut object = json!({
            "status": "solved",
            "verdict": report.verdict,
            "gamma": claims.number(part.gamma),
            "guaranteed_gain": claims.number(part.guaranteed_gain),
            "xi": claims.number(part.xi),
            "optimality": design.optimality.filter(|_| report.verdict == Verdict::Proved),
            "form": design.file.provenance.form,
            "vertices": vertices,
            "solve_seconds": design.solve_seconds,
            "search": design.file.provenance.search,
            "worst": report.worst(),
            "conditions": report.conditions,
            "not_covered": report.not_covered,
            "solver_runs": design.file.provenance.solver_runs,
            "cross_check": check.as_ref().map(cross_check::json),
        });
        claims.add_to(&mut object);
        print(&object.to_string());
        return Ok(exit_code(report.verdict));
    }
    print(&format!(
        "model: {} ({vertices} vertices)",
        design.file.name
    ));
    for run in &design.file.provenance.solver_runs {
        print(&describe_run(run));
    }
    if let Some(check) = &check {
        cross_check::print_lines(check);
    }
    if report.verdict == Verdict::Proved {
        print(&format!("gamma: {:.6}", part.gamma));
        print(&format!(
            "guaranteed gain: {:.6} (sup|y| / sup|tau| from rest)",
            part.guaranteed_gain
        ));
    }
    if let Some(angle) = claims.certified_angle_deg() {
        print(&format!(
            "certified set: every attitude at rest up to {angle:.3} deg"
        ));
    }
    claims.lines().iter().for_each(|line| print(line));
    let remark = design.optimality.and_then(|optimality| optimality.remark());
    print(&describe(&report, remark.as_deref()));
    print_written(kept, report.verdict);
    Ok(exit_code(report.verdict))
}

/// What became of the design.
pub(crate) fn print_written(kept: Option<&Path>, verdict: Verdict) {
    match (kept, verdict) {
        (Some(path), _) => print(&format!("written: {}", path.display())),
        (None, Verdict::NotProved) => print("nothing written"),
        (None, Verdict::Proved) => print("nothing written; give -o DESIGN.json to keep the design"),
    }
}

fn print_failure(args: &Reporting, decision: &Decision, status: &str, kept: Option<&Path>) {
    let blocking: Vec<Value> = decision
        .blocking
        .iter()
        .map(|(name, fraction)| json!({ "name": name, "share": fraction }))
        .collect();
    if args.json {
        print(
            &json!({
                "status": status,
                "verdict": "not_proved",
                "gamma": null,
                "guaranteed_gain": null,
                "xi": null,
                "form": args.form.name(),
                "vertices": args.model.task().system.vertices.len(),
                "conditions": [],
                "certified_angle_deg": null,
                "shortfall": decision.shortfall.as_deref().map(reach::shortfall_json),
                "feasibility": feasibility::verdict(&decision.answer),
                "shown": feasibility::shown(&decision.answer),
                "bound": feasibility::bound(&decision.answer),
                "blocking_gains": feasibility::blocking_gains(&decision.answer),
                "slack": decision.slack,
                "blocking": blocking,
                "solve_seconds": decision.solve_seconds,
                "solver_runs": decision.runs,
            })
            .to_string(),
        );
        return;
    }
    if let Some(shortfall) = decision.shortfall.as_deref() {
        reach::print_shortfall(args.model_path, shortfall, &decision.blocking);
        return;
    }
    print(&headline(args, decision, status));
    match feasibility::slack_line(decision.slack) {
        Some(line) => print(&line),
        None if matches!(
            decision.answer,
            Answer::Infeasible(_) | Answer::Undecided(Some(_))
        ) => {}
        None => print("the smallest slack could not be computed either"),
    }
    for line in feasibility::blocking_lines(&decision.blocking) {
        print(&line);
    }
    match kept {
        Some(path) => print(&format!("written: {}", path.display())),
        None => print("nothing written"),
    }
}

/// A solver's run as text.
pub(crate) fn describe_run(run: &SolverRun) -> String {
    format!(
        "solver: {}, {} at {} vertices: {} after {} iterations, {:.2} s (its own opinion)",
        run.solver, run.goal, run.vertices, run.status, run.iterations, run.seconds
    )
}

fn headline(args: &Reporting, decision: &Decision, status: &str) -> String {
    let model = args.model_path.display();
    match (&decision.answer, status) {
        (Answer::Infeasible(_) | Answer::Undecided(Some(_)), _) => {
            format!("{model}: {}", feasibility::headline(&decision.answer))
        }
        (_, "undecided") => format!(
            "{model}: UNDECIDED: no {} was found, and none was proved not to exist",
            args.what
        ),
        _ => format!("{model}: the solvers failed numerically"),
    }
}
