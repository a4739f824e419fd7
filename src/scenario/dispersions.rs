//! The checked dispersions of a scenario.

use synth::model::{check_positive, ModelError};

use super::dispersions_file::{
    AttitudeDispersionFile, ChangeFile, DispersionsFile, DistributionFile, FaultDispersionFile,
    PlanFile,
};
use super::distribution::Distribution;
use crate::base::ranges::require;
use crate::plants::SystemFile;

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

/// A fault that may happen.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultDispersion {
    /// Which of the list, from 1.
    pub number: usize,
    /// Probability that it happens.
    pub probability: f64,
    /// Axis; any when left out.
    pub axis: Option<u32>,
    /// Start, s.
    pub from_s: Distribution,
    /// Duration, s; to the end when left out.
    pub duration_s: Option<Distribution>,
    /// Fraction of the commanded torque that acts.
    pub effectiveness: Distribution,
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
            return Err(ModelError::WrongShape {
                field: format!("{field}.name"),
                found: format!("'{}'", value.name),
                expected:
                    "a number other than the seed, the duration, the requirements and the output"
                        .to_string(),
            });
        }
        all.push(Dispersion::Number {
            name: value.name.clone(),
            distribution: Distribution::new(&format!("{field}.distribution"), &value.distribution)?,
            change: value.change,
        });
    }
    check_kind(file, system)?;
    check_start(file, system, &mut all)?;
    if let Some(inertia) = &file.inertia {
        let part = |name: &str, file: &Option<DistributionFile>| {
            let field = format!("inertia.{name}_percent");
            optional(&field, file)
        };
        let moments = part("moments", &inertia.moments_percent)?;
        let products = part("products", &inertia.products_percent)?;
        all.push(Dispersion::Inertia([moments, products]));
    }
    if let Some(disturbance) = &file.disturbance {
        let factor = optional("disturbance.factor", &disturbance.factor)?;
        all.extend(factor.map(Dispersion::Factor));
        let sines = match system {
            SystemFile::RigidBody(body) => body.disturbance.sines.len(),
            SystemFile::TakagiSugeno(model) => model.disturbance.sines.len(),
        };
        let phase = optional("disturbance.phase_deg", &disturbance.phase_deg)?;
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

fn optional(
    field: &str,
    file: &Option<DistributionFile>,
) -> Result<Option<Distribution>, ModelError> {
    let distribution = file.as_ref().map(|file| Distribution::new(field, file));
    distribution.transpose()
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
    Err(ModelError::Choice {
        field: field.to_string(),
        reason: reason.to_string(),
    })
}

fn check_start(
    file: &DispersionsFile,
    system: &SystemFile,
    all: &mut Vec<Dispersion>,
) -> Result<(), ModelError> {
    match &file.initial_attitude {
        None => {}
        Some(AttitudeDispersionFile::Uniform(_)) => all.push(Dispersion::AnyAttitude),
        Some(AttitudeDispersionFile::AxisAngle(turn)) => {
            let field = "initial_attitude.axis_angle.angle_deg";
            all.push(Dispersion::Turn(Distribution::new(field, &turn.angle_deg)?));
        }
    }
    let rate = optional("initial_rate_rad_s", &file.initial_rate_rad_s)?;
    all.extend(rate.map(Dispersion::Rate));
    if let (Some(state), SystemFile::TakagiSugeno(model)) = (&file.initial_state, system) {
        let state = Distribution::new("initial_state", state)?;
        all.push(Dispersion::State(state, model.initial_state.len()));
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
        return Err(ModelError::Choice {
            field: field.to_string(),
            reason: "must be left out, because certified_boundary sets the whole start".to_string(),
        });
    }
    let level = boundary.level.unwrap_or(1.0);
    check_positive("certified_boundary.level", level)?;
    all.push(Dispersion::Boundary { level });
    Ok(())
}

fn check_fault(index: usize, file: &FaultDispersionFile) -> Result<FaultDispersion, ModelError> {
    let field = |name: &str| format!("faults[{index}].{name}");
    let probability = file.probability;
    let ok = (0.0..=1.0).contains(&probability);
    require(ok, &field("probability"), probability, "in [0, 1]")?;
    if let Some(axis) = file.axis {
        let ok = (1..=3).contains(&axis);
        require(ok, &field("axis"), f64::from(axis), "1, 2 or 3")?;
    }
    let effectiveness = Distribution::new(&field("effectiveness"), &file.effectiveness)?;
    for end in effectiveness.range() {
        let ok = (0.0..=1.0).contains(&end);
        let allowed =
            "in [0, 1] for every value; at_least and at_most cut a normal distribution off";
        require(ok, &field("effectiveness"), end, allowed)?;
    }
    Ok(FaultDispersion {
        number: index + 1,
        probability,
        axis: file.axis,
        from_s: Distribution::new(&field("from_s"), &file.from_s)?,
        duration_s: optional(&field("duration_s"), &file.duration_s)?,
        effectiveness,
    })
}
