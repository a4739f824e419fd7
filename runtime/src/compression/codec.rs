//! Encoder and decoder of all axes.

use nalgebra::SVector;

use super::axis::{AxisEnd, AxisParameters};
use super::word::Word;
use crate::error::{AllowedRange, ParameterError};

/// Share of a resynchronisation period by which a sample may be early, so that rounding of the
/// sampling instants does not delay the word by a sample.
const PERIOD_ROUNDING: f64 = 1e-9;

/// What both ends must agree on, for `M` axes with up to `L` levels given one by one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters<const M: usize, const L: usize> {
    /// The axes.
    pub axes: [AxisParameters<L>; M],
    /// Time between two resynchronisations, s, positive; never when `None`. They fall on samples: on
    /// the first one at which the period is over.
    pub resynchronisation_period_s: Option<f64>,
}

impl<const M: usize, const L: usize> Parameters<M, L> {
    fn check(&self) -> Result<(), ParameterError> {
        if let Some(period) = self.resynchronisation_period_s {
            AllowedRange::POSITIVE.check_scalar("resynchronisation_period_s", period)?;
        }
        let mut axes = self.axes.iter().enumerate();
        axes.try_for_each(|(index, axis)| axis.check(index))
    }
}

/// What an [`Encoder`] made of the commands of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoded<const M: usize> {
    /// The numbers held from now on, N m; the actuators hold the same when every word arrives.
    pub held: SVector<f64, M>,
    /// The words to send.
    pub words: [Option<Word>; M],
    /// The levels of the steps that were made, for a compressed axis only.
    pub levels: [Option<u32>; M],
    /// Whether these words are resynchronisation words.
    pub resynchronised: bool,
}

impl<const M: usize> Encoded<M> {
    /// Whether any word is to be sent.
    pub fn sent(&self) -> bool {
        self.words.iter().any(Option::is_some)
    }

    /// Bits of all words.
    pub fn bits(&self) -> usize {
        let words = self.words.iter().flatten();
        words.map(|word| word.bits() as usize).sum()
    }
}

/// The controller's end of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder<const M: usize, const L: usize> {
    axes: [AxisEnd<L>; M],
    period_s: Option<f64>,
    period_began_s: Option<f64>,
}

impl<const M: usize, const L: usize> Encoder<M, L> {
    /// An encoder before its first sample: it holds zero.
    ///
    /// # Errors
    /// The first parameter that is out of its range.
    pub fn new(parameters: &Parameters<M, L>) -> Result<Self, ParameterError> {
        parameters.check()?;
        Ok(Self {
            axes: parameters.axes.map(AxisEnd::with_checked),
            period_s: parameters.resynchronisation_period_s,
            period_began_s: None,
        })
    }

    /// The numbers held, N m.
    pub fn held(&self) -> SVector<f64, M> {
        SVector::from(self.axes.each_ref().map(AxisEnd::held))
    }

    /// Takes the commands of the sample at `time_s` seconds, N m.
    pub fn encode(&mut self, time_s: f64, command: &SVector<f64, M>) -> Encoded<M> {
        let resynchronised = self.period_is_over(time_s);
        let mut encoded = Encoded {
            held: SVector::<f64, M>::zeros(),
            words: [None; M],
            levels: [None; M],
            resynchronised,
        };
        let held = encoded.held.iter_mut();
        let outputs = held.zip(&mut encoded.words).zip(&mut encoded.levels);
        let axes = self.axes.iter_mut().zip(command.iter());
        for ((axis, command), ((held, word), level)) in axes.zip(outputs) {
            let output = if resynchronised {
                axis.encode_and_resynchronise(*command)
            } else {
                axis.encode(*command)
            };
            (*held, *word, *level) = (output.held, output.word, output.level);
        }
        encoded
    }

    /// Back to the state before the first sample.
    pub fn reset(&mut self) {
        self.axes.iter_mut().for_each(AxisEnd::reset);
        self.period_began_s = None;
    }

    /// A clock that goes back ends the period as well.
    fn period_is_over(&mut self, time_s: f64) -> bool {
        let Some(period) = self.period_s.filter(|_| time_s.is_finite()) else {
            return false;
        };
        let Some(began) = self.period_began_s else {
            self.period_began_s = Some(time_s);
            return false;
        };
        let over = time_s - began >= period * (1.0 - PERIOD_ROUNDING) || time_s < began;
        if over {
            self.period_began_s = Some(time_s);
        }
        over
    }
}

/// What a [`Decoder`] made of the words of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decoded<const M: usize> {
    /// The numbers held from now on, N m.
    pub held: SVector<f64, M>,
    /// Words that were refused.
    pub refused: usize,
}

/// The actuators' end of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decoder<const M: usize, const L: usize> {
    axes: [AxisEnd<L>; M],
}

impl<const M: usize, const L: usize> Decoder<M, L> {
    /// A decoder before its first word: it holds zero.
    ///
    /// # Errors
    /// The first parameter that is out of its range.
    pub fn new(parameters: &Parameters<M, L>) -> Result<Self, ParameterError> {
        parameters.check()?;
        Ok(Self {
            axes: parameters.axes.map(AxisEnd::with_checked),
        })
    }

    /// The numbers held, N m.
    pub fn held(&self) -> SVector<f64, M> {
        SVector::from(self.axes.each_ref().map(AxisEnd::held))
    }

    /// Takes the words that have arrived, at most one for each axis. An axis whose word is refused
    /// holds what it held.
    pub fn receive(&mut self, words: &[Option<Word>; M]) -> Decoded<M> {
        let mut refused = 0;
        for (axis, word) in self.axes.iter_mut().zip(words) {
            if let Some(word) = word {
                refused += usize::from(axis.receive(word).is_err());
            }
        }
        Decoded {
            held: self.held(),
            refused,
        }
    }

    /// Back to the state before the first word.
    pub fn reset(&mut self) {
        self.axes.iter_mut().for_each(AxisEnd::reset);
    }
}
