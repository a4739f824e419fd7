//! A file that is valid, and what it holds, in short.

use std::path::Path;

use serde::Serialize;
use synth::claim::Claim;
use synth::fuzzy::triangle_excess;
use synth::model::{GainsFile, Kind, Model, Plant};
use synth::problem::Problem;
use synth::requirements::Facts;

use crate::batch::tune::file::Requirements;
use crate::batch::tune::limits::least_time_s;
use crate::controllers::DesignCheck;

/// What a file is.
#[derive(Debug, Serialize)]
pub struct CheckReport<'a> {
    /// Always true.
    valid: bool,
    /// Kind of file.
    kind: String,
    /// What it holds, in short.
    summary: String,
    /// What is allowed and yet hardly meant, with its numbers.
    warnings: Vec<String>,
    /// The conditions of a paper on the parameters of its controller; left out where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    design_check: Option<&'a DesignCheck>,
}

impl<'a> CheckReport<'a> {
    /// Of a valid file.
    pub fn new(
        kind: Kind,
        summary: String,
        warnings: Vec<String>,
        check: Option<&'a DesignCheck>,
    ) -> Self {
        CheckReport {
            valid: true,
            kind: kind.to_string(),
            summary,
            warnings,
            design_check: check,
        }
    }

    /// In words; the warnings are for standard error.
    pub fn lines(&self, path: &Path) -> Vec<String> {
        let (kind, summary) = (&self.kind, &self.summary);
        let title = format!("{}: valid {kind} file: {summary}", path.display());
        let check = self.design_check.into_iter().flat_map(condition_lines);
        [title].into_iter().chain(check).collect()
    }
}

/// A spacecraft and its requirements.
pub fn of_facts(facts: &Facts) -> String {
    let interval = facts.longest_interval();
    let name = &facts.file.name;
    format!("{name}, sampled every {interval} s, the rest to be found")
}

/// The conditions of a paper in words, those that fail marked.
fn condition_lines(check: &DesignCheck) -> Vec<String> {
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
    lines
}

/// A model, or what is about one.
pub fn of_model(name: &str, model: &Model) -> String {
    let (states, inputs, disturbances, outputs) = model.plant.sizes();
    let vertices = model.task().system.vertices.len();
    format!(
        "{name}, {vertices} vertices, {states} states, {inputs} inputs, {disturbances} disturbances, {outputs} outputs{}",
        inertia_set(model)
    )
}

/// What is to be said of an uncertain inertia; empty for one that is known.
fn inertia_set(model: &Model) -> String {
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

/// A problem, or its design.
pub fn of_problem(problem: &Problem) -> String {
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

/// Gains.
pub fn of_gains(gains: &GainsFile) -> String {
    let (inputs, states) = gains.gains[0].shape();
    let count = gains.gains.len();
    format!("{}, {count} gains, {inputs} x {states}", gains.name)
}

/// Requirements of a parameter search.
pub fn of_requirements(requirements: &Requirements) -> String {
    let (file, least) = (&requirements.file, least_time_s(requirements));
    format!(
        "{}, {} deg within {} s; any controller needs {:.5} s",
        file.name,
        file.manoeuvre.angle_deg,
        file.limits.settle_s,
        Claim::AtLeast(least)
    )
}
