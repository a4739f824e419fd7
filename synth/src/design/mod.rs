//! Design files: what synthesis proves and the runtime needs.

mod certificate;
mod file;
mod imperfections;
mod matrices;
mod recover;

pub use certificate::{CertificateFile, ControllerFile, MismatchFile};
pub use file::{
    prove, Coupling, DesignFile, LargeSetCertificate, OuterFile, ProblemUnits, Provenance,
    SearchRecord, SolverRun, VariedFile, DESIGN_SCHEMA_VERSION,
};
pub use imperfections::{FinalBoundsFile, FirstTorqueFile, MeasurementFile};
pub(crate) use matrices::{matrix, positive_list, rows, symmetric};
pub use recover::recover;
pub(crate) use recover::{add_claims, claim_anew, descriptor_multiplier, measurement_weights};
