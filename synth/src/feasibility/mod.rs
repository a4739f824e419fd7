//! Does any design exist? Feasible with a proof, infeasible with a proof, or undecided.
//!
//! One problem is solved: the smallest slack t with which all conditions hold. Where t is below the
//! margin its point is a candidate for a design, which the check of designs proves; where t is above,
//! its dual solution is a candidate for the dual multipliers that
//! [`certify::infeasible`](crate::certify::infeasible) proves.

mod candidate;
mod decide;
mod dual;
mod given;
mod relax;
mod size;

pub use decide::decide;
pub use relax::{relaxations, Relaxation};

pub use crate::infeasibility::{InfeasibilityFile, WeightsFile, INFEASIBILITY_SCHEMA_VERSION};
pub use crate::programs::{Answer, Decision, Infeasible};

pub(crate) use decide::decide_after;
pub(crate) use given::refute_given;
