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
