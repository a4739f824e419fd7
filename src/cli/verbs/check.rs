//! `steadfast check FILE`

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;
use synth::fuzzy::triangle_excess;
use synth::model::{kind_of, Kind, Model, Plant};
use synth::problem::Problem;

use crate::batch::tune::file::Requirements;
use crate::batch::tune::limits::least_time_s;
use crate::cli::answer::print;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::controllers::DesignCheck;
use crate::scenario::{design_check, Scenario};

/// Arguments of `check`.
#[derive(clap::Args)]
pub struct CheckArgs {
    /// Model, design, scenario, gains, problem or requirements file, or infeasibility certificate
    file: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Reads a file of any kind and says what it is, and for a controller whose paper has conditions on its
/// parameters, which of them hold. Nothing is proved here. A condition that fails is no error: the file
/// is valid, and the status is 0.
pub fn run(args: &CheckArgs) -> Result<ExitCode, CliError> {
    let text = files::text(&args.file)?;
    let mut design = None;
    let (kind, summary) = match kind_of(&text) {
        Some(Kind::Design) => {
            let (design, model) = files::design_of(&args.file, &text)?;
            (
                Kind::Design,
                format!("{}, {}", design.name, describe(&model)),
            )
        }
        Some(Kind::Scenario) => {
            let scenario = scenario(args, &text)?;
            design = design_check(&scenario);
            (
                Kind::Scenario,
                format!("{}, {} s", scenario.name, scenario.duration_s),
            )
        }
        Some(Kind::Requirements) => (Kind::Requirements, requirements(args, &text)?),
        Some(Kind::Infeasibility) => {
            let (file, model) = files::infeasibility_of(&args.file, &text)?;
            (
                Kind::Infeasibility,
                format!("{}, {}", file.name, describe(&model)),
            )
        }
        Some(Kind::Problem) => {
            let problem = files::problem_of(&args.file, &text)?;
            (Kind::Problem, describe_problem(&problem))
        }
        Some(Kind::ProblemDesign) => {
            let (_, problem) = files::problem_design_of(&args.file, &text)?;
            (Kind::ProblemDesign, describe_problem(&problem))
        }
        Some(Kind::Gains) => {
            let gains = files::gains_of(&args.file, &text)?;
            let (inputs, states) = gains.gains[0].shape();
            let count = gains.gains.len();
            let summary = format!("{}, {count} gains, {inputs} x {states}", gains.file.name);
            (Kind::Gains, summary)
        }
        // A model is the default: its errors name the missing fields.
        Some(Kind::Model) | None => {
            let model = files::model_of(&args.file, &text)?;
            (
                Kind::Model,
                format!("{}, {}", model.file.name, describe(&model)),
            )
        }
    };
    if args.json {
        let mut report = json!({ "valid": true, "kind": kind.to_string(), "summary": summary });
        if let Some(check) = &design {
            report["design_check"] = json!({
                "paper": check.paper,
                "conditions": check.conditions,
                "constants": check.constants,
            });
        }
        print(&report.to_string());
        return Ok(ExitCode::SUCCESS);
    }
    print(&format!(
        "{}: valid {kind} file: {summary}",
        args.file.display()
    ));
    if let Some(check) = &design {
        print(&conditions(check));
    }
    Ok(ExitCode::SUCCESS)
}

/// The conditions in words, those that fail marked.
fn conditions(check: &DesignCheck) -> String {
    let held = check.conditions.iter().filter(|one| one.holds).count();
    let mut lines = vec![format!(
        "{held} of {} conditions of {} hold (sufficient for its proof; a run may meet its requirements without them):",
        check.conditions.len(),
        check.paper
    )];
    for condition in &check.conditions {
        let verdict = if condition.holds { "holds" } else { "FAILS" };
        let side =
            |value: Option<f64>| value.map_or("undefined".to_string(), |v| format!("{v:.4e}"));
        lines.push(format!(
            "  {verdict}  {}: {}; {} {} {}  [{}]",
            condition.name,
            condition.statement,
            side(condition.left),
            condition.relation.sign(),
            side(condition.right),
            condition.place
        ));
        if !condition.note.is_empty() {
            lines.push(format!("         {}", condition.note));
        }
    }
    lines.join("\n")
}

fn describe(model: &Model) -> String {
    let (states, inputs, disturbances, outputs) = model.plant.sizes();
    let vertices = model.task().system.vertices.len();
    format!(
        "{vertices} vertices, {states} states, {inputs} inputs, {disturbances} disturbances, {outputs} outputs{}",
        describe_inertia_set(model)
    )
}

/// What is to be said of an uncertain inertia; empty for one that is known.
fn describe_inertia_set(model: &Model) -> String {
    let Plant::Spacecraft(craft) = &model.plant else {
        return String::new();
    };
    let set = &craft.inertia_uncertainty;
    let entries = set.uncertain_entries(&craft.inertia).len();
    if entries == 0 {
        return String::new();
    }
    let corners = set.vertices(&craft.inertia);
    let unphysical = corners
        .iter()
        .filter(|corner| triangle_excess(corner) > 0.0)
        .count();
    let rest = match unphysical {
        0 => String::new(),
        some => format!(
            ", {some} of them no rigid body's (one principal moment above the sum of the others; a proof covers them too)"
        ),
    };
    format!(
        ", inertia uncertain in {entries} entries, {} corners{rest}",
        corners.len()
    )
}

fn describe_problem(problem: &Problem) -> String {
    let plant = &problem.plant;
    format!(
        "{}, {}, {} vertices, {} states, {} inputs",
        problem.file.name,
        problem.task.name(),
        plant.vertices.len(),
        plant.states(),
        plant.inputs()
    )
}

fn scenario(args: &CheckArgs, text: &str) -> Result<Scenario, CliError> {
    Scenario::from_json(text).map_err(|problem| CliError::file(&args.file, problem))
}

fn requirements(args: &CheckArgs, text: &str) -> Result<String, CliError> {
    let found = Requirements::from_json(text);
    let found = found.map_err(|problem| CliError::file(&args.file, problem))?;
    let (file, least) = (&found.file, least_time_s(&found));
    Ok(format!(
        "{}, {} deg within {} s; any controller needs {least:.3} s",
        file.name, file.manoeuvre.angle_deg, file.limits.settle_s
    ))
}
