//! What a result says of where it comes from.

pub use synth::programs::sha256_of;

/// The program that made a result.
pub const GENERATOR: &str = concat!("steadfast ", env!("CARGO_PKG_VERSION"));
