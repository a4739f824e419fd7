//! Several controllers on one task, compared.

mod faults;
mod run;
pub mod table;
mod task;

pub use faults::{standard_faults, StandardFault};
pub use run::{ComparisonJob, Curves};
pub use table::{Comparison, ControllerRow, FaultOutcome, TaskSummary, COMPARISON_SCHEMA_VERSION};
pub use task::{check_one_task, impose, name_apart, Candidate, ComparisonError, Difference, Entry};
