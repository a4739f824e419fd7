//! Encoder and decoder of one axis.

use super::alphabet::Alphabet;
use super::levels::Levels;
use super::number::{NumberFormat, Refusal};
use super::word::Word;
use crate::error::{AllowedRange, Field, ParameterError};

/// How a compressed axis is resynchronised: the number held, in single precision.
pub const RESYNCHRONISATION: NumberFormat = NumberFormat::Single;

/// When a word is sent and what it says. Here u is the command and v the number held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme<const L: usize> {
    /// Whenever u, as the format writes it, differs from v. The word is u.
    EveryChange {
        /// How u is written.
        format: NumberFormat,
    },
    /// When `|u - v| >= threshold`. The word is u.
    FixedThreshold {
        /// The threshold, N m, above zero and at most twice the limit.
        threshold: f64,
        /// How u is written.
        format: NumberFormat,
    },
    /// When `|u - v| >= relative |u| + absolute`. The word is u.
    RelativeThreshold {
        /// Share of the command's magnitude, in [0, 1).
        relative: f64,
        /// The threshold at zero, N m, above zero and at most twice the limit.
        absolute: f64,
        /// How u is written.
        format: NumberFormat,
    },
    /// Yang et al. 2025, (21)-(23): when `|u - v| >= T_h`, with h the level of |u| and T_h its
    /// threshold. The word names h and the direction, and v moves by T_h towards u: by one step at
    /// each sample, however far u is.
    Compressed {
        /// The words.
        alphabet: Alphabet,
        /// The levels, at most as many as the alphabet has.
        levels: Levels<L>,
    },
}

impl<const L: usize> Scheme<L> {
    /// How the number held is written when the decoder is resynchronised.
    pub const fn resynchronisation(&self) -> NumberFormat {
        match self {
            Self::EveryChange { format }
            | Self::FixedThreshold { format, .. }
            | Self::RelativeThreshold { format, .. } => *format,
            Self::Compressed { .. } => RESYNCHRONISATION,
        }
    }

    /// Bits of an ordinary word.
    pub const fn word_bits(&self) -> u32 {
        match self {
            Self::Compressed { alphabet, .. } => alphabet.bits(),
            _ => self.resynchronisation().bits(),
        }
    }
}

/// What both ends of one axis must agree on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisParameters<const L: usize> {
    /// Largest magnitude of the torque, N m, positive. Commands beyond it are cut off.
    pub limit: f64,
    /// The scheme.
    pub scheme: Scheme<L>,
}

impl<const L: usize> AxisParameters<L> {
    /// Checks the parameters of the axis with this number, which an error carries.
    pub(super) fn check(&self, axis: usize) -> Result<(), ParameterError> {
        let field = |name| Field::component(name, axis);
        AllowedRange::POSITIVE.check(field("limit"), self.limit)?;
        let step = AllowedRange::left_open(0.0, 2.0 * self.limit);
        match &self.scheme {
            Scheme::EveryChange { format } => format.check(axis),
            Scheme::FixedThreshold { threshold, format } => {
                step.check(field("threshold"), *threshold)?;
                format.check(axis)
            }
            Scheme::RelativeThreshold {
                relative,
                absolute,
                format,
            } => {
                AllowedRange::half_open(0.0, 1.0).check(field("relative"), *relative)?;
                step.check(field("absolute"), *absolute)?;
                format.check(axis)
            }
            Scheme::Compressed { alphabet, levels } => {
                levels.check(axis, self.limit, alphabet.levels())
            }
        }
    }
}

/// What the encoder of one axis made of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisOutput {
    /// The number held from now on, N m.
    pub held: f64,
    /// The word to send, if any.
    pub word: Option<Word>,
    /// The level of the step that was made, for [`Scheme::Compressed`] only.
    pub level: Option<u32>,
}

/// One end of one axis. The controller's end encodes commands and receives its own words, the actuator's end receives
/// those that arrive: both hold the same number, zero until the first word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisEnd<const L: usize> {
    parameters: AxisParameters<L>,
    held: f64,
}

