//! The validation harness: runs a controller on a plant and judges the run.
//!
//! A [`scenario`] names everything; [`simulation::simulate`] turns it into a
//! [`closed loop`](closed_loop) of a [`plant`], a [`sensor`], a [`controller`] and its [`actuator`]s,
//! runs it and returns the [`summary`], the trajectory and, for a proved [`design`], whether its
//! claims held.

pub mod actuator;
pub mod campaign;
pub mod closed_loop;
pub mod comparison;
pub mod controller;
pub mod design;
pub mod design_check;
pub mod distribution;
pub mod disturbance;
pub mod effort;
pub mod events;
pub mod export;
pub mod inner;
pub mod integrator;
pub mod link;
pub mod lyapunov;
pub mod output;
pub mod padding;
pub mod parquet;
pub mod plant;
pub mod pointing;
pub mod profile;
pub mod random;
pub mod recorder;
pub mod reference;
pub mod report;
pub mod sampling;
pub mod scenario;
pub mod sensor;
pub mod simulation;
pub mod summary;
pub mod sweep;
pub mod transmissions;
pub mod tune;
pub mod usage;
pub mod yang;
