//! Changes of a physical quantity with which every requirement is proved.

use serde::Serialize;

use super::design::best;
use super::facts::{Facts, FactsFile, FactsPlant};
use crate::programs::{Solvers, SynthesisError};
use sdp::solve::Observer;

/// Factors of a quantity that are tried, beside the fraction that is missing.
const FACTORS: [f64; 3] = [1.25, 2.0, 4.0];

/// A change of a quantity with which every requirement was proved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suggestion {
    /// Field of the file.
    pub field: &'static str,
    /// The factor; of every entry where there are several.
    pub factor: f64,
    /// Its values with the change.
    pub values: Vec<f64>,
}

/// Changes a file by a factor above 1 in the direction that makes its requirements easier; the field and the new values.
type Change = fn(&mut FactsFile, f64) -> Option<(&'static str, f64, Vec<f64>)>;

/// The quantities, in the order in which they are printed.
const CHANGES: [Change; 3] = [more_torque, less_disturbance, more_samples];

/// For each quantity the smallest of a few changes with which every requirement is proved, where there is one. `fraction`:
/// the largest fraction of a requirement that was proved; 1 where no design was found.
///
/// # Errors
/// As [`best`].
pub fn suggestions(
    facts: &Facts,
    fraction: f64,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Vec<Suggestion>, SynthesisError> {
    let mut out = Vec::new();
    for change in CHANGES {
        for factor in FACTORS {
            let factor = short(factor / fraction.clamp(0.01, 1.0));
            let mut file = facts.file.clone();
            let Some((field, factor, values)) = change(&mut file, factor) else {
                break;
            };
            let Ok(changed) = Facts::new(file) else {
                break;
            };
            let found = best(&changed, "", solvers, observer.clone())?;
            if found.is_some_and(|found| found.meets_all()) {
                out.push(Suggestion {
                    field,
                    factor,
                    values,
                });
                break;
            }
        }
    }
    Ok(out)
}

/// Two significant digits, rounded up.
fn short(factor: f64) -> f64 {
    let unit = 10f64.powf(factor.log10().floor() - 1.0);
    (factor / unit - 1e-9).ceil() * unit
}

fn more_torque(file: &mut FactsFile, factor: f64) -> Option<(&'static str, f64, Vec<f64>)> {
    let FactsPlant::Exact(craft) = &mut file.plant;
    craft
        .torque_limit_nm
        .iter_mut()
        .for_each(|limit| *limit *= factor);
    Some((
        "plant.exact.torque_limit_nm",
        factor,
        craft.torque_limit_nm.to_vec(),
    ))
}

fn less_disturbance(file: &mut FactsFile, factor: f64) -> Option<(&'static str, f64, Vec<f64>)> {
    let FactsPlant::Exact(craft) = &mut file.plant;
    craft.disturbance_bound_nm /= factor;
    let value = vec![craft.disturbance_bound_nm];
    Some(("plant.exact.disturbance_bound_nm", 1.0 / factor, value))
}

fn more_samples(file: &mut FactsFile, factor: f64) -> Option<(&'static str, f64, Vec<f64>)> {
    if file.requirements.messages_per_s.is_some() {
        return None;
    }
    let specs = &mut file.specs;
    if let Some(rate) = &mut specs.sample_hz {
        *rate *= factor;
        return Some(("specs.sample_hz", factor, vec![*rate]));
    }
    let interval = specs.hbar_s.as_mut()?;
    *interval /= factor;
    Some(("specs.hbar_s", 1.0 / factor, vec![*interval]))
}
