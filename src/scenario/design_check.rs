//! From a scenario to the conditions of its controller.

use super::check::Scenario;
use crate::controllers::DesignCheck;
use crate::plants::System;
use crate::sim::metrics::Metric;

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
