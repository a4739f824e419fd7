//! The semidefinite programs of a synthesis: stated, solved and recorded, with the types of their
//! outcomes.
//!
//! Below both [`feasibility`](crate::feasibility) and [`synthesis`](crate::synthesis), which use each program
//! in their own order.

mod active;
mod assemble;
mod completion;
mod form_search;
mod optimum;
mod outcome;
mod parameter;
mod record;
mod request;
mod satisfied;
mod session;
mod solvers;
mod trigger_weight;
mod units;

pub use assemble::{assemble, assemble_at, Assembled, Form, Goal, MARGIN_UNIT};
pub(crate) use completion::{complete, complete_both};
pub use optimum::Optimum;
pub use outcome::{
    Answer, Cancelled, Decision, Infeasible, LimitingFactors, Outcome, Sensitivity, SynthesisError,
    Synthesized,
};
pub(crate) use solvers::{is_small, is_structured, Asked};
pub use solvers::{solver_order, Solvers};
pub use units::{scaled_task, FIRST_UNITS};

pub(crate) use assemble::{state, Part};
pub(crate) use form_search::{best_form, in_form, slack_in};
pub(crate) use outcome::Recorded;
pub use parameter::Parameter;
pub(crate) use record::{blocking, now};
pub use record::{sha256_of, Blocking, GENERATOR};
pub(crate) use request::{ConditionSubset, DesignRequest};
pub(crate) use satisfied::satisfied;
pub(crate) use session::{has_point, largest_magnitude, Session, Solved};
pub(crate) use units::{containment_weights, scaled, CONTAINMENT_WEIGHTS, STATE_UNITS};
