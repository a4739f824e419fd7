//! The controller of Yang et al. 2025.

mod check;
pub mod file;
pub mod in_loop;

pub use check::YangChoice;
pub use file::*;
pub use in_loop::YangAttitude;
