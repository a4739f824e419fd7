//! The law of Lei et al. 2022 for the rest of the program.

use nalgebra::Vector3;
use runtime::error::ParameterError;
use runtime::lei2022::{self, Parameters, TriggerRule};

use super::{conditions, Bounds, Case};
use crate::controllers::law::{
    AnyAttitudeController, AttitudeLaw, DesignCheck, Flown, Surroundings,
};
use crate::plants::RigidBodySystem;
use crate::sim::disturbance::Disturbance;
use crate::sim::reference::Reference;
use crate::sim::rigid_body_state::rigid_body_state;
use crate::sim::sampling::Instants;

impl AttitudeLaw for Parameters {
    fn name(&self) -> String {
        let law = match self.trigger {
            TriggerRule::Composite(_) => "law (12) with triggers (6) and (8)",
            TriggerRule::EverySample => "law (12) at every sample",
        };
        format!("Lei et al. 2022, {law}")
    }

    fn torque_limit(&self) -> Vector3<f64> {
        self.torque_limit
    }

    fn build(&self, _: &Surroundings) -> Result<AnyAttitudeController, ParameterError> {
        Ok(Box::new(lei2022::Controller::new(*self)?))
    }

    fn sends_every_sample(&self) -> bool {
        self.trigger == TriggerRule::EverySample
    }

    fn notes(&self, flown: &Flown) -> Vec<String> {
        notes(self, flown)
    }

    fn conditions(
        &self,
        system: &RigidBodySystem,
        rate_limit_rad_s: Option<f64>,
    ) -> Option<DesignCheck> {
        let case = case(self, system, rate_limit_rad_s)?;
        Some(DesignCheck {
            paper: "Lei et al. 2022",
            conditions: conditions(&case),
            // Named numbers can always be written.
            constants: serde_json::to_value(Bounds::new(&case)).unwrap_or_default(),
        })
    }
}

fn case(
    parameters: &Parameters,
    system: &RigidBodySystem,
    rate_limit_rad_s: Option<f64>,
) -> Option<Case> {
    let state = rigid_body_state(&system.attitude, &system.rate_rad_s);
    let error = system.reference.error(0.0, &state);
    Some(Case {
        law: parameters.law,
        trigger: *parameters.trigger.composite()?,
        torque_limit: parameters.torque_limit,
        error: error.error.shortest(),
        rate_rad_s: error.rate_rad_s,
        disturbance_nm: largest(&system.disturbance),
        rate_limit_rad_s,
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

fn notes(parameters: &Parameters, flown: &Flown) -> Vec<String> {
    let mut notes = Vec::new();
    if !matches!(flown.system.reference, Reference::Fixed(_)) {
        notes.push(
            "The reference moves; the law is made for a fixed one and does not feed its rate forward."
                .to_string(),
        );
    }
    let Some(trigger) = parameters.trigger.composite() else {
        return notes;
    };
    let continuous = matches!(flown.instants, Instants::Continuous { .. });
    if !continuous && trigger.relative_buffer == 0.0 {
        notes.push(
            "The trigger is evaluated at samples without a relative_buffer: V2 may exceed its envelope \
             S2 before the next sample."
                .to_string(),
        );
    }
    let law = &parameters.law;
    let error = flown.start.error.shortest();
    let energy = law
        .evaluate(0.0, &error, &flown.start.rate_rad_s)
        .rate_error_energy;
    if energy >= trigger.envelope_initial_j {
        notes.push(format!(
            "The start is above the envelope: V2 is {energy:.3e} J and S2(0) is {:.3e} J; the paper \
             needs S2(0) above V2(0).",
            trigger.envelope_initial_j
        ));
    }
    notes
}
