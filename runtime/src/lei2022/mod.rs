//! Intermittent prescribed-performance controller of Lei, Meng, Wang, Wang and Jin, "Event-triggered
//! intermittent prescribed performance control for spacecraft attitude reorientation", 2022.
//!
//! The vector part of the error quaternion is kept in a shrinking funnel ([`PerformanceFunction`]) by a
//! backstepping law ([`ControlLaw`]) that follows a virtual rate ([`VirtualLaw`]). The actuators are on
//! for short times only ([`CompositeTrigger`]): they hold the torque computed when they were turned
//! on, and are off otherwise. Made for a fixed desired attitude.
//!
//! Where the paper's formulas are used in another form:
//! - The virtual law (10) contains the inverse of F_s, which does not exist at a half turn. With unit
//!   norm, |q0| F_s^-1 = 2 sgn(q0) (q0^2 I - q0 skew(q) + q q'), which needs no inverse.
//! - Every quantity is invariant under the change of sign of the quaternion that this makes visible, so
//!   the law works on the quaternion with the non-negative scalar part (with hysteresis where wanted).
//! - P_q in (12) is printed as psi F_s eps; what (15) and (21) need is F_s' psi eps. Both agree when all
//!   axes have the same performance function.

mod barrier;
mod controller;
mod law;
mod performance;
mod trigger;
mod virtual_law;

pub use barrier::Barrier;
pub use controller::{Controller, Parameters, SwitchCount, MESSAGE_BYTES};
pub use law::{ControlLaw, DisturbanceCompensation, Evaluation};
pub use performance::PerformanceFunction;
pub use trigger::{CompositeTrigger, Switching, TriggerRule};
pub use virtual_law::VirtualLaw;
