//! Adhesive-resilient prescribed performance control of Yang, Yang, Ji, Wang and Ma, "z-Ary compression
//! event-triggered control for spacecraft with adhesive-resilient prescribed performance",
//! Mathematics 13 (2025) 386.
//!
//! Equation numbers are that paper's. Three corrections are made, all explained where they are: the
//! denominator of (9), the direction of the resilient correction (10)-(11), and p/q in (16).

pub mod allocation;
pub mod envelope;
pub mod fault;
pub mod law;
pub mod performance;

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use self::allocation::Allocation;
use self::envelope::{Bounds, Correction, Envelope, EnvelopeParameters};
use self::fault::{FaultEstimation, FaultEstimator, SampleInterval};
use self::law::{Gains, Motion, TransformedError};
use crate::attitude::{AttitudeMeasurement, Quaternion};
use crate::command::{Command, HoldReason, SampleClock, Status, BITS_PER_NUMBER};
use crate::error::{require_positive_definite, ParameterError};

/// Bits of one message: a torque for each of `M` actuators.
pub const fn message_bits<const M: usize>() -> usize {
    M * BITS_PER_NUMBER
}

/// Parameters of the controller for `M` actuators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters<const M: usize> {
    /// Nominal inertia J0 (3x3, kg m^2), symmetric positive definite.
    pub inertia: Matrix3<f64>,
    /// Nominal actuator matrix D0 (3 x M, dimensionless), of full rank: torque about each body axis
    /// per unit torque of each actuator.
    pub actuator_matrix: SMatrix<f64, 3, M>,
    /// Largest torque of each actuator, N m, positive.
    pub torque_limit: SVector<f64, M>,
    /// Envelope of each component of the error quaternion's vector part.
    pub envelopes: [EnvelopeParameters; 3],
    /// Gains of the law.
    pub gains: Gains,
    /// Where the estimate of the fault comes from.
    pub fault_estimation: FaultEstimation,
}

/// One sample. Vectors have three components in body axes unless said otherwise.
///
/// Components count, in [`HoldReason::NonFiniteMeasurement`], as those of the attitude measurement
/// (0 to 6), then the desired rate (7 to 9), the desired acceleration (10 to 12), the fault (13 to
/// 15), the command in force (from 16).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement<const M: usize> {
    /// Error quaternion and rate error.
    pub attitude: AttitudeMeasurement,
    /// Desired rate omega_d in the desired frame, rad/s.
    pub desired_rate_rad_s: Vector3<f64>,
    /// Its time derivative in the desired frame, rad/s^2.
    pub desired_acceleration_rad_s2: Vector3<f64>,
    /// Lumped fault f of (6), N m, from an external diagnosis: used by [`FaultEstimation::External`].
    pub fault_nm: Option<Vector3<f64>>,
    /// The command that the actuators have held since the last sample, N m, where an encoder on the
    /// way to them says so; `None` when they held what this controller commanded.
    pub held_nm: Option<SVector<f64, M>>,
}

impl<const M: usize> Measurement<M> {
    /// A sample of an attitude that should stay constant, without external knowledge of faults.
    pub fn at_rest(attitude: AttitudeMeasurement) -> Self {
        Self {
            attitude,
            desired_rate_rad_s: Vector3::zeros(),
            desired_acceleration_rad_s2: Vector3::zeros(),
            fault_nm: None,
            held_nm: None,
        }
    }

    fn check(&self) -> Result<(), HoldReason> {
        self.attitude.check()?;
        let desired = self.desired_rate_rad_s.iter();
        let known = desired.chain(self.desired_acceleration_rad_s2.iter());
        HoldReason::check_finite(7, known)?;
        HoldReason::check_finite(13, self.fault_nm.iter().flat_map(|fault| fault.iter()))?;
        HoldReason::check_finite(16, self.held_nm.iter().flat_map(|held| held.iter()))
    }
}

/// What the controller knew at its last usable sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Vector part of the error quaternion, with the sign the controller works on.
    pub error: Vector3<f64>,
    /// Bounds of each component.
    pub bounds: [Bounds; 3],
    /// Sliding variable s, rad/s.
    pub sliding: Vector3<f64>,
    /// Estimated fault, N m.
    pub fault: Vector3<f64>,
    /// mu of each axis, dimensionless.
    pub correction: Vector3<f64>,
    /// Whether each component was inside of its bounds.
    pub inside: [bool; 3],
}

