//! Changes of a physical quantity with which every requirement is proved.

use rayon::prelude::*;
use serde::Serialize;

use super::answer::Answered;
use super::design::{among, candidate, Best, Candidate};
use super::facts::{Facts, FactsFile, FactsPlant};
use super::recipe::{wanted_angle, Recipe};
use crate::programs::{Solvers, SynthesisError};
use sdp::solve::Observer;

/// Factors of a quantity that are tried, beside the fraction that is missing.
const FACTORS: [f64; 2] = [1.1, 2.0];

/// The same where no design was found, or one that is far from a requirement: multiples of the least torque over the
/// disturbance with which designs are found, and at least of the file's own.
const FACTORS_FROM_AFAR: [f64; 2] = [2.0, 8.0];

/// The smallest torque over the disturbance with which designs are found; and how much larger it must be than an angle over
/// the pointing error that is required.
const LEAST_AUTHORITY: f64 = 10.0;
const AUTHORITY_OF_POINTING: f64 = 3.0;

/// A fraction of a requirement below which a design is far from it.
const FAR: f64 = 0.02;

/// The fraction of the hardest requirement that a trial of a change must show for a search of the ratio to be worth its time;
/// and that the larger change must reach by the power law through what the smaller one does, for it to be tried.
const NEARLY: f64 = 0.9;

/// A change of a quantity with which every requirement was proved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suggestion {
    /// The factor of every number of the quantity.
    pub factor: f64,
    /// The fields of the file that hold the quantity.
    pub fields: Vec<ChangedField>,
}

/// A field of the file with its changed values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangedField {
    /// Its name.
    pub field: &'static str,
    /// Its values.
    pub values: Vec<f64>,
}

