//! The codec between command and actuator: Yang et al. 2025, (21)-(23), and its rivals.

mod links;

use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use runtime::compression::{
    Alphabet, AxisEnd, AxisParameters, BitReader, BitWriter, Decoder, Encoder, Level, Levels,
    NumberFormat, Parameters, Refusal, Scheme, Word,
};
use runtime::error::{Field, ParameterError};
use runtime::nalgebra::Vector3;

const LIMIT: f64 = 0.2;
/// Largest table of levels in these tests.
const TABLE: usize = 4;
/// The words of the tests: (z, m).
const ALPHABETS: [(u32, u32); 4] = [(2, 3), (6, 4), (4, 6), (16, 2)];
/// Time between two samples, s.
const SAMPLE: f64 = 0.01;

type Axis = AxisParameters<TABLE>;

/// Yang et al. 2025, Table 3.
fn published_levels(steps: [f64; 4]) -> Levels<TABLE> {
    let edges = [0.0, 0.05, 0.1, 0.15];
    let level = |index: usize| Level {
        from: edges[index],
        threshold: steps[index],
    };
    Levels::table(&[0, 1, 2, 3].map(level)).unwrap()
}

fn published() -> [Axis; 3] {
    let steps = [
        [0.03, 0.037, 0.048, 0.056],
        [0.02, 0.024, 0.033, 0.047],
        [0.02, 0.022, 0.032, 0.040],
    ];
    steps.map(|steps| Axis {
        limit: LIMIT,
        scheme: Scheme::Compressed {
            alphabet: Alphabet::new(2, 3).unwrap(),
            levels: published_levels(steps),
        },
    })
}

/// Every level that the alphabet has, with steps that fit any of them.
fn full((radix, digits): (u32, u32)) -> Axis {
    let alphabet = Alphabet::new(radix, digits).unwrap();
    Axis {
        limit: LIMIT,
        scheme: Scheme::Compressed {
            alphabet,
            levels: Levels::Even {
                count: alphabet.levels(),
                smallest_threshold: 0.002,
                largest_threshold: 0.05,
            },
        },
    }
}

fn fixed(format: NumberFormat) -> Axis {
    Axis {
        limit: LIMIT,
        scheme: Scheme::FixedThreshold {
            threshold: 0.02,
            format,
        },
    }
}

fn relative(format: NumberFormat) -> Axis {
    Axis {
        limit: LIMIT,
        scheme: Scheme::RelativeThreshold {
            relative: 0.1,
            absolute: 0.02,
            format,
        },
    }
}

fn every_scheme() -> Vec<Axis> {
    let mut axes = vec![published()[0]];
    axes.extend(ALPHABETS.map(full));
    for format in [
        NumberFormat::Quantised { bits: 9 },
        NumberFormat::Single,
        NumberFormat::Double,
    ] {
        axes.extend([fixed(format), relative(format)]);
        axes.push(Axis {
            limit: LIMIT,
            scheme: Scheme::EveryChange { format },
        });
    }
    axes
}

fn parameters(axis: Axis, period_s: Option<f64>) -> Parameters<3, TABLE> {
    Parameters {
        axes: [axis; 3],
        resynchronisation_period_s: period_s,
    }
}

/// Torques of three axes at each sample: smooth stretches, jumps and commands beyond the limit.
fn torques() -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec(prop::array::uniform3(-1.3 * LIMIT..1.3 * LIMIT), 2..12).prop_map(
        |knots| {
            let pairs = knots.windows(2);
            let samples = pairs.flat_map(|pair| {
                let [from, to] = [pair[0], pair[1]];
                (0..25).map(move |index| {
                    let share = f64::from(index) / 25.0;
                    std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * share)
                })
            });
            samples.collect()
        },
    )
}

/// The words of a sample through bytes and back, with a length in front of each.
fn through_bytes(words: &[Option<Word>; 3]) -> [Option<Word>; 3] {
    let mut bytes = [0xa5_u8; 40];
    let mut writer = BitWriter::new(&mut bytes);
    for word in words {
        let length = word.map_or(0, |word| word.bits());
        assert!(writer.write(&Word::new(u64::from(length), 7).unwrap()));
        if let Some(word) = word {
            assert!(writer.write(word));
        }
    }
    let mut reader = BitReader::new(&bytes);
    words.map(|_| {
        let length = reader.read(7).unwrap().value();
        reader.read(length as u32)
    })
}

