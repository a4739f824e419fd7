//! The flight controllers behind one trait.

use nalgebra::{SMatrix, SVector};
use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;
use runtime::lei2022::{self, SwitchCount};
use runtime::membership::Membership;
use runtime::{wu2018, xu2020};

/// What is true at a sample, before the controller's step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth<'a, const M: usize> {
    /// Time, s.
    pub time_s: f64,
    /// State of the plant.
    pub state: &'a [f64],
    /// Disturbance, with everything that acts whatever is commanded.
    pub disturbance: &'a [f64],
    /// What the actuators have been told last, as far as the controller's end of the link knows: a lost
    /// word makes them hold something else.
    pub held: SVector<f64, M>,
    /// What acts on the plant because of it.
    pub acting: SVector<f64, M>,
}

/// An event-triggered controller that takes measurements `T` and commands `M` axes.
pub trait Controller<T, const M: usize> {
    /// Takes the sample at `time_s` seconds.
    fn step(&mut self, time_s: f64, measurement: &T) -> Command<M>;

    /// Told before each step what no sensor measures. Only for controllers that are tried with perfect
    /// knowledge of something, or beside whose output an encoder works.
    fn tell(&mut self, _truth: &Truth<M>) {}

    /// Whether this sample would be sent; the controller stays as it is.
    fn would_send(&self, time_s: f64, measurement: &T) -> bool;

    /// The largest difference of a membership at this sample and at the one sent last (the kappa of
    /// Xu and Huang 2020, Theorem 2); `None` without fuzzy rules.
    fn membership_mismatch(&self, _measurement: &T) -> Option<f64> {
        None
    }

    /// Names, with units, of what the controller shows of itself: columns of the trajectory.
    fn signal_names(&self) -> &'static [&'static str] {
        &[]
    }

    /// The values of the signals at the true state, in the order of their names.
    fn signals(&self, _time_s: f64, _truth: &T, _values: &mut [f64]) {}

    /// The largest share of the prescribed bounds on its error that the true state uses, 1 at the edge;
    /// `None` without such bounds.
    fn funnel_ratio(&self, _time_s: f64, _truth: &T) -> Option<f64> {
        None
    }

    /// What the trigger watches over its threshold at the true state, 1 where it should fire; `None`
    /// where that is not watched.
    fn threshold_ratio(&self, _time_s: f64, _truth: &T) -> Option<f64> {
        None
    }

    /// How often the actuators were switched; `None` for a controller that never turns them off.
    fn switch_count(&self) -> Option<SwitchCount> {
        None
    }
}

impl Controller<AttitudeMeasurement, 3> for wu2018::Controller {
    #[inline]
    fn step(&mut self, time_s: f64, measurement: &AttitudeMeasurement) -> Command<3> {
        self.step(time_s, measurement)
    }

