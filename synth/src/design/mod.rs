//! Design files: what synthesis proves and the runtime needs.

mod file;
mod outer;
mod recover;

pub(crate) use file::rows;
pub use file::{
    CertificateFile, ControllerFile, DesignFile, MismatchFile, ProblemUnits, Provenance, SolverRun,
    VerdictFile, DESIGN_SCHEMA_VERSION,
};
pub use outer::{Coupling, OuterCertificate, OuterFile};
pub use recover::{recover, RecoverError};
