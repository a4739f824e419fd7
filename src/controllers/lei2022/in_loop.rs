//! The controller of Lei et al. 2022 in the closed loop.

use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;
use runtime::lei2022;
use runtime::lei2022::SwitchCount;

use crate::sim::controller::Controller;

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
