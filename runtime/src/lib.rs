//! Event-triggered spacecraft attitude controllers, as they would fly.
//!
//! One file or folder per published controller ([`xu2020`], [`wu2018`], [`lei2022`], [`yang2025`]) and
//! one per concern they share. The crate is `no_std`, allocates nothing, contains no `unsafe` code and
//! runs in bounded time. It knows nothing of files, synthesis or simulation.
//!
//! Every controller has the same shape: `new(parameters)` checks the parameters and returns a
//! [`ParameterError`](error::ParameterError) that carries the numbers; `step(time_s, &measurement)`
//! returns a [`Command`](command::Command). An input that cannot be used (not finite, or a time
//! not later than the last) never reaches the control law: the last valid command is held and the
//! step says why.
//!
//! All quantities are in SI units and radians. Scalar functions come from `libm`, so a simulation
//! and flight software compute the same bits.
#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod attitude;
pub mod command;
pub mod compression;
pub mod error;
pub mod lei2022;
mod matrix_check;
pub mod membership;
mod sample_clock;
pub mod saturation;
pub mod trigger;
pub mod wu2018;
pub mod xu2020;
pub mod yang2025;

pub use nalgebra;
