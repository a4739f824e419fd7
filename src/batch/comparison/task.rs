//! What is the same for every controller of a comparison.

use std::collections::BTreeSet;
use std::path::PathBuf;

use nalgebra::Vector3;
use serde_json::Value;
use synth::model::{ModelError, Plant};

use crate::batch::engine::Interrupted;
use crate::controllers::ControllerChoice;
use crate::plants::{System, SystemFile};
use crate::run::design::Design;
use crate::run::outcome::SimulateError;
use crate::scenario::{Scenario, ScenarioFile};
use crate::sim::embedding;

/// A controller with the task it runs on.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Name in tables and figures.
    pub label: String,
    /// The scenario as written.
    pub entry: Entry,
    /// The checked scenario.
    pub scenario: Scenario,
    /// The design, for a scenario whose controller is one.
    pub design: Option<Design>,
}

impl Candidate {
    /// The torque that can act on each axis, N m: the smaller of the controller's limit and the
    /// actuators'; infinite without either.
    pub fn torque_limit(&self) -> Vector3<f64> {
        let own = match (&self.design, self.scenario.controller.law()) {
            (_, Some(law)) => law.torque_limit(),
            (Some(design), None) => match &design.model.plant {
                Plant::Spacecraft(craft) => craft.torque_limit,
                plant => {
                    let limit = plant.takagi_sugeno().input_limit;
                    embedding::filled(limit.as_slice(), f64::INFINITY)
                }
            },
            (None, None) => Vector3::repeat(f64::INFINITY),
        };
        match &self.scenario.system {
            System::RigidBody(body) => own.zip_map(&body.actuators.limit, f64::min),
            System::TakagiSugeno(_) => own,
        }
    }

    /// Whether the controller is that of a design file.
    pub fn needs_design(&self) -> bool {
        matches!(self.scenario.controller, ControllerChoice::Design(_))
    }
}

/// A scenario file to be compared.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Where it is.
    pub path: PathBuf,
    /// The file.
    pub file: ScenarioFile,
    /// SHA-256 of its text.
    pub sha256: String,
}

/// A field in which two tasks differ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// The field.
    pub field: String,
    /// Its value here.
    pub value: String,
    /// Its value there.
    pub other: String,
}

/// Why scenarios cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ComparisonError {
    /// A scenario's plant is not a spacecraft.
    #[error("{file}: field 'system': only scenarios of a rigid_body can be compared")]
    NotASpacecraft {
        /// The scenario.
        file: String,
    },
    /// Two tasks differ.
    #[error(
        "{file}: field '{}' is {}, but {} in {other_file}; only controllers on the same task can be \
         compared (--take-system-from FILE imposes the task of one scenario on all)",
        difference.field, difference.value, difference.other
    )]
    Differs {
        /// The scenario.
        file: String,
        /// The one before it.
        other_file: String,
        /// The first difference.
        difference: Difference,
    },
    /// A scenario does not allow a standard fault.
    #[error("{label}: {problem}")]
    Fault {
        /// The controller.
        label: String,
        /// What is wrong.
        problem: ModelError,
    },
    /// A scenario cannot be run.
    #[error("{label}: {problem}")]
    Simulate {
        /// The controller.
        label: String,
        /// What is wrong.
        problem: SimulateError,
    },
    /// It was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// Keys of the scenario file that make the task: spacecraft, start, reference, disturbance, sensors,
/// actuators and faults; length of the run; how errors are summed up; what is required.
const KEYS: [&str; 4] = ["system", "duration_s", "metrics", "requirements"];

impl Entry {
    fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Refuses a plant that is not a spacecraft.
    ///
    /// # Errors
    /// It is not one.
    pub fn check_spacecraft(&self) -> Result<(), ComparisonError> {
        match &self.file.system {
            SystemFile::RigidBody(_) => Ok(()),
            SystemFile::TakagiSugeno(_) => {
                let file = self.name();
                Err(ComparisonError::NotASpacecraft { file })
            }
        }
    }

    /// The first field in which two tasks differ. The actuators' torque limits are left out: what
    /// counts is the torque that can act, and the controllers have limits of their own.
    fn first_difference(&self, other: &Self) -> Option<Difference> {
        let parts = |entry: &Self| -> Value {
            let mut file = entry.file.clone();
            if let SystemFile::RigidBody(body) = &mut file.system {
                body.actuators.torque_limit_nm = None;
            }
            // A scenario that was read from JSON can be written as JSON.
            serde_json::to_value(&file).unwrap_or_default()
        };
        let (here, there) = (parts(self), parts(other));
        let mut keys = KEYS.iter();
        keys.find_map(|key| difference(key, &here[key], &there[key]))
    }
}

