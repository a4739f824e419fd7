//! Design files: what synthesis proves and the runtime needs.

mod certificate;
mod file;
mod hand_over;
mod imperfections;
mod matrices;
mod recover;
mod settling;

pub use certificate::{CertificateFile, ControllerFile, MismatchFile};
pub use file::{
    prove, Coupling, DesignFile, LargeSetCertificate, OuterFile, ProblemUnits, Provenance,
    SearchRecord, SolverRun, VariedFile, DESIGN_SCHEMA_VERSION,
};
pub(crate) use hand_over::hand_over;
pub use hand_over::{HeldWeightsFile, SetHandOverFile};
pub use imperfections::{FinalBoundsFile, FirstTorqueFile, MeasurementFile};
pub(crate) use matrices::{matrix, positive_list, rows, symmetric};
pub use recover::recover;
pub(crate) use recover::{add_claims, claim_anew, descriptor_multiplier, measurement_weights};
pub use settling::settling_time;
