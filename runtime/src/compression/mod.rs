//! From a continuous torque command to words on a link, and back.
//!
//! An [`Encoder`] sits beside the controller, a [`Decoder`] beside the actuators. At every sample the
//! encoder is given the command; per axis it decides whether a word is sent, and what the actuator
//! holds from then on. Four [`Scheme`]s share this shape:
//!
//! - [`Scheme::Compressed`]: the z-ary compression event-triggered scheme of Yang et al. 2025,
//!   (21)-(23). A word says only "one step up" or "one step down" and the size of the step, as one of
//!   a few levels: m digits in base z ([`Alphabet`]).
//! - [`Scheme::FixedThreshold`], [`Scheme::RelativeThreshold`]: the rivals. A word is the command
//!   itself in some [`NumberFormat`].
//! - [`Scheme::EveryChange`]: every command that differs from the one before is sent.
//!
//! The encoder runs the decoder's own recursion, so that both hold the same number, to the last bit,
//! for as long as every word arrives. A lost or corrupted word makes them differ. With a
//! resynchronisation period the encoder sends at the end of every period a word with the number that
//! it holds, and a decoder that receives it agrees again: a loss lasts at most one period, plus one
//! for each resynchronisation word that is lost too.
//!
//! The axes are independent of each other, as if each actuator had a line of its own: a message costs
//! the bits of its words, and addressing, framing and error detection are not counted. The decoder
//! tells a resynchronisation word from a step by its length. Any word that may arrive is decoded or
//! refused, and the number held never leaves the limits.

mod alphabet;
mod axis;
mod codec;
mod levels;
mod number;
mod word;

pub use alphabet::{Alphabet, MOST_WORDS};
pub use axis::{AxisEnd, AxisOutput, AxisParameters, Scheme, RESYNCHRONISATION};
pub use codec::{Decoded, Decoder, Encoded, Encoder, Parameters};
pub use levels::{Level, Levels};
pub use number::{NumberFormat, Refusal};
pub use word::{BitReader, BitWriter, Word};
