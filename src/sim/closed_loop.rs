//! The closed loop: plant, sensor, controller and actuators in time.

use nalgebra::SVector;
use runtime::command::Command;

use super::actuator::{ActuatorData, Actuators};
use super::controller::{Controller, Truth};
use super::disturbance::{Disturbance, DisturbanceCursor};
use super::dormand_prince::DormandPrince;
use super::input_gradient::InputGradient;
use super::integrator::{runge_kutta_step, Method};
use super::link::Link;
use super::network::Network;
use super::plant::Plant;
use super::sampling::{Instants, Sampling};
use super::sensor::Sensor;

/// Observes a run with a controller `C`. Times are in s.
pub trait Observer<C, const N: usize, const M: usize, const D: usize> {
    /// The initial state, before the first sample.
    fn start(&mut self, state: &SVector<f64, N>, disturbance: &SVector<f64, D>, controller: &C);

    /// A sample was taken; `mismatch` is the largest difference of a membership from the sample sent
    /// last.
    fn sample(
        &mut self,
        time_s: f64,
        state: &SVector<f64, N>,
        command: &Command<M>,
        mismatch: Option<f64>,
        controller: &C,
    );

    /// The largest errors of the sensor so far (see [`Sensor::largest_errors`]).
    fn measured(&mut self, _largest_errors: &[f64]) {}

    /// A command acts from now on that came from a sample: the first time, the loop is closed.
    fn in_force(&mut self, _time_s: f64) {}

    /// At the sample that is reported next the link carried these steps (see [`Link::steps`]).
    fn transmitted(&mut self, _steps: &[f64; M]) {}

    /// From `time_s` on this torque acts, beside a disturbance that begins with this value: where either jumps, both
    /// are those after the jump. Comes after what else happens at that time.
    fn hold(
        &mut self,
        time_s: f64,
        torque: &SVector<f64, M>,
        disturbance: &SVector<f64, D>,
        controller: &C,
    );

    /// The torque acted for `span_s`.
    fn held(&mut self, span_s: f64, torque: &SVector<f64, M>);

    /// An integration step of `step_s` ended at `time_s`.
    fn step(
        &mut self,
        time_s: f64,
        step_s: f64,
        state: &SVector<f64, N>,
        disturbance: &SVector<f64, D>,
        controller: &C,
    );
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// At the scenario's duration.
    Completed,
    /// The state was no longer finite.
    Diverged {
        /// When, s.
        time_s: f64,
    },
}

/// Everything that makes a run, except what watches it.
#[derive(Debug)]
pub struct ClosedLoop<'a, P, S, C, const N: usize, const M: usize, const D: usize> {
    /// The plant.
    pub plant: &'a P,
    /// Its disturbance.
    pub disturbance: &'a Disturbance<D>,
    /// The sensor.
    pub sensor: S,
    /// The controller.
    pub controller: C,
    /// The link from its command to the actuators; without one the command acts unchanged.
    pub link: Option<&'a mut Link<M>>,
    /// The network that carries its messages; without one they arrive at once.
    pub network: Option<&'a mut Network<M>>,
    /// How x'Ux of the design grows with the torque; needed by what is the worst possible.
    pub gradient: Option<InputGradient<'a, N, M>>,
    /// The same for the disturbance.
    pub disturbance_gradient: Option<InputGradient<'a, N, D>>,
    /// Sampling instants.
    pub sampling: Sampling,
    /// The actuators.
    pub actuators: &'a ActuatorData<M>,
    /// Times at which something changes abruptly, s, increasing.
    pub breakpoints_s: Vec<f64>,
    /// How the plant is integrated.
    pub method: Method,
    /// End of the run, s.
    pub duration_s: f64,
    /// The scenario's seed.
    pub seed: u64,
}

/// Intervals shorter than this fraction of a step are not worth a step of their own.
const STEP_ROUNDING: f64 = 1e-9;

/// Where a run stands.
struct Progress<'a, const N: usize, const D: usize> {
    time: f64,
    next_sample: f64,
    state: SVector<f64, N>,
    cursor: DisturbanceCursor<'a, D>,
    /// The worst disturbance, held until the next event.
    push: Option<SVector<f64, D>>,
}

impl<const N: usize, const D: usize> Progress<'_, N, D> {
    /// The disturbance now.
    fn disturbance(&self) -> SVector<f64, D> {
        let given = *self.cursor.now();
        self.push.map_or(given, |push| given + push)
    }
}

