//! What a file holds, in short.

use synth::fuzzy::triangle_excess;
use synth::model::{GainsFile, Model, Plant};
use synth::problem::Problem;

use crate::batch::tune::file::Requirements;
use crate::batch::tune::limits::least_time_s;

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
        "{}, {} deg within {} s; any controller needs {least:.3} s",
        file.name, file.manoeuvre.angle_deg, file.limits.settle_s
    )
}
