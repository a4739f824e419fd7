//! Lost words, resynchronisation, clocks and commands that are no numbers.

use super::*;

#[test]
fn a_lost_word_without_resynchronisation_stays_lost() {
    let parameters = parameters(published()[0], None);
    let mut encoder = Encoder::new(&parameters).unwrap();
    let mut decoder = Decoder::new(&parameters).unwrap();
    encoder.encode(0.0, &Vector3::repeat(0.1));
    for index in 1..1000 {
        let command = 0.1 * (0.1 * f64::from(index)).cos();
        let sent = encoder.encode(SAMPLE * f64::from(index), &Vector3::repeat(command));
        decoder.receive(&sent.words);
        let missing = sent.held - decoder.held();
        assert!((missing - Vector3::repeat(0.048)).amax() < 1e-12);
    }
}

#[test]
fn resynchronisation_words_do_not_disturb_a_perfect_link() {
    let run = |period_s| {
        let mut encoder = Encoder::new(&parameters(published()[1], period_s)).unwrap();
        let samples = 0..2000;
        let held = samples.map(|index| {
            let time = SAMPLE * f64::from(index);
            let command = 0.2 * (0.7 * time).sin();
            encoder.encode(time, &Vector3::repeat(command)).held
        });
        held.collect::<Vec<_>>()
    };
    for (without, with) in run(None).iter().zip(run(Some(0.5))) {
        // Single precision, once per resynchronisation.
        assert!((without - with).amax() < 40.0 * 0.2 * f64::from(f32::EPSILON));
    }
}

#[test]
fn a_clock_that_goes_back_resynchronises_and_one_that_is_not_a_number_does_nothing() {
    let mut encoder = Encoder::new(&parameters(published()[0], Some(10.0))).unwrap();
    let zero = Vector3::zeros();
    assert!(!encoder.encode(5.0, &zero).resynchronised);
    assert!(!encoder.encode(f64::NAN, &zero).resynchronised);
    assert!(encoder.encode(1.0, &zero).resynchronised);
    assert!(!encoder.encode(10.9, &zero).resynchronised);
    assert!(encoder.encode(11.0, &zero).resynchronised);
}

#[test]
fn a_command_that_is_not_a_number_changes_nothing_and_infinities_are_cut_off() {
    for axis in every_scheme() {
        let mut encoder = AxisEnd::new(axis).unwrap();
        for _ in 0..400 {
            encoder.encode(f64::INFINITY);
        }
        let held = encoder.held();
        assert!(held > 0.7 * LIMIT && held <= LIMIT, "{axis:?}: {held}");
        let output = encoder.encode(f64::NAN);
        assert_eq!((output.word, output.held), (None, held));
    }
}
