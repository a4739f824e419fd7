//! A search along coordinates: each number of the shape is multiplied and divided by a factor; what
//! lowers the penalty is kept, and when nothing does, the factor shrinks. It ends as soon as every
//! training run meets the requirements with a margin, so the shape stays near the one that it began
//! with. There is no random number in it.

use nalgebra::Vector3;

use super::file::{Requirements, Start};
use super::shape::Shape;
use super::trial::{every, starts, Trial};
use crate::batch::engine::{Control, Interrupted, Threads};

/// Factor that the search begins with.
const FIRST_FACTOR: f64 = 1.35;
/// Factor below which it gives up.
const LAST_FACTOR: f64 = 1.03;
/// Worst runs that a candidate must improve on before the others are run.
const PROBES: usize = 4;

/// A search and where it stands.
pub struct Search<'a> {
    requirements: &'a Requirements,
    threads: &'a Threads,
    shape: Shape,
    /// Sum of the penalties of the training runs.
    penalty: f64,
    candidates: usize,
    most_candidates: usize,
}

impl<'a> Search<'a> {
    /// A search that tries at most so many candidates in all.
    pub fn new(
        requirements: &'a Requirements,
        threads: &'a Threads,
        most_candidates: usize,
    ) -> Self {
        Search {
            requirements,
            threads,
            shape: Shape::default(),
            penalty: f64::INFINITY,
            candidates: 0,
            most_candidates,
        }
    }

    /// The best shape so far.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The sum of its penalties; 0 when every training run meets the requirements with a margin.
    pub fn penalty(&self) -> f64 {
        self.penalty
    }

    /// Candidates tried.
    pub fn candidates(&self) -> usize {
        self.candidates
    }

    /// Whether no candidate is left.
    pub fn exhausted(&self) -> bool {
        self.candidates >= self.most_candidates
    }

    /// Searches from the best shape so far.
    ///
    /// # Errors
    /// It was stopped.
    pub fn run(&mut self, axes: &[Vector3<f64>], control: &Control) -> Result<(), Interrupted> {
        let starts = starts(axes);
        let trials = self.every(&self.shape, &starts, control)?;
        self.count(control)?;
        self.penalty = total(&trials);
        let mut worst_first = by_penalty(&trials);
        let mut factor = FIRST_FACTOR;
        while self.penalty > 0.0 && !self.exhausted() && factor >= LAST_FACTOR {
            let mut improved = false;
            for index in 0..Shape::COUNT {
                if let Some(order) = self.improve(index, factor, &worst_first, control)? {
                    (worst_first, improved) = (order, true);
                }
                if self.penalty == 0.0 || self.exhausted() {
                    return Ok(());
                }
            }
            if !improved {
                factor = factor.sqrt();
            }
        }
        Ok(())
    }

    /// Moves one number as long as that helps, up or else down; the starts in their new order when it
    /// did.
    fn improve(
        &mut self,
        index: usize,
        factor: f64,
        starts: &[Start],
        control: &Control,
    ) -> Result<Option<Vec<Start>>, Interrupted> {
        let mut order: Option<Vec<Start>> = None;
        for factor in [factor, factor.recip()] {
            while let Some(shape) = self.shape.scaled(index, factor) {
                if self.exhausted() {
                    return Ok(order);
                }
                let starts = order.as_deref().unwrap_or(starts);
                let better = self.better(&shape, starts, control)?;
                self.count(control)?;
                let Some(trials) = better else { break };
                self.penalty = total(&trials);
                self.shape = shape;
                order = Some(by_penalty(&trials));
                if self.penalty == 0.0 {
                    return Ok(order);
                }
            }
            if order.is_some() {
                break;
            }
        }
        Ok(order)
    }

    /// The trials of a candidate when it is better than the best so far.
    fn better(
        &self,
        shape: &Shape,
        starts: &[Start],
        control: &Control,
    ) -> Result<Option<Vec<Trial>>, Interrupted> {
        let (probes, others) = starts.split_at(PROBES.min(starts.len()));
        let mut trials = self.every(shape, probes, control)?;
        if total(&trials) >= self.penalty {
            return Ok(None);
        }
        trials.extend(self.every(shape, others, control)?);
        Ok((total(&trials) < self.penalty).then_some(trials))
    }

    fn every(
        &self,
        shape: &Shape,
        starts: &[Start],
        control: &Control,
    ) -> Result<Vec<Trial>, Interrupted> {
        every(self.requirements, shape, starts, (self.threads, control))
    }

    fn count(&mut self, control: &Control) -> Result<(), Interrupted> {
        self.candidates += 1;
        (control.done)();
        control.check()
    }
}

fn total(trials: &[Trial]) -> f64 {
    trials.iter().map(Trial::penalty).sum()
}

/// The starts, those with the largest penalty first.
fn by_penalty(trials: &[Trial]) -> Vec<Start> {
    let mut order: Vec<(f64, Start)> = trials
        .iter()
        .map(|trial| (trial.penalty(), trial.start))
        .collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    order.into_iter().map(|(_, start)| start).collect()
}
