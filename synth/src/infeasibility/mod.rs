//! Infeasibility certificates: the files that prove that no design exists.

mod file;

pub use file::{InfeasibilityFile, WeightsFile, INFEASIBILITY_SCHEMA_VERSION};
