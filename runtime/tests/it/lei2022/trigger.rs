//! The composite trigger of Lei et al. 2022: when actuators turn on and off.

use super::*;

#[test]
fn actuators_start_off_and_turn_on_where_v2_meets_the_envelope_less_its_buffer() {
    let sample = measurement([0.0; 3], [0.3, -0.2, 0.1]);
    let command = with_envelope(1.002, &sample).step(0.0, &sample);
    assert_eq!(command.torque, Vector3::zeros());
    assert!(!command.sent && command.bytes() == 0);

    let mut controller = with_envelope(1.0005, &sample);
    let command = controller.step(0.0, &sample);
    assert!(command.sent && controller.is_on());
    assert_eq!(command.bytes(), MESSAGE_BYTES);
    let wanted = controller.evaluate(0.0, &sample).unwrap().torque;
    assert_eq!(
        command.torque,
        wanted.map(|value| value.clamp(-0.05, 0.05)),
        "the torque in force is the law's, saturated"
    );
}

#[test]
fn the_relative_buffer_turns_on_earlier() {
    let sample = measurement([0.0; 3], [0.3, -0.2, 0.1]);
    let level = 1.2 * energy(&sample);
    for (relative_buffer, on) in [(0.0, false), (0.15, false), (0.2, true)] {
        let parameters = with_trigger(|trigger| {
            trigger.envelope_terminal_j = level;
            trigger.envelope_initial_j = 1.000_001 * level;
            trigger.relative_buffer = relative_buffer;
        });
        let mut controller = Controller::new(parameters).unwrap();
        assert_eq!(controller.step(0.0, &sample).sent, on, "{relative_buffer}");
    }
}

#[test]
fn the_longest_on_time_ends_at_its_sample_in_spite_of_rounding() {
    let sample = measurement([0.0; 3], [0.3, -0.2, 0.1]);
    let mut controller = with_envelope(0.9, &sample);
    // At rest in the funnel's wide part the law hardly changes, so the held error stays small. The
    // samples are 0.1 s apart, the first where rounding makes ten of them a little less than 1 s.
    let time = |tenth: i32| f64::from(tenth) / 10.0;
    let short = |tenth: &i32| time(tenth + 10) - time(*tenth) < 1.0;
    let first = (1..100).find(short).unwrap();
    for tenth in first..first + 10 {
        let sent = controller.step(time(tenth), &sample).sent;
        assert_eq!(sent, tenth == first, "{tenth}");
    }
    let command = controller.step(time(first + 10), &sample);
    assert!(command.sent, "off and, V2 being where it was, on again");
    assert_eq!(controller.switch_count(), SwitchCount { on: 2, off: 1 });
    assert!(controller.is_on());
}

#[test]
fn a_held_error_above_its_level_turns_the_actuators_off() {
    let sample = measurement([0.0; 3], [0.3, -0.2, 0.1]);
    let mut controller = with_envelope(0.9, &sample);
    let held = controller.step(0.0, &sample).torque;
    // At the virtual rate V2 is zero, and the law asks for next to nothing.
    let virtual_rate = controller.evaluate(0.1, &sample).unwrap().virtual_rate;
    let following = AttitudeMeasurement {
        rate_rad_s: virtual_rate,
        ..sample
    };
    let wanted = controller.evaluate(0.1, &following).unwrap().torque;
    let level = trigger().turn_off_level(0.1);
    assert!((wanted - held).norm_squared() > level);
    let command = controller.step(0.1, &following);
    assert!(command.sent && !controller.is_on());
    assert_eq!(command.torque, Vector3::zeros());
    assert_eq!(controller.switch_count(), SwitchCount { on: 1, off: 1 });
}

#[test]
fn the_levels_are_the_exponentials_of_6_and_70() {
    let trigger = trigger();
    for time in [0.0_f64, 3.0, 40.0, 1e4] {
        let decay = (-0.18 * time).exp();
        let envelope = (4.2e-3 - 2e-7) * decay + 2e-7;
        assert_relative_eq!(trigger.envelope(time), envelope, max_relative = 1e-14);
        assert_relative_eq!(
            trigger.turn_off_level(time),
            1.7e-3 * decay + 1e-5,
            max_relative = 1e-14
        );
        assert_relative_eq!(
            trigger.turn_on_level(time),
            envelope - 6e-8,
            max_relative = 1e-13
        );
    }
}

#[test]
fn always_on_follows_the_law_at_every_sample() {
    let mut controller = Controller::new(Parameters {
        trigger: TriggerRule::EverySample,
        ..parameters()
    })
    .unwrap();
    for (index, q1) in [0.3, 0.2, 0.1].into_iter().enumerate() {
        let sample = measurement([0.001, 0.0, 0.0], [q1, -0.2, 0.1]);
        let command = controller.step(index as f64, &sample);
        let wanted = controller.evaluate(index as f64, &sample).unwrap().torque;
        assert!(command.sent);
        assert_eq!(command.torque, wanted.map(|value| value.clamp(-0.05, 0.05)));
    }
    assert_eq!(controller.switch_count(), SwitchCount { on: 3, off: 0 });
}

#[test]
fn the_manoeuvre_starts_at_the_first_sample_whatever_the_clock_says() {
    let sample = |k: i32| measurement([1e-3 * f64::from(k), 0.0, 0.0], [0.3, -0.2, 0.1]);
    let mut at_zero = Controller::new(parameters()).unwrap();
    let mut later = at_zero;
    for k in 0..40 {
        let time = 0.25 * f64::from(k);
        let command = later.step(4096.0 + time, &sample(k));
        assert_eq!(at_zero.step(time, &sample(k)), command);
    }
    assert!(later.switch_count().on > 0);
    later.reset();
    assert_eq!(later, Controller::new(parameters()).unwrap());
}