    fn would_send(&self, time_s: f64, measurement: &AttitudeMeasurement) -> bool {
        let mut trial = *self;
        trial.step(time_s, measurement).sent
    }
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

/// Xu and Huang's controller on attitude measurements.
#[derive(Clone, Copy, Debug)]
pub struct XuAttitude<S, const R: usize> {
    /// The flight code.
    pub controller: xu2020::Controller<S, 6, 3, R>,
    sent_weights: Option<[f64; R]>,
}

impl<S: Membership<6, R>, const R: usize> XuAttitude<S, R> {
    /// The controller before its first sample.
    pub fn new(controller: xu2020::Controller<S, 6, 3, R>) -> Self {
        Self {
            controller,
            sent_weights: None,
        }
    }
}

impl<S: Membership<6, R> + Copy, const R: usize> Controller<AttitudeMeasurement, 3>
    for XuAttitude<S, R>
{
    #[inline]
    fn step(&mut self, time_s: f64, measurement: &AttitudeMeasurement) -> Command<3> {
        let state = measurement.rigid_body_state();
        let command = self.controller.step(time_s, &state);
        if command.sent && R > 1 {
            self.sent_weights = Some(self.controller.law().membership().weights(&state));
        }
        command
    }

    fn would_send(&self, time_s: f64, measurement: &AttitudeMeasurement) -> bool {
        let mut trial = *self;
        trial.step(time_s, measurement).sent
    }

    fn membership_mismatch(&self, measurement: &AttitudeMeasurement) -> Option<f64> {
        let sent = self.sent_weights?;
        let state = measurement.rigid_body_state();
        let now = self.controller.law().membership().weights(&state);
        let differences = now.iter().zip(&sent).map(|(a, b)| (a - b).abs());
        Some(differences.fold(0.0, f64::max))
    }
}

/// Xu and Huang's controller with a constant gain on a padded state of any size.
#[derive(Clone, Copy, Debug)]
pub struct XuState<const N: usize, const M: usize> {
    controller: xu2020::Controller<runtime::membership::ConstantGain, N, M, 1>,
    message_bits: usize,
}

impl<const N: usize, const M: usize> XuState<N, M> {
    /// The controller of a design for `states` states, padded.
    ///
    /// # Errors
    /// A parameter that the flight code refuses.
    pub fn new(
        design: &synth::design::DesignFile,
        gain: &SMatrix<f64, M, N>,
        weight: &SMatrix<f64, N, N>,
        limit: &SVector<f64, M>,
        states: usize,
    ) -> Result<Self, runtime::error::ParameterError> {
        let controller = xu2020::Controller::new(xu2020::Parameters {
            gains: [*gain],
            membership: runtime::membership::ConstantGain,
            trigger_weight: *weight,
            threshold_update: super::design::threshold_update(&design.model.specs),
            torque_limit: *limit,
            longest_interval_s: Some(design.model.specs.hbar_s),
        })?;
        Ok(Self {
            controller,
            message_bits: runtime::command::BITS_PER_NUMBER * states,
        })
    }
}

impl<const N: usize, const M: usize> Controller<SVector<f64, N>, M> for XuState<N, M> {
    fn step(&mut self, time_s: f64, measurement: &SVector<f64, N>) -> Command<M> {
        let mut command = self.controller.step(time_s, measurement);
        if command.sent {
            command.bits = self.message_bits;
        }
        command
    }

    fn would_send(&self, time_s: f64, measurement: &SVector<f64, N>) -> bool {
        let mut trial = *self;
        trial.step(time_s, measurement).sent
    }
}

/// A controller chosen at run time.
pub type AnyController<T, const M: usize> = Box<dyn Controller<T, M>>;

impl<T, const M: usize> Controller<T, M> for AnyController<T, M> {
    fn step(&mut self, time_s: f64, measurement: &T) -> Command<M> {
        self.as_mut().step(time_s, measurement)
    }

    fn tell(&mut self, truth: &Truth<M>) {
        self.as_mut().tell(truth);
    }

    fn would_send(&self, time_s: f64, measurement: &T) -> bool {
        self.as_ref().would_send(time_s, measurement)
    }

    fn membership_mismatch(&self, measurement: &T) -> Option<f64> {
        self.as_ref().membership_mismatch(measurement)
    }

    fn signal_names(&self) -> &'static [&'static str] {
        self.as_ref().signal_names()
    }

    fn signals(&self, time_s: f64, truth: &T, values: &mut [f64]) {
        self.as_ref().signals(time_s, truth, values);
    }

    fn funnel_ratio(&self, time_s: f64, truth: &T) -> Option<f64> {
        self.as_ref().funnel_ratio(time_s, truth)
    }

    fn threshold_ratio(&self, time_s: f64, truth: &T) -> Option<f64> {
        self.as_ref().threshold_ratio(time_s, truth)
    }

    fn switch_count(&self) -> Option<SwitchCount> {
        self.as_ref().switch_count()
    }
}
