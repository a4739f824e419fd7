//! From a scenario file to checked numbers.

use synth::model::{check_line, check_positive, finite, parse, FileError, Kind, ModelError};

use super::dispersions::{check_dispersions, Dispersions};
use super::file::{
    InstantsFile, IntegratorFile, MetricsFile, RequirementFile, SamplingFile, ScenarioFile,
    SCENARIO_SCHEMA_VERSION,
};
use super::links::check_link;
use crate::base::provenance::sha256_of;
use crate::base::ranges::require;
use crate::controllers::registry::check_controller;
use crate::controllers::ControllerChoice;
use crate::plants::registry::check_system;
use crate::plants::System;
use crate::sim::integrator::Method;
use crate::sim::link::LinkData;
use crate::sim::sampling::Instants;

/// Most samples or integration steps of one run; more is a typing error.
const MAX_STEPS: f64 = 1e9;
/// Most rows of a trajectory that the sampling grid may ask for.
const MAX_ROWS: f64 = 1e7;
/// Settling tolerance of the attitude when the file gives none, deg.
const DEFAULT_SETTLE_TOLERANCE_DEG: f64 = 1.0;
/// Settling tolerance of another plant's state when the file gives none.
const DEFAULT_SETTLE_TOLERANCE_STATE: f64 = 0.01;
/// Fraction of the run over which the root mean square is taken when the file gives none.
const DEFAULT_TAIL: f64 = 0.2;
/// Rows of the trajectory when the file gives no interval.
const DEFAULT_ROWS: f64 = 4000.0;

/// A checked scenario. Its parts may be changed by a program that runs many variants.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// A short name.
    pub name: String,
    /// Where the numbers come from.
    pub source: String,
    /// SHA-256 of the file's bytes, in hexadecimal.
    pub sha256: String,
    /// Length of the run, s.
    pub duration_s: f64,
    /// Seed of the generator.
    pub seed: u64,
    /// The plant with its surroundings.
    pub system: System,
    /// When the sensor is sampled.
    pub instants: Instants,
    /// Probability that a sample is lost.
    pub dropout_probability: f64,
    /// The controller.
    pub controller: ControllerChoice,
    /// The link to the actuators.
    pub link: Option<LinkData<3>>,
    /// How the plant is integrated.
    pub method: Method,
    /// When an attitude error counts as settled, rad.
    pub settle_tolerance_rad: f64,
    /// When an attitude error counts as settled instead: the largest component of its vector part.
    pub settle_tolerance_component: Option<f64>,
    /// When another plant's state counts as settled.
    pub settle_tolerance_state: f64,
    /// Length of the tail, s.
    pub tail_s: f64,
    /// Requirements.
    pub requirements: Vec<RequirementFile>,
    /// Longest time between two rows of the trajectory, s.
    pub output_interval_s: f64,
    /// What a campaign samples for every run.
    pub dispersions: Option<Dispersions>,
}

impl Scenario {
    /// Reads and checks the text of a scenario file.
    ///
    /// # Errors
    /// The first field that is missing, unknown, of the wrong type or out of its range.
    pub fn from_json(text: &str) -> Result<Self, FileError> {
        let (file, sha256) = Self::read(text)?;
        Ok(Self::from_file(&file, sha256)?)
    }

    /// Reads the text of a scenario file, unchecked, and its SHA-256 in hexadecimal.
    ///
    /// # Errors
    /// A field that is missing, unknown or of the wrong type.
    pub fn read(text: &str) -> Result<(ScenarioFile, String), FileError> {
        let file: ScenarioFile = parse(text, Kind::Scenario)?;
        Ok((file, sha256_of(text)))
    }