impl<'a, P, S, C, const N: usize, const M: usize, const D: usize> ClosedLoop<'a, P, S, C, N, M, D>
where
    P: Plant<N, M, D>,
    S: Sensor<N>,
    C: Controller<S::Measurement, M>,
{
    /// Runs from `initial`.
    pub fn run<O>(mut self, initial: &SVector<f64, N>, observer: &mut O) -> End
    where
        O: Observer<C, N, M, D>,
    {
        let mut at = Progress {
            time: 0.0,
            next_sample: 0.0,
            state: *initial,
            cursor: DisturbanceCursor::new(self.disturbance, 0.0),
            push: None,
        };
        let mut next_breakpoint = 0;
        let mut actuators = Actuators::new(self.actuators, self.seed);
        let mut reference = self.reference_integrator();
        observer.start(&at.state, at.cursor.now(), &self.controller);
        while at.time < self.duration_s {
            if at.time >= at.next_sample {
                self.take_sample(&mut at, &mut actuators, observer);
            }
            self.deliver(at.time, &mut actuators, observer);
            let torque = self.acting(&at, &mut actuators);
            let mut event = at
                .next_sample
                .min(actuators.next_change_s())
                .min(self.next_arrival_s())
                .min(self.duration_s);
            while let Some(&breakpoint) = self.breakpoints_s.get(next_breakpoint) {
                if breakpoint > at.time {
                    event = event.min(breakpoint);
                    break;
                }
                next_breakpoint += 1;
            }
            let from = at.time;
            at.push = self.push(&at);
            observer.hold(from, &torque, &at.disturbance(), &self.controller);
            match &mut reference {
                None => self.advance(&mut at, event, &torque, observer),
                Some(reference) => {
                    while at.time < event {
                        let (time, state) = reference.step(at.time, event, &at.state, &torque);
                        let disturbance = self.disturbance.at(time);
                        observer.step(time, time - at.time, &state, &disturbance, &self.controller);
                        (at.time, at.state) = (time, state);
                    }
                    at.cursor.move_to(at.time);
                }
            }
            actuators.acted(at.time - from);
            observer.held(at.time - from, &torque);
            if !at.state.iter().all(|value| value.is_finite()) {
                return End::Diverged { time_s: at.time };
            }
        }
        End::Completed
    }

    #[inline]
    fn next_arrival_s(&self) -> f64 {
        let network = self.network.as_ref();
        network.map_or(f64::INFINITY, |network| network.next_arrival_s())
    }

    fn gradient(&self, at: &Progress<'a, N, D>) -> Option<SVector<f64, M>> {
        let gradient = self.gradient.as_ref();
        gradient.map(|gradient| gradient.at(at.time, &at.state))
    }

    /// The worst disturbance, in the direction in which x'Ux grows fastest.
    #[inline]
    fn push(&self, at: &Progress<'a, N, D>) -> Option<SVector<f64, D>> {
        let gradient = self.disturbance_gradient.as_ref()?;
        let direction = gradient.at(at.time, &at.state).try_normalize(0.0);
        direction.map(|direction| direction * self.disturbance.worst)
    }

    /// Hands the messages that have arrived to the actuators.
    #[inline]
    fn deliver<O>(&mut self, time_s: f64, actuators: &mut Actuators<'a, M>, observer: &mut O)
    where
        O: Observer<C, N, M, D>,
    {
        let network = self.network.as_mut();
        if let Some(torque) = network.and_then(|network| network.deliver(time_s)) {
            actuators.command(time_s, &torque);
            observer.in_force(time_s);
        }
    }

    /// The torque that acts from now on.
    #[inline]
    fn acting(&self, at: &Progress<'a, N, D>, actuators: &mut Actuators<'a, M>) -> SVector<f64, M> {
        let torque = actuators.torque(at.time);
        if self.actuators.gain_error.is_none() {
            return torque;
        }
        actuators.renew(self.gradient(at).as_ref());
        actuators.torque(at.time)
    }

    fn reference_integrator(&self) -> Option<DormandPrince<'a, P, N, M, D>> {
        match self.method {
            Method::RungeKutta4 { .. } => None,
            Method::DormandPrince853 { tolerance } => Some(DormandPrince {
                plant: self.plant,
                disturbance: self.disturbance,
                tolerance,
                trial_s: 1.0,
            }),
        }
    }

    #[inline]
    fn take_sample<O>(
        &mut self,
        at: &mut Progress<'a, N, D>,
        actuators: &mut Actuators<'a, M>,
        observer: &mut O,
    ) where
        O: Observer<C, N, M, D>,
    {
        at.next_sample = self.sampling.after(at.time);
        if self.sampling.lost() {
            return;
        }
        let measurement = self.sensor.measure(at.time, &at.state);
        let mismatch = self.controller.membership_mismatch(&measurement);
        let acting = actuators.torque(at.time);
        self.controller.observe_truth(&Truth {
            time_s: at.time,
            state: at.state.as_slice(),
            disturbance: at.cursor.now().as_slice(),
            held: match (&self.link, &self.network) {
                (Some(link), _) => link.held_by_encoder(),
                (None, Some(network)) => network.entered(),
                (None, None) => *actuators.last_command(),
            },
            acting,
        });
        let command = self.controller.step(at.time, &measurement);
        if command.sent {
            self.sensor.sent(&measurement);
        }
        observer.measured(self.sensor.largest_errors());
        let gradient = self.network.as_ref().and_then(|_| self.gradient(at));
        match (&mut self.link, &mut self.network) {
            (None, Some(network)) => network.transmit(at.time, &command, gradient.as_ref()),
            (None, None) => {
                actuators.command(at.time, &command.torque);
                if command.sent {
                    observer.in_force(at.time);
                }
            }
            (Some(link), _) => {
                let held = link.transmit(at.time, &command.torque);
                actuators.command(at.time, &held);
                observer.transmitted(link.steps());
            }
        }
        observer.sample(at.time, &at.state, &command, mismatch, &self.controller);
    }

    /// Steps of equal length to `event`, or to where a trigger that is watched continuously fires.
    #[inline]
    fn advance<O>(
        &mut self,
        at: &mut Progress<'a, N, D>,
        event: f64,
        torque: &SVector<f64, M>,
        observer: &mut O,
    ) where
        O: Observer<C, N, M, D>,
    {
        let Method::RungeKutta4 { step_s } = self.method else {
            return;
        };
        let from = at.time;
        let steps = (event - from) / step_s - STEP_ROUNDING;
        let count = if steps <= 1.0 { 1.0 } else { steps.ceil() };
        let step = (event - from) / count;
        let count = count as u64;
        for index in 1..=count {
            let (start, start_state) = (at.time, at.state);
            let mut values = at.cursor.step(start, step);
            if let Some(push) = &at.push {
                values.iter_mut().for_each(|value| *value += push);
            }
            at.state = runge_kutta_step(self.plant, start, &start_state, step, torque, &values);
            at.time = if index == count {
                event
            } else {
                from + index as f64 * step
            };
            if let Instants::Continuous { resolution_s } = *self.sampling.instants() {
                if self.fires(at.time, &at.state) {
                    self.find_event(at, (start, start_state, step), resolution_s, torque);
                    let fired = at.time;
                    let disturbance = at.cursor.now();
                    observer.step(
                        fired,
                        fired - start,
                        &at.state,
                        disturbance,
                        &self.controller,
                    );
                    at.next_sample = fired;
                    return;
                }
            }
            observer.step(at.time, step, &at.state, &values[2], &self.controller);
        }
    }

    fn fires(&mut self, time: f64, state: &SVector<f64, N>) -> bool {
        let measurement = self.sensor.measure(time, state);
        self.controller.would_send(time, &measurement)
    }

    /// Bisects the step in which the trigger fires, down to `resolution`, and puts `at` on the end of
    /// the remaining interval, where it fires.
    fn find_event(
        &mut self,
        at: &mut Progress<'a, N, D>,
        (start, start_state, step): (f64, SVector<f64, N>, f64),
        resolution: f64,
        torque: &SVector<f64, M>,
    ) {
        let (mut silent, mut firing) = (0.0, step);
        while firing - silent > resolution {
            let middle = 0.5 * (silent + firing);
            let times = [start, start + 0.5 * middle, start + middle];
            let values = times.map(|time| self.disturbance.at(time));
            let state = runge_kutta_step(self.plant, start, &start_state, middle, torque, &values);
            if self.fires(start + middle, &state) {
                firing = middle;
                (at.time, at.state) = (start + middle, state);
            } else {
                silent = middle;
            }
        }
        at.cursor.move_to(at.time);
    }
}
