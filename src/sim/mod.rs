//! The closed loop and its parts, for any plant and any controller.
//!
//! A [`closed_loop::ClosedLoop`] runs a [`plant`], a [`sensor`], a [`controller`] and its [`actuator`]s, and
//! an observer measures it.

pub mod actuator;
pub mod bench;
pub mod bound_utilisation;
pub mod closed_loop;
pub mod controller;
pub mod disturbance;
pub mod dormand_prince;
mod dormand_prince_coefficients;
pub mod effect;
pub mod effort;
pub mod embedding;
pub mod events;
pub mod gain_error;
pub mod input_gradient;
pub mod integrator;
pub mod link;
pub mod lyapunov;
pub mod measurement_error;
pub mod metrics;
pub mod network;
pub mod plant;
pub mod pointing;
pub mod profile;
pub mod random;
pub mod recorder;
pub mod reference;
pub mod rigid_body_state;
pub mod sampling;
pub mod sensor;
pub mod transmissions;
