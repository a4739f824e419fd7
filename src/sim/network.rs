//! The network between a controller and the actuators: late and lost messages, each sent several times.
//!
//! Both ends are those of the flight code, [`runtime::repeat`].

use std::collections::VecDeque;

use nalgebra::SVector;
use runtime::command::Command;
use runtime::repeat::{Arrival, Message, Receiver, Sender};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::random::{Purpose, Random};
use crate::base::bounded::{As, BelowOne};

/// How late a message is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Delay {
    /// Every message by `delay_s`.
    #[default]
    Largest,
    /// Each by itself, uniform from 0 to `delay_s`, so that messages overtake each other.
    Random,
    /// At once where the new torque makes x'Ux of the design grow faster, else by `delay_s`.
    Worst,
}

/// Which transmissions are lost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Loss {
    /// Each by itself, but never more than `lost_in_a_row` in a row.
    Random {
        /// Probability, in [0, 1).
        #[serde(with = "As::<BelowOne>")]
        probability: f64,
    },
    /// Those whose torque would make x'Ux of the design grow more slowly than the torque in force does, but never more
    /// than `lost_in_a_row` in a row.
    #[default]
    Worst,
}

/// A network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkData {
    /// Longest time from a transmission to its arrival, s.
    pub delay_s: f64,
    /// How late each one is.
    pub delay: Delay,
    /// The most transmissions that are lost in a row.
    pub lost_in_a_row: u32,
    /// Which ones are lost.
    pub loss: Loss,
    /// At how many following samples a value is sent again.
    pub repeats: u32,
}

impl NetworkData {
    /// Whether it must know how x'Ux of a design depends on the torque.
    pub fn needs_design(&self) -> bool {
        self.delay == Delay::Worst || (self.lost_in_a_row > 0 && self.loss == Loss::Worst)
    }
}

/// What a network carried.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NetworkOutcome {
    /// At how many following samples each value was sent again.
    pub repeats: u32,
    /// Values that were sent.
    pub values: u64,
    /// Transmissions: the values and their repetitions.
    pub transmissions: u64,
    /// Transmissions that were lost.
    pub lost: u64,
    /// The most that were lost in a row.
    pub longest_loss: u32,
    /// Transmissions that were overtaken by a newer value and dropped.
    pub dropped_as_old: u64,
    /// Longest time from a transmission to its arrival, s.
    pub longest_delay_s: f64,
    /// When the first message arrived, s; null when none did.
    pub first_arrival_s: Option<f64>,
    /// Greatest age of the sample that the torque in force was based on, s. As long as the trigger would have kept a
    /// value, it counts as new.
    pub oldest_sample_s: f64,
}

/// A network during a run, for commands of `M` axes.
#[derive(Clone, Debug)]
pub struct Network<const M: usize> {
    data: NetworkData,
    sender: Sender<SVector<f64, M>>,
    receiver: Receiver<SVector<f64, M>>,
    /// Time of arrival and message, in the order of arrival.
    on_the_way: VecDeque<(f64, Message<SVector<f64, M>>)>,
    /// Each value that may still come into force, or is in force, with the last sample at which it was the sender's.
    current: VecDeque<(Message<SVector<f64, M>>, f64)>,
    lost_in_a_row: u32,
    delays: Random,
    losses: Random,
    outcome: NetworkOutcome,
}

impl<const M: usize> Network<M> {
    /// A network that has carried nothing yet.
    pub fn new(data: &NetworkData, seed: u64) -> Self {
        Self {
            data: *data,
            sender: Sender::new(data.repeats),
            receiver: Receiver::new(),
            on_the_way: VecDeque::new(),
            current: VecDeque::new(),
            lost_in_a_row: 0,
            delays: Random::new(seed, Purpose::NetworkDelay),
            losses: Random::new(seed, Purpose::NetworkLoss),
            outcome: NetworkOutcome {
                repeats: data.repeats,
                ..NetworkOutcome::default()
            },
        }
    }

