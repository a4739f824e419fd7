//! Reference vectors: what the flight controllers of [`runtime`] answer to samples, to the last bit.

use nalgebra::SVector;
use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;
use runtime::repeat::{Receiver, Sender};
use synth::model::Plant;

use super::error::NoSource;
use super::inputs::{attitudes, states, Extent};
use crate::controllers::law::Surroundings;
use crate::plants::System;
use crate::run::design::Design;
use crate::run::designed::{designed, designed_attitude};
use crate::scenario::Scenario;
use crate::sim::controller::{Controller, Use};
use crate::sim::embedding;
use crate::sim::random::{Purpose, Random};

/// Probability with which a transmission arrives.
const ARRIVES: f64 = 0.6;

/// Rate errors in the samples of a scenario [rad/s], and vector parts.
const RATE_RAD_S: f64 = 0.05;
const VECTOR_PART: f64 = 0.6;

/// One sample with what is expected of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// The time (s), then the measurement: the error quaternion, scalar part first, and the rate; or the state.
    pub given: Vec<f64>,
    /// The command.
    pub command: Vec<f64>,
    /// Whether it was sent.
    pub sent: bool,
    /// The status as a number.
    pub status: u8,
    /// Whether a transmission at this sample, if there is one, arrives.
    pub arrives: bool,
    /// The command in force at the receiver's end.
    pub received: Vec<f64>,
}

/// Samples in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Vectors(pub Vec<Sample>);

impl Vectors {
    /// Of a design's controller, with so many samples.
    ///
    /// # Errors
    /// Gains that are no law; numbers that the flight code refuses.
    pub fn of_design(design: &Design, count: usize) -> Result<Self, NoSource> {
        let (states, inputs, _, _) = design.model.plant.sizes();
        if design.model.plant.inertia().is_some() {
            let samples = attitudes(&extent(design), count);
            let recorder = Recorder {
                samples: &samples,
                inputs: 3,
                repeats: design.repeats(),
                given: |sample: &AttitudeMeasurement| numbers_of(sample),
            };
            return Ok(designed_attitude(design, recorder)?);
        }
        match (states, inputs) {
            (..=2, ..=1) => of_padded::<2, 1>(design, count),
            (..=6, ..=3) => of_padded::<6, 3>(design, count),
            _ => of_padded::<24, 12>(design, count),
        }
    }

    /// Of a scenario's controller, with so many samples at most an interval (s) apart.
    ///
    /// # Errors
    /// Numbers that the flight code refuses; a controller of a design.
    pub fn of_scenario(
        scenario: &Scenario,
        interval_s: f64,
        count: usize,
    ) -> Result<Self, NoSource> {
        let System::RigidBody(system) = &scenario.system else {
            return Err(NoSource::OfDesign);
        };
        let extent = Extent {
            states: [[RATE_RAD_S; 3], [VECTOR_PART; 3]].concat(),
            interval_s,
        };
        let samples = attitudes(&extent, count);
        let recorder = Recorder {
            samples: &samples,
            inputs: 3,
            repeats: 0,
            given: |sample: &AttitudeMeasurement| numbers_of(sample),
        };
        let around = Surroundings {
            system,
            linked: false,
        };
        let built = scenario.controller.build(&around, recorder)?;
        built.map_err(|_| NoSource::OfDesign)
    }
}

/// A measurement in the order in which a step takes it.
fn numbers_of(measured: &AttitudeMeasurement) -> Vec<f64> {
    let quaternion = measured.error.to_scalar_first();
    [&quaternion[..], measured.rate_rad_s.as_slice()].concat()
}

/// Of a controller padded to `N` states and `M` inputs.
fn of_padded<const N: usize, const M: usize>(
    design: &Design,
    samples: usize,
) -> Result<Vectors, NoSource> {
    let (count, inputs, _, _) = design.model.plant.sizes();
    let samples = states(&extent(design), samples).into_iter();
    let samples = samples.map(|(time_s, state)| (time_s, embedding::vector::<N>(&state)));
    let samples: Vec<_> = samples.collect();
    let recorder = Recorder {
        samples: &samples,
        inputs,
        repeats: design.repeats(),
        given: |state: &SVector<f64, N>| state.iter().take(count).copied().collect(),
    };
    Ok(designed::<SVector<f64, N>, N, M, _>(design, recorder)?)
}

/// The extent of the certified set along each state, and the longest interval.
fn extent(design: &Design) -> Extent {
    let inverse = design.certificate.lyapunov.clone().try_inverse();
    let lengths = inverse.map(|inverse| inverse.diagonal().map(|square| square.abs().sqrt()));
    let mut states: Vec<f64> = match lengths {
        Some(lengths) => lengths.iter().copied().collect(),
        None => vec![1.0; design.model.plant.sizes().0],
    };
    if let Plant::Spacecraft(craft) = &design.model.plant {
        // Out of the box, too.
        let least = craft.scalar_part_min;
        let widest = (1.0 - least * least).sqrt();
        let bounds = [craft.rate_bound.into(), [widest; 3]].concat();
        states
            .iter_mut()
            .zip(bounds)
            .for_each(|(state, bound)| *state = state.max(bound));
    }
    Extent {
        states,
        interval_s: design.model.file.specs.hbar_s,
    }
}

/// Runs a controller over samples, and the messages that it sends over a network that loses some.
struct Recorder<'a, T, G> {
    samples: &'a [(f64, T)],
    inputs: usize,
    repeats: u32,
    given: G,
}

impl<T, G: Fn(&T) -> Vec<f64>, const M: usize> Use<T, M> for Recorder<'_, T, G> {
    type Output = Vectors;

    fn with<C: Controller<T, M>>(self, mut controller: C) -> Vectors {
        let mut random = Random::new(0, Purpose::NetworkLoss);
        let mut network = (Sender::new(self.repeats), Receiver::new());
        let samples = self.samples.iter().map(|(time_s, measured)| {
            let command = controller.step(*time_s, measured);
            let arrives = random.open_uniform() < ARRIVES;
            let received = received(&mut network, &command, arrives);
            let kept =
                |vector: &SVector<f64, M>| vector.iter().take(self.inputs).copied().collect();
            Sample {
                given: [vec![*time_s], (self.given)(measured)].concat(),
                command: kept(&command.torque),
                sent: command.sent,
                status: command.status.number(),
                arrives,
                received: kept(&received),
            }
        });
        Vectors(samples.collect())
    }
}

/// The command in force at the receiver's end after a sample.
fn received<const M: usize>(
    (sender, receiver): &mut (Sender<SVector<f64, M>>, Receiver<SVector<f64, M>>),
    command: &Command<M>,
    arrives: bool,
) -> SVector<f64, M> {
    let message = sender.sample(command.sent.then_some(command.torque));
    if let Some(message) = message.filter(|_| arrives) {
        receiver.receive(&message);
    }
    receiver.value().copied().unwrap_or_else(SVector::zeros)
}