fn round_trip(axis: Axis, commands: &[[f64; 3]], period_s: Option<f64>) -> TestCaseResult {
    let parameters = parameters(axis, period_s);
    let mut encoder = Encoder::new(&parameters).unwrap();
    let mut decoder = Decoder::new(&parameters).unwrap();
    for (index, command) in commands.iter().enumerate() {
        let before = encoder.held();
        let sent = encoder.encode(SAMPLE * index as f64, &Vector3::from(*command));
        let received = decoder.receive(&through_bytes(&sent.words));
        prop_assert_eq!(received.refused, 0);
        prop_assert_eq!(received.held, sent.held);
        prop_assert_eq!(sent.held, encoder.held());
        prop_assert!(sent.held.amax() <= LIMIT);
        if !sent.sent() {
            prop_assert_eq!(sent.held, before);
            prop_assert_eq!(sent.bits(), 0);
        }
    }
    Ok(())
}

/// Lengths of a step and of a resynchronisation word.
fn every_length(index: usize) -> [u32; 2] {
    let scheme = every_scheme()[index].scheme;
    [scheme.word_bits(), scheme.resynchronisation().bits()]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn both_ends_hold_the_same_to_the_last_bit(
        commands in torques(),
        axis in prop::sample::select(every_scheme()),
        period_s in prop::option::of(0.03..0.5f64),
    ) {
        round_trip(axis, &commands, period_s)?;
    }

    #[test]
    fn an_axis_that_sends_nothing_is_closer_than_its_threshold(
        commands in prop::collection::vec(-1.5 * LIMIT..1.5 * LIMIT, 1..60),
        which in prop::sample::select(ALPHABETS.to_vec()),
    ) {
        let axis = full(which);
        let Scheme::Compressed { levels, .. } = axis.scheme else { unreachable!() };
        let mut encoder = AxisEnd::new(axis).unwrap();
        for command in commands {
            let (before, cut) = (encoder.held(), command.clamp(-LIMIT, LIMIT));
            let step = levels.threshold(levels.level(cut.abs(), LIMIT)).unwrap();
            let output = encoder.encode(command);
            let fires = (cut - before).abs() >= step;
            prop_assert_eq!(output.word.is_some(), fires);
            // A step goes towards the command and not past it.
            let moved = if fires { step } else { 0.0 };
            let distance = (cut - before).abs() - (cut - output.held).abs();
            prop_assert!((distance - moved).abs() <= 1e-15);
        }
    }

    #[test]
    fn the_rivals_stay_within_their_threshold(
        commands in prop::collection::vec(-LIMIT..LIMIT, 1..60),
        bits in 6u32..=32,
    ) {
        let format = NumberFormat::Quantised { bits };
        let resolution = LIMIT / (2.0f64.powi(bits as i32 - 1) - 1.0);
        for (axis, relative) in [(fixed(format), 0.0), (relative(format), 0.1)] {
            let mut encoder = AxisEnd::new(axis).unwrap();
            for command in &commands {
                let before = encoder.held();
                let threshold = relative * command.abs() + 0.02;
                let output = encoder.encode(*command);
                if output.word.is_some() {
                    prop_assert!((command - before).abs() >= threshold);
                    prop_assert!((command - output.held).abs() <= 0.5 * resolution * (1.0 + 1e-6));
                } else {
                    prop_assert!((command - output.held).abs() < threshold.max(resolution));
                }
            }
        }
    }

    #[test]
    fn lost_words_are_made_good_within_one_period(
        commands in torques(),
        axis in prop::sample::select(every_scheme()),
        lost in prop::collection::vec(any::<[bool; 3]>(), 275),
        samples_per_period in 2usize..40,
    ) {
        let parameters = parameters(axis, Some(SAMPLE * samples_per_period as f64));
        let mut encoder = Encoder::new(&parameters).unwrap();
        let mut decoder = Decoder::new(&parameters).unwrap();
        let mut last_loss = [None; 3];
        for (index, command) in commands.iter().enumerate() {
            let sent = encoder.encode(SAMPLE * index as f64, &Vector3::from(*command));
            prop_assert_eq!(sent.resynchronised, index > 0 && index % samples_per_period == 0);
            let mut words = sent.words;
            for axis in 0..3 {
                // Resynchronisation words arrive here; the loss of one costs one period more.
                if words[axis].is_some() && lost[index][axis] && !sent.resynchronised {
                    words[axis] = None;
                    last_loss[axis] = Some(index);
                }
            }
            let held = decoder.receive(&words).held;
            for axis in 0..3 {
                let recent = last_loss[axis].is_some_and(|lost| index - lost < samples_per_period);
                prop_assert!(recent || held[axis] == sent.held[axis]);
            }
        }
    }

    #[test]
    fn any_word_is_decoded_or_refused(
        words in prop::collection::vec((any::<u64>(), 1u32..=64), 1..200),
        axis in prop::sample::select(every_scheme()),
    ) {
        let mut decoder = AxisEnd::new(axis).unwrap();
        for (value, bits) in words {
            let before = decoder.held();
            let answer = decoder.receive(&Word::new(value, bits).unwrap());
            prop_assert!(decoder.held().abs() <= LIMIT);
            match answer {
                Ok(held) => prop_assert_eq!(held, decoder.held()),
                Err(_) => prop_assert_eq!(before, decoder.held()),
            }
        }
    }

    #[test]
    fn words_survive_packing_into_bytes(
        words in prop::collection::vec((any::<u64>(), 1u32..=64), 0..40),
    ) {
        let words: Vec<Word> = words.into_iter().map(|(v, b)| Word::new(v, b).unwrap()).collect();
        let bits: usize = words.iter().map(|word| word.bits() as usize).sum();
        let mut bytes = vec![0xff; bits.div_ceil(8)];
        let mut writer = BitWriter::new(&mut bytes);
        prop_assert!(words.iter().all(|word| writer.write(word)));
        prop_assert_eq!(writer.bits(), bits);
        prop_assert!(!writer.write(&Word::new(0, 8).unwrap()));
        let mut reader = BitReader::new(&bytes);
        for word in &words {
            prop_assert_eq!(reader.read(word.bits()), Some(*word));
        }
        prop_assert_eq!(reader.read(8), None);
    }

    #[test]
    fn the_first_digit_tells_the_direction(
        which in prop::sample::select(ALPHABETS.to_vec()),
        level in any::<u32>(),
        down in any::<bool>(),
    ) {
        let alphabet = Alphabet::new(which.0, which.1).unwrap();
        let level = level % alphabet.levels();
        let word = alphabet.word(level, down).unwrap();
        let digits: Vec<u32> = (0..alphabet.digits()).map(|i| alphabet.digit(&word, i).unwrap()).collect();
        prop_assert_eq!(digits[0] >= alphabet.radix() / 2, down);
        prop_assert!(digits.iter().all(|&digit| digit < alphabet.radix()));
        prop_assert_eq!(alphabet.from_digits(&digits), Some(word));
        prop_assert_eq!(alphabet.step(&word), Some((level, down)));
    }
}

