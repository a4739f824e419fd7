//! What is the same for every controller of a comparison.

use nalgebra::Vector3;
use serde_json::Value;
use synth::model::Plant;

use crate::controllers::ControllerChoice;
use crate::plants::{System, SystemFile};
use crate::run::design::Design;
use crate::scenario::{Scenario, ScenarioFile};
use crate::sim::padding;

/// A controller with the task it runs on.
#[derive(Debug, Clone)]
pub struct ComparisonCandidate {
    /// Name in tables and figures.
    pub label: String,
    /// The scenario as written.
    pub file: ScenarioFile,
    /// The checked scenario.
    pub scenario: Scenario,
    /// The design, for a scenario whose controller is one.
    pub design: Option<Design>,
}

impl ComparisonCandidate {
    /// The torque that can act on each axis, N m: the smaller of the controller's limit and the
    /// actuators'; infinite without either.
    pub fn torque_limit(&self) -> Vector3<f64> {
        let own = match (&self.design, self.scenario.controller.torque_limit()) {
            (_, Some(limit)) => limit,
            (Some(design), None) => match &design.model.plant {
                Plant::Spacecraft(craft) => craft.torque_limit,
                plant => {
                    let limit = plant.takagi_sugeno().input_limit;
                    padding::filled(limit.as_slice(), f64::INFINITY)
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

/// Spacecraft, start, reference, disturbance, sensors, actuators and faults; length of the run; how
/// errors are summed up; what is required.
#[derive(Debug, Clone, PartialEq)]
pub struct Task(ScenarioFile);

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
}

/// Keys of the scenario file that make the task.
const KEYS: [&str; 4] = ["system", "duration_s", "metrics", "requirements"];

impl Task {
    /// The task of a scenario file.
    ///
    /// # Errors
    /// A plant that is not a spacecraft.
    pub fn of(name: &str, file: &ScenarioFile) -> Result<Self, ComparisonError> {
        match &file.system {
            SystemFile::RigidBody(_) => Ok(Self(file.clone())),
            SystemFile::TakagiSugeno(_) => Err(ComparisonError::NotASpacecraft {
                file: name.to_string(),
            }),
        }
    }

    /// The first field in which two tasks differ. The actuators' torque limits are left out: what
    /// counts is the torque that can act, and the controllers have limits of their own.
    pub fn first_difference(&self, other: &Self) -> Option<Difference> {
        let parts = |task: &Self| -> Value {
            let mut file = task.0.clone();
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

    /// The scenario with this task in place of its own. `limit`: the torque that can act, N m.
    pub fn imposed_on(&self, file: &ScenarioFile, limit: &Vector3<f64>) -> ScenarioFile {
        let mut system = self.0.system.clone();
        if let SystemFile::RigidBody(body) = &mut system {
            let finite = limit.iter().all(|value| value.is_finite());
            body.actuators.torque_limit_nm = finite.then_some((*limit).into());
        }
        ScenarioFile {
            system,
            duration_s: self.0.duration_s,
            metrics: self.0.metrics.clone(),
            requirements: self.0.requirements.clone(),
            ..file.clone()
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
            let keys = left.keys().chain(right.keys());
            let mut keys: Vec<&String> = keys.collect();
            keys.sort();
            keys.into_iter().find_map(|key| {
                let (a, b) = (left.get(key), right.get(key));
                let (a, b) = (a.unwrap_or(&Value::Null), b.unwrap_or(&Value::Null));
                difference(&format!("{field}.{key}"), a, b)
            })
        }
        (Value::Array(left), Value::Array(right)) if left.len() == right.len() => {
            let pairs = left.iter().zip(right).enumerate();
            let mut pairs = pairs.into_iter();
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
