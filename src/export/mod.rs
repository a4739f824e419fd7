//! Designs and trajectories in the formats of other programs.
//!
//! A design becomes a list of [`quantity::Quantity`] with what is to be said of it
//! ([`design::DesignData`]), a trajectory a table with units ([`trajectory::TrajectoryData`]); [`csv`],
//! [`mat`], [`c_header`] and [`crate::base::parquet`] write them, and [`flight`] a controller that runs. Every number is written so that it reads back
//! as the same double.

pub mod basilisk;
mod c_float;
pub mod c_header;
pub mod c_text;
pub mod csv;
pub mod design;
pub mod flight;
pub mod mat;
mod opening;
pub mod quantity;
pub mod trajectory;
