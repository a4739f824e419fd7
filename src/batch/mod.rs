//! Many runs: random, on a grid, compared, searched.
//!
//! What is run is a [`engine::Job`] whose runs are numbered. Where a run's numbers come from is in
//! [`variation`], the threads in [`engine`], and what is on disk so that an interruption costs little in
//! [`store`]. On top of these are [`sweep`], [`campaign`], [`comparison`] and [`tune`].

pub mod campaign;
pub mod comparison;
pub mod engine;
pub mod store;
pub mod sweep;
pub mod tune;
pub mod variation;
