//! What a campaign samples for every run.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::ModelError;

use super::distribution::Distribution;
use crate::base::bounded::{As, Positive, Unit};
use crate::base::ranges::require;
use crate::plants::SystemFile;

/// What a campaign draws anew for every run. A single run without an index leaves it aside.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DispersionsFile {
    /// How the drawn numbers are spread over the runs.
    #[serde(default)]
    pub sampling: PlanFile,
    /// Attitude of a spacecraft at the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_attitude: Option<AttitudeDispersionFile>,
    /// Added to each component of a spacecraft's rate at the start, each drawn by itself [rad/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_rate_rad_s: Option<Distribution>,
    /// Added to each component of the state of a plant that is no spacecraft at the start, each drawn by
    /// itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_state: Option<Distribution>,
    /// Start on the boundary of the certified set of the design, in the place of the three above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certified_boundary: Option<BoundaryFile>,
    /// Inertia of a spacecraft.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<InertiaDispersionFile>,
    /// Amplitude and phase of the disturbance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbance: Option<DisturbanceDispersionFile>,
    /// Faults of a spacecraft's actuators, in addition to those of the scenario.
    #[serde(default)]
    pub faults: Vec<FaultDispersion>,
    /// Any other number of the scenario by its name, such as `sampling.dropout_probability`.
    #[serde(default)]
    pub values: Vec<ValueDispersionFile>,
}

/// How the drawn numbers are spread over the runs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlanFile {
    /// Every number of every run by itself.
    #[default]
    Independent,
    /// Every number in N runs takes one value from each of N equally probable intervals.
    LatinHypercube,
    /// A Sobol sequence with the direction numbers of Joe and Kuo, shifted by the seed.
    Sobol,
}

/// Attitude at the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum AttitudeDispersionFile {
    /// Any attitude, uniform over all rotations. Write `{}` after it.
    Uniform {},
    /// The scenario's attitude turned about an axis of uniformly random direction.
    AxisAngle {
        /// The angle (deg).
        angle_deg: Distribution,
    },
}

/// The boundary of the certified set x'Ux <= 1 of a design.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundaryFile {
    /// x'Ux of every start, above 0; 1, the edge of the certified set, when left out. The direction is
    /// uniform in the metric of U, so units play no part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<Positive>,
}

/// Changes of the inertia matrix. The controller keeps what it knows of the nominal one.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InertiaDispersionFile {
    /// Change of each moment of inertia, drawn by itself (percent of it).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moments_percent: Option<Distribution>,
    /// Change of each product of inertia, drawn by itself (percent of it).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub products_percent: Option<Distribution>,
}

/// Changes of the disturbance.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisturbanceDispersionFile {
    /// Factor of the whole disturbance: bias, sines and table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<Distribution>,
    /// Phase added to each of the sines, drawn by itself (deg).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase_deg: Option<Distribution>,
}

/// A fault that may happen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultDispersion {
    /// Which of the list, from 1; set by the check.
    #[serde(skip)]
    pub number: usize,
    /// Probability that it happens in a run, in [0, 1]; 1 when left out.
    #[serde(default = "certain", with = "As::<Unit>")]
    pub probability: f64,
    /// Axis: 1, 2 or 3; any of them when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 3))]
    pub axis: Option<u32>,
    /// Start (s).
    pub from_s: Distribution,
    /// Duration; to the end of the run when left out (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<Distribution>,
    /// Share of the commanded torque that acts.
    pub effectiveness: Distribution,
}

fn certain() -> f64 {
    1.0
}

/// A number of the scenario.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ValueDispersionFile {
    /// Its name, such as `system.rigid_body.sensors.attitude_noise_deg`; the end of the name will do
    /// when it is the end of one name only.
    pub name: String,
    /// What is drawn.
    pub distribution: Distribution,
    /// What is done with it.
    #[serde(default)]
    pub change: ChangeFile,
}

/// What is done with a drawn value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ChangeFile {
    /// It takes the place of the scenario's.
    #[default]
    Replace,
    /// It is added.
    Add,
    /// The scenario's is multiplied by it.
    Multiply,
}

/// What a campaign samples for every run.
#[derive(Debug, Clone, PartialEq)]
pub struct Dispersions {
    /// How the drawn numbers are spread over the runs.
    pub sampling: PlanFile,
    /// What is drawn, in the order in which it is applied.
    pub all: Vec<Dispersion>,
}

/// One thing that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Dispersion {
    /// A number of the scenario file.
    Number {
        /// Its name.
        name: String,
        /// What is drawn.
        distribution: Distribution,
        /// What is done with it.
        change: ChangeFile,
    },
    /// Any attitude at the start.
    AnyAttitude,
    /// The attitude at the start turned about a random axis, deg.
    Turn(Distribution),
    /// Added to each rate at the start, rad/s.
    Rate(Distribution),
    /// Added to each of so many states at the start.
    State(Distribution, usize),
    /// A start on x'Ux = level of the design.
    Boundary {
        /// The level.
        level: f64,
    },
    /// Changes of the moments and of the products of inertia, percent.
    Inertia([Option<Distribution>; 2]),
    /// Factor of the disturbance.
    Factor(Distribution),
    /// Phase added to each of so many sines, deg.
    Phase(Distribution, usize),
    /// A fault.
    Fault(FaultDispersion),
}

