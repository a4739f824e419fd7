//! The command line and the validation harness of Steadfast.
//!
//! Steadfast synthesizes event-triggered attitude controllers with a machine-checked proof and runs them
//! on a simulated spacecraft. The synthesis and the proof are in the crate [`synth`], the controllers that
//! fly in the crate [`runtime`]; this one ties them together.
//!
//! | module | what it holds |
//! |---|---|
//! | [`cli`] | the verbs of the program, one file each, and how results and errors are printed |
//! | [`harness::scenario`], [`harness::simulation`] | a scenario file, and its run from the plant to the verdict |
//! | [`harness::closed_loop`], [`harness::plant`], [`harness::sensor`], [`harness::actuator`], [`harness::link`] | the loop and its parts |
//! | [`harness::design`], [`harness::lyapunov`] | a design on a scenario: whether its proof covers the run, and its bounds along it |
//! | [`harness::campaign`], [`harness::sweep`], [`harness::comparison`], [`harness::tune`] | many runs: random, on a grid, side by side, searched |
//! | [`harness::report`], [`harness::export`] | pages, and files for other programs |
//!
//! # Example
//!
//! The program is this library: a verb is a call with its arguments, and the exit status says what came
//! of it.
//!
//! ```
//! use std::ffi::OsString;
//!
//! let arguments = ["steadfast", "schema", "model"].map(OsString::from);
//! let _status = steadfast::cli::run(arguments);
//! ```
//!
//! From a shell:
//!
//! ```text
//! steadfast synthesize models/xu2020.json -o design.json
//! steadfast simulate models/xu2020-closed-loop.json --design design.json -o run
//! ```

pub mod cli;
pub mod harness;
