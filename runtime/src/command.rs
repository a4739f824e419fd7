//! What a controller step returns: the torque, whether something was sent, and the step's status.

use core::fmt;

use nalgebra::SVector;

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

    pub(crate) fn held(torque: SVector<f64, M>, reason: HoldReason) -> Self {
        Self {
            torque,
            sent: false,
            bits: 0,
            status: Status::Held(reason),
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoldReason {
    /// The time is infinite or not a number.
    NonFiniteTime,
    /// The time is not later than that of the last usable sample.
    TimeNotIncreasing {
        /// Time of the last usable sample, s.
        last_s: f64,
        /// Time given, s.
        time_s: f64,
    },
    /// A component of the measurement is infinite or not a number.
    NonFiniteMeasurement {
        /// Index of the first such component, counted from zero in the order the controller's
        /// measurement type documents.
        component: usize,
    },
    /// The measured quaternion is too far from unit length to be an attitude (see
    /// [`NORM_TOLERANCE`](crate::attitude::NORM_TOLERANCE)).
    NotUnitQuaternion {
        /// Its norm.
        norm: f64,
    },
    /// The measurement is finite but so large that the law or the trigger overflows.
    Overflow,
}

impl fmt::Display for HoldReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFiniteTime => write!(f, "the time is not a finite number"),
            Self::TimeNotIncreasing { last_s, time_s } => write!(
                f,
                "the time {time_s} s is not later than the last sample's {last_s} s"
            ),
            Self::NonFiniteMeasurement { component } => {
                write!(
                    f,
                    "measurement component {component} is not a finite number"
                )
            }
            Self::NotUnitQuaternion { norm } => {
                write!(f, "the measured quaternion has norm {norm}, not 1")
            }
            Self::Overflow => write!(f, "the measurement is too large to compute with"),
        }
    }
}

impl core::error::Error for HoldReason {}
