//! The validation harness.
