//! Arithmetic that proves what it computes.
//!
//! [`rounding`] rounds in a given direction without changing the mode of the processor, [`interval`] encloses exact
//! results, [`matrix`] is a small dense matrix over any [`scalar`], and [`definite`] proves that every symmetric member
//! of an interval matrix is positive definite; [`exact`] decides the same in rational arithmetic. A proof needs IEEE 754 doubles and nothing else: no rounding mode, no
//! linear-algebra library.
//!
//! ```
//! use verified::definite::{prove_positive_definite, IntervalMatrix};
//! use verified::interval::Interval;
//!
//! // Every member of [2, -1; -1, c] with c in [1, 2] is positive definite; with c = 1/4 it is not.
//! let entries = [2.0, -1.0, -1.0].map(Interval::from);
//! let corner = Interval::new(1.0, 2.0);
//! let matrix = IntervalMatrix::from_entries(2, &[entries[0], entries[1], entries[2], corner])?;
//! assert!(prove_positive_definite(&matrix).is_ok());
//!
//! let wider = Interval::new(0.25, 2.0);
//! let matrix = IntervalMatrix::from_entries(2, &[entries[0], entries[1], entries[2], wider])?;
//! assert!(prove_positive_definite(&matrix).is_err());
//! # Ok::<(), verified::definite::WrongEntryCount>(())
//! ```

pub mod definite;
pub mod exact;
pub mod interval;
pub mod matrix;
pub mod rounding;
pub mod scalar;
