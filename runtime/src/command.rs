//! What a controller step returns: the torque, whether something was sent, and the step's status.

use nalgebra::SVector;
use thiserror::Error;

/// Bytes of one transmitted number. A message is counted in IEEE 754 single precision, as in Wu et
/// al. 2018, section 5. Only the count presumes it: the values themselves are held in double
/// precision, and rounding a message changes them by a relative 6e-8 at most.
pub const BYTES_PER_NUMBER: usize = 4;
/// Bits of one transmitted number.
pub const BITS_PER_NUMBER: usize = 8 * BYTES_PER_NUMBER;

/// The result of one controller step, for `M` actuated axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<const M: usize> {
    /// Commanded torque in N m about each body axis (for a plant that is not a spacecraft: its
    /// input, in the plant's own unit). Always finite and within the controller's limits; zero until
    /// the first usable sample.
    pub torque: SVector<f64, M>,
    /// True when the event trigger fired at this sample, so that a message was sent.
    pub sent: bool,
    /// Bits of the message that was sent; zero when none was.
    pub bits: usize,
    /// Whether the step was regular.
    pub status: Status,
}

impl<const M: usize> Command<M> {
    /// Bytes of the message that was sent: its bits, rounded up to whole bytes.
    pub const fn bytes(&self) -> usize {
        self.bits.div_ceil(8)
    }

    /// After a step: the torque in force, the bits of a message, and whether one was sent with what
    /// status, or why the sample was not used.
    pub(crate) fn of_step(
        torque: SVector<f64, M>,
        message_bits: usize,
        outcome: Result<(bool, Status), HoldReason>,
    ) -> Self {
        let (sent, status) = outcome.unwrap_or_else(|reason| (false, Status::Held(reason)));
        Self {
            torque,
            sent,
            bits: if sent { message_bits } else { 0 },
            status,
        }
    }
}

/// Whether a controller step was regular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Status {
    /// The sample was used.
    Nominal,
    /// The sample was used, but it breaks an assumption of the controller's certificate, which says
    /// nothing about the run from here on until the state is back in the certified set.
    Uncertified(Departure),
    /// The sample was not used: the last valid command is held.
    Held(HoldReason),
}

impl Status {
    /// Its number for languages without enums, as in the header of C: 0 nominal; 1 outside of the box, 2 late; 3 time not
    /// finite, 4 time not increasing, 5 measurement not finite, 6 no unit quaternion, 7 overflow.
    pub const fn number(&self) -> u8 {
        match self {
            Self::Nominal => 0,
            Self::Uncertified(Departure::OutsideBox) => 1,
            Self::Uncertified(Departure::LateSample { .. }) => 2,
            Self::Held(HoldReason::NonFiniteTime) => 3,
            Self::Held(HoldReason::TimeNotIncreasing { .. }) => 4,
            Self::Held(HoldReason::NonFiniteMeasurement { .. }) => 5,
            Self::Held(HoldReason::NotUnitQuaternion { .. }) => 6,
            Self::Held(HoldReason::Overflow) => 7,
        }
    }
}

/// The assumption of a certificate that a sample broke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Departure {
    /// The state is outside of the box on which the fuzzy model equals the plant.
    OutsideBox,
    /// The time since the last usable sample is longer than the sampling interval of the design
    /// (the bound of Xu and Huang 2020, (9)).
    LateSample {
        /// Time since the last usable sample, s.
        interval_s: f64,
        /// Longest interval of the design, s.
        longest_s: f64,
    },
}

/// Why a sample was not used.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum HoldReason {
    /// The time is infinite or not a number.
    #[error("the time is not a finite number")]
    NonFiniteTime,
    /// The time is not later than that of the last usable sample.
    #[error("the time {time_s} s is not later than the last sample's {last_s} s")]
    TimeNotIncreasing {
        /// Time of the last usable sample, s.
        last_s: f64,
        /// Time given, s.
        time_s: f64,
    },
    /// A component of the measurement is infinite or not a number.
    #[error("measurement component {component} is not a finite number")]
    NonFiniteMeasurement {
        /// Index of the first such component, counted from zero in the order the controller's
        /// measurement type documents.
        component: usize,
    },
    /// The measured quaternion is too far from unit length to be an attitude (see
    /// [`NORM_TOLERANCE`](crate::attitude::NORM_TOLERANCE)).
    #[error("the measured quaternion has norm {norm}, not 1")]
    NotUnitQuaternion {
        /// Its norm.
        norm: f64,
    },
    /// The measurement is finite but so large that the law or the trigger overflows.
    #[error("the measurement is too large to compute with")]
    Overflow,
}

impl HoldReason {
    /// Refuses measured values that are not finite; the first one is number `first` of the components.
    pub(crate) fn check_finite<'a>(
        first: usize,
        values: impl IntoIterator<Item = &'a f64>,
    ) -> Result<(), Self> {
        match values.into_iter().position(|value| !value.is_finite()) {
            Some(index) => Err(Self::NonFiniteMeasurement {
                component: first + index,
            }),
            None => Ok(()),
        }
    }
}

/// Refuses times that are not finite or not later than the last accepted one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SampleClock {
    last_s: Option<f64>,
}

impl SampleClock {
    /// Interval since the last accepted sample in s; `None` at the first.
    pub(crate) fn interval(&self, time_s: f64) -> Result<Option<f64>, HoldReason> {
        if !time_s.is_finite() {
            return Err(HoldReason::NonFiniteTime);
        }
        match self.last_s {
            Some(last_s) if time_s <= last_s => {
                Err(HoldReason::TimeNotIncreasing { last_s, time_s })
            }
            Some(last_s) => Ok(Some(time_s - last_s)),
            None => Ok(None),
        }
    }

    /// Time of the last accepted sample, s.
    pub(crate) fn last_s(&self) -> Option<f64> {
        self.last_s
    }

    /// Makes `time_s` the time of the last usable sample.
    pub(crate) fn accept(&mut self, time_s: f64) {
        self.last_s = Some(time_s);
    }
}
