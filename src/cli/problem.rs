//! What `synthesize` and `verify` do for problem files and their designs.

use std::path::Path;
use std::process::ExitCode;

use serde_json::{json, Value};
use synth::certify::{Report, Verdict};
use synth::problem::{
    self, InfeasibilityProof, Problem, ProblemDesignFile, ProblemFailure, ProblemOutcome,
    ProblemSynthesized,
};

use super::progress::SolverProgress;
use super::synthesize::{describe_run, print_end, solver_problem, SynthesizeArgs};
use super::verify::{describe, exit_code};
use super::{feasibility, files, print, CliError, EXIT_NO, EXIT_SOLVER};

/// Designs, writes and proves. 0: proved; 2: infeasible or not proved; 3: the solver failed.
pub fn synthesize(args: &SynthesizeArgs, text: &str) -> Result<ExitCode, CliError> {
    let problem = files::problem_of(&args.model, text)?;
    if let Some(option) = args.option_without_use() {
        let reason = format!(
            "this is a problem file ({}), for which {option} has no meaning",
            problem.task.name()
        );
        return Err(CliError::unsuitable(&args.model, reason));
    }
    if let Some(output) = &args.output {
        files::check_output(output, &args.model)?;
    }
    match solve(args, &problem, text)? {
        ProblemOutcome::Solved(design) => finish(args, &problem, *design),
        ProblemOutcome::Infeasible(failure) => {
            tell_failure(args, &problem, &failure, "infeasible");
            Ok(ExitCode::from(EXIT_NO))
        }
        ProblemOutcome::Undecided(failure) => {
            tell_failure(args, &problem, &failure, "undecided");
            Ok(ExitCode::from(EXIT_NO))
        }
        ProblemOutcome::SolverFailed(failure) => {
            tell_failure(args, &problem, &failure, "failed");
            Ok(ExitCode::from(EXIT_SOLVER))
        }
    }
}

fn solve(args: &SynthesizeArgs, problem: &Problem, text: &str) -> Result<ProblemOutcome, CliError> {
    let progress = SolverProgress::start("assembling the conditions");
    let observer = Some(progress.observer());
    let found = problem::synthesize(problem, text, args.solver.backend().as_ref(), observer);
    found.map_err(|error| solver_problem(&args.model, error))
}

fn finish(
    args: &SynthesizeArgs,
    problem: &Problem,
    design: ProblemSynthesized,
) -> Result<ExitCode, CliError> {
    let mut report = design.report.clone();
    let kept = args
        .output
        .as_ref()
        .filter(|_| report.verdict == Verdict::Proved);
    if let Some(path) = kept {
        files::write(path, &design.file.to_json())?;
        // What counts is what a reader of the file gets.
        let (file, problem) = files::problem_design_of(path, &files::text(path)?)?;
        report = checked(path, &file, &problem)?;
    }
    let runs = &design.file.provenance.solver_runs;
    if args.json {
        let mut out = answer(problem, &design.file, &report);
        out["status"] = json!("solved");
        out["optimality"] = json!(design
            .optimality
            .filter(|_| report.verdict == Verdict::Proved));
        out["solve_seconds"] = json!(design.solve_seconds);
        out["solver_runs"] = json!(runs);
        print(&out.to_string());
        return Ok(exit_code(report.verdict));
    }
    print(&headline(problem));
    runs.iter().for_each(|run| print(&describe_run(run)));
    if report.verdict == Verdict::Proved {
        print(&guarantee(problem, &design.file));
    }
    let remark = design.optimality.and_then(|optimality| optimality.remark());
    print(&describe(&report, remark.as_deref()));
    print_end(kept.map(std::path::PathBuf::as_path), report.verdict);
    Ok(exit_code(report.verdict))
}

