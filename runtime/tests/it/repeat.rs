//! The protocol for messages that may be lost or late.

use proptest::prelude::*;
use runtime::repeat::{Arrival, Message, Receiver, Sender, SequenceNumber};

/// Numbers that wrap soon.
const NEAR_THE_END: SequenceNumber = SequenceNumber::new(u32::MAX - 3);

/// What happens at one sample.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// Time since the sample before, in units of the longest interval.
    interval: f64,
    /// Whether the trigger fires.
    fires: bool,
    /// Whether what is transmitted is lost, unless too many were lost before it.
    lost: bool,
    /// Delay of what is transmitted, in units of the longest delay.
    delay: f64,
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let delay = prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0f64];
    let step = (
        0.05..=1.0f64,
        any::<bool>(),
        prop::bool::weighted(0.7),
        delay,
    );
    let step = step.prop_map(|(interval, fires, lost, delay)| Step {
        interval,
        fires,
        lost,
        delay,
    });
    prop::collection::vec(step, 1..60)
}

/// The arrivals, in order, and the sender's value at each sample: (time, number of the value).
fn transmit(steps: &[Step], repeats: u32, longest: [f64; 2]) -> (Vec<Arriving>, Vec<(f64, u32)>) {
    let [interval_s, delay_s] = longest;
    let mut sender = Sender::starting_at(repeats, NEAR_THE_END);
    let (mut time, mut value, mut lost_in_a_row) = (0.0, 0, 0);
    let (mut arriving, mut samples) = (Vec::new(), Vec::new());
    for (index, step) in steps.iter().enumerate() {
        if index > 0 {
            time += step.interval * interval_s;
        }
        let fires = step.fires || index == 0;
        value += u32::from(fires);
        samples.push((time, value));
        let Some(message) = sender.sample(fires.then_some(value)) else {
            continue;
        };
        if step.lost && lost_in_a_row < repeats {
            lost_in_a_row += 1;
            continue;
        }
        lost_in_a_row = 0;
        arriving.push((time + step.delay * delay_s, message));
    }
    arriving.sort_by(|a, b| a.0.total_cmp(&b.0));
    (arriving, samples)
}

type Arriving = (f64, Message<u32>);

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn the_value_in_force_is_never_based_on_a_sample_older_than_the_bound(
        steps in steps(),
        repeats in 0..4_u32,
        delay_s in prop_oneof![Just(0.0), 0.0..5.0f64],
    ) {
        let interval_s = 1.0;
        let (arriving, samples) = transmit(&steps, repeats, [interval_s, delay_s]);
        let oldest = f64::from(repeats + 1) * interval_s + delay_s;
        let first = f64::from(repeats) * interval_s + delay_s;
        let end = samples.last().map_or(0.0, |sample| sample.0);
        let mut receiver = Receiver::new();
        // Just before each arrival, and at the end, what is in force has been so for longest.
        let mut moments: Vec<(f64, Option<Message<u32>>)> =
            arriving.into_iter().map(|(time, message)| (time, Some(message))).collect();
        moments.push((end, None));
        moments.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (time, message) in moments {
            if time > end {
                break;
            }
            let room = 1e-9;
            match receiver.value() {
                Some(value) => {
                    let mut taken = samples.iter().filter(|sample| sample.0 <= time);
                    let last = taken.rfind(|sample| sample.1 == *value);
                    let age = time - last.map_or(f64::NEG_INFINITY, |sample| sample.0);
                    prop_assert!(age <= oldest + room, "{age} s after {time} s");
                }
                None => prop_assert!(time <= first + room, "nothing before {time} s"),
            }
            if let Some(message) = message {
                receiver.receive(&message);
            }
        }
    }

    #[test]
    fn the_newest_message_is_kept_in_whatever_order_messages_arrive(
        order in Just((0..8_u32).collect::<Vec<_>>()).prop_shuffle(),
        start in any::<u32>(),
    ) {
        let mut receiver = Receiver::new();
        let mut newest = None;
        for index in order {
            let number = SequenceNumber::new(start.wrapping_add(index));
            let arrival = receiver.receive(&Message { number, value: index });
            let expected = match newest {
                Some(newest) if index < newest => Arrival::Old,
                _ => Arrival::New,
            };
            prop_assert_eq!(arrival, expected);
            newest = newest.max(Some(index));
            prop_assert_eq!(receiver.value().copied(), newest);
        }
    }
}

#[test]
fn a_value_is_transmitted_at_its_own_sample_and_at_the_following_ones() {
    let mut sender = Sender::new(2);
    assert_eq!(sender.sample(None), None);
    let sent: Vec<_> = [
        Some('a'),
        None,
        None,
        None,
        Some('b'),
        None,
        Some('c'),
        None,
        None,
        None,
    ]
    .into_iter()
    .map(|value| sender.sample(value).map(|message| message.value))
    .collect();
    let expected = [
        Some('a'),
        Some('a'),
        Some('a'),
        None,
        Some('b'),
        Some('b'),
        Some('c'),
        Some('c'),
        Some('c'),
        None,
    ];
    assert_eq!(sent, expected);
}

#[test]
fn without_repeats_a_value_is_transmitted_once() {
    let mut sender = Sender::new(0);
    assert!(sender.sample(Some(1)).is_some());
    assert!(sender.sample(None).is_none());
    assert_eq!(sender.message().map(|message| message.value), Some(1));
}

#[test]
fn a_repeated_message_and_an_old_one_change_nothing() {
    let mut sender = Sender::starting_at(1, NEAR_THE_END);
    let mut receiver = Receiver::default();
    assert!(!receiver.has_arrived());
    let first = sender.sample(Some(1.0)).unwrap();
    let repeated = sender.sample(None).unwrap();
    let second = sender.sample(Some(2.0)).unwrap();
    assert_eq!(receiver.receive(&first), Arrival::New);
    assert_eq!(receiver.receive(&second), Arrival::New);
    assert_eq!(receiver.receive(&repeated), Arrival::Old);
    assert_eq!(receiver.receive(&second), Arrival::Repeated);
    assert_eq!(receiver.value(), Some(&2.0));
    receiver.reset();
    assert!(!receiver.has_arrived());
    assert_eq!(receiver.receive(&first), Arrival::New);
}

#[test]
fn numbers_go_on_over_the_largest_and_after_a_reset() {
    let last = SequenceNumber::new(u32::MAX);
    assert_eq!(last.next().value(), 0);
    assert!(last.next().is_after(last) && !last.is_after(last.next()));
    assert!(!last.is_after(last));
    let mut sender = Sender::starting_at(3, last);
    sender.sample(Some(()));
    sender.reset();
    assert_eq!(sender.sample(None), None);
    let next = sender.sample(Some(())).unwrap();
    assert_eq!(next.number, SequenceNumber::new(0));
}
