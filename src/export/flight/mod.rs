//! A controller as source text that runs elsewhere: C99 with reference vectors of [`runtime`].
//!
//! Data goes one way: a design or a scenario becomes a [`source::Source`], what is run on the controller becomes
//! [`vectors::Vectors`], and both become the files of a [`package::Package`].

mod error;
mod fmu;
mod frameworks;
pub mod inputs;
mod law_text;
mod lei2022;
mod matlab;
pub mod package;
mod scenario;
mod single;
pub mod source;
pub mod vectors;
mod wu2018;
mod xu2020;
mod yang2025;

pub use self::error::NoSource;
use self::package::Package;
use self::source::Precision;
use self::vectors::Vectors;
use crate::run::design::Design;
use crate::scenario::Scenario;

/// The files of a design's controller, with so many samples in the reference vectors.
///
/// # Errors
/// Gains that are no law; numbers that the flight code refuses; what needs doubles, in single precision.
pub fn of_design(
    design: &Design,
    samples: usize,
    precision: Precision,
) -> Result<Package, NoSource> {
    let source = single::in_precision(precision, xu2020::source(design)?, Some(design))?;
    let vectors = Vectors::of_design(design, samples)?;
    Ok(Package::new(&source, &vectors))
}

/// The files of a scenario's controller. `text` is the file's.
///
/// # Errors
/// A controller without C text; numbers that the flight code refuses; what needs doubles, in single precision.
pub fn of_scenario(
    scenario: &Scenario,
    text: &str,
    samples: usize,
    precision: Precision,
) -> Result<Package, NoSource> {
    let source = single::in_precision(precision, scenario::source(scenario, text)?, None)?;
    let vectors = Vectors::of_scenario(scenario, source.interval_s, samples)?;
    Ok(Package::new(&source, &vectors))
}

/// The functional mock-up unit of a design's controller.
///
/// # Errors
/// As [`of_design`]; a unit that is too large.
pub fn unit_of_design(design: &Design) -> Result<Vec<u8>, NoSource> {
    Ok(fmu::unit(&xu2020::source(design)?)?)
}

/// The functional mock-up unit of a scenario's controller. `text` is the file's.
///
/// # Errors
/// As [`of_scenario`]; a unit that is too large.
pub fn unit_of_scenario(scenario: &Scenario, text: &str) -> Result<Vec<u8>, NoSource> {
    Ok(fmu::unit(&scenario::source(scenario, text)?)?)
}
