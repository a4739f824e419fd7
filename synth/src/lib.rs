//! Synthesis of event-triggered attitude controllers, with proofs.
//!
//! From a model file (a rigid spacecraft, or any plant given by vertices or local rules) this crate makes
//! a design file: a gain, an event-trigger weight, and a certificate that is proved in interval
//! arithmetic from the file's own numbers. It knows nothing of simulation or of the command line. The
//! book in `docs/` has the mathematics; its page on notation maps symbols to names.
//!
//! # Modules, in the order in which data passes through them
//!
//! | module | what it does |
//! |---|---|
//! | [`model`] | reads and checks model files, and reads and writes files safely |
//! | [`fuzzy`] | the plant as a Takagi-Sugeno model: vertices, box, memberships |
//! | [`scaling`] | changes units by powers of two, and back, exactly |
//! | [`conditions`] | the published conditions, one file each, as named matrix inequalities |
//! | [`lmi`] | of steadfast-sdp: unknowns and affine matrix expressions, lowered to a semidefinite program |
//! | [`reduce`] | makes the decrease condition smaller without losing anything |
//! | [`solve`] | of steadfast-sdp: solvers behind one trait; what they return is a candidate |
//! | [`design`] | recovers the numbers of a design and reads and writes its file |
//! | [`certify`] | proves a file, apart from everything above that made it |
//! | [`infeasibility`] | the file of a proof that there is no design |
//! | [`programs`] | the semidefinite programs of a synthesis: stated, solved, recorded, and what may come of them |
//! | [`feasibility`] | decides, with a proof, whether there is any design |
//! | [`synthesis`] | runs these steps, from a model to a proved design |
//! | [`problem`] | takes other design problems the same way |
//! | [`held_command`] | proves given gains that send by a trigger on the command |
//! | [`requirements`] | from what an engineer knows and requires to a proved design |
//! | [`claim`] | writes what is claimed, rounded to the safe side |
//! | [`riccati`] | Riccati and Lyapunov equations, for candidates and units |
//!
//! # Example
//!
//! A model is checked as it is read, and an error names the field, the value and what is allowed:
//!
//! ```
//! use synth::model::Model;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = r#"{
//!   "schema_version": 1,
//!   "name": "cart",
//!   "plant": {
//!     "vertices": {
//!       "state_matrices": [[[0, 1], [0, 0]], [[0, 1], [0, -0.1]]],
//!       "input_matrix": [[0], [1]],
//!       "input_limit": [1],
//!       "disturbance_bound": 0.02,
//!       "box": [{ "row": [1, 0], "bound": 1 }, { "row": [0, 1], "bound": 1 }]
//!     }
//!   },
//!   "specs": { "phi_per_s": 0.1, "hbar_s": 0.05, "nu": 0.05, "xi_max": 100 }
//! }"#;
//! let plant = Model::from_json(text)?.plant.takagi_sugeno();
//! assert_eq!(plant.vertices.len(), 2);
//! assert_eq!((plant.states(), plant.inputs()), (2, 1));
//!
//! let wrong = text.replace(r#""nu": 0.05"#, r#""nu": 1.2"#);
//! let error = Model::from_json(&wrong).unwrap_err().to_string();
//! assert!(error.contains("specs.nu") && error.contains("1.2"), "{error}");
//! # Ok(())
//! # }
//! ```
//!
//! [`synthesis::synthesize`] makes a design of such a model with one of the solvers of [`solve`], and
//! [`certify::check`] proves it.
//!
//! Two crates stand below this one and know no control: `steadfast-sdp` states and solves semidefinite programs,
//! `steadfast-verified` encloses and proves in floating point.

mod balancing;
pub mod certify;
pub mod claim;
pub mod conditions;
pub mod design;
pub mod feasibility;
pub mod fuzzy;
pub mod held_command;
pub mod infeasibility;
pub mod model;
pub mod natural_units;
pub mod optimality;
pub mod problem;
pub mod programs;
pub mod reduce;
pub mod requirements;
pub mod riccati;
pub mod scaling;
pub mod synthesis;

pub use sdp::{lmi, solve};
