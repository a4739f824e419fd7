//! Every controller of the runtime crate, used as flight software would use it.
//!
//! `black_box` hides each value and each choice of a variant from the optimiser, so that no branch
//! is removed because of the numbers given here.
#![no_std]
#![forbid(unsafe_code)]

mod yang;

use core::hint::black_box;

use runtime::attitude::{skew, AttitudeMeasurement, Quaternion};
use runtime::command::Command;
use runtime::compression::{
    Alphabet, AxisParameters, BitReader, BitWriter, Decoder, Encoder, Level, Levels, NumberFormat,
    Parameters, Scheme, Word,
};
use runtime::error::ParameterError;
use runtime::local_rules::{FuzzySet, LocalRules};
use runtime::membership::{
    ConstantGain, GaussianRules, Membership, RigidBodyBox, RIGID_BODY_VERTICES,
};
use runtime::nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3, Vector6};
use runtime::repeat::{Arrival, Message, Receiver, Sender, SequenceNumber};
use runtime::saturation::Saturation;
use runtime::trigger::{Adaptation, ThresholdUpdate};
use runtime::{lei2022, wu2018, xu2020};

/// Largest torque, N m, that any controller commands over a few samples.
pub fn exercise_controllers() -> Result<f64, ParameterError> {
    let plane = RigidBodyBox::new(black_box([0.1; 3]), black_box(0.75))?;
    let local = GaussianRules::new(
        black_box([Vector6::zeros(), Vector6::repeat(0.5)]),
        black_box(Vector6::repeat(0.3)),
    )?;
    let shapes = LocalRules::new(
        black_box([
            [FuzzySet::Gaussian {
                centre: 0.0,
                width: 0.3,
            }; 6],
            [FuzzySet::Triangular {
                left: -1.0,
                peak: 0.0,
                right: 1.0,
            }; 6],
            [FuzzySet::Trapezoidal {
                left: -1.0,
                left_top: -0.5,
                right_top: 0.5,
                right: 1.0,
            }; 6],
            [FuzzySet::Any; 6],
        ]),
        black_box(Vector6::repeat(1.0)),
    )?;
    let torques = [
        fuzzy::<_, 1>(ConstantGain)?,
        fuzzy::<_, 1>(plane)?,
        fuzzy::<_, RIGID_BODY_VERTICES>(plane)?,
        fuzzy::<_, 2>(local)?,
        fuzzy::<_, 4>(shapes)?,
        wu(wu2018::Unwinding::AsPublished)?,
        wu(wu2018::Unwinding::ShortestRotation {
            hysteresis: black_box(0.1),
        })?,
        lei(lei2022::TriggerRule::Composite(composite_trigger()))?,
        lei(lei2022::TriggerRule::EverySample)?,
        yang::largest_torque()?,
    ];
    Ok(torques.into_iter().fold(0.0, f64::max))
}

/// A number that depends on every function of the attitude algebra and of the saturation.
pub fn exercise_algebra() -> Result<f64, ParameterError> {
    let axis = black_box(Vector3::new(1.0, 2.0, -2.0));
    let turn = Quaternion::from_axis_angle(&axis, black_box(0.4)).unwrap_or(Quaternion::identity());
    let euler = Quaternion::from_euler_321(black_box(0.1), black_box(0.2), black_box(-0.3));
    let error = (turn * euler).conjugate().shortest();
    let [q0, ..] = error.to_scalar_first();
    let [.., last] = (-error).to_scalar_last();
    let matrix = error.direction_cosine_matrix() + skew(&axis);
    let saturation = Saturation::new(black_box(Vector3::repeat(0.5)))?;
    let torque = saturation.saturate(&(matrix * axis)) + saturation.dead_zone(&axis);
    Ok(q0 + last + torque.dot(saturation.limit()) + error.rotation_angle_rad())
}