impl Snapshot {
    /// The largest distance of a component from the middle of its bounds, as a share of their half
    /// width: at most 1 inside of the envelope.
    pub fn envelope_ratio(&self) -> f64 {
        let pairs = self.bounds.iter().zip(self.error.iter());
        pairs.fold(0.0, |largest, (bounds, &error)| {
            f64::max(largest, bounds.position(error).abs())
        })
    }
}

/// What the first sample fixes, and what changes from one to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Memory<const M: usize> {
    began_s: f64,
    initial_error: Vector3<f64>,
    attitude: Quaternion,
    corrections: [Correction; 3],
    command: SVector<f64, M>,
    snapshot: Snapshot,
}

impl<const M: usize> Memory<M> {
    /// Of the two quaternions of an attitude, the one that continues the motion so far.
    fn continuing(&self, error: &Quaternion) -> Quaternion {
        let last = &self.attitude;
        let along = last.scalar * error.scalar + last.vector.dot(&error.vector);
        if along < 0.0 {
            -*error
        } else {
            *error
        }
    }
}

/// Law (20) inside of the envelope (10)-(12), for `M` actuators.
///
/// The command is computed and sent anew at every sample. An
/// [`Encoder`](crate::compression::Encoder) behind the controller turns it into rare short words; its
/// numbers in force then come back with the next [`Measurement`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller<const M: usize> {
    inertia: Matrix3<f64>,
    allocation: Allocation<M>,
    envelopes: [Envelope; 3],
    gains: Gains,
    fault_kind: FaultEstimation,
    estimator: FaultEstimator,
    clock: SampleClock,
    memory: Option<Memory<M>>,
}

impl<const M: usize> Controller<M> {
    /// Controller before its first sample.
    ///
    /// # Errors
    /// The first parameter that is not finite or out of its range.
    pub fn new(parameters: Parameters<M>) -> Result<Self, ParameterError> {
        require_positive_definite("inertia", &parameters.inertia)?;
        parameters.gains.check()?;
        let [first, second, third] = parameters.envelopes;
        let kind = parameters.fault_estimation;
        Ok(Self {
            inertia: parameters.inertia,
            allocation: Allocation::new(parameters.actuator_matrix, parameters.torque_limit)?,
            envelopes: [
                Envelope::new(first)?,
                Envelope::new(second)?,
                Envelope::new(third)?,
            ],
            gains: parameters.gains,
            fault_kind: kind,
            estimator: FaultEstimator::new(kind, parameters.inertia)?,
            clock: SampleClock::default(),
            memory: None,
        })
    }

    /// Takes the measurement at `time_s` seconds. The envelope's time counts from the first usable one.
    pub fn step(&mut self, time_s: f64, measurement: &Measurement<M>) -> Command<M> {
        let outcome = self.advance(time_s, measurement);
        Command::of_step(self.torque(), message_bits::<M>(), outcome)
    }

    fn advance(
        &mut self,
        time_s: f64,
        measurement: &Measurement<M>,
    ) -> Result<(bool, Status), HoldReason> {
        let seconds = self.clock.interval(time_s)?;
        measurement.check()?;
        let mut estimator = self.estimator;
        let mut memory = self.continued(time_s, measurement, seconds);
        let motion = motion(&memory.attitude, measurement);
        let held = measurement.held_nm.unwrap_or(memory.command);
        let interval = seconds.map(|seconds| SampleInterval {
            seconds,
            torque: self.allocation.torque(&held),
        });
        estimator.update(
            &motion.rate,
            measurement.fault_nm.as_ref(),
            interval.as_ref(),
        );
        let fault = *estimator.fault();
        let rates = memory.attitude.derivative(&motion.rate_error).vector;
        let errors = self.transformed(&mut memory, time_s, &rates, &fault);
        let sliding = law::sliding_variable(&self.gains, &errors, &motion.rate_error);
        let torque = law::torque(
            &self.gains,
            &self.inertia,
            &errors,
            &sliding,
            &motion,
            &fault,
        );
        let command = self.allocation.command(&torque);
        let mut numbers = command.iter().chain(fault.iter()).chain(sliding.iter());
        if !numbers.all(|value| value.is_finite()) {
            return Err(HoldReason::Overflow);
        }
        memory.command = command;
        memory.snapshot.sliding = sliding;
        memory.snapshot.fault = fault;
        self.estimator = estimator;
        self.memory = Some(memory);
        self.clock.accept(time_s);
        Ok((true, Status::Nominal))
    }

