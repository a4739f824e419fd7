//! What a result says of where it comes from.

pub use synth::programs::{sha256_of, GENERATOR};
