//! One model after the other is synthesized in natural units and restated in SI units, until one meets every requirement.

use super::answer::{Achieved, Answered};
use super::facts::Facts;
use super::recipe::{stated, Recipe};
use crate::certify::Verdict;
use crate::model::Model;
use crate::programs::{Outcome, Solvers, SynthesisError, Synthesized};
use crate::synthesis::{restated, synthesize};
use sdp::solve::Observer;

/// A proved design, what it achieves, and how it was found.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The recipe.
    pub recipe: Recipe,
    /// The design in SI units, proved there.
    pub design: Box<Synthesized>,
    /// What is proved of it.
    pub achieved: Achieved,
    /// Each requirement with its proved value.
    pub answered: Vec<Answered>,
}

impl Candidate {
    /// Whether every requirement is met.
    pub fn meets_all(&self) -> bool {
        self.answered.iter().all(Answered::is_met)
    }

    /// The requirement of which the smallest fraction is met.
    pub fn hardest(&self) -> Option<&Answered> {
        let answered = self.answered.iter();
        answered.min_by(|one, other| one.fraction().total_cmp(&other.fraction()))
    }

    /// The smallest fraction of a requirement that is met: 1 or above where all are.
    pub fn fraction(&self) -> f64 {
        self.hardest().map_or(f64::INFINITY, Answered::fraction)
    }
}

/// Found so far.
#[derive(Debug, Clone, Default)]
pub struct Best {
    /// The proved design that meets every requirement or, without one, the largest fraction of the hardest.
    pub candidate: Option<Candidate>,
    /// Whether the observer stopped before every way was tried.
    pub stopped: bool,
}

impl Best {
    /// Whether every requirement is met.
    pub fn meets_all(&self) -> bool {
        self.candidate.as_ref().is_some_and(Candidate::meets_all)
    }

    /// The smallest fraction of a requirement that is met; infinite without a design.
    fn fraction(&self) -> f64 {
        let own = self.candidate.as_ref();
        own.map_or(f64::INFINITY, Candidate::fraction)
    }

    fn keep(&mut self, found: Candidate) {
        let own = self.candidate.as_ref();
        if own.is_none_or(|own| found.fraction() > own.fraction()) {
            self.candidate = Some(found);
        }
    }
}

/// After so many proved designs with two sets no other recipe is tried, where the best of them meets less than this fraction
/// of the hardest requirement.
const OUT_OF_REACH: [(u32, f64); 2] = [(1, 0.3), (2, 0.6)];

/// After so many recipes of two sets without a design only the last of them is tried, which decays the slowest.
const ENOUGH_FAILED: u32 = 2;

/// How far the search has come, before a recipe is tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standing {
    /// Recipes tried.
    pub tried: usize,
    /// Recipes that may be tried, with these.
    pub recipes: usize,
    /// The fraction of the hardest requirement that the best design meets; `None` without one.
    pub fraction: Option<f64>,
}

/// What is given how far the search has come.
pub type Watch<'a> = &'a (dyn Fn(Standing) + Sync);

/// The first proved design that meets every requirement; without one the proved design that meets the largest fraction.
/// `text` is the file's. What was found is kept when the observer stops.
///
/// # Errors
/// Stopped by the observer before anything was found; a problem that the solver refuses.
pub fn best(
    facts: &Facts,
    text: &str,
    solvers: &Solvers,
    observer: Option<Observer>,
    watch: Watch,
) -> Result<Best, SynthesisError> {
    let recipes = Recipe::ways(facts);
    let best = among(facts, &recipes, text, solvers, observer.clone(), watch)?;
    if best.candidate.is_some() {
        return Ok(best);
    }
    // Nothing at all was proved: the other solver is asked for two sets too.
    let two = recipes.into_iter().filter(|recipe| recipe.has_two_sets());
    let two: Vec<_> = two.collect();
    for other in solvers.one_by_one().into_iter().skip(1) {
        let found = among(facts, &two, text, &other, observer.clone(), watch)?;
        if found.candidate.is_some() {
            return Ok(found);
        }
    }
    Ok(best)
}

/// The best of some recipes. For two sets the first solver alone is asked: another recipe is the better second way.
pub(super) fn among(
    facts: &Facts,
    recipes: &[Recipe],
    text: &str,
    solvers: &Solvers,
    observer: Option<Observer>,
    watch: Watch,
) -> Result<Best, SynthesisError> {
    let mut best = Best::default();
    if facts.is_overwhelmed() {
        return Ok(best);
    }
    let alone = solvers.one_by_one();
    let (mut proved, mut failed) = (0, 0);
    for (tried, &recipe) in recipes.iter().enumerate() {
        // The small sets of two designs differ by less than what is missing.
        let mut limits = OUT_OF_REACH.iter();
        if limits.any(|&(enough, limit)| proved >= enough && best.fraction() < limit) {
            break;
        }
        // One set, or another search of it, does no better than what leads to the bound in the end already.
        let best_so_far = best.candidate.as_ref();
        let leads = best_so_far.is_some_and(|found| found.achieved.is_handed_over);
        if leads && !recipe.has_two_sets() {
            break;
        }
        // What differs little from two ways that led to nothing is left out.
        let is_last = recipes
            .get(tried + 1)
            .is_none_or(|next| !next.has_two_sets());
        if recipe.has_two_sets() && proved == 0 && failed >= ENOUGH_FAILED && !is_last {
            continue;
        }
        let solvers = match recipe.has_two_sets() {
            true => alone.first().unwrap_or(solvers),
            false => solvers,
        };
        watch(Standing {
            tried,
            recipes: recipes.len(),
            fraction: best.candidate.as_ref().map(Candidate::fraction),
        });
        match candidate(facts, recipe, text, solvers, observer.clone()) {
            Ok(Some(found)) => {
                proved += u32::from(found.recipe.has_two_sets());
                best.keep(found);
            }
            Ok(None) => failed += u32::from(recipe.has_two_sets()),
            Err(SynthesisError::Cancelled(_)) if best.candidate.is_some() => {
                best.stopped = true;
                break;
            }
            Err(error) => return Err(error),
        }
        if best.meets_all() {
            break;
        }
    }
    Ok(best)
}

/// The proved design of a recipe, if it gives one.
///
/// # Errors
/// As [`best`].
pub fn candidate(
    facts: &Facts,
    recipe: Recipe,
    text: &str,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Option<Candidate>, SynthesisError> {
    let stated = stated(facts, recipe);
    let Ok(model) = Model::new(stated.model) else {
        return Ok(None);
    };
    let outcome = match synthesize(&model, text, solvers, observer) {
        // Numbers that no file may hold are one recipe's failure.
        Err(SynthesisError::Invalid(_)) => return Ok(None),
        outcome => outcome?,
    };
    let Outcome::Solved(design) = outcome else {
        return Ok(None);
    };
    let Ok(design) = restated(stated.units, *design) else {
        return Ok(None);
    };
    if design.report.verdict != Verdict::Proved {
        return Ok(None);
    }
    let model = Model::new(design.file.model.clone())?;
    let required = facts.file.requirements.pointing_deg;
    let achieved = Achieved::of(&design.file, &model, required);
    let answered = achieved.answers(facts);
    Ok(Some(Candidate {
        recipe,
        design: Box::new(design),
        achieved,
        answered,
    }))
}
