//! The seeded generator behind every random number of a run.

use rand_chacha::rand_core::{RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// What a random number is for. Each purpose has its own stream, so that switching the noise on does
/// not move the sampling instants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Sampling instants.
    Sampling,
    /// Lost samples.
    Dropout,
    /// Sensor noise.
    Noise,
    /// Initial states.
    InitialState,
    /// Words lost on the link.
    WordLoss,
    /// Bits inverted on the link.
    BitErrors,
    /// The plant's inertia.
    Inertia,
    /// Bounded errors of the sensors.
    MeasurementError,
    /// Delays of messages.
    NetworkDelay,
    /// Lost messages.
    NetworkLoss,
    /// Gains of the actuators.
    ActuatorGain,
}

/// What a stream of a campaign's generator is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CampaignStream {
    /// The run of this index.
    Run(u64),
    /// The drawn number of this index, in all runs.
    Number(u64),
}

/// Bits as a number in (0, 1): the middle of one of 2^52 intervals.
pub fn open_unit(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) * (1.0 / (1u64 << 52) as f64)
}

/// ChaCha with 8 rounds: the same numbers on every machine.
#[derive(Clone, Debug)]
pub struct Random(ChaCha8Rng);

impl Random {
    /// The generator of one purpose for the scenario's seed.
    pub fn new(seed: u64, purpose: Purpose) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(purpose as u64);
        Self(generator)
    }

    /// A stream of a campaign with this seed: of one of its runs or of one of its drawn numbers.
    pub fn of_campaign(seed: u64, stream: CampaignStream) -> Self {
        // Far from the streams of the purposes.
        const RUNS: u64 = 1 << 62;
        const NUMBERS: u64 = 1 << 63;
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(match stream {
            CampaignStream::Run(run) => RUNS | run,
            CampaignStream::Number(number) => NUMBERS | number,
        });
        Self(generator)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Uniform in (0, 1), without its ends.
    pub fn open_uniform(&mut self) -> f64 {
        open_unit(self.bits())
    }

    /// Uniform in [0, 1).
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Normal with mean 0 and standard deviation 1.
    #[inline]
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
}
