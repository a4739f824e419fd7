//! `steadfast synthesize MODEL.json`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::ValueEnum;
use serde_json::{json, Value};
use synth::certify::Verdict;
use synth::design::SolverRun;
use synth::feasibility::{Answer, Decision};
use synth::model::{kind_of, Kind, Model, Objective};
use synth::solve::SolveError;
use synth::synthesis::{self, Form, Outcome, SynthesisError, Synthesized};

use super::claims::Claims;
use super::progress::SolverProgress;
use super::reach;
use super::solver::SolverArg;
use super::verify::{describe, exit_code};
use super::{
    both, cross_check, feasibility, files, print, problem, CliError, EXIT_NO, EXIT_SOLVER,
};

/// Arguments of `synthesize`.
#[derive(clap::Args)]
pub struct SynthesizeArgs {
    /// Model or problem file
    pub(super) model: PathBuf,
    /// Design file to write
    #[arg(short, long)]
    pub(super) output: Option<PathBuf>,
    /// What to optimise, in place of the model's own objective
    #[arg(long)]
    objective: Option<ObjectiveArg>,
    /// Form of the decrease condition; by default reduced for clarabel, slack for structured
    #[arg(long)]
    form: Option<FormArg>,
    /// Solver
    #[arg(long, default_value = "clarabel")]
    pub(super) solver: SolverArg,
    /// Minimise gamma with both solvers at the end and report the difference
    #[arg(long)]
    pub(super) cross_check: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

impl SynthesizeArgs {
    fn form(&self) -> Form {
        self.form.map_or(self.solver.form(), Form::from)
    }

    /// An option given that says nothing about a problem file.
    pub(super) fn option_without_use(&self) -> Option<&'static str> {
        match (self.form, self.objective, self.cross_check) {
            (Some(_), _, _) => Some("--form"),
            (None, Some(_), _) => Some("--objective"),
            (None, None, true) => Some("--cross-check"),
            (None, None, false) => None,
        }
    }
}

/// What to optimise.
#[derive(Clone, Copy, ValueEnum)]
pub enum ObjectiveArg {
    /// The smallest L-infinity gain bound
    Gain,
    /// One gain, two certificates: the smallest gain bound near the origin while the set of the model's
    /// specs.outer is certified too
    Both,
    /// The largest certified set along the must-contain states, or of attitudes at rest
    Region,
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
            FormArg::Reduced => synthesis::Form::Chordal,
            FormArg::Slack => synthesis::Form::VertexRelaxed,
            FormArg::Full => synthesis::Form::Full,
        }
    }
}

/// Designs, writes and proves. 0: proved; 2: infeasible or not proved; 3: the solver failed.
pub fn run(args: &SynthesizeArgs) -> Result<ExitCode, CliError> {
    let text = files::text(&args.model)?;
    if kind_of(&text) == Some(Kind::Problem) {
        return problem::synthesize(args, &text);
    }
    let mut model = files::model_of(&args.model, &text)?;
    if let Some(objective) = args.objective {
        model = with_objective(model, objective, &args.model)?;
    }
    if let Some(output) = &args.output {
        files::check_output(output, &args.model)?;
    }
    let ending = Ending {
        model_path: &args.model,
        model: &model,
        output: args.output.as_deref(),
        json: args.json,
        form: args.form(),
        cross_check: args.cross_check.then_some(args.solver),
        what: "design",
        keeps_refutation: false,
    };
    match model.file.specs.objective {
        Objective::Both => both::synthesize(args, &ending, &text),
        Objective::Gain | Objective::Region => ending.tell(solve(args, &model, &text)?),
    }
}

/// How a synthesis or an analysis is reported.
pub struct Ending<'a> {
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
    /// The solver used, when the other is to be asked too.
    pub cross_check: Option<SolverArg>,
    /// What was sought: a design, or a proof for given gains.
    pub what: &'static str,
    /// A proof that there is none is written in the place of the design.
    pub keeps_refutation: bool,
}