/// Numbers that a dispersion may not change: they belong to the campaign.
const FIXED: [&str; 5] = [
    "schema_version",
    "random.",
    "duration_s",
    "requirements",
    "output.",
];

/// Checks the dispersions of a file, as far as they can be checked without a design.
pub(crate) fn check_dispersions(
    file: &DispersionsFile,
    system: &SystemFile,
) -> Result<Dispersions, ModelError> {
    let mut all = Vec::new();
    for (index, value) in file.values.iter().enumerate() {
        let field = format!("values[{index}]");
        if FIXED.iter().any(|fixed| value.name.starts_with(fixed)) {
            let expected =
                "a number other than the seed, the duration, the requirements and the output";
            let found = format!("'{}'", value.name);
            return Err(ModelError::shape(format!("{field}.name"), found, expected));
        }
        all.push(Dispersion::Number {
            name: value.name.clone(),
            distribution: value.distribution.clone(),
            change: value.change,
        });
    }
    check_kind(file, system)?;
    check_start(file, system, &mut all)?;
    if let Some(inertia) = &file.inertia {
        let parts = [&inertia.moments_percent, &inertia.products_percent];
        all.push(Dispersion::Inertia(parts.map(Clone::clone)));
    }
    if let Some(disturbance) = &file.disturbance {
        all.extend(disturbance.factor.clone().map(Dispersion::Factor));
        let sines = match system {
            SystemFile::RigidBody(body) => body.disturbance.sines.len(),
            SystemFile::TakagiSugeno(model) => model.disturbance.sines.len(),
        };
        let phase = disturbance.phase_deg.clone();
        all.extend(phase.map(|phase| Dispersion::Phase(phase, sines)));
    }
    for (index, fault) in file.faults.iter().enumerate() {
        let fault = check_fault(index, fault)?;
        all.push(Dispersion::Fault(fault));
    }
    Ok(Dispersions {
        sampling: file.sampling,
        all,
    })
}

/// Refuses what the kind of plant does not have.
fn check_kind(file: &DispersionsFile, system: &SystemFile) -> Result<(), ModelError> {
    let given: &[(&str, bool)] = match system {
        SystemFile::RigidBody(_) => &[("initial_state", file.initial_state.is_some())],
        SystemFile::TakagiSugeno(_) => &[
            ("initial_attitude", file.initial_attitude.is_some()),
            ("initial_rate_rad_s", file.initial_rate_rad_s.is_some()),
            ("inertia", file.inertia.is_some()),
            ("faults", !file.faults.is_empty()),
        ],
    };
    let Some((field, _)) = given.iter().find(|(_, given)| *given) else {
        return Ok(());
    };
    let reason = match system {
        SystemFile::RigidBody(_) => {
            "the system is rigid_body; initial_attitude and initial_rate_rad_s are for its start"
        }
        SystemFile::TakagiSugeno(_) => {
            "the system is takagi_sugeno, which has none; initial_state is for its start"
        }
    };
    Err(ModelError::choice(*field, reason))
}

fn check_start(
    file: &DispersionsFile,
    system: &SystemFile,
    all: &mut Vec<Dispersion>,
) -> Result<(), ModelError> {
    match &file.initial_attitude {
        None => {}
        Some(AttitudeDispersionFile::Uniform {}) => all.push(Dispersion::AnyAttitude),
        Some(AttitudeDispersionFile::AxisAngle { angle_deg }) => {
            all.push(Dispersion::Turn(angle_deg.clone()));
        }
    }
    all.extend(file.initial_rate_rad_s.clone().map(Dispersion::Rate));
    if let (Some(state), SystemFile::TakagiSugeno(model)) = (&file.initial_state, system) {
        all.push(Dispersion::State(state.clone(), model.initial_state.len()));
    }
    let Some(boundary) = &file.certified_boundary else {
        return Ok(());
    };
    let others = [
        ("initial_attitude", file.initial_attitude.is_some()),
        ("initial_rate_rad_s", file.initial_rate_rad_s.is_some()),
        ("initial_state", file.initial_state.is_some()),
    ];
    if let Some((field, _)) = others.iter().find(|(_, given)| *given) {
        let reason = "must be left out, because certified_boundary sets the whole start";
        return Err(ModelError::choice(*field, reason));
    }
    let level = boundary.level.map_or(1.0, Positive::get);
    all.push(Dispersion::Boundary { level });
    Ok(())
}

fn check_fault(index: usize, file: &FaultDispersion) -> Result<FaultDispersion, ModelError> {
    let field = |name: &str| format!("faults[{index}].{name}");
    if let Some(axis) = file.axis {
        let ok = (1..=3).contains(&axis);
        require(ok, &field("axis"), f64::from(axis), "1, 2 or 3")?;
    }
    for end in file.effectiveness.range() {
        let ok = (0.0..=1.0).contains(&end);
        let allowed =
            "in [0, 1] for every value; at_least and at_most cut a normal distribution off";
        require(ok, &field("effectiveness"), end, allowed)?;
    }
    Ok(FaultDispersion {
        number: index + 1,
        ..file.clone()
    })
}
