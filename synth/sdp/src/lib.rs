//! Semidefinite programs: stated, written, solved, and refuted with a proof.
//!
//! | module | what it does |
//! |---|---|
//! | [`lmi`] | matrix unknowns and affine matrix expressions, lowered to a semidefinite program; SDPA text |
//! | [`solve`] | Clarabel and the structured solver behind one trait; what they return is a candidate |
//! | [`centre`] | the analytic centre of the dual solutions that suffice for a proof |
//! | [`exclusion`] | proves from dual weights, in interval arithmetic, that a program has no solution |
//!
//! Nothing here knows of control: unknowns are matrices, and a condition is a name with an affine matrix expression.
//!
//! ```
//! use nalgebra::DMatrix;
//! use sdp::lmi::{Affine, Condition, LmiProblem, Unknowns};
//! use sdp::solve::{Accuracy, Backend, Status, Structured};
//!
//! // The smallest t with t I >= A: the largest eigenvalue of A, which is 3.
//! let a = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
//! let mut unknowns = Unknowns::new();
//! let t = unknowns.scalar("t");
//! let above = t.times_matrix(&DMatrix::identity(2, 2)) - Affine::constant(&a);
//! let problem = LmiProblem {
//!     unknowns,
//!     objective: t,
//!     conditions: vec![Condition::semidefinite("t I above A", above)],
//! };
//! let accuracy = Accuracy { relative_gap: 1e-8, objective_unit: 1.0 };
//! let solution = Structured::default().solve(&problem.lower(), accuracy, None)?;
//! assert_eq!(solution.status, Status::Solved);
//! assert!((solution.objective - 3.0).abs() < 1e-6);
//! # Ok::<(), sdp::solve::SolveError>(())
//! ```

mod backend;
pub mod centre;
pub mod exclusion;
pub mod lmi;
mod memory;
pub mod solve;