impl Ending<'_> {
    /// Reports the outcome, writes the design if it is proved, and returns the exit status.
    pub fn tell(&self, outcome: Outcome) -> Result<ExitCode, CliError> {
        match outcome {
            Outcome::Solved(design) => finish(self, *design),
            Outcome::Infeasible(decision) => {
                let kept = self.keep_refutation(&decision)?;
                tell_failure(self, &decision, "infeasible", kept);
                Ok(ExitCode::from(EXIT_NO))
            }
            Outcome::Undecided(decision) => {
                let kept = self.keep_refutation(&decision)?;
                tell_failure(self, &decision, "undecided", kept);
                Ok(ExitCode::from(EXIT_NO))
            }
            Outcome::SolverFailed(decision) => {
                tell_failure(self, &decision, "failed", None);
                Ok(ExitCode::from(EXIT_SOLVER))
            }
        }
    }
}

impl Ending<'_> {
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

/// The model with the objective of the command line.
fn with_objective(model: Model, objective: ObjectiveArg, path: &Path) -> Result<Model, CliError> {
    let mut file = model.file;
    file.specs.objective = match objective {
        ObjectiveArg::Gain => Objective::Gain,
        ObjectiveArg::Region => Objective::Region,
        ObjectiveArg::Both => Objective::Both,
    };
    Model::new(file).map_err(|problem| CliError::value(path, problem))
}

fn solve(args: &SynthesizeArgs, model: &Model, text: &str) -> Result<Outcome, CliError> {
    let progress = SolverProgress::start("assembling the conditions");
    let observer = Some(progress.observer());
    let form = args.form();
    let backend = args.solver.backend_for(form);
    let found = synthesis::synthesize(model, text, form, backend.as_ref(), observer);
    found.map_err(|error| solver_problem(&args.model, error))
}

/// What a search that could not run means to the user.
pub fn solver_problem(model: &Path, error: SynthesisError) -> CliError {
    match error {
        SynthesisError::Cancelled(_) => CliError::Interrupted,
        // The numbers overflow on the way from the model to the solver.
        SynthesisError::Solve(problem @ SolveError::NotFinite { .. }) => {
            let reason = format!("{problem}; the model's numbers are too far apart");
            CliError::unsuitable(model, reason)
        }
        other => other.into(),
    }
}

fn finish(args: &Ending, design: Synthesized) -> Result<ExitCode, CliError> {
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
    let check = check.map(|solver| cross_check::run(solver, args, &design));
    let check = check.transpose()?;
    let part = &design.file.certificate;
    let vertices = model.task().system.vertices.len();
    let claims = Claims::of(&design.file, model, report.verdict);
    if args.json {
        let mut told = json!({
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
        claims.add_to(&mut told);
        print(&told.to_string());
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
        cross_check::tell(check);
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
    print_end(kept, report.verdict);
    Ok(exit_code(report.verdict))
}

/// What became of the design.
pub(super) fn print_end(kept: Option<&Path>, verdict: Verdict) {
    match (kept, verdict) {
        (Some(path), _) => print(&format!("written: {}", path.display())),
        (None, Verdict::NotProved) => print("nothing written"),
        (None, Verdict::Proved) => print("nothing written; give -o DESIGN.json to keep the design"),
    }
}

fn tell_failure(args: &Ending, decision: &Decision, status: &str, kept: Option<&Path>) {
    let blocking: Vec<Value> = decision
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
                "form": args.form.name(),
                "vertices": args.model.task().system.vertices.len(),
                "conditions": [],
                "certified_angle_deg": null,
                "shortfall": decision.limiting_factors.as_deref().map(reach::shortfall_json),
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
    if let Some(shortfall) = decision.limiting_factors.as_deref() {
        reach::tell_shortfall(args.model_path, shortfall, &decision.blocking);
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

/// A solver's run in words.
pub(super) fn describe_run(run: &SolverRun) -> String {
    format!(
        "solver: {}, {} at {} vertices: {} after {} iterations, {:.2} s (its own opinion)",
        run.solver, run.goal, run.vertices, run.status, run.iterations, run.seconds
    )
}

fn headline(args: &Ending, decision: &Decision, status: &str) -> String {
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
