//! Counts of samples, messages and what they cost.

use runtime::command::{Command, Departure, HoldReason, Status};

/// What happened at the samples of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EventCount {
    /// Samples that reached the controller.
    pub samples: u64,
    /// Samples that were sent.
    pub triggers: u64,
    /// Bits of all messages.
    pub bits: u64,
    /// Bytes of all messages, each rounded up to whole bytes.
    pub bytes: u64,
    /// Samples that could not be used, and the first reason.
    pub held: u64,
    /// Why the first such sample was not used.
    pub first_hold: Option<HoldReason>,
    /// Samples outside of the box of the controller's model.
    pub outside_box: u64,
    /// Samples later than the design allows.
    pub late: u64,
    /// Largest difference of a membership from that at the sample sent last.
    pub largest_mismatch: Option<f64>,
    /// Shortest time between two messages, s.
    pub shortest_interval_s: Option<f64>,
    first_sent_s: f64,
    last_sent_s: f64,
}

impl EventCount {
    /// Counts one sample.
    #[inline]
    pub fn record<const M: usize>(
        &mut self,
        time_s: f64,
        command: &Command<M>,
        mismatch: Option<f64>,
    ) {
        self.samples += 1;
        match command.status {
            Status::Nominal => {}
            Status::Uncertified(Departure::OutsideBox) => self.outside_box += 1,
            Status::Uncertified(Departure::LateSample { .. }) => self.late += 1,
            Status::Held(reason) => {
                self.held += 1;
                self.first_hold.get_or_insert(reason);
            }
        }
        if let Some(mismatch) = mismatch {
            let largest = self.largest_mismatch.unwrap_or(0.0);
            self.largest_mismatch = Some(largest.max(mismatch));
        }
        if command.sent {
            self.message(time_s, command);
        }
    }

    fn message<const M: usize>(&mut self, time_s: f64, command: &Command<M>) {
        if self.triggers == 0 {
            self.first_sent_s = time_s;
        } else {
            let interval = time_s - self.last_sent_s;
            let shortest = self.shortest_interval_s.unwrap_or(f64::INFINITY);
            self.shortest_interval_s = Some(shortest.min(interval));
        }
        self.triggers += 1;
        self.bits += command.bits as u64;
        self.bytes += command.bytes() as u64;
        self.last_sent_s = time_s;
    }

    /// Mean time between two messages, s.
    pub fn mean_interval_s(&self) -> Option<f64> {
        let intervals = self.triggers.checked_sub(1).filter(|&count| count > 0)?;
        Some((self.last_sent_s - self.first_sent_s) / intervals as f64)
    }
}
