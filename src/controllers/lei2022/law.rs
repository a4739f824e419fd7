//! The law of Lei et al. 2022 for the rest of the program, and in the closed loop.

use nalgebra::Vector3;
use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;
use runtime::error::ParameterError;
use runtime::lei2022::{self, Parameters, SwitchCount, TriggerRule};

use super::{conditions, Bounds, Case};
use crate::controllers::law::{AttitudeLaw, DesignCheck, Flown, Surroundings};
use crate::plants::RigidBodySystem;
use crate::sim::controller::{Controller, Use};
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

    fn build<U: Use<AttitudeMeasurement, 3>>(
        &self,
        _: &Surroundings,
        then: U,
    ) -> Result<U::Output, ParameterError> {
        Ok(then.with(lei2022::Controller::new(*self)?))
    }

    fn sends_every_sample(&self) -> bool {
        self.trigger == TriggerRule::EverySample
    }

    fn notes(&self, flown: &Flown) -> Vec<String> {
        let mut notes = Vec::new();
        if !matches!(flown.system.reference, Reference::Fixed(_)) {
            notes.push(
                "The reference moves; the law is made for a fixed one and does not feed its rate forward."
                    .to_string(),
            );
        }
        let Some(trigger) = self.trigger.composite() else {
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
        let law = &self.law;
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

/// Signals of Lei et al. 2022; the last needs an envelope.
const LEI_SIGNALS: [&str; 7] = [
    "funnel_1",
    "funnel_2",
    "funnel_3",
    "on",
    "barrier_v1_j",
    "rate_error_v2_j",
    "envelope_s2_j",
];

impl Controller<AttitudeMeasurement, 3> for lei2022::Controller {
    #[inline]
    fn step(&mut self, time_s: f64, measurement: &AttitudeMeasurement) -> Command<3> {
        self.step(time_s, measurement)
    }

    /// Whether anything would be switched, on or off.
    fn would_send(&self, time_s: f64, measurement: &AttitudeMeasurement) -> bool {
        let mut trial = *self;
        trial.step(time_s, measurement).sent
    }

    fn signal_names(&self) -> &'static [&'static str] {
        match self.rule() {
            lei2022::TriggerRule::Composite(_) => &LEI_SIGNALS,
            lei2022::TriggerRule::EverySample => &LEI_SIGNALS[..6],
        }
    }

    fn signals(&self, time_s: f64, truth: &AttitudeMeasurement, values: &mut [f64]) {
        let elapsed_s = self.elapsed_s(time_s);
        let [funnel_1, funnel_2, funnel_3] = self.law().performance.value(elapsed_s).into();
        let on = f64::from(u8::from(self.is_on()));
        let (barrier, energy) = match self.evaluate(time_s, truth) {
            Ok(now) => (now.barrier_value, now.rate_error_energy),
            Err(_) => (f64::NAN, f64::NAN),
        };
        let trigger = self.rule().composite();
        let envelope = trigger.map_or(f64::NAN, |trigger| trigger.envelope(elapsed_s));
        let all = [funnel_1, funnel_2, funnel_3, on, barrier, energy, envelope];
        for (value, now) in values.iter_mut().zip(all) {
            *value = now;
        }
    }

    /// Largest |q_i| / rho_i.
    fn funnel_ratio(&self, time_s: f64, truth: &AttitudeMeasurement) -> Option<f64> {
        let performance = &self.law().performance;
        Some(performance.occupancy(self.elapsed_s(time_s), &truth.error.vector))
    }

    /// V2 / S2.
    fn threshold_ratio(&self, time_s: f64, truth: &AttitudeMeasurement) -> Option<f64> {
        let trigger = self.rule().composite()?;
        let energy = self.evaluate(time_s, truth).ok()?.rate_error_energy;
        Some(energy / trigger.envelope(self.elapsed_s(time_s)))
    }

    fn switch_count(&self) -> Option<SwitchCount> {
        self.rule().composite().map(|_| self.switch_count())
    }
}
