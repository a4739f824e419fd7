//! Several controllers on one task, side by side.

mod faults;
mod run;
pub mod table;
mod task;

pub use faults::{standard_faults, StandardFault};
pub use run::{ComparisonJob, Curves, RunError};
pub use table::{Comparison, ControllerRow, FaultOutcome, TaskSummary, COMPARISON_SCHEMA_VERSION};
pub use task::{Candidate, ComparisonError, Difference, Task};
