//! Many runs: random, on a grid, side by side, searched.

pub mod campaign;
pub mod comparison;
pub mod parameter;
pub mod sweep;
pub mod tune;
pub mod watch;