    /// Takes the command of a sample; `gradient` says how x'Ux grows with the torque, where that is known.
    pub fn transmit(
        &mut self,
        time_s: f64,
        command: &Command<M>,
        gradient: Option<&SVector<f64, M>>,
    ) {
        let entered = self.sender.message().map(|message| message.value);
        let new = command.sent || entered.is_some_and(|value| value != command.torque);
        let Some(message) = self.sender.sample(new.then_some(command.torque)) else {
            self.keep(time_s);
            return;
        };
        if new {
            self.outcome.values += 1;
            self.current.push_back((message, time_s));
        }
        self.keep(time_s);
        self.outcome.transmissions += 1;
        // How much faster x'Ux grows once this message is in force.
        let gain = gradient.map(|gradient| gradient.dot(&(message.value - self.in_force())));
        if self.is_lost(gain) {
            return;
        }
        let delay = self.delay(gain);
        self.outcome.longest_delay_s = self.outcome.longest_delay_s.max(delay);
        let arrival = time_s + delay;
        let later = |&(time, _): &(f64, Message<SVector<f64, M>>)| time <= arrival;
        let place = self.on_the_way.partition_point(later);
        self.on_the_way.insert(place, (arrival, message));
    }

    /// When the next message arrives, s; infinite when none is on its way.
    #[inline]
    pub fn next_arrival_s(&self) -> f64 {
        let next = self.on_the_way.front();
        next.map_or(f64::INFINITY, |(time, _)| *time)
    }

    /// The torque that comes into force at `time_s`, N m; `None` when it stays what it is.
    #[inline]
    pub fn deliver(&mut self, time_s: f64) -> Option<SVector<f64, M>> {
        let mut changed = None;
        while self.next_arrival_s() <= time_s {
            let (_, message) = self.on_the_way.pop_front()?;
            self.grow_old(time_s);
            match self.receiver.receive(&message) {
                Arrival::New => {
                    self.outcome.first_arrival_s.get_or_insert(time_s);
                    while self
                        .current
                        .front()
                        .is_some_and(|(value, _)| value.number != message.number)
                    {
                        self.current.pop_front();
                    }
                    changed = Some(message.value);
                }
                Arrival::Repeated => {}
                Arrival::Old => self.outcome.dropped_as_old += 1,
            }
        }
        changed
    }

    /// What the controller's end knows to have been sent last, N m.
    pub fn entered(&self) -> SVector<f64, M> {
        let entered = self.sender.message();
        entered.map_or(SVector::zeros(), |message| message.value)
    }

    /// What the network has carried until `time_s`.
    pub fn outcome(&mut self, time_s: f64) -> NetworkOutcome {
        self.grow_old(time_s);
        self.outcome.clone()
    }

    fn in_force(&self) -> SVector<f64, M> {
        self.receiver.value().copied().unwrap_or(SVector::zeros())
    }

    /// The sender's value is still what it sent last.
    fn keep(&mut self, time_s: f64) {
        if let Some((_, last_s)) = self.current.back_mut() {
            *last_s = time_s;
        }
    }

    /// Takes the age of what is in force.
    fn grow_old(&mut self, time_s: f64) {
        let oldest = self.current.front().filter(|_| self.receiver.has_arrived());
        if let Some((_, last_s)) = oldest {
            self.outcome.oldest_sample_s = self.outcome.oldest_sample_s.max(time_s - last_s);
        }
    }

    fn is_lost(&mut self, gain: Option<f64>) -> bool {
        let lost = self.lost_in_a_row < self.data.lost_in_a_row
            && match self.data.loss {
                Loss::Random { probability } => self.losses.uniform() < probability,
                Loss::Worst => gain.is_some_and(|gain| gain < 0.0),
            };
        self.lost_in_a_row = if lost { self.lost_in_a_row + 1 } else { 0 };
        self.outcome.lost += u64::from(lost);
        self.outcome.longest_loss = self.outcome.longest_loss.max(self.lost_in_a_row);
        lost
    }

