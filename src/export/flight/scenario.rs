//! The C text of a scenario's controller.

use super::error::NoSource;
use super::source::{Measurement, Precision, Source, MARK, TORQUE};
use super::{lei2022, wu2018, yang2025};
use crate::controllers::registry::ControllerChoice;
use crate::export::c_text::prefix;
use crate::export::opening::opening_of_scenario;
use crate::plants::System;
use crate::scenario::Scenario;
use crate::sim::reference::Reference;

/// The interval of the example and of the vectors where the scenario is sampled without a longest one (s).
const USUAL_INTERVAL_S: f64 = 0.1;

/// The C text of a scenario's controller. `text` is the file's.
///
/// # Errors
/// A controller without C text; a reference that moves.
pub fn source(scenario: &Scenario, text: &str) -> Result<Source, NoSource> {
    let law = scenario.controller.law().ok_or(NoSource::OfDesign)?;
    let own = match &scenario.controller {
        ControllerChoice::Wu(parameters) => wu2018::text(parameters),
        ControllerChoice::Lei(parameters) => lei2022::text(parameters),
        ControllerChoice::Yang(choice) => yang2025::text(choice)?,
        _ => return Err(NoSource::Law { law: law.name() }),
    };
    let System::RigidBody(system) = &scenario.system else {
        return Err(NoSource::OfDesign);
    };
    if !matches!(system.reference, Reference::Fixed(_)) {
        return Err(NoSource::MovingReference);
    }
    let mut about = opening_of_scenario(scenario, law, text, "flight code in C99");
    about.push(format!("format: {MARK}"));
    Ok(Source {
        title: scenario.name.clone(),
        name: prefix(&scenario.name),
        proved: false,
        about,
        sizes: [6, 3],
        repeats: 0,
        interval_s: interval_s(scenario),
        precision: Precision::Double,
        sampling: sampling(scenario),
        sending: own.sending,
        measurement: Measurement::Attitude,
        command: TORQUE,
        fields: own.fields,
        further: own.further,
        constants: own.constants,
        counts: own.counts,
        macros: Vec::new(),
        parts: own.parts,
        library: own.library,
        words: own.words,
        given_fault: own.given_fault,
        in_matlab: own.in_matlab,
    })
}

/// What is to be known of the sampling interval.
fn sampling(scenario: &Scenario) -> String {
    match scenario.instants.longest_interval_s() {
        Some(interval_s) => format!(
            "The scenario takes a sample at least every {interval_s} s. Nothing is proved for this interval, or for another one."
        ),
        None => format!(
            "The scenario has no sampling interval: its trigger is watched at every instant. A controller on a processor takes \
             samples; example and vectors are made for {USUAL_INTERVAL_S} s. Simulate the interval that you will use."
        ),
    }
}

/// The longest interval between samples (s).
fn interval_s(scenario: &Scenario) -> f64 {
    scenario
        .instants
        .longest_interval_s()
        .unwrap_or(USUAL_INTERVAL_S)
}
