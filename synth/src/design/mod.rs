//! Design files: what synthesis proves and the runtime needs.

mod file;
mod outer;
mod recover;
mod search;

pub(crate) use file::rows;
pub use file::{
    CertificateFile, ControllerFile, DesignFile, MismatchFile, ProblemUnits, Provenance, SolverRun,
    VerdictFile, DESIGN_SCHEMA_VERSION,
};
pub use outer::{Coupling, OuterCertificate, OuterFile};
pub(crate) use recover::add_claims;
pub use recover::{recover, RecoverError};
pub use search::{SearchRecord, VariedFile};