    fn delay(&mut self, gain: Option<f64>) -> f64 {
        match self.data.delay {
            Delay::Largest => self.data.delay_s,
            Delay::Random => self.data.delay_s * self.delays.uniform(),
            Delay::Worst if gain.is_some_and(|gain| gain > 0.0) => 0.0,
            Delay::Worst => self.data.delay_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector1;
    use runtime::command::Status;

    fn command(torque: f64, sent: bool) -> Command<1> {
        Command {
            torque: Vector1::new(torque),
            sent,
            bits: 0,
            status: Status::Nominal,
        }
    }

    fn data(delay_s: f64, delay: Delay) -> NetworkData {
        NetworkData {
            delay_s,
            delay,
            lost_in_a_row: 0,
            loss: Loss::Worst,
            repeats: 0,
        }
    }

    #[test]
    fn a_late_message_that_was_overtaken_is_dropped() {
        let mut network = Network::<1>::new(&data(1.0, Delay::Worst), 1);
        // The first makes things better and is late, the second makes them worse and comes at once.
        let up = Vector1::new(1.0);
        network.transmit(0.0, &command(-2.0, true), Some(&up));
        assert_eq!(network.deliver(0.0), None);
        assert_eq!(network.next_arrival_s(), 1.0);
        network.transmit(0.5, &command(3.0, true), Some(&up));
        assert_eq!(network.deliver(0.5), Some(Vector1::new(3.0)));
        assert_eq!(network.deliver(1.0), None);
        let outcome = network.outcome(1.0);
        assert_eq!(
            (outcome.dropped_as_old, outcome.first_arrival_s),
            (1, Some(0.5))
        );
    }

    #[test]
    fn random_losses_and_delays_keep_within_their_bounds_and_the_age_within_that_of_the_protocol() {
        let data = NetworkData {
            lost_in_a_row: 2,
            loss: Loss::Random { probability: 0.8 },
            repeats: 2,
            ..data(0.35, Delay::Random)
        };
        let mut network = Network::<1>::new(&data, 3);
        let mut random = Random::new(5, Purpose::Sampling);
        let (mut time, mut torque) = (0.0, 0.0);
        for index in 0..20_000 {
            let sample = time;
            let sent = index == 0 || random.uniform() < 0.4;
            torque = if sent { f64::from(index) } else { torque };
            network.transmit(sample, &command(torque, sent), None);
            network.deliver(sample);
            time = sample + 0.1 * random.uniform();
            while network.next_arrival_s() < time {
                let arrival = network.next_arrival_s();
                network.deliver(arrival);
            }
        }
        let outcome = network.outcome(time);
        assert_eq!(outcome.longest_loss, 2);
        assert!(outcome.dropped_as_old > 0 && outcome.transmissions > outcome.values);
        assert!(outcome.longest_delay_s > 0.34 && outcome.longest_delay_s <= 0.35);
        let bound = 3.0 * 0.1 + 0.35;
        let oldest = outcome.oldest_sample_s;
        assert!(oldest > 0.8 * bound && oldest <= bound, "{oldest}");
    }

    #[test]
    fn the_worst_losses_are_those_that_would_help_and_no_more_in_a_row_than_allowed() {
        let data = NetworkData {
            lost_in_a_row: 1,
            ..data(0.0, Delay::Largest)
        };
        let up = Vector1::new(1.0);
        let mut network = Network::<1>::new(&data, 1);
        let mut arrives = |time: f64, torque: f64| {
            network.transmit(time, &command(torque, true), Some(&up));
            network.deliver(time).is_some()
        };
        assert!(arrives(0.0, 1.0));
        assert!(!arrives(1.0, -1.0));
        assert!(arrives(2.0, -1.0));
        assert!(arrives(3.0, 1.0));
    }
}