/// Refuses entries of different tasks.
///
/// # Errors
/// A plant that is not a spacecraft; a task that differs from the first.
pub fn check_one_task(entries: &[Entry]) -> Result<(), ComparisonError> {
    entries.iter().try_for_each(Entry::check_spacecraft)?;
    let Some((first, others)) = entries.split_first() else {
        return Ok(());
    };
    for entry in others {
        if let Some(difference) = entry.first_difference(first) {
            return Err(ComparisonError::Differs {
                file: entry.name(),
                other_file: first.name(),
                difference,
            });
        }
    }
    Ok(())
}

/// The task of one candidate, which may be any, in place of every entry's own, with the torque that can act
/// there as the actuators' limit.
///
/// # Errors
/// A plant that is not a spacecraft.
pub fn impose(source: &Candidate, entries: &mut [Entry]) -> Result<(), ComparisonError> {
    let mut task = source.entry.file.clone();
    if let SystemFile::RigidBody(body) = &mut task.system {
        let limit = source.torque_limit();
        let finite = limit.iter().all(|value| value.is_finite());
        body.actuators.torque_limit_nm = finite.then_some(limit.into());
    }
    for entry in entries {
        entry.check_spacecraft()?;
        entry.file.system = task.system.clone();
        entry.file.duration_s = task.duration_s;
        entry.file.metrics = task.metrics.clone();
        entry.file.requirements = task.requirements.clone();
    }
    Ok(())
}

/// Tells candidates of the same name apart by their files.
pub fn name_apart(candidates: &mut [Candidate]) {
    let names: Vec<String> = candidates.iter().map(|one| one.label.clone()).collect();
    for candidate in candidates {
        let alike = names.iter().filter(|name| **name == candidate.label);
        if alike.count() > 1 {
            candidate.label += &format!(" ({})", candidate.entry.name());
        }
    }
}

/// The first place where two values differ.
fn difference(field: &str, here: &Value, there: &Value) -> Option<Difference> {
    if here == there || equal_numbers(here, there) {
        return None;
    }
    let inside = match (here, there) {
        (Value::Object(left), Value::Object(right)) => {
            let keys: BTreeSet<&String> = left.keys().chain(right.keys()).collect();
            let mut keys = keys.into_iter();
            keys.find_map(|key| difference(&format!("{field}.{key}"), &here[key], &there[key]))
        }
        (Value::Array(left), Value::Array(right)) if left.len() == right.len() => {
            let mut pairs = (0..).zip(left.iter().zip(right));
            return pairs
                .find_map(|(index, (a, b))| difference(&format!("{field}[{index}]"), a, b));
        }
        _ => None,
    };
    inside.or_else(|| {
        Some(Difference {
            field: field.to_string(),
            value: shown(here),
            other: shown(there),
        })
    })
}

fn equal_numbers(here: &Value, there: &Value) -> bool {
    matches!((here.as_f64(), there.as_f64()), (Some(a), Some(b)) if a == b)
}

/// A value in one line, not too long.
fn shown(value: &Value) -> String {
    const LONGEST: usize = 60;
    if value.is_null() {
        return "left out".to_string();
    }
    let text = value.to_string();
    if text.chars().count() <= LONGEST {
        return text;
    }
    text.chars().take(LONGEST).chain("...".chars()).collect()
}

/// The difference of the torques that can act.
pub(crate) fn limit_difference(here: &Vector3<f64>, there: &Vector3<f64>) -> Option<Difference> {
    let axis = (0..3).find(|&axis| here[axis] != there[axis])?;
    let text = |value: f64| match value.is_finite() {
        true => format!("{value} N m"),
        false => "without limit".to_string(),
    };
    Some(Difference {
        field: format!("torque limit of axis {}", axis + 1),
        value: text(here[axis]),
        other: text(there[axis]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_first_difference_is_named_with_its_place() {
        let here = json!({ "a": [1, 2.0], "b": { "c": "x" } });
        assert_eq!(difference("s", &here, &here), None);
        assert_eq!(difference("s", &json!(1), &json!(1.0)), None);
        let cases = [
            (
                json!({ "a": [1, 3], "b": { "c": "x" } }),
                "s.a[1]",
                "2.0",
                "3",
            ),
            (
                json!({ "a": [1], "b": { "c": "x" } }),
                "s.a",
                "[1,2.0]",
                "[1]",
            ),
            (
                json!({ "a": [1, 2], "b": {} }),
                "s.b.c",
                "\"x\"",
                "left out",
            ),
        ];
        for (there, field, value, other) in cases {
            let found = difference("s", &here, &there);
            let expected = Difference {
                field: field.to_string(),
                value: value.to_string(),
                other: other.to_string(),
            };
            assert_eq!(found, Some(expected));
        }
    }
}
