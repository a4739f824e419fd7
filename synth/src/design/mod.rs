//! Design files: what synthesis proves and the runtime needs.

mod certificate;
mod file;
mod outer;
mod recover;
mod search;

pub use certificate::{CertificateFile, MismatchFile};
pub(crate) use file::rows;
pub use file::{
    ControllerFile, DesignFile, ProblemUnits, Provenance, SolverRun, VerdictFile,
    DESIGN_SCHEMA_VERSION,
};
pub use outer::{Coupling, OuterCertificate, OuterFile};
pub(crate) use recover::add_claims;
pub use recover::{recover, RecoverError};
pub use search::{SearchRecord, VariedFile};
