//! The semidefinite programs of a synthesis: stated, solved and recorded, with the types of their
//! outcomes.
//!
//! Below both [`feasibility`](crate::feasibility) and [`synthesis`](crate::synthesis), which use each program
//! in their own order.

mod active;
mod assemble;
mod outcome;
mod request;
mod session;
mod solver;
mod units;

pub use assemble::{assemble, assemble_at, Assembled, Form, Goal, MARGIN_UNIT};
pub use outcome::{
    Answer, Cancelled, Decision, Infeasible, LimitingFactors, Outcome, Sensitivity, SynthesisError,
    Synthesized,
};
pub use solver::sha256_of;
pub use units::{scaled_task, FIRST_UNITS};

pub(crate) use assemble::{bounded_trigger_weight, full_decrease};
pub(crate) use request::{ConditionSubset, DesignRequest};
pub(crate) use session::Session;
pub(crate) use solver::{blocking, generator, now, run_solver, SolveRequest};
pub(crate) use units::{containment_weights, scaled, CONTAINMENT_WEIGHTS, STATE_UNITS};