#[test]
fn a_word_costs_m_log2_z_bits_rounded_up() {
    for (radix, digits) in ALPHABETS {
        let bits = f64::from(digits) * f64::from(radix).log2();
        let alphabet = Alphabet::new(radix, digits).unwrap();
        assert_eq!(f64::from(alphabet.bits()), bits.ceil(), "{radix}^{digits}");
    }
    let bits = ALPHABETS.map(|(radix, digits)| Alphabet::new(radix, digits).unwrap().bits());
    assert_eq!(bits, [3, 11, 12, 8]);
}

#[test]
fn the_words_of_table_1_are_levels_up_and_down() {
    let alphabet = Alphabet::new(2, 3).unwrap();
    for level in 0..4 {
        let up = alphabet.word(level, false).unwrap();
        let down = alphabet.word(level, true).unwrap();
        assert_eq!((up.value(), up.bits()), (u64::from(level), 3));
        assert_eq!((down.value(), down.bits()), (u64::from(level) + 4, 3));
    }
    assert_eq!(alphabet.word(4, false), None);
}

#[test]
fn a_step_has_the_size_of_the_commands_level() {
    let [axis, ..] = published();
    let mut encoder = AxisEnd::new(axis).unwrap();
    let mut steps = Vec::new();
    for _ in 0..6 {
        let output = encoder.encode(0.12);
        steps.push((output.level, (1e3 * output.held).round()));
    }
    // 0.12 is in the third interval, with a step of 0.048; 0.12 - 0.096 is below it.
    let expected = [
        (Some(2), 48.0),
        (Some(2), 96.0),
        (None, 96.0),
        (None, 96.0),
        (None, 96.0),
        (None, 96.0),
    ];
    assert_eq!(steps, expected);
    // In the first interval the step down has the first size.
    let output = encoder.encode(0.01);
    assert_eq!(output.level, Some(0));
    assert!((output.held - 0.066).abs() < 1e-15);
    assert_eq!(output.word.unwrap().value(), 4);
}

#[test]
fn a_million_random_words_leave_the_torque_within_the_limit() {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut decoders: Vec<_> = every_scheme()
        .into_iter()
        .map(|axis| AxisEnd::new(axis).unwrap())
        .collect();
    let (mut taken, mut refused) = (0, 0);
    for index in 0..1_000_000_usize {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        // Every other word has a length that the scheme knows.
        let axis = index % decoders.len();
        let known = every_length(axis);
        let bits = match index & 2 {
            0 => known[(seed >> 32) as usize % 2],
            _ => 1 + (seed >> 40) as u32 % 64,
        };
        match decoders[axis].receive(&Word::new(seed, bits).unwrap()) {
            Ok(_) => taken += 1,
            Err(_) => refused += 1,
        }
        assert!(decoders[axis].held().abs() <= LIMIT);
    }
    assert!(taken > 100_000 && refused > 100_000, "{taken} {refused}");
}

