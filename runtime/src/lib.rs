//! Event-triggered spacecraft attitude controllers, as they would fly.
//!
//! The crate is `no_std`, allocates nothing, contains no `unsafe` code and runs in bounded time. It knows
//! nothing of files, synthesis or simulation.
//!
//! Every controller has the same shape: `new(parameters)` checks the parameters and returns a
//! [`ParameterError`](error::ParameterError) that carries the numbers; `step(time_s, &measurement)`
//! returns a [`Command`](command::Command). An input that cannot be used (not finite, or a time
//! not later than the last) never reaches the control law: the last valid command is held and the
//! step says why.
//!
//! All quantities are in SI units and radians. Scalar functions come from `libm`, so a simulation
//! and flight software compute the same bits.
//!
//! # Modules
//!
//! | controllers | |
//! |---|---|
//! | [`xu2020`] | Xu and Huang: fuzzy state feedback with an event trigger; what a design of Steadfast flies in |
//! | [`wu2018`] | Wu, Shen and Cao: relative-threshold trigger |
//! | [`lei2022`] | Lei et al.: prescribed performance, actuators switched on and off |
//! | [`yang2025`] | Yang et al.: prescribed performance whose envelope follows faults |
//!
//! | shared | |
//! |---|---|
//! | [`attitude`] | quaternions, their kinematics, the measurement of an attitude |
//! | [`command`] | what a step returns: torque, message, status |
//! | [`error`] | errors of parameters |
//! | [`trigger`] | event trigger on sampled states, and its threshold |
//! | [`membership`], [`local_rules`] | membership functions of scheduled gains |
//! | [`saturation`] | saturation of each axis |
//! | [`repeat`] | messages that may be lost or late: sent again, old ones dropped |
//! | [`compression`] | codec between torque commands and words on a link |
//!
//! # Example
//!
//! A spacecraft that is 0.1 rad off about its third axis. The first sample is sent; the second, which
//! differs by nothing, is not, and the torque is held:
//!
//! ```
//! use runtime::attitude::{AttitudeMeasurement, Quaternion};
//! use runtime::command::Status;
//! use runtime::membership::ConstantGain;
//! use runtime::nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3};
//! use runtime::trigger::ThresholdUpdate;
//! use runtime::xu2020::{Controller, Parameters};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // Columns 1 to 3 multiply the body rate, columns 4 to 6 the error quaternion's vector part.
//! let mut gain = Matrix3x6::zeros();
//! gain.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Matrix3::identity() * -100.0));
//! gain.fixed_view_mut::<3, 3>(0, 3).copy_from(&(Matrix3::identity() * -15.0));
//! let mut controller = Controller::new(Parameters {
//!     gains: [gain],
//!     membership: ConstantGain,
//!     trigger_weight: Matrix6::identity(),
//!     threshold_update: ThresholdUpdate::Fixed { threshold: 0.2 },
//!     torque_limit: Vector3::new(2.0, 2.0, 2.0),
//!     trigger_floor: 0.0,
//!     longest_interval_s: Some(0.1),
//! })?;
//!
//! let measurement = AttitudeMeasurement {
//!     error: Quaternion::from_axis_angle(&Vector3::z(), 0.1)?,
//!     rate_rad_s: Vector3::zeros(),
//! };
//! let command = controller.step(0.0, &measurement.rigid_body_state());
//! assert!(command.sent && command.status == Status::Nominal);
//! assert!((command.torque.z + 15.0 * libm::sin(0.05)).abs() < 1e-12);
//!
//! let held = controller.step(0.1, &measurement.rigid_body_state());
//! assert!(!held.sent);
//! assert_eq!(held.torque, command.torque);
//! # Ok(())
//! # }
//! ```
#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod attitude;
pub mod command;
pub mod compression;
pub mod error;
pub mod lei2022;
pub mod local_rules;
pub mod membership;
pub mod repeat;
pub mod saturation;
pub mod trigger;
pub mod wu2018;
pub mod xu2020;
pub mod yang2025;

pub use nalgebra;
