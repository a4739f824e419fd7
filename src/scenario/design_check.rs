//! From a scenario to the conditions of its controller.

use nalgebra::Vector3;
use runtime::lei2022::TriggerRule;

use super::check::Scenario;
use crate::base::condition::Condition;
use crate::controllers::lei2022::{conditions, Bounds, Case};
use crate::controllers::ControllerChoice;
use crate::plants::System;
use crate::sim::disturbance::Disturbance;
use crate::sim::metrics::Metric;
use crate::sim::rigid_body_state::rigid_body_state;

/// The conditions of a paper, evaluated for a scenario.
#[derive(Debug, Clone)]
pub struct DesignCheck {
    /// The paper in short.
    pub paper: &'static str,
    /// Its conditions.
    pub conditions: Vec<Condition>,
    /// The constants that they are made of.
    pub bounds: Bounds,
}

/// The conditions of the scenario's controller; `None` when its paper has none that are evaluated
/// here, as for a controller without the trigger that they are about.
pub fn design_check(scenario: &Scenario) -> Option<DesignCheck> {
    let case = case(scenario)?;
    Some(DesignCheck {
        paper: "Lei et al. 2022",
        conditions: conditions(&case),
        bounds: Bounds::new(&case),
    })
}

fn case(scenario: &Scenario) -> Option<Case> {
    let (ControllerChoice::Lei(parameters), System::RigidBody(system)) =
        (&scenario.controller, &scenario.system)
    else {
        return None;
    };
    let TriggerRule::Composite(trigger) = parameters.trigger else {
        return None;
    };
    let state = rigid_body_state(&system.attitude, &system.rate_rad_s);
    let error = system.reference.error(0.0, &state);
    Some(Case {
        law: parameters.law,
        trigger,
        torque_limit: parameters.torque_limit,
        error: error.error.shortest(),
        rate_rad_s: error.rate_rad_s,
        disturbance_nm: largest(&system.disturbance),
        rate_limit_rad_s: rate_limit(scenario),
    })
}

/// Bound of each component of a disturbance: the sum of the magnitudes of its parts.
fn largest(disturbance: &Disturbance<3>) -> Vector3<f64> {
    let harmonics = disturbance.harmonics.iter();
    let waves = harmonics.map(|wave| wave.sine.zip_map(&wave.cosine, libm::hypot));
    let rows = disturbance.table.iter().flat_map(|table| &table.values);
    let table = rows.fold(Vector3::zeros(), |most: Vector3<f64>, row| {
        most.sup(&row.abs())
    });
    waves.fold(disturbance.bias.abs() + table, |sum, wave| sum + wave)
}

fn rate_limit(scenario: &Scenario) -> Option<f64> {
    let of_rate = |requirement: &&_| {
        let requirement: &super::file::RequirementFile = requirement;
        requirement.metric == Metric::MaxRate
    };
    scenario.requirements.iter().find(of_rate)?.at_most
}
