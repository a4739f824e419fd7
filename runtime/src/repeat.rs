//! Messages over a network that loses and delays them: each is sent several times, and old ones are dropped.
//!
//! # The protocol
//!
//! Samples are taken at most h seconds apart. At each of them the sender is called once: with a new value when the
//! controller's trigger has fired, without one otherwise. It transmits a value at its own sample and at the N samples
//! that follow; a new value takes its place and restarts the count. Nothing is acknowledged. Every new value has the next
//! sequence number, its repetitions have the same, and the receiver keeps a message only when it is newer than what it
//! has. Until the first arrival the receiver has nothing, and the torque must be zero.
//!
//! # What it guarantees
//!
//! Of any N + 1 consecutive transmissions let at least one arrive within d seconds of its sample. Then the first value
//! arrives within `N h + d`, and from then on the value in force was the sender's value at some sample that is at most
//!
//! ```text
//! h_m = (N + 1) h + d
//! ```
//!
//! seconds old. *Proof.* Let i be the last sample at which the sender's value was the one in force, and i + 1 a sample that
//! has been taken; then a new value was entered at i + 1, and something newer than the value in force is transmitted
//! without a gap at the samples i + 1 to i + 1 + N. One of these arrives by `t_i + (N + 1) h + d`, after which the old value
//! is never in force again.
//!
//! Without repetitions a lost message is worse than a longer sampling interval: the trigger goes on comparing with a value
//! that the receiver never got, until the next event.
//!
//! # Example
//!
//! ```
//! use runtime::repeat::{Receiver, Sender};
//!
//! let mut sender = Sender::new(2);
//! let mut receiver = Receiver::new();
//! let lost = sender.sample(Some(0.7));
//! assert!(lost.is_some() && receiver.value().is_none());
//! if let Some(repeated) = sender.sample(None) {
//!     receiver.receive(&repeated);
//! }
//! assert_eq!(receiver.value(), Some(&0.7));
//! ```

/// Number of a message. It wraps: of two numbers the newer is the one ahead by less than half of all numbers, so a message
/// must not be overtaken by 2^31 new values or more, nor that many values in a row be lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SequenceNumber(u32);

impl SequenceNumber {
    /// The number with this value, as it is in a message.
    pub const fn new(value: u32) -> Self {
        Self(value)
    }

    /// Its value.
    pub const fn value(self) -> u32 {
        self.0
    }

    /// The number after it; 0 follows the largest.
    pub const fn next(self) -> Self {
        Self(self.0.wrapping_add(1))
    }

    /// Whether it is newer than another.
    pub const fn is_after(self, other: Self) -> bool {
        let ahead = self.0.wrapping_sub(other.0);
        ahead != 0 && ahead < 1 << 31
    }
}

/// A value on its way, with its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Message<T> {
    /// The number, the same for all repetitions of a value.
    pub number: SequenceNumber,
    /// The value, such as the state that the trigger sends, or the torque made of it.
    pub value: T,
}

/// The sender's end: transmits a value at its own sample and at a number of following samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sender<T> {
    repeats: u32,
    remaining: u32,
    next: SequenceNumber,
    message: Option<Message<T>>,
}

impl<T: Copy> Sender<T> {
    /// A sender that transmits each value once and again at the `repeats` following samples; 0 never repeats.
    pub const fn new(repeats: u32) -> Self {
        Self::starting_at(repeats, SequenceNumber(0))
    }

    /// As [`Self::new`], with the number of the first value: a sender that restarts while the receiver does not goes on
    /// with a number newer than its last.
    pub const fn starting_at(repeats: u32, first: SequenceNumber) -> Self {
        Self {
            repeats,
            remaining: 0,
            next: first,
            message: None,
        }
    }

    /// Called once at each sample: with the value to be sent when the trigger fired, without one otherwise. Returns the
    /// message to transmit at this sample, if any.
    pub fn sample(&mut self, new_value: Option<T>) -> Option<Message<T>> {
        if let Some(value) = new_value {
            let number = self.next;
            self.next = number.next();
            self.remaining = self.repeats;
            self.message = Some(Message { number, value });
            return self.message;
        }
        self.remaining = self.remaining.checked_sub(1)?;
        self.message
    }

    /// The value entered last, with its number; `None` before the first.
    pub const fn message(&self) -> Option<&Message<T>> {
        self.message.as_ref()
    }

    /// How often each value is sent again.
    pub const fn repeats(&self) -> u32 {
        self.repeats
    }

    /// Nothing is transmitted until the next new value, whose number goes on.
    pub fn reset(&mut self) {
        self.remaining = 0;
        self.message = None;
    }
}

/// What an arriving message was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// Newer than anything before: its value is in force from now on.
    New,
    /// A repetition of the value in force.
    Repeated,
    /// Overtaken by a newer one; dropped.
    Old,
}

/// The receiver's end: keeps the newest value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver<T> {
    newest: Option<Message<T>>,
}

impl<T: Copy> Receiver<T> {
    /// A receiver that has nothing yet.
    pub const fn new() -> Self {
        Self { newest: None }
    }

    /// Takes a message that has arrived.
    pub fn receive(&mut self, message: &Message<T>) -> Arrival {
        if let Some(newest) = &self.newest {
            if message.number == newest.number {
                return Arrival::Repeated;
            }
            if !message.number.is_after(newest.number) {
                return Arrival::Old;
            }
        }
        self.newest = Some(*message);
        Arrival::New
    }

    /// Whether anything has arrived. Until then the torque must be zero.
    pub const fn has_arrived(&self) -> bool {
        self.newest.is_some()
    }

    /// The value in force; `None` before the first arrival.
    pub fn value(&self) -> Option<&T> {
        self.newest.as_ref().map(|newest| &newest.value)
    }

    /// The value in force with its number.
    pub const fn message(&self) -> Option<&Message<T>> {
        self.newest.as_ref()
    }

    /// Back to having nothing: any number is new.
    pub fn reset(&mut self) {
        self.newest = None;
    }
}

impl<T: Copy> Default for Receiver<T> {
    fn default() -> Self {
        Self::new()
    }
}
