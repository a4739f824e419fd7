//! Linear matrix inequalities, written as a paper writes them.
//!
//! [`Unknowns`] hands out matrix unknowns as [`Affine`] expressions; constant factors, sums,
//! transposes and blocks of them are again [`Affine`]. A [`Condition`] is such an expression with
//! a name, a sign and a margin; a [`LmiProblem`] is a list of conditions with a linear objective. It is
//! lowered once, to a [`Semidefinite`] program, which every backend and file writer reads.
//!
//! ```
//! use nalgebra::DMatrix;
//! use sdp::lmi::{Condition, Unknowns};
//!
//! let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -2.0, -3.0]);
//! let mut unknowns = Unknowns::new();
//! let lyapunov = unknowns.symmetric("P", 2);
//! let decrease = Condition::negative("A'P + PA", (&lyapunov * &a).symmetrised(), 1e-6);
//! assert_eq!(decrease.side(), 2);
//! ```
//!
//! A product of two unknowns is not linear, and there is no way to write one:
//!
//! ```compile_fail,E0277
//! use sdp::lmi::Unknowns;
//!
//! let mut unknowns = Unknowns::new();
//! let multiplier = unknowns.general("Q", 2, 2);
//! let gain = unknowns.general("F", 2, 2);
//! let bilinear = &multiplier * &gain;
//! ```

mod affine;
mod condition;
mod sdpa;
mod sdpa_read;
mod semidefinite;
mod unknowns;

pub use affine::{Affine, SymmetricBlocks};
pub use condition::{Condition, LmiProblem, Strictness};
pub use sdpa_read::{RepeatedEntry, SdpaError, SdpaForm};
pub use semidefinite::{
    dual_matrix, dual_trace, inner, inner_product, svec_index, Cone, Entry, Semidefinite,
};
pub use unknowns::Unknowns;