    /// Checks a scenario file.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub fn from_file(file: &ScenarioFile, sha256: String) -> Result<Self, ModelError> {
        if file.schema_version != SCENARIO_SCHEMA_VERSION {
            return Err(ModelError::SchemaVersion {
                found: file.schema_version,
                expected: SCENARIO_SCHEMA_VERSION,
            });
        }
        check_line("name", &file.name)?;
        check_positive("duration_s", file.duration_s)?;
        let system = check_system(&file.system, file.random.seed)?;
        let controller = check_controller(&file.controller, &system)?;
        let instants = check_sampling(&file.sampling, file.duration_s)?;
        let method = check_integrator(&file.integrator, file.duration_s)?;
        let link = file.link.as_ref();
        let link = link.map(|link| check_link(link, &system, &instants));
        check_continuous(&instants, &method, &system, &controller)?;
        check_metrics(&file.metrics, file.duration_s)?;
        check_requirements(&file.requirements)?;
        let dispersions = file.dispersions.as_ref();
        let dispersions = dispersions.map(|all| check_dispersions(all, &file.system));
        let dispersions = dispersions.transpose();
        let tolerance_deg = file.metrics.settle_tolerance_deg;
        Ok(Self {
            name: file.name.clone(),
            source: file.source.clone(),
            sha256,
            duration_s: file.duration_s,
            seed: file.random.seed,
            system,
            instants,
            dropout_probability: file.sampling.dropout_probability,
            controller,
            link: link.transpose()?,
            method,
            settle_tolerance_rad: tolerance_deg
                .unwrap_or(DEFAULT_SETTLE_TOLERANCE_DEG)
                .to_radians(),
            settle_tolerance_component: file.metrics.settle_tolerance_component,
            settle_tolerance_state: file
                .metrics
                .settle_tolerance_state
                .unwrap_or(DEFAULT_SETTLE_TOLERANCE_STATE),
            tail_s: file
                .metrics
                .tail_s
                .unwrap_or(DEFAULT_TAIL * file.duration_s),
            requirements: file.requirements.clone(),
            output_interval_s: check_output(file)?,
            dispersions: dispersions.map_err(|error| error.within("dispersions"))?,
        })
    }
}

fn check_step_count(field: &str, step: f64, duration: f64) -> Result<(), ModelError> {
    check_positive(field, step)?;
    let least = duration / MAX_STEPS;
    require(
        step >= least,
        field,
        step,
        &format!("at least duration_s / {MAX_STEPS:e}"),
    )
}

fn check_sampling(file: &SamplingFile, duration: f64) -> Result<Instants, ModelError> {
    let lost = file.dropout_probability;
    let ok = (0.0..1.0).contains(&lost);
    require(ok, "sampling.dropout_probability", lost, "in [0, 1)")?;
    match &file.instants {
        InstantsFile::Periodic(periodic) => {
            let field = "sampling.instants.periodic";
            check_step_count(
                &format!("{field}.interval_s"),
                periodic.interval_s,
                duration,
            )?;
            let ok = (0.0..0.5 * periodic.interval_s).contains(&periodic.jitter_s);
            let allowed = "0 or above and below half of interval_s";
            require(ok, &format!("{field}.jitter_s"), periodic.jitter_s, allowed)?;
            Ok(Instants::Periodic {
                interval_s: periodic.interval_s,
                jitter_s: periodic.jitter_s,
            })
        }
        InstantsFile::Aperiodic(aperiodic) => {
            let field = "sampling.instants.aperiodic";
            let (shortest, longest) = (aperiodic.shortest_s, aperiodic.longest_s);
            check_positive(&format!("{field}.shortest_s"), shortest)?;
            check_step_count(&format!("{field}.longest_s"), longest, duration)?;
            let ok = shortest <= longest;
            require(
                ok,
                &format!("{field}.longest_s"),
                longest,
                "shortest_s or above",
            )?;
            Ok(Instants::Aperiodic {
                shortest_s: shortest,
                longest_s: longest,
            })
        }
        InstantsFile::Continuous(continuous) => {
            let field = "sampling.instants.continuous.resolution_s";
            let resolution_s = continuous.resolution_s;
            require(resolution_s >= 1e-9, field, resolution_s, "at least 1e-9")?;
            Ok(Instants::Continuous { resolution_s })
        }
    }
}

