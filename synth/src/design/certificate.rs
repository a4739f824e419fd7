//! The part of a design file that only the proof needs.

pub use crate::certify::{CertificateFile, MismatchFile};
