//! Numbers of files that carry their range, as `synth` has them.

pub use synth::model::bounded::*;