/// Proves a problem's design from its file alone. 0: proved; 2: not proved.
pub fn verify(path: &Path, text: &str, as_json: bool) -> Result<ExitCode, CliError> {
    let (design, problem) = files::problem_design_of(path, text)?;
    let report = checked(path, &design, &problem)?;
    if as_json {
        print(&answer(&problem, &design, &report).to_string());
    } else {
        print(&format!("design: {} ({})", design.name, path.display()));
        print(&describe(&report, None));
        if report.verdict == Verdict::Proved {
            print(&guarantee(&problem, &design));
        }
    }
    Ok(exit_code(report.verdict))
}

fn checked(path: &Path, file: &ProblemDesignFile, problem: &Problem) -> Result<Report, CliError> {
    file.verify(problem)
        .map_err(|fault| CliError::value(path, fault))
}

fn headline(problem: &Problem) -> String {
    let what = match problem.plant.gain {
        Some(_) => "analysis of a given feedback",
        None => "state feedback",
    };
    format!(
        "problem: {}, {} ({what}, {} vertices)",
        problem.file.name,
        problem.task.name(),
        problem.plant.vertices.len()
    )
}

fn guarantee(problem: &Problem, design: &ProblemDesignFile) -> String {
    format!(
        "guarantee: {:.6} ({})",
        design.certificate.guarantee,
        problem.task.guarantee()
    )
}

fn answer(problem: &Problem, design: &ProblemDesignFile, report: &Report) -> Value {
    json!({
        "problem": problem.task.name(),
        "verdict": report.verdict,
        "guarantee": (report.verdict == Verdict::Proved).then_some(design.certificate.guarantee),
        "guarantee_meaning": problem.task.guarantee(),
        "gain": design.controller.gain,
        "vertices": problem.plant.vertices.len(),
        "worst": report.worst(),
        "conditions": report.conditions,
        "not_covered": report.not_covered,
    })
}

fn tell_failure(args: &SynthesizeArgs, problem: &Problem, failure: &ProblemFailure, status: &str) {
    let runs = &failure.runs;
    if args.json {
        let share = |(name, share): &(String, f64)| json!({ "name": name, "share": share });
        let blocking: Vec<Value> = failure.blocking.iter().map(share).collect();
        print(
            &json!({
                "problem": problem.task.name(),
                "status": status,
                "verdict": "not_proved",
                "guarantee": null,
                "guarantee_meaning": problem.task.guarantee(),
                "gain": null,
                "vertices": problem.plant.vertices.len(),
                "conditions": [],
                "slack": failure.slack,
                "excluded_radius": failure.infeasibility.map(|excluded| excluded.radius.min(f64::MAX)),
                "excluded_margin": failure.infeasibility.map(|excluded| excluded.margin),
                "blocking": blocking,
                "solve_seconds": failure.solve_seconds,
                "solver_runs": runs,
            })
            .to_string(),
        );
        return;
    }
    print(&headline(problem));
    runs.iter().for_each(|run| print(&describe_run(run)));
    print(&match (failure.infeasibility, status) {
        (Some(excluded), "infeasible") => format!("INFEASIBLE, proved {}", no_solution(excluded)),
        (Some(excluded), _) => format!(
            "UNDECIDED: no feedback was found; shown {}; solvers returned unknowns up to {:.3e}",
            no_solution(excluded),
            excluded.largest_returned
        ),
        (None, "undecided") => {
            "UNDECIDED: no feedback was found, and none was proved not to exist".to_string()
        }
        (None, _) => "the solvers failed numerically".to_string(),
    });
    match feasibility::slack_line(failure.slack) {
        Some(line) => print(&line),
        None => print("the smallest slack could not be computed either"),
    }
    let blocking = feasibility::blocking_lines(&failure.blocking);
    blocking.iter().for_each(|line| print(line));
    print("nothing written");
}

/// What is proved about solutions that there are not.
fn no_solution(excluded: InfeasibilityProof) -> String {
    let within = match excluded.radius == f64::INFINITY {
        true => String::new(),
        false => format!(" with every scalar unknown below {:.3e}", excluded.radius),
    };
    let margin = match excluded.margin == 0.0 {
        true => String::new(),
        false => format!(" and a margin of {}", excluded.margin),
    };
    format!("for the scaled problem as given to the solver: it has no solution{within}{margin}")
}
