//! Design files: what synthesis proves and the runtime needs.

mod certificate;
mod file;
mod recover;

pub(crate) use certificate::{matrix, rows, symmetric};
pub use certificate::{CertificateFile, ControllerFile, MismatchFile};
pub use file::{
    Coupling, DesignFile, LargeSetCertificate, OuterFile, ProblemUnits, Provenance, SearchRecord,
    SolverRun, VariedFile, DESIGN_SCHEMA_VERSION,
};
pub(crate) use recover::add_claims;
pub use recover::recover;
