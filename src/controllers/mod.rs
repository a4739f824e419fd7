//! Controllers, one paper each: its parameters as written in a scenario file and as checked, its law in the
//! closed loop, what is said of its runs, and the paper's own conditions.

pub mod law;
pub mod lei2022;
pub mod registry;
pub mod wu2018;
pub mod xu2020;
pub mod yang2025;

pub use law::{AttitudeLaw, DesignCheck};
pub use registry::{ControllerChoice, ControllerFile, DesignReferenceFile};
