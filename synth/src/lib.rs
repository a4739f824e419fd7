//! Synthesis of event-triggered attitude controllers, with proofs.
//!
//! Data goes one way: a [`model`] becomes the matrix inequalities of [`conditions`] (made smaller by
//! [`reduce`], put into convenient units by [`scaling`], lowered by [`lmi`]), [`solve`] returns a
//! candidate, [`design`] turns it into a file, and [`certify`] proves the file. [`synthesis`] runs
//! these steps. [`feasibility`] says, with a proof, whether there is any design. [`problem`] takes other
//! design problems the same way.

pub mod certify;
pub mod conditions;
pub mod design;
pub mod feasibility;
pub mod fuzzy;
pub mod lmi;
pub mod model;
pub mod optimality;
pub mod problem;
pub mod reduce;
pub mod scaling;
pub mod solve;
pub mod synthesis;
