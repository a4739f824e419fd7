//! Design files: what synthesis proves and the runtime needs.

mod certificate;
mod file;
mod large_set;
mod recover;
mod search;

pub use certificate::{CertificateFile, MismatchFile};
pub(crate) use file::{matrix, rows};
pub use file::{
    ControllerFile, DesignFile, ProblemUnits, Provenance, SolverRun, DESIGN_SCHEMA_VERSION,
};
pub use large_set::{Coupling, LargeSetCertificate, OuterFile};
pub(crate) use recover::add_claims;
pub use recover::recover;
pub use search::{SearchRecord, VariedFile};
