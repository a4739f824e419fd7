//! The link between the controller's torque command and the actuators, with its errors.

use nalgebra::SVector;
use runtime::command::{Command, Status};
use runtime::compression::{Decoder, Encoded, Encoder, NumberFormat, Parameters, Scheme, Word};
use runtime::error::ParameterError;
use serde::{Deserialize, Serialize};

use super::events::EventCount;
use super::random::{Purpose, Random};

/// Most levels of a z-ary word that are given one by one.
pub const MAX_LEVELS: usize = 64;

/// A link of `M` axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkData<const M: usize> {
    /// What both ends agree on.
    pub parameters: Parameters<M, MAX_LEVELS>,
    /// Probability that a bit arrives inverted.
    pub bit_error_probability: f64,
    /// Probability that a word does not arrive.
    pub word_loss_probability: f64,
}

/// What a link carried.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LinkOutcome {
    /// The encoding as text.
    pub encoding: String,
    /// Samples at which at least one word was sent.
    pub messages: u64,
    /// Words sent, one for an axis at a time.
    pub words: u64,
    /// Bits sent.
    pub bits: u64,
    /// Bytes sent: the bits of each message, rounded up to whole bytes.
    pub bytes: u64,
    /// Resynchronisation words among the words.
    pub resynchronisation_words: u64,
    /// Words that did not arrive.
    pub lost_words: u64,
    /// Resynchronisation words among them.
    pub lost_resynchronisation_words: u64,
    /// Words that arrived with inverted bits.
    pub corrupted_words: u64,
    /// Words that the decoder refused.
    pub refused_words: u64,
    /// Shortest time between two messages, s.
    pub shortest_interval_s: Option<f64>,
    /// Mean time between two messages, s.
    pub mean_interval_s: Option<f64>,
    /// Longest time for which the two ends of an axis held different torques, s.
    pub longest_disagreement_s: f64,
}

/// A link during a run.
#[derive(Clone, Debug)]
pub struct Link<const M: usize> {
    data: LinkData<M>,
    encoder: Encoder<M, MAX_LEVELS>,
    decoder: Decoder<M, MAX_LEVELS>,
    loss: Random,
    errors: Random,
    events: EventCount,
    outcome: LinkOutcome,
    differ_since_s: [Option<f64>; M],
    steps: [f64; M],
}

impl<const M: usize> Link<M> {
    /// A link both ends of which hold zero.
    ///
    /// # Errors
    /// Parameters that the codec refuses.
    pub fn new(data: &LinkData<M>, seed: u64) -> Result<Self, ParameterError> {
        Ok(Self {
            data: *data,
            encoder: Encoder::new(&data.parameters)?,
            decoder: Decoder::new(&data.parameters)?,
            loss: Random::new(seed, Purpose::WordLoss),
            errors: Random::new(seed, Purpose::BitErrors),
            events: EventCount::default(),
            outcome: LinkOutcome {
                encoding: description(&data.parameters),
                ..LinkOutcome::default()
            },
            differ_since_s: [None; M],
            steps: [0.0; M],
        })
    }

    /// Sends the command of a sample, N m, and returns the torque that the actuators hold from then on.
    pub fn transmit(&mut self, time_s: f64, command: &SVector<f64, M>) -> SVector<f64, M> {
        let before = self.encoder.held();
        let sent = self.encoder.encode(time_s, command);
        self.steps = std::array::from_fn(|axis| {
            let level = sent.levels[axis].map_or(1.0, |level| f64::from(level) + 1.0);
            let step = sent.held[axis] - before[axis];
            if sent.words[axis].is_some() && !sent.resynchronised && step != 0.0 {
                level.copysign(step)
            } else {
                0.0
            }
        });
        self.count(time_s, &sent);
        let words = sent.words.map(|word| {
            let word = word?;
            self.outcome.words += 1;
            self.outcome.resynchronisation_words += u64::from(sent.resynchronised);
            self.carry(word, sent.resynchronised)
        });
        let received = self.decoder.receive(&words);
        self.outcome.refused_words += received.refused as u64;
        for (axis, since) in self.differ_since_s.iter_mut().enumerate() {
            let longest = &mut self.outcome.longest_disagreement_s;
            if let Some(since) = since {
                *longest = longest.max(time_s - *since);
            }
            if received.held[axis] == sent.held[axis] {
                *since = None;
            } else {
                since.get_or_insert(time_s);
            }
        }
        received.held
    }

    /// What the actuators hold if every word has arrived, N m.
    pub fn held_by_encoder(&self) -> SVector<f64, M> {
        self.encoder.held()
    }

    /// What the last sample's words say of each axis: zero without a word, or when it only repeats what
    /// is held. A step counts positive upwards: 1 is the lowest level, or any step in an encoding without
    /// levels.
    pub fn steps(&self) -> &[f64; M] {
        &self.steps
    }

    /// What the link has carried so far.
    pub fn outcome(&self) -> LinkOutcome {
        LinkOutcome {
            messages: self.events.triggers,
            bits: self.events.bits,
            bytes: self.events.bytes,
            shortest_interval_s: self.events.shortest_interval_s,
            mean_interval_s: self.events.mean_interval_s(),
            ..self.outcome.clone()
        }
    }

    fn count(&mut self, time_s: f64, sent: &Encoded<M>) {
        let message = Command {
            torque: sent.held,
            sent: sent.sent(),
            bits: sent.bits(),
            status: Status::Nominal,
        };
        self.events.record(time_s, &message, None);
    }

    /// The word as it arrives, if it does.
    fn carry(&mut self, word: Word, resynchronisation: bool) -> Option<Word> {
        let probability = self.data.word_loss_probability;
        if probability > 0.0 && self.loss.uniform() < probability {
            self.outcome.lost_words += 1;
            self.outcome.lost_resynchronisation_words += u64::from(resynchronisation);
            return None;
        }
        let probability = self.data.bit_error_probability;
        if probability == 0.0 {
            return Some(word);
        }
        let mut arrived = word;
        for bit in 0..word.bits() {
            if self.errors.uniform() < probability {
                arrived = arrived.with_flipped(bit);
            }
        }
        self.outcome.corrupted_words += u64::from(arrived != word);
        Some(arrived)
    }
}

fn description<const M: usize>(parameters: &Parameters<M, MAX_LEVELS>) -> String {
    let Some(axis) = parameters.axes.first() else {
        return String::new();
    };
    let format = |format: NumberFormat| format!("{} bits a word", format.bits());
    match axis.scheme {
        Scheme::EveryChange { format: written } => {
            format!("every change, {}", format(written))
        }
        Scheme::FixedThreshold {
            format: written, ..
        } => format!("fixed threshold, {}", format(written)),
        Scheme::RelativeThreshold {
            format: written, ..
        } => format!("relative threshold, {}", format(written)),
        Scheme::Compressed { alphabet, levels } => format!(
            "z-ary compression, z = {}, m = {}, {} levels, {} bits a word",
            alphabet.radix(),
            alphabet.digits(),
            levels.count(),
            alphabet.bits()
        ),
    }
}
