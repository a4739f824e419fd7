//! The controller of Lei et al. 2022.

pub mod bounds;
pub mod case;
mod check;
pub mod conditions;
pub mod file;
pub mod in_loop;
mod law;

pub use bounds::Bounds;
pub use case::Case;
pub use conditions::conditions;
pub use file::*;