/// Largest torque, N m, after commands and words of every scheme, some of them corrupted.
pub fn exercise_compression() -> Result<f64, ParameterError> {
    let alphabet = Alphabet::new(black_box(6), black_box(4))?;
    let digits = [0, 1, 2].map(|index| {
        let word = alphabet.word(black_box(7), black_box(true));
        word.and_then(|word| alphabet.digit(&word, index))
            .unwrap_or(0)
    });
    let spelt = alphabet.from_digits(black_box(&digits));
    let level = |from, threshold| Level { from, threshold };
    let table = Levels::table(black_box(&[level(0.0, 0.02), level(0.1, 0.05)]));
    let even = Levels::Even {
        count: black_box(600),
        smallest_threshold: 0.01,
        largest_threshold: 0.05,
    };
    let format = black_box(NumberFormat::Quantised { bits: 9 });
    let schemes: [Scheme<2>; 5] = [
        Scheme::EveryChange { format },
        Scheme::FixedThreshold {
            threshold: 0.02,
            format: black_box(NumberFormat::Single),
        },
        Scheme::RelativeThreshold {
            relative: 0.1,
            absolute: 0.02,
            format: black_box(NumberFormat::Double),
        },
        Scheme::Compressed {
            alphabet,
            levels: table.unwrap_or(even),
        },
        Scheme::Compressed {
            alphabet,
            levels: even,
        },
    ];
    let mut largest = spelt.map_or(0.0, |word| f64::from(word.bits()));
    for scheme in black_box(schemes) {
        let parameters = Parameters {
            axes: [AxisParameters { limit: 0.2, scheme }; 3],
            resynchronisation_period_s: black_box(Some(0.1)),
        };
        largest = f64::max(largest, transmit(&parameters)?);
    }
    Ok(largest)
}

fn transmit(parameters: &Parameters<3, 2>) -> Result<f64, ParameterError> {
    let (mut encoder, mut decoder) = (Encoder::new(parameters)?, Decoder::new(parameters)?);
    let mut largest = 0.0_f64;
    for index in 0..20_i32 {
        let command = black_box(Vector3::new(0.1, -0.3, f64::NAN));
        let sent = encoder.encode(0.02 * f64::from(index), &command);
        let mut bytes = [0_u8; 24];
        let mut writer = BitWriter::new(&mut bytes);
        let written = sent.words.iter().flatten().all(|word| writer.write(word));
        let mut reader = BitReader::new(black_box(&bytes));
        let words = sent.words.map(|word| {
            let read: Option<Word> = word.and_then(|word| reader.read(word.bits()));
            read.map(|word| word.with_flipped(black_box(70)))
        });
        let received = decoder.receive(&words);
        if !written || received.refused > 0 || sent.bits() > 1000 {
            encoder.reset();
            decoder.reset();
        }
        largest = largest.max(received.held.amax()).max(encoder.held().amax());
    }
    Ok(largest)
}

fn fuzzy<S, const R: usize>(membership: S) -> Result<f64, ParameterError>
where
    S: Membership<6, R>,
{
    let adaptation = black_box(Adaptation {
        amplitude: 10.0,
        slope: 1.0,
        dead_band: 0.02,
    });
    let threshold_update = ThresholdUpdate::Clamped {
        adaptation,
        minimum: 0.1,
        maximum: 0.2,
    };
    let mut controller = xu2020::Controller::new(xu2020::Parameters {
        gains: black_box([Matrix3x6::repeat(-1.0); R]),
        membership,
        trigger_weight: black_box(Matrix6::identity()),
        threshold_update: black_box(threshold_update),
        torque_limit: black_box(Vector3::repeat(2.0)),
        trigger_floor: black_box(1e-4),
        longest_interval_s: black_box(Some(0.1)),
    })?;
    Ok(largest_torque(|time_s, measurement| {
        let command = controller.step(time_s, &measurement.rigid_body_state());
        if command.torque.norm() > 1e3 {
            controller.reset();
        }
        command
    }))
}

