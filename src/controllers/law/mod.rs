//! What the rest of the program asks of a controller of a spacecraft.

use nalgebra::{Matrix3, Vector3};
use runtime::attitude::AttitudeMeasurement;
use runtime::error::ParameterError;
use serde::Serialize;
use serde_json::Value;
use synth::model::ModelError;

use crate::base::condition::Condition;
use crate::plants::RigidBodySystem;
use crate::sim::controller::Use;
use crate::sim::events::EventCount;
use crate::sim::sampling::Instants;

/// A controller as written in a scenario file.
pub trait LawFile {
    /// The controller with its numbers checked.
    type Law: AttitudeLaw;

    /// Checks the numbers, for this spacecraft.
    ///
    /// # Errors
    /// A number that is out of its range; the field is named from the controller's own object on.
    fn check(&self, system: &RigidBodySystem) -> Result<Self::Law, ModelError>;

    /// A law that takes the plant's inertia where its file gives none takes this one, kg m^2, whatever
    /// the plant's is.
    fn assume_inertia(&mut self, _inertia_kg_m2: &[[f64; 3]; 3]) {}
}

/// A checked controller.
pub trait AttitudeLaw {
    /// The law and the paper that it is from, in words.
    fn name(&self) -> String;

    /// Torque limit of each axis, N m.
    fn torque_limit(&self) -> Vector3<f64>;

    /// Hands on the controller before its first sample.
    ///
    /// # Errors
    /// A parameter that the flight code refuses.
    fn build<U: Use<AttitudeMeasurement, 3>>(
        &self,
        surroundings: &Surroundings,
        then: U,
    ) -> Result<U::Output, ParameterError>
    where
        Self: Sized;

    /// Whether the torque changes at every sample, so that there is no trigger to watch.
    fn sends_every_sample(&self) -> bool {
        false
    }

    /// Whether it has no messages of its own, so that those of the link count where there is one.
    fn sends_by_link(&self) -> bool {
        false
    }

    /// What is to be said of a run.
    fn notes(&self, _flown: &Flown) -> Vec<String> {
        Vec::new()
    }

    /// The paper's own conditions for this spacecraft and largest required body rate, rad/s; `None`
    /// when none are evaluated.
    fn conditions(
        &self,
        _system: &RigidBodySystem,
        _rate_limit_rad_s: Option<f64>,
    ) -> Option<DesignCheck> {
        None
    }
}

/// What surrounds a controller.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    /// The spacecraft.
    pub system: &'a RigidBodySystem,
    /// Whether an encoder sends the controller's commands on.
    pub linked: bool,
}

/// What a note may be about.
#[derive(Debug, Clone, Copy)]
pub struct Flown<'a> {
    /// The spacecraft.
    pub system: &'a RigidBodySystem,
    /// When it was sampled.
    pub instants: &'a Instants,
    /// What a perfect sensor measures at the start.
    pub start: &'a AttitudeMeasurement,
    /// What happened at the samples.
    pub events: &'a EventCount,
}

/// The conditions of a paper, evaluated for a scenario.
#[derive(Debug, Clone, Serialize)]
pub struct DesignCheck {
    /// The paper in short.
    pub paper: &'static str,
    /// Its conditions.
    pub conditions: Vec<Condition>,
    /// The constants that they are made of, by name.
    pub constants: Value,
}

/// The rows of a file as a matrix.
pub(crate) fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| rows[row][column])
}
