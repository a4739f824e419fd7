//! The command line and the validation harness of Steadfast.
//!
//! Steadfast synthesizes event-triggered attitude controllers with a machine-checked proof and runs them
//! on a simulated spacecraft. The synthesis and the proof are in the crate [`synth`], the controllers that
//! fly in the crate [`runtime`]; this one ties them together.
//!
//! Every module uses only modules below it in this table.
//!
//! | module | what it holds |
//! |---|---|
//! | [`cli`] | the verbs of the program, one file each, and how results and errors are printed |
//! | [`report`], [`export`] | pages, and files for other programs |
//! | [`batch`] | many runs: random, on a grid, compared, searched |
//! | [`run`] | one scenario: built, run in the closed loop, judged; whether a design's proof covers the run |
//! | [`scenario`] | the scenario file |
//! | [`controllers`] | the controllers, one paper each |
//! | [`plants`] | the plants |
//! | [`sim`] | the closed loop and its parts, and what measures it |
//! | [`base`] | checks of a file's numbers, tables, digests, numbers as text |
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

pub mod base;
pub mod batch;
pub mod cli;
pub mod controllers;
pub mod export;
pub mod plants;
pub mod report;
pub mod run;
pub mod scenario;
pub mod sim;