fn check_integrator(file: &IntegratorFile, duration: f64) -> Result<Method, ModelError> {
    match file {
        IntegratorFile::RungeKutta4(fixed) => {
            check_step_count("integrator.runge_kutta4.step_s", fixed.step_s, duration)?;
            Ok(Method::RungeKutta4 {
                step_s: fixed.step_s,
            })
        }
        IntegratorFile::DormandPrince853(adaptive) => {
            let tolerance = adaptive.tolerance;
            let ok = (1e-14..=1e-3).contains(&tolerance);
            let field = "integrator.dormand_prince853.tolerance";
            require(ok, field, tolerance, "in [1e-14, 0.001]")?;
            Ok(Method::DormandPrince853 { tolerance })
        }
    }
}

/// Root finding asks the sensor again and again about the same moment.
fn check_continuous(
    instants: &Instants,
    method: &Method,
    system: &System,
    controller: &ControllerChoice,
) -> Result<(), ModelError> {
    let Instants::Continuous { resolution_s } = instants else {
        return Ok(());
    };
    if controller.law().is_some_and(|law| law.sends_every_sample()) {
        let field = "sampling.instants.continuous.resolution_s";
        let allowed =
            "left out, and the sampling periodic or aperiodic, because the controller sends \
                       every sample";
        return require(false, field, *resolution_s, allowed);
    }
    let refuse = |field: &str, value: f64, allowed: &str| {
        let allowed = format!("{allowed} when sampling.instants is continuous");
        require(false, field, value, &allowed)
    };
    if let Method::DormandPrince853 { tolerance } = method {
        return refuse(
            "integrator.dormand_prince853.tolerance",
            *tolerance,
            "left out",
        );
    }
    match system {
        System::RigidBody(body) if !body.sensors.is_perfect() => {
            let noise = body.sensors.attitude_noise_rad.to_degrees();
            refuse(
                "system.rigid_body.sensors.attitude_noise_deg",
                noise,
                "0, as every sensor error,",
            )
        }
        System::TakagiSugeno(model) if model.state_noise > 0.0 => {
            refuse("system.takagi_sugeno.state_noise", model.state_noise, "0")
        }
        _ => Ok(()),
    }
}

fn check_metrics(file: &MetricsFile, duration: f64) -> Result<(), ModelError> {
    if let Some(tolerance) = file.settle_tolerance_deg {
        let ok = tolerance > 0.0 && tolerance <= 180.0;
        require(
            ok,
            "metrics.settle_tolerance_deg",
            tolerance,
            "above 0 and at most 180",
        )?;
    }
    if let Some(tolerance) = file.settle_tolerance_component {
        let field = "metrics.settle_tolerance_component";
        let ok = tolerance > 0.0 && tolerance < 1.0;
        require(ok, field, tolerance, "above 0 and below 1")?;
        let alone = file.settle_tolerance_deg.is_none();
        let allowed = "left out when settle_tolerance_deg is given";
        require(alone, field, tolerance, allowed)?;
    }
    if let Some(tolerance) = file.settle_tolerance_state {
        check_positive("metrics.settle_tolerance_state", tolerance)?;
    }
    if let Some(tail) = file.tail_s {
        let ok = tail > 0.0 && tail <= duration;
        require(ok, "metrics.tail_s", tail, "above 0 and at most duration_s")?;
    }
    Ok(())
}

fn check_requirements(requirements: &[RequirementFile]) -> Result<(), ModelError> {
    for (index, requirement) in requirements.iter().enumerate() {
        let field = format!("requirements[{index}]");
        match (requirement.at_most, requirement.at_least) {
            (Some(limit), None) => finite(&format!("{field}.at_most"), limit)?,
            (None, Some(limit)) => finite(&format!("{field}.at_least"), limit)?,
            (most, _) => {
                return Err(ModelError::WrongShape {
                    field,
                    found: format!("{} limits", 2 * u8::from(most.is_some())),
                    expected: "1 limit: at_most or at_least".to_string(),
                })
            }
        }
    }
    Ok(())
}

fn check_output(file: &ScenarioFile) -> Result<f64, ModelError> {
    let Some(interval) = file.output.interval_s else {
        return Ok(file.duration_s / DEFAULT_ROWS);
    };
    check_positive("output.interval_s", interval)?;
    let ok = interval >= file.duration_s / MAX_ROWS;
    let allowed = format!("at least duration_s / {MAX_ROWS:e}");
    require(ok, "output.interval_s", interval, &allowed)?;
    Ok(interval)
}
