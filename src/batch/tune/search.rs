//! A search along coordinates: each number of the shape is multiplied and divided by a factor; what
//! lowers the penalty is kept, and when nothing does, the factor shrinks. It ends as soon as every
//! training run meets the requirements with a margin, so the shape stays near the one that it began
//! with. There is no random number in it.

use std::sync::Arc;

use nalgebra::Vector3;

use super::file::{Requirements, Start};
use super::shape::{Shape, COUNT};
use super::trial::{starts, Trial, TrialJob};
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
    control: &'a Control<'a>,
    /// The best shape so far.
    pub shape: Shape,
    /// The sum of its penalties; 0 when every training run meets the requirements with a margin.
    pub penalty: f64,
    /// Candidates tried.
    pub candidates: usize,
}

impl<'a> Search<'a> {
    /// A search that tries at most as many candidates in all as the requirements say.
    pub fn new(
        requirements: &'a Requirements,
        threads: &'a Threads,
        control: &'a Control<'a>,
    ) -> Self {
        Search {
            requirements,
            threads,
            control,
            shape: Shape::default(),
            penalty: f64::INFINITY,
            candidates: 0,
        }
    }

    /// Whether no candidate is left.
    pub fn exhausted(&self) -> bool {
        self.candidates >= self.requirements.file.search.candidates
    }

    /// Searches from the best shape so far.
    ///
    /// # Errors
    /// It was stopped.
    pub fn run(&mut self, axes: &[Vector3<f64>]) -> Result<(), Interrupted> {
        let trials = self.trials(&self.shape, &starts(axes))?;
        self.count()?;
        self.penalty = total(&trials);
        let mut worst_first = by_penalty(&trials);
        let mut factor = FIRST_FACTOR;
        while self.penalty > 0.0 && !self.exhausted() && factor >= LAST_FACTOR {
            let mut improved = false;
            for index in 0..COUNT {
                if let Some(order) = self.improve(index, factor, &worst_first)? {
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
    ) -> Result<Option<Vec<Start>>, Interrupted> {
        let mut order: Option<Vec<Start>> = None;
        for factor in [factor, factor.recip()] {
            while let Some(shape) = self.shape.scaled(index, factor) {
                if self.exhausted() {
                    return Ok(order);
                }
                let better = self.better(&shape, order.as_deref().unwrap_or(starts))?;
                self.count()?;
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
    fn better(&self, shape: &Shape, starts: &[Start]) -> Result<Option<Vec<Trial>>, Interrupted> {
        let (probes, others) = starts.split_at(PROBES.min(starts.len()));
        let mut trials = self.trials(shape, probes)?;
        if total(&trials) >= self.penalty {
            return Ok(None);
        }
        trials.extend(self.trials(shape, others)?);
        Ok((total(&trials) < self.penalty).then_some(trials))
    }

    /// Runs a candidate from every start, in parallel; the trials are in the order of the starts.
    ///
    /// # Errors
    /// It was stopped.
    pub fn trials(&self, shape: &Shape, starts: &[Start]) -> Result<Vec<Trial>, Interrupted> {
        let job = TrialJob {
            requirements: self.requirements,
            shape,
            starts,
        };
        // What is counted is candidates, not runs.
        let control = Control {
            done: &|| {},
            stop: Arc::clone(&self.control.stop),
        };
        self.threads.collect(&job, starts.len(), &control)
    }

    fn count(&mut self) -> Result<(), Interrupted> {
        self.candidates += 1;
        (self.control.done)();
        self.control.check()
    }
}

fn total(trials: &[Trial]) -> f64 {
    trials.iter().map(|trial| trial.penalty).sum()
}

/// The starts, those with the largest penalty first.
fn by_penalty(trials: &[Trial]) -> Vec<Start> {
    let mut order: Vec<&Trial> = trials.iter().collect();
    order.sort_by(|a, b| b.penalty.total_cmp(&a.penalty));
    order.into_iter().map(|trial| trial.start).collect()
}