impl Suggestion {
    fn of<const N: usize>(factor: f64, fields: [(&'static str, Vec<f64>); N]) -> Option<Self> {
        let fields = fields.map(|(field, values)| ChangedField { field, values });
        Some(Suggestion {
            factor,
            fields: fields.to_vec(),
        })
    }
}

/// Changes a file by a factor above 1 in the direction that makes its requirements easier; `None` where it has no such
/// quantity.
type Change = fn(&mut FactsFile, f64) -> Option<Suggestion>;

/// So many quantities are tried at once; the others where none of them suffices.
const AT_ONCE: usize = 2;

/// The quantities, the likeliest first, with the power of the missing fraction that is needed of each: a
/// pointing error goes with torque, disturbance and error of the sensors; a time to turn with the root of the torque.
fn changes(facts: &Facts, hardest: Option<&str>) -> Vec<(Change, f64)> {
    let has_errors = facts.file.imperfections.measurement.is_some();
    match hardest {
        Some("settle_s") => vec![(more_torque, 2.0)],
        Some("certified_angle_deg") => vec![(more_torque, 1.0), (more_samples, 1.0)],
        // Errors of sensors are what keeps a fine pointing away, where there are any.
        _ if has_errors => vec![
            (less_error, 1.0),
            (less_disturbance, 1.0),
            (more_torque, 1.0),
            (more_samples, 1.0),
        ],
        _ => vec![
            (more_torque, 1.0),
            (less_disturbance, 1.0),
            (more_samples, 1.0),
        ],
    }
}

/// Changes of two quantities at once, tried where no change of one suffices.
fn changes_of_two(hardest: Option<&str>) -> Vec<(Change, f64)> {
    match hardest {
        Some("settle_s" | "certified_angle_deg") => Vec::new(),
        _ => vec![(less_disturbance_and_error, 1.0)],
    }
}

/// For each quantity the smallest of a few changes with which every requirement is proved, where there is one. `found` is
/// what was found without a change: its way is the only one that is tried again.
///
/// # Errors
/// A problem that the solver refuses. What was found is kept when the observer stops.
pub fn suggestions(
    facts: &Facts,
    found: &Best,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Vec<Suggestion>, SynthesisError> {
    let candidate = found.candidate.as_ref();
    let hardest = candidate.and_then(Candidate::hardest);
    let search = ChangeSearch {
        facts,
        ways: candidate.map_or_else(|| Recipe::ways(facts), |found| vec![found.recipe]),
        trial: candidate.and_then(trial),
        fraction: hardest.map(Answered::fraction),
        solvers,
        observer,
    };
    let name = hardest.map(|hardest| hardest.requirement);
    let (single, two) = (changes(facts, name), changes_of_two(name));
    for changes in single.chunks(AT_ONCE).chain([two.as_slice()]) {
        let out = search.among(changes)?;
        if !out.is_empty() {
            return Ok(out);
        }
    }
    Ok(Vec::new())
}

/// The search for a change that suffices.
struct ChangeSearch<'a> {
    facts: &'a Facts,
    /// The recipes that are tried.
    ways: Vec<Recipe>,
    /// The same with the ratio of two sets that the best design has: a solve or two, to see whether a change helps.
    trial: Option<Recipe>,
    /// What is met of the hardest requirement.
    fraction: Option<f64>,
    solvers: &'a Solvers,
    observer: Option<Observer>,
}

impl ChangeSearch<'_> {
    /// Those of some changes that suffice, tried on every processor.
    fn among(&self, changes: &[(Change, f64)]) -> Result<Vec<Suggestion>, SynthesisError> {
        let changes = changes.par_iter();
        let tried: Vec<_> = changes.map(|&change| self.smallest(change)).collect();
        let kept = tried.into_iter().filter_map(|tried| match tried {
            Err(SynthesisError::Cancelled(_)) | Ok(None) => None,
            Err(error) => Some(Err(error)),
            Ok(Some(suggestion)) => Some(Ok(suggestion)),
        });
        kept.collect()
    }

    /// The smallest change of a quantity that suffices.
    fn smallest(
        &self,
        (change, power): (Change, f64),
    ) -> Result<Option<Suggestion>, SynthesisError> {
        let [small, large] = self.factors(power);
        if self.ways.len() == 1 {
            return self.first_of(change, [small, large]);
        }
        // From afar the larger one first: where it does not suffice none does.
        let (Some(suffices), _) = self.with_change(change, large)? else {
            return Ok(None);
        };
        Ok(self.with_change(change, small)?.0.or(Some(suffices)))
    }

    /// The first of two changes of a quantity that suffices. A trial shows first whether a search of the ratio of two sets is
    /// worth its time; what suffices is proved as the user's own call would prove it.
    fn first_of(
        &self,
        change: Change,
        factors: [f64; 2],
    ) -> Result<Option<Suggestion>, SynthesisError> {
        for factor in factors {
            // Without a design the ratio may be another one.
            let mut fraction = self.shown(change, factor)?;
            if fraction.is_none_or(|fraction| fraction >= NEARLY) {
                let (suffices, found) = self.with_change(change, factor)?;
                if suffices.is_some() {
                    return Ok(suffices);
                }
                fraction = found;
            }
            let before = self.fraction.unwrap_or(0.0);
            let may_suffice = |with: f64| {
                let power = (with / before).ln() / factor.ln();
                before * factors[1].powf(power) >= NEARLY
            };
            if !fraction.is_some_and(may_suffice) {
                return Ok(None);
            }
        }
        Ok(None)
    }

    /// The fraction of the hardest requirement that a trial of a change shows, where there is a way to try it.
    fn shown(&self, change: Change, factor: f64) -> Result<Option<f64>, SynthesisError> {
        let changed = self.changed(change, factor);
        let (Some(trial), Some((_, changed))) = (self.trial, changed) else {
            return Ok(None);
        };
        let observer = self.observer.clone();
        let shown = candidate(&changed, trial, "", self.solvers, observer)?;
        Ok(shown.map(|shown| shown.fraction()))
    }

    /// The change of a quantity by a factor, where every requirement is proved with it; and the fraction of the hardest one
    /// that is.
    fn with_change(
        &self,
        change: Change,
        factor: f64,
    ) -> Result<(Option<Suggestion>, Option<f64>), SynthesisError> {
        let Some((suggestion, changed)) = self.changed(change, factor) else {
            return Ok((None, None));
        };
        let observer = self.observer.clone();
        let found = among(&changed, &self.ways, "", self.solvers, observer, &|_| {})?;
        let fraction = found.candidate.as_ref().map(Candidate::fraction);
        Ok((found.meets_all().then_some(suggestion), fraction))
    }

    /// The file with a quantity changed; `None` where it has none such, or may not hold the number.
    fn changed(&self, change: Change, factor: f64) -> Option<(Suggestion, Facts)> {
        let mut file = self.facts.file.clone();
        let suggestion = change(&mut file, short(factor))?;
        Some((suggestion, Facts::new(file).ok()?))
    }

    /// What a quantity is changed by, the smallest first: by what is missing of the hardest requirement, where a design comes
    /// near to it.
    fn factors(&self, power: f64) -> [f64; 2] {
        match self.fraction.filter(|fraction| *fraction > FAR) {
            Some(fraction) => FACTORS.map(|factor| factor / fraction.min(1.0).powf(power)),
            None => FACTORS_FROM_AFAR.map(|factor| factor * missing_authority(self.facts)),
        }
    }
}

/// The recipe of a design with two sets, with their ratio.
fn trial(found: &Candidate) -> Option<Recipe> {
    let coupling = found.design.file.provenance.coupling?;
    Some(found.recipe.at_ratio(Some(coupling.inner_scale)))
}

/// By how much the torque over the disturbance is too small for designs to be found; at least 1.
fn missing_authority(facts: &Facts) -> f64 {
    let pointing = facts.file.requirements.pointing_deg;
    let needed = pointing.map_or(0.0, |pointing| {
        AUTHORITY_OF_POINTING * wanted_angle(facts).to_degrees() / pointing
    });
    (needed.max(LEAST_AUTHORITY) / facts.authority()).max(1.0)
}

/// Two significant digits, rounded up.
fn short(factor: f64) -> f64 {
    let unit = 10f64.powf(factor.log10().floor() - 1.0);
    (factor / unit - 1e-9).ceil() * unit
}

fn more_torque(file: &mut FactsFile, factor: f64) -> Option<Suggestion> {
    let FactsPlant::Exact(craft) = &mut file.plant;
    craft.torque_limit_nm = craft.torque_limit_nm.map(|limit| limit * factor);
    let values = craft.torque_limit_nm.to_vec();
    Suggestion::of(factor, [("plant.exact.torque_limit_nm", values)])
}

fn less_disturbance(file: &mut FactsFile, factor: f64) -> Option<Suggestion> {
    let FactsPlant::Exact(craft) = &mut file.plant;
    craft.disturbance_bound_nm /= factor;
    let value = vec![craft.disturbance_bound_nm];
    Suggestion::of(1.0 / factor, [("plant.exact.disturbance_bound_nm", value)])
}

fn less_error(file: &mut FactsFile, factor: f64) -> Option<Suggestion> {
    let bounds = file.imperfections.measurement.as_mut()?;
    let (rate, attitude) = (bounds.rate_rad_s.as_mut()?, bounds.attitude_deg.as_mut()?);
    *rate /= factor;
    *attitude /= factor;
    let fields = [
        ("imperfections.measurement.rate_rad_s", vec![*rate]),
        ("imperfections.measurement.attitude_deg", vec![*attitude]),
    ];
    Suggestion::of(1.0 / factor, fields)
}

fn less_disturbance_and_error(file: &mut FactsFile, factor: f64) -> Option<Suggestion> {
    let mut both = less_error(file, factor)?;
    both.fields.extend(less_disturbance(file, factor)?.fields);
    Some(both)
}

fn more_samples(file: &mut FactsFile, factor: f64) -> Option<Suggestion> {
    if file.requirements.messages_per_s.is_some() {
        return None;
    }
    let specs = &mut file.specs;
    if let Some(rate) = &mut specs.sample_hz {
        *rate *= factor;
        return Suggestion::of(factor, [("specs.sample_hz", vec![*rate])]);
    }
    let interval = specs.hbar_s.as_mut()?;
    *interval /= factor;
    Suggestion::of(1.0 / factor, [("specs.hbar_s", vec![*interval])])
}
