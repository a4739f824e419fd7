//! From a scenario file to checked numbers.

use synth::model::{check_line, finite, parse, readable, FileError, Kind, ModelError};

use super::dispersions::{check_dispersions, Dispersions};
use super::file::{MetricsFile, RequirementFile, ScenarioFile, SCENARIO_SCHEMA_VERSION};
use super::link::check_link;
use super::network::{check_network, check_worst, NetworkChoice};
use crate::base::bounded::{HalfTurn, InsideUnit, Positive, Tail};
use crate::base::provenance::sha256_of;
use crate::base::ranges::require;
use crate::controllers::registry::check_controller;
use crate::controllers::{ControllerChoice, DesignCheck};
use crate::plants::System;
use crate::sim::integrator::Method;
use crate::sim::link::LinkData;
use crate::sim::metrics::Metric;
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
    /// The network of the controller's messages.
    pub network: Option<NetworkChoice>,
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
        let system = file.system.check(file.random.seed)?;
        let controller = check_controller(&file.controller, &system)?;
        let (instants, method) = (file.sampling.instants, file.integrator);
        check_sampling(&instants, file.duration_s)?;
        if let Method::RungeKutta4 { step_s } = method {
            check_step_count("integrator.runge_kutta4.step_s", step_s, file.duration_s)?;
        }
        let link = file.link.as_ref();
        let link = link.map(|link| check_link(link, &system, &instants));
        let network = file.network.as_ref();
        let network = network.map(|network| check_network(network, &instants, link.is_some()));
        let network = network.transpose()?;
        check_worst(&system, network.as_ref(), &controller, (&instants, &method))?;
        check_wheels(&system, &method)?;
        check_continuous(&instants, &method, &system, &controller)?;
        check_metrics(&file.metrics, file.duration_s)?;
        check_requirements(&file.requirements)?;
        let dispersions = file.dispersions.as_ref();
        let dispersions = dispersions.map(|all| check_dispersions(all, &file.system));
        let dispersions = dispersions.transpose();
        let metrics = &file.metrics;
        let (angle_deg, component) = (
            metrics.settle_tolerance_deg,
            metrics.settle_tolerance_component,
        );
        let (state, tail_s) = (metrics.settle_tolerance_state, metrics.tail_s);
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
            network,
            method,
            settle_tolerance_rad: angle_deg
                .map_or(DEFAULT_SETTLE_TOLERANCE_DEG, HalfTurn::get)
                .to_radians(),
            settle_tolerance_component: component.map(InsideUnit::get),
            settle_tolerance_state: state.map_or(DEFAULT_SETTLE_TOLERANCE_STATE, Positive::get),
            tail_s: tail_s.map_or(DEFAULT_TAIL * file.duration_s, Tail::get),
            requirements: file.requirements.clone(),
            output_interval_s: check_output(file)?,
            dispersions: dispersions.map_err(|error| error.within("dispersions"))?,
        })
    }
}

fn check_step_count(field: &str, step: f64, duration: f64) -> Result<(), ModelError> {
    if step >= duration / MAX_STEPS {
        return Ok(());
    }
    let [step, duration] = [step, duration].map(readable);
    let reason = format!(
        "{step} s is too short for duration_s, {duration} s: a run has at most {MAX_STEPS:e} steps; shorten the run or \
         lengthen the step"
    );
    Err(ModelError::choice(field, reason))
}

fn check_sampling(instants: &Instants, duration: f64) -> Result<(), ModelError> {
    match *instants {
        Instants::Periodic {
            interval_s,
            jitter_s,
        } => {
            let field = |name: &str| format!("sampling.instants.periodic.{name}");
            check_step_count(&field("interval_s"), interval_s, duration)?;
            let ok = jitter_s < 0.5 * interval_s;
            let allowed = "0 or above and below half of interval_s";
            require(ok, &field("jitter_s"), jitter_s, allowed)
        }
        Instants::Aperiodic {
            shortest_s,
            longest_s,
        } => {
            let field = "sampling.instants.aperiodic.longest_s";
            check_step_count(field, longest_s, duration)?;
            let ok = shortest_s <= longest_s;
            require(ok, field, longest_s, "shortest_s or above")
        }
        Instants::Continuous { .. } => Ok(()),
    }
}

fn check_wheels(system: &System, method: &Method) -> Result<(), ModelError> {
    match system {
        System::RigidBody(body) => body
            .wheels
            .map_or(Ok(()), |wheels| wheels.check_step(method)),
        System::TakagiSugeno(_) => Ok(()),
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
        System::RigidBody(body) if body.sensors.bounded.is_some() => {
            let field = "system.rigid_body.sensors.bounded_error";
            let expected = "none, as every sensor error, when sampling.instants is continuous";
            Err(ModelError::shape(field, "an error", expected))
        }
        System::RigidBody(body) if !body.sensors.is_perfect() => {
            let noise = body.sensors.attitude_noise_rad.to_degrees();
            refuse(
                "system.rigid_body.sensors.attitude_noise_deg",
                noise,
                "0, as every sensor error,",
            )
        }
        System::TakagiSugeno(model) if model.measurement_error.is_some() => {
            let field = "system.takagi_sugeno.measurement_error";
            let expected = "none, as every sensor error, when sampling.instants is continuous";
            Err(ModelError::shape(field, "an error", expected))
        }
        System::TakagiSugeno(model) if model.state_noise > 0.0 => {
            refuse("system.takagi_sugeno.state_noise", model.state_noise, "0")
        }
        _ => Ok(()),
    }
}

fn check_metrics(file: &MetricsFile, duration: f64) -> Result<(), ModelError> {
    if let Some(tolerance) = file.settle_tolerance_component {
        let field = "metrics.settle_tolerance_component";
        let alone = file.settle_tolerance_deg.is_none();
        let allowed = "left out when settle_tolerance_deg is given";
        require(alone, field, tolerance.get(), allowed)?;
    }
    let tail = file.tail_s.map_or(duration, Tail::get);
    let allowed = "above 0 and at most duration_s";
    require(tail <= duration, "metrics.tail_s", tail, allowed)
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
    let default = file.duration_s / DEFAULT_ROWS;
    let interval = file.output.interval_s.map_or(default, Positive::get);
    let allowed = format!("at least duration_s / {MAX_ROWS:e}");
    let ok = interval >= file.duration_s / MAX_ROWS;
    require(ok, "output.interval_s", interval, &allowed)?;
    Ok(interval)
}

/// The conditions of the scenario's controller; `None` when its paper has none that are evaluated
/// here, as for a controller without the trigger that they are about.
pub fn design_check(scenario: &Scenario) -> Option<DesignCheck> {
    let System::RigidBody(system) = &scenario.system else {
        return None;
    };
    let mut requirements = scenario.requirements.iter();
    let of_rate = requirements.find(|requirement| requirement.metric == Metric::MaxRate);
    let rate_limit = of_rate.and_then(|requirement| requirement.at_most);
    scenario.controller.law()?.conditions(system, rate_limit)
}