/// Number of new values among messages of which some are repeated, some overtaken and one comes twice.
pub fn exercise_repeats() -> u32 {
    let first = SequenceNumber::new(black_box(u32::MAX));
    let mut sender = Sender::starting_at(black_box(2), first);
    let mut receiver = Receiver::new();
    let mut late: Option<Message<Vector3<f64>>> = None;
    let mut new = 0;
    for index in 0..20_u32 {
        let fires = black_box(index % 5 == 0);
        let message = sender.sample(fires.then(|| black_box(Vector3::repeat(0.1))));
        for message in message.into_iter().chain(late) {
            new += u32::from(receiver.receive(&message) == Arrival::New);
        }
        late = message.or(late);
        if black_box(index == 17) {
            sender.reset();
            receiver.reset();
        }
    }
    match receiver.has_arrived() && receiver.value().is_some() {
        true => new,
        false => 0,
    }
}

fn wu(unwinding: wu2018::Unwinding) -> Result<f64, ParameterError> {
    let mut controller = wu2018::Controller::new(wu2018::Parameters {
        gains: wu2018::Gains::from_settling_time(black_box(160.0), 1.0, 100.0)?,
        trigger: black_box(wu2018::TriggerRule::Relative {
            relative: 0.5,
            absolute_rad_s: 1e-6,
        }),
        torque_limit: black_box(Vector3::repeat(0.2)),
        unwinding,
    })?;
    Ok(largest_torque(|time_s, measurement| {
        let command = controller.step(time_s, measurement);
        if command.torque.norm() > 1e3 {
            controller.reset();
        }
        command
    }))
}

fn composite_trigger() -> lei2022::CompositeTrigger {
    lei2022::CompositeTrigger {
        held_error_initial: 1.7e-3,
        held_error_terminal: 1e-5,
        longest_on_s: 0.1,
        envelope_initial_j: 4.2e-3,
        envelope_terminal_j: 2e-7,
        decay_rate_per_s: 0.18,
        buffer_j: 6e-8,
        relative_buffer: 0.2,
    }
}

fn lei(trigger: lei2022::TriggerRule) -> Result<f64, ParameterError> {
    let mut controller = lei2022::Controller::new(black_box(lei2022::Parameters {
        law: lei2022::ControlLaw {
            inertia: Matrix3::from_diagonal(&Vector3::new(2.8, 2.5, 1.9)),
            performance: lei2022::PerformanceFunction {
                initial: Vector3::repeat(0.5),
                terminal: Vector3::repeat(5e-3),
                midpoint_s: 50.0,
                time_scale_s: 6.4,
            },
            barrier: lei2022::Barrier {
                gain_j: 5e-5,
                width: 1.0,
            },
            virtual_law: lei2022::VirtualLaw {
                gain: 1.5,
                rate_scale_rad_s: 0.0524,
                slope: 13.0,
            },
            rate_gain: 2.6,
            disturbance: lei2022::DisturbanceCompensation {
                bound_nm: 1.5e-3,
                smoothing_rad_s: 2.8e-4,
            },
        },
        trigger,
        torque_limit: Vector3::repeat(0.05),
        sign_hysteresis: 0.1,
    }))?;
    Ok(largest_torque(|time_s, measurement| {
        let command = controller.step(time_s, measurement);
        let evaluated = controller.evaluate(time_s, measurement);
        if evaluated.is_err() || controller.switch_count().off > 1_000 {
            controller.reset();
        }
        command
    }))
}

fn largest_torque(mut step: impl FnMut(f64, &AttitudeMeasurement) -> Command<3>) -> f64 {
    let desired = black_box(Quaternion::from_scalar_last([0.0, 0.0, 0.0, 1.0]));
    let mut attitude = black_box(Quaternion::from_scalar_first([0.9, 0.1, -0.3, 0.2]));
    let rate_rad_s = black_box(Vector3::new(0.01, -0.02, 0.03));
    let mut largest = 0.0_f64;
    for index in 0..10_i32 {
        attitude = attitude.normalised().unwrap_or(Quaternion::identity());
        let error = attitude.error_from(&desired);
        let measurement = AttitudeMeasurement {
            error,
            rate_rad_s: error.rate_error(&rate_rad_s, &Vector3::zeros()),
        };
        let command = step(0.05 * f64::from(index), &black_box(measurement));
        largest = largest.max(command.torque.amax());
        let change = attitude.derivative(&rate_rad_s);
        attitude.scalar += change.scalar * 0.05;
        attitude.vector += change.vector * 0.05;
    }
    largest
}