#[test]
fn a_coarse_number_is_not_sent_again_and_again() {
    let mut encoder = AxisEnd::new(fixed(NumberFormat::Quantised { bits: 3 })).unwrap();
    // The torques are multiples of 0.0667; 0.03 is nearest to zero, which is held already.
    assert_eq!(encoder.encode(0.03).word, None);
    assert!(encoder.encode(0.04).word.is_some());
    assert_eq!(encoder.encode(0.04).word, None);
}

#[test]
fn what_no_word_says_is_refused() {
    let mut decoder = AxisEnd::new(full((6, 4))).unwrap();
    let refusal = |word| decoder.receive(&word).unwrap_err();
    // 6^4 = 1296 words in 11 bits.
    let mut refusal = refusal;
    let unknown = Refusal::Unknown { value: 1296 };
    assert_eq!(refusal(Word::new(1296, 11).unwrap()), unknown);
    let length = Refusal::Length { bits: 12 };
    assert_eq!(refusal(Word::new(0, 12).unwrap()), length);
    let beyond = u64::from(0.3_f32.to_bits());
    let torque = f64::from(0.3_f32);
    assert_eq!(
        refusal(Word::new(beyond, 32).unwrap()),
        Refusal::OutOfLimits { torque }
    );
    let nan = u64::from(f32::NAN.to_bits());
    assert!(matches!(
        refusal(Word::new(nan, 32).unwrap()),
        Refusal::OutOfLimits { .. }
    ));
    // A level of the alphabet that the table does not have.
    let mut axis = published()[0];
    axis.scheme = Scheme::Compressed {
        alphabet: Alphabet::new(4, 2).unwrap(),
        levels: published_levels([0.03; 4]),
    };
    let mut decoder = AxisEnd::new(axis).unwrap();
    let unknown = Refusal::Unknown { value: 4 };
    assert_eq!(decoder.receive(&Word::new(4, 4).unwrap()), Err(unknown));
}

#[test]
fn a_word_with_a_flipped_bit_differs_in_that_bit() {
    let word = Word::new(0b101, 3).unwrap();
    assert_eq!(word.with_flipped(1).value(), 0b111);
    assert_eq!(word.with_flipped(3), word);
    assert_eq!(Word::new(0, 0), None);
    assert_eq!(Word::new(0, 65), None);
    assert_eq!(Word::new(0b1111, 2).unwrap().value(), 0b11);
}

#[test]
fn parameters_out_of_range_are_refused() {
    let odd = Alphabet::new(3, 2).unwrap_err();
    let field = Field::scalar("radix");
    assert_eq!(odd, ParameterError::NotEven { field, value: 3 });
    assert!(Alphabet::new(0, 2).is_err());
    let none = Alphabet::new(2, 0).unwrap_err();
    assert_eq!(none.to_string(), "digits is 0, allowed is [1, 24]");
    let many = Alphabet::new(16, 7).unwrap_err();
    assert_eq!(many.to_string(), "digits is 7, allowed is [1, 6]");
    assert!(Alphabet::new(16, 6).is_ok() && Alphabet::new(2, 24).is_ok());
    let too_many: Option<Levels<2>> = Levels::table(&[Level::default(); 3]);
    assert_eq!(too_many, None);

    let refused = |axis: Axis| {
        Encoder::new(&parameters(axis, None))
            .unwrap_err()
            .to_string()
    };
    let mut axis = published()[0];
    axis.limit = 0.0;
    assert_eq!(refused(axis), "limit[0] is 0, allowed is (0, inf)");
    axis.limit = 0.12;
    assert_eq!(refused(axis), "from[0][3] is 0.15, allowed is (0.1, 0.12)");
    let with = |levels| Axis {
        limit: LIMIT,
        scheme: Scheme::Compressed {
            alphabet: Alphabet::new(2, 3).unwrap(),
            levels,
        },
    };
    let axis = with(published_levels([0.03, 0.04, 0.5, 0.05]));
    assert_eq!(refused(axis), "threshold[0][2] is 0.5, allowed is (0, 0.4]");
    let axis = with(Levels::Even {
        count: 5,
        smallest_threshold: 0.01,
        largest_threshold: 0.01,
    });
    assert_eq!(refused(axis), "level_count[0] is 5, allowed is [1, 4]");
    let wide = fixed(NumberFormat::Quantised { bits: 33 });
    assert_eq!(refused(wide), "bits[0] is 33, allowed is [2, 32]");
    let never = Encoder::new(&parameters(published()[0], Some(0.0))).unwrap_err();
    let text = "resynchronisation_period_s is 0, allowed is (0, inf)";
    assert_eq!(never.to_string(), text);
}