    /// The memory with the attitude of this sample and the corrections advanced to it.
    fn continued(
        &self,
        time_s: f64,
        measurement: &Measurement<M>,
        seconds: Option<f64>,
    ) -> Memory<M> {
        let measured = measurement.attitude.error;
        let measured = measured.normalised().unwrap_or(measured);
        let (Some(mut memory), Some(seconds)) = (self.memory, seconds) else {
            let attitude = measured.shortest();
            return Memory {
                began_s: time_s,
                initial_error: attitude.vector,
                attitude,
                corrections: [Correction::default(); 3],
                command: SVector::zeros(),
                snapshot: Snapshot::default(),
            };
        };
        memory.attitude = memory.continuing(&measured);
        for (correction, envelope) in memory.corrections.iter_mut().zip(&self.envelopes) {
            *correction = envelope.advance(correction, seconds);
        }
        memory
    }

    /// The transformed errors; the bounds go into the snapshot.
    fn transformed(
        &self,
        memory: &mut Memory<M>,
        time_s: f64,
        rates: &Vector3<f64>,
        fault: &Vector3<f64>,
    ) -> [TransformedError; 3] {
        let elapsed = time_s - memory.began_s;
        let [vector] = memory.attitude.vector.data.0;
        let ([starts], [rates]) = (memory.initial_error.data.0, rates.data.0);
        let ([faults], [authority]) = (fault.data.0, self.allocation.authority().data.0);
        let errors: [(TransformedError, Bounds); 3] = core::array::from_fn(|axis| {
            let (envelope, correction) = (&self.envelopes[axis], &mut memory.corrections[axis]);
            envelope.drive(correction, faults[axis], authority[axis], rates[axis]);
            let bounds = envelope.at(elapsed, starts[axis], correction);
            let error = TransformedError::new(vector[axis], rates[axis], &bounds);
            (error, bounds)
        });
        memory.snapshot = Snapshot {
            error: memory.attitude.vector,
            bounds: errors.map(|(_, bounds)| bounds),
            correction: Vector3::from(memory.corrections.map(|correction| correction.value)),
            inside: errors.map(|(error, _)| error.inside),
            ..memory.snapshot
        };
        errors.map(|(error, _)| error)
    }

    /// What was known at the last usable sample; `None` before the first.
    pub fn snapshot(&self) -> Option<&Snapshot> {
        self.memory.as_ref().map(|memory| &memory.snapshot)
    }

    /// The vector part of an error quaternion with the sign the controller would work on, and the
    /// bounds of its components at `time_s` seconds, not before the last usable sample. Before the
    /// first sample: as if that were one.
    pub fn envelope_at(&self, time_s: f64, error: &Quaternion) -> (Vector3<f64>, [Bounds; 3]) {
        let fresh = Correction::default();
        let Some(memory) = &self.memory else {
            let vector = error.shortest().vector;
            let [starts] = vector.data.0;
            let bounds =
                core::array::from_fn(|axis| self.envelopes[axis].at(0.0, starts[axis], &fresh));
            return (vector, bounds);
        };
        let since = time_s - self.clock.last_s().unwrap_or(time_s);
        let [starts] = memory.initial_error.data.0;
        let bounds = core::array::from_fn(|axis| {
            let envelope = &self.envelopes[axis];
            let correction = envelope.advance(&memory.corrections[axis], since);
            envelope.at(time_s - memory.began_s, starts[axis], &correction)
        });
        (memory.continuing(error).vector, bounds)
    }

    /// The command in force, N m.
    pub fn torque(&self) -> SVector<f64, M> {
        self.memory
            .as_ref()
            .map_or_else(SVector::zeros, |memory| memory.command)
    }

    /// The nominal actuators.
    pub fn allocation(&self) -> &Allocation<M> {
        &self.allocation
    }

    /// The envelopes.
    pub fn envelopes(&self) -> &[Envelope; 3] {
        &self.envelopes
    }

    /// Back to the state before the first sample, with zero torque.
    pub fn reset(&mut self) {
        if let Ok(estimator) = FaultEstimator::new(self.fault_kind, self.inertia) {
            self.estimator = estimator;
        }
        self.clock = SampleClock::default();
        self.memory = None;
    }
}

/// The motion in body axes.
fn motion<const M: usize>(error: &Quaternion, measurement: &Measurement<M>) -> Motion {
    let rotation = error.direction_cosine_matrix();
    let desired_rate = rotation * measurement.desired_rate_rad_s;
    Motion {
        rate: measurement.attitude.rate_rad_s + desired_rate,
        rate_error: measurement.attitude.rate_rad_s,
        desired_rate,
        desired_acceleration: rotation * measurement.desired_acceleration_rad_s2,
    }
}
