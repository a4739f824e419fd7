//! From what an engineer knows and requires to a proved design.

mod answer;
mod design;
mod facts;
mod recipe;
mod suggestions;
mod tables;

pub use answer::{Achieved, Answered};
pub use design::{best, candidate, Best, Candidate, Standing, Watch};
pub use facts::{Facts, FactsFile, FactsPlant, FactsSpacecraft, FactsSpecs, Requirements};
pub use recipe::{stated, Recipe, Stated};
pub use suggestions::{suggestions, Suggestion};