impl<const L: usize> AxisEnd<L> {
    /// One end of an axis.
    ///
    /// # Errors
    /// The first parameter that is out of its range.
    pub fn new(parameters: AxisParameters<L>) -> Result<Self, ParameterError> {
        parameters.check(0)?;
        Ok(Self::with_checked(parameters))
    }

    pub(super) const fn with_checked(parameters: AxisParameters<L>) -> Self {
        Self {
            parameters,
            held: 0.0,
        }
    }

    /// The number held, N m, never beyond the limit.
    pub const fn held(&self) -> f64 {
        self.held
    }

    /// Takes a word and returns the number held from now on, N m: (23).
    ///
    /// # Errors
    /// A word that the scheme does not have; the number held stays as it is.
    pub fn receive(&mut self, word: &Word) -> Result<f64, Refusal> {
        let limit = self.parameters.limit;
        let scheme = &self.parameters.scheme;
        self.held = match scheme {
            Scheme::Compressed { alphabet, levels } if word.bits() == alphabet.bits() => {
                let unknown = Refusal::Unknown {
                    value: word.value(),
                };
                let (level, down) = alphabet.step(word).ok_or(unknown)?;
                let step = levels.threshold(level).ok_or(unknown)?;
                let moved = if down {
                    self.held - step
                } else {
                    self.held + step
                };
                // Only a decoder that has missed a word can get there.
                moved.max(-limit).min(limit)
            }
            _ => scheme.resynchronisation().decode(word, limit)?,
        };
        Ok(self.held)
    }

    /// Takes the command u of one sample, N m. A command that is not a number changes nothing.
    pub fn encode(&mut self, command: f64) -> AxisOutput {
        let limit = self.parameters.limit;
        let usable = Some(command).filter(|command| !command.is_nan());
        let step = usable.and_then(|command| self.step(command.max(-limit).min(limit)));
        let (word, level) = step.unzip();
        if let Some(word) = &word {
            // The encoder's own words are never refused.
            let _ = self.receive(word);
        }
        AxisOutput {
            held: self.held,
            word,
            level: level.flatten(),
        }
    }

    /// As [`Self::encode`], and then a word with the number held, which makes a decoder that receives
    /// it agree. It takes the place of the word of a step.
    pub fn encode_and_resynchronise(&mut self, command: f64) -> AxisOutput {
        let output = self.encode(command);
        let format = self.parameters.scheme.resynchronisation();
        let word = format.encode(self.held, self.parameters.limit);
        // Both ends hold the number as the word has it.
        let _ = self.receive(&word);
        AxisOutput {
            held: self.held,
            word: Some(word),
            ..output
        }
    }

    /// Back to zero.
    pub fn reset(&mut self) {
        self.held = 0.0;
    }

    /// The word to send for a command within the limit, and its level.
    fn step(&self, command: f64) -> Option<(Word, Option<u32>)> {
        let AxisParameters { limit, scheme } = &self.parameters;
        let distance = (command - self.held).abs();
        let (threshold, format) = match scheme {
            Scheme::EveryChange { format } => (0.0, format),
            Scheme::FixedThreshold { threshold, format } => (*threshold, format),
            Scheme::RelativeThreshold {
                relative,
                absolute,
                format,
            } => (relative * command.abs() + absolute, format),
            Scheme::Compressed { alphabet, levels } => {
                let level = levels.level(command.abs(), *limit);
                let fires = distance >= levels.threshold(level)?;
                let down = command < self.held;
                let word = alphabet.word(level, down).filter(|_| fires)?;
                return Some((word, Some(level)));
            }
        };
        if distance < threshold {
            return None;
        }
        // A coarse number may not get any closer: then there is nothing to say.
        let word = format.encode(command, *limit);
        let changes = format.decode(&word, *limit) != Ok(self.held);
        changes.then_some((word, None))
    }
}
